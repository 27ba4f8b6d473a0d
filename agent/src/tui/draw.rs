//! Where things are on the screen. From 110 columns the preview stands beside the transcript; below
//! that it lies above it, and under 24 rows it is folded away unless asked for.

use super::app::App;
use super::pane::Play;
use crate::cli::sanitise::is_unprintable;
use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Paragraph};
use ratatui_image::Image;

/// From this width on the preview stands beside the transcript.
const WIDE: u16 = 110;
/// Under this height the preview is folded away.
const TALL: u16 = 24;
/// Most rows of the composer.
const COMPOSER_ROWS: u16 = 8;

/// The parts of the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// What was said.
    pub transcript: Rect,
    /// The picture and its caption, where shown.
    pub preview: Option<Rect>,
    /// What is being typed, its upper edge included.
    pub composer: Rect,
    /// The last row.
    pub status: Rect,
}

/// Divides the screen.
pub fn parts(area: Rect, composer_rows: u16, preview: Option<bool>, has_pictures: bool) -> Parts {
    let typed = composer_rows.clamp(1, COMPOSER_ROWS.min(area.height.saturating_sub(4).max(1))) + 1;
    let [main, composer, status] = Layout::vertical([Constraint::Min(1), Constraint::Length(typed), Constraint::Length(1)]).areas(area);
    let shown = has_pictures && preview.unwrap_or(area.width >= WIDE || area.height >= TALL);
    if !shown || main.height < 5 {
        return Parts { transcript: main, preview: None, composer, status };
    }
    let [transcript, preview] = if area.width >= WIDE {
        Layout::horizontal([Constraint::Percentage(58), Constraint::Percentage(42)]).areas(main)
    } else {
        let rows = 12.min(main.height / 2).max(4);
        let [preview, transcript] = Layout::vertical([Constraint::Length(rows), Constraint::Min(1)]).areas(main);
        [transcript, preview]
    };
    Parts { transcript, preview: Some(preview), composer, status }
}

/// Draws everything.
pub fn draw(app: &mut App, frame: &mut Frame<'_>) {
    let area = frame.area();
    let prompt_width = area.width.saturating_sub(2).max(2);
    let (rows, cursor) = app.composer.rows(prompt_width);
    let parts = parts(area, rows.len() as u16, app.preview_shown, !app.pane.is_empty());
    transcript(app, frame, parts.transcript);
    composer(app, frame, parts.composer, &rows, cursor);
    frame.render_widget(Paragraph::new(status(app, parts.status.width)), parts.status);
    let [picture, line] = Layout::vertical([Constraint::Min(1), Constraint::Length(1)]).areas(parts.preview.unwrap_or_default());
    if parts.preview.is_some() {
        caption(app, frame, line);
    }
    replace_unprintable(frame.buffer_mut());
    // Kitty's pictures are escapes in cells, so they come last.
    if parts.preview.is_some()
        && let Some((place, protocol)) = app.pane.painted(picture)
    {
        frame.render_widget(Image::new(protocol), place);
    }
}

/// Keeps escapes and direction overrides off the terminal, whatever text was drawn.
fn replace_unprintable(buffer: &mut Buffer) {
    for cell in &mut buffer.content {
        if cell.symbol().contains(is_unprintable) {
            cell.set_symbol("\u{fffd}");
        }
    }
}

fn transcript(app: &mut App, frame: &mut Frame<'_>, area: Rect) {
    let lines = app.transcript.view(area.width.saturating_sub(1), area.height, &app.theme);
    let rows = (lines.len() as u16).min(area.height);
    let bottom = Rect { y: area.y + area.height - rows, height: rows, ..area };
    frame.render_widget(Paragraph::new(lines), bottom);
}

