//! Styles: the terminal's own sixteen colours, and none where `NO_COLOR` is set. No meaning hangs
//! on a colour alone.

use ratatui::style::{Color, Modifier, Style};

/// One style for each meaning.
#[derive(Clone, Copy, Debug)]
pub struct Theme {
    /// Ordinary text.
    pub plain: Style,
    /// The user's words, titles.
    pub strong: Style,
    /// Listings, frames, hints.
    pub dim: Style,
    /// What changed, progress.
    pub accent: Style,
    /// Warnings.
    pub warning: Style,
    /// Failures.
    pub error: Style,
}

impl Theme {
    /// With colours unless the user asked for none.
    pub fn from_environment() -> Theme {
        if std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty()) { Theme::plain() } else { Theme::coloured() }
    }

    /// Weights only.
    pub fn plain() -> Theme {
        let plain = Style::default();
        let strong = plain.add_modifier(Modifier::BOLD);
        Theme { plain, strong, dim: plain.add_modifier(Modifier::DIM), accent: plain, warning: strong, error: strong }
    }

    fn coloured() -> Theme {
        let plain = Style::default();
        Theme {
            plain,
            strong: plain.add_modifier(Modifier::BOLD),
            dim: plain.fg(Color::DarkGray),
            accent: plain.fg(Color::Cyan),
            warning: plain.fg(Color::Yellow),
            error: plain.fg(Color::Red),
        }
    }
}
