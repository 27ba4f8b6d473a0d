//! Pictures in a terminal: kitty graphics where they were asked for, half-blocks everywhere else.

use super::Picture;
use clap::ValueEnum;
use image::{DynamicImage, RgbImage};
use ratatui::layout::{Rect, Size};
use ratatui_image::protocol::{Protocol, halfblocks::Halfblocks, kitty::Kitty};
use std::time::Duration;

/// How pictures reach the terminal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Graphics {
    /// Ask the terminal, for a fifth of a second at most; half-blocks inside tmux and zellij
    #[default]
    Auto,
    /// The kitty protocol
    Kitty,
    /// Two pixels a character, in any terminal with colours
    Halfblocks,
    /// No preview
    Off,
}

/// A way to draw pictures into cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Painter {
    /// Pixels, of which this many wide and high make a cell.
    Kitty {
        /// Pixels of one cell.
        cell: [u16; 2],
    },
    /// Two pixels a cell, one above the other.
    Halfblocks,
}

impl Graphics {
    /// Settles what to use. Call it in raw mode, before any thread reads the keyboard.
    pub fn settle(self) -> Option<Painter> {
        match self {
            Graphics::Off => None,
            Graphics::Halfblocks => Some(Painter::Halfblocks),
            Graphics::Kitty => Some(kitty()),
            Graphics::Auto if in_multiplexer() || misreads_placeholders() || !answers_kitty() => Some(Painter::Halfblocks),
            Graphics::Auto => Some(kitty()),
        }
    }
}

fn is_set(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|v| !v.is_empty())
}

/// Pictures do not stay with their pane there.
fn in_multiplexer() -> bool {
    ["TMUX", "ZELLIJ", "STY"].into_iter().any(is_set)
}

/// Terminals that answer the kitty query and then show its placeholders as text.
fn misreads_placeholders() -> bool {
    ["WEZTERM_EXECUTABLE", "KONSOLE_VERSION"].into_iter().any(is_set)
}

fn kitty() -> Painter {
    let cell = crossterm::terminal::window_size().ok().filter(|s| s.width > 0 && s.columns > 0 && s.rows > 0);
    Painter::Kitty { cell: cell.map_or([10, 20], |s| [(s.width / s.columns).max(1), (s.height / s.rows).max(1)]) }
}

/// Sends a one-pixel kitty query followed by a question that every terminal answers, and waits for
/// that answer.
#[cfg(unix)]
fn answers_kitty() -> bool {
    use std::io::Write;
    const QUERY: &[u8] = b"\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\x1b[c";
    let patience = Duration::from_millis(if is_set("SSH_CONNECTION") { 400 } else { 200 });
    let mut out = std::io::stdout();
    if out.write_all(QUERY).and_then(|()| out.flush()).is_err() {
        return false;
    }
    let reply = read_until(patience, |reply| reply.ends_with(b"c") && reply.windows(3).any(|w| w == b"\x1b[?"));
    reply.windows(7).any(|w| w == b"_Gi=31;") && reply.windows(3).any(|w| w == b";OK")
}

#[cfg(not(unix))]
fn answers_kitty() -> bool {
    false
}

/// Bytes of standard input until `done` or until time is up.
#[cfg(unix)]
fn read_until(patience: Duration, done: impl Fn(&[u8]) -> bool) -> Vec<u8> {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let input = std::io::stdin();
    let end = std::time::Instant::now() + patience;
    let mut reply = Vec::new();
    while !done(&reply) {
        let left = end.saturating_duration_since(std::time::Instant::now());
        let timeout = Timespec { tv_sec: 0, tv_nsec: i64::from(left.subsec_nanos()) };
        let mut files = [PollFd::new(&input, PollFlags::IN)];
        if left.is_zero() || !matches!(poll(&mut files, Some(&timeout)), Ok(1..)) {
            break;
        }
        let mut bytes = [0u8; 64];
        match rustix::io::read(&input, &mut bytes) {
            Ok(count @ 1..) => reply.extend_from_slice(&bytes[..count]),
            _ => break,
        }
    }
    reply
}