fn caption(app: &App, frame: &mut Frame<'_>, area: Rect) {
    if let Some(c) = app.pane.caption() {
        let state = match c.play {
            Play::Playing => " playing",
            Play::Paused => " paused · Alt+P plays",
            Play::Still | Play::Following => "",
        };
        let text = match c.play {
            Play::Still => c.version,
            _ => format!("{} {:>3}/{} {:.2} s{state}", c.version, c.frame, c.last, c.time_s),
        };
        frame.render_widget(Paragraph::new(Line::styled(text, app.theme.dim)).centered(), area);
    }
}

fn composer(app: &App, frame: &mut Frame<'_>, area: Rect, rows: &[String], cursor: (u16, u16)) {
    let block = Block::new().borders(Borders::TOP).border_style(app.theme.dim);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let first = (cursor.1 + 1).saturating_sub(inner.height);
    let lines: Vec<Line<'_>> = if app.composer.is_empty() {
        let hint = if app.running.is_some() { "type ahead; Esc stops" } else { "say what should happen, or /help" };
        vec![Line::from(vec![Span::styled("> ", app.theme.strong), Span::styled(hint, app.theme.dim)])]
    } else {
        let mark = |index: usize| if index == 0 { "> " } else { "  " };
        rows.iter()
            .enumerate()
            .skip(usize::from(first))
            .map(|(i, r)| Line::from(vec![Span::styled(mark(i), app.theme.strong), Span::raw(r.as_str())]))
            .collect()
    };
    frame.render_widget(Paragraph::new(lines), inner);
    frame.set_cursor_position((inner.x + 2 + cursor.0, inner.y + cursor.1 - first));
}

/// The last row: where the run is, else session, version and device.
fn status(app: &App, width: u16) -> Line<'static> {
    let queued = match app.queued() {
        0 => String::new(),
        n => format!(" · {n} queued"),
    };
    let Some(running) = &app.running else {
        let version = if app.version.is_empty() { "no version yet" } else { &app.version };
        let device = if app.device.is_empty() { String::new() } else { format!(" · {}", app.device) };
        return Line::styled(clip(format!("{} · {version}{device}{queued}", app.session), width), app.theme.dim);
    };
    let (done, total) = running.done;
    let bar = if total > 0 { format!(" {} {done}/{total}", bar(done, total)) } else { String::new() };
    let left = running.seconds_left.map(|s| format!(" · {} left", crate::conversation::duration(s))).unwrap_or_default();
    let state = if running.stopping { "stopping" } else { running.stage.as_str() };
    Line::styled(clip(format!("{state}{bar}{left}{queued}"), width), app.theme.accent)
}

/// Twelve cells of progress.
fn bar(done: u64, total: u64) -> String {
    let filled = (done.min(total) * 12 / total.max(1)) as usize;
    format!("[{}{}]", "=".repeat(filled), " ".repeat(12 - filled))
}

fn clip(text: String, width: u16) -> String {
    if text.chars().count() <= usize::from(width) {
        text
    } else {
        text.chars().take(usize::from(width).saturating_sub(1)).chain(std::iter::once('…')).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_fits_at_every_size() {
        for (width, height) in [(40, 12), (80, 24), (120, 40), (200, 60), (10, 4), (1, 1)] {
            for rows in [1, 3, 20] {
                for preview in [None, Some(true), Some(false)] {
                    let area = Rect::new(0, 0, width, height);
                    let parts = parts(area, rows, preview, true);
                    for part in [Some(parts.transcript), parts.preview, Some(parts.composer), Some(parts.status)].into_iter().flatten() {
                        assert_eq!(part.intersection(area), part, "{width}x{height} {rows} {preview:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_preview_is_beside_above_or_folded() {
        let at = |w, h, preview| parts(Rect::new(0, 0, w, h), 1, preview, true).preview;
        assert!(at(120, 40, None).is_some_and(|p| p.x > 60 && p.height > 30));
        assert!(at(80, 24, None).is_some_and(|p| p.y == 0 && p.width == 80));
        assert_eq!(at(40, 12, None), None);
        assert!(at(40, 12, Some(true)).is_some());
        assert_eq!(at(120, 40, Some(false)), None);
    }
}