impl Painter {
    /// Fits a picture into `area`, its shape kept, its middle in the middle; the cells it takes and
    /// what to draw there. `turn` alternates, so that one kitty image is replaced by another.
    pub fn paint(self, picture: &Picture, area: Rect, turn: u32) -> Option<(Rect, Protocol)> {
        // Half-blocks are square pixels of half a cell; kitty gets half of the screen's resolution,
        // which a quarter of the bytes carries.
        let pixels = match self {
            Painter::Halfblocks => [1.0, 2.0],
            Painter::Kitty { cell } => [f64::from(cell[0]) / 2.0, f64::from(cell[1]) / 2.0],
        };
        let cell_aspect = pixels[1] / pixels[0];
        let aspect = f64::from(picture.size[0]) / f64::from(picture.size[1]);
        let height = f64::from(area.height).min(f64::from(area.width) / aspect / cell_aspect);
        let size =
            Size { width: ((height * aspect * cell_aspect).round() as u16).clamp(1, area.width.max(1)), height: (height.round() as u16).max(1) };
        if area.is_empty() || size.height > area.height {
            return None;
        }
        let image = RgbImage::from_raw(picture.size[0], picture.size[1], picture.rgb8.to_vec())?;
        let wanted = [f64::from(size.width) * pixels[0], f64::from(size.height) * pixels[1]].map(|v| v.round().max(1.0) as u32);
        let image = DynamicImage::ImageRgb8(image::imageops::thumbnail(&image, wanted[0], wanted[1]));
        let protocol = match self {
            Painter::Halfblocks => Protocol::Halfblocks(Halfblocks::new(image, size).ok()?),
            Painter::Kitty { .. } => Protocol::Kitty(Kitty::new(image, size, KITTY_ID + turn % 2, false, false).ok()?),
        };
        let place =
            Rect { x: area.x + (area.width - size.width) / 2, y: area.y + (area.height - size.height) / 2, width: size.width, height: size.height };
        Some((place, protocol))
    }
}

/// First of the two image numbers that this program uses with kitty; below 2^24, so that a colour carries it.
const KITTY_ID: u32 = 0x50_48_59;

/// Tells kitty to forget our pictures; nothing where the terminal never had one.
pub fn forget_pictures(painter: Option<Painter>) -> String {
    match painter {
        Some(Painter::Kitty { .. }) => (0..2).map(|n| format!("\x1b_Ga=d,d=I,i={},q=2\x1b\\", KITTY_ID + n)).collect(),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::{Terminal, backend::TestBackend};
    use ratatui_image::Image;

    fn picture() -> Picture {
        let shades = (0..36).flat_map(|y| [100 + y as u8 * 4; 64 * 3]);
        Picture { index: 0, time_s: 0.0, size: [64, 36], rgb8: shades.collect::<Vec<u8>>().into() }
    }

    fn drawn(painter: Painter) -> Terminal<TestBackend> {
        let mut terminal = Terminal::new(TestBackend::new(40, 12)).unwrap();
        let (place, protocol) = painter.paint(&picture(), Rect::new(0, 0, 40, 12), 0).unwrap();
        assert_eq!((place.width, place.height), (40, 11));
        terminal.draw(|f| f.render_widget(Image::new(&protocol), place)).unwrap();
        terminal
    }

    #[test]
    fn half_blocks_fill_the_area_in_the_pictures_shape() {
        let terminal = drawn(Painter::Halfblocks);
        let cell = &terminal.backend().buffer()[(20, 5)];
        assert!(matches!(cell.symbol(), "▀" | "▄"), "{cell:?}");
        assert_ne!(cell.fg, cell.bg, "the upper half is darker than the lower one");
    }

    #[test]
    fn kitty_sends_pixels_once_and_placeholders_after() {
        let terminal = drawn(Painter::Kitty { cell: [10, 20] });
        let symbols: Vec<&str> = terminal.backend().buffer().content().iter().map(|c| c.symbol()).collect();
        assert!(symbols[0].contains("\x1b_G"), "the first cell carries the pixels");
        assert!(symbols.iter().filter(|s| s.contains('\u{10EEEE}')).count() >= 11, "each row shows placeholders");
    }

    #[test]
    fn no_room_no_picture() {
        assert!(Painter::Halfblocks.paint(&picture(), Rect::new(0, 0, 0, 5), 0).is_none());
    }
}
