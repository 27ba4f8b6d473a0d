//! What was said and what came of it, as lines of the width at hand.

use super::theme::Theme;
use crate::cli::sanitise;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

/// Who speaks, or what kind of thing is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Voice {
    /// The user's words or command.
    You,
    /// A sentence of the program.
    Agent,
    /// A change of the spec.
    Change,
    /// A row of a plan, a measurement, a listing: not wrapped at words.
    Detail,
    /// Something the user should know.
    Warning,
    /// A failure.
    Error,
}

#[derive(Clone, Debug)]
struct Entry {
    voice: Voice,
    text: String,
}

/// All entries, and how far the view is scrolled up from the end.
#[derive(Clone, Debug, Default)]
pub struct Transcript {
    entries: Vec<Entry>,
    /// Lines between the end and the bottom of the view.
    up: usize,
    /// Lines of the last drawing and the rows it had, for scrolling.
    extent: (usize, usize),
}

impl Transcript {
    /// Adds an entry at the end and shows the end. Control characters are shown as escapes.
    pub fn add(&mut self, voice: Voice, text: impl AsRef<str>) {
        self.entries.push(Entry { voice, text: sanitise::text(text.as_ref()).into_owned() });
        self.up = 0;
    }

    /// Scrolls by pages, positive to older lines.
    pub fn scroll_pages(&mut self, pages: isize) {
        let (lines, rows) = self.extent;
        let step = rows.saturating_sub(2).max(1) as isize * pages;
        self.up = self.up.saturating_add_signed(step).min(lines.saturating_sub(rows));
    }

    /// The lines that `rows` rows show.
    pub fn view(&mut self, width: u16, rows: u16, theme: &Theme) -> Vec<Line<'static>> {
        let lines: Vec<Line<'static>> = self.entries.iter().flat_map(|e| wrapped(e, usize::from(width), theme)).collect();
        self.extent = (lines.len(), usize::from(rows));
        self.up = self.up.min(lines.len().saturating_sub(usize::from(rows)));
        let end = lines.len() - self.up;
        lines[end.saturating_sub(usize::from(rows))..end].to_vec()
    }
}

fn wrapped(entry: &Entry, width: usize, theme: &Theme) -> Vec<Line<'static>> {
    let (mark, style): (&str, Style) = match entry.voice {
        Voice::You => ("> ", theme.strong),
        Voice::Agent => ("", theme.plain),
        Voice::Change => ("  ", theme.accent),
        Voice::Detail => ("  ", theme.dim),
        Voice::Warning => ("! ", theme.warning),
        Voice::Error => ("x ", theme.error),
    };
    let room = width.saturating_sub(mark.len()).max(4);
    let mut lines = Vec::new();
    for (index, row) in entry.text.lines().flat_map(|l| wrap(l, room)).enumerate() {
        let lead = if index == 0 { mark.to_owned() } else { " ".repeat(mark.len()) };
        lines.push(Line::from(vec![Span::styled(lead, style), Span::styled(row, style)]));
    }
    lines
}

/// Breaks a line at blanks, and inside a word only where it is longer than a row.
fn wrap(line: &str, room: usize) -> Vec<String> {
    let width = |s: &str| Span::raw(s).width();
    if width(line) <= room {
        return vec![line.to_owned()];
    }
    let indent: String = line.chars().take_while(|c| *c == ' ').take(room / 2).collect();
    let mut rows = vec![indent.clone()];
    for word in line.split(' ').filter(|w| !w.is_empty()) {
        let row = rows.last().map_or(0, |r| width(r));
        let fresh = rows.last().is_none_or(|r| r.trim().is_empty());
        if fresh && row + width(word) <= room {
            rows.last_mut().into_iter().for_each(|r| r.push_str(word));
        } else if row + 1 + width(word) <= room {
            rows.last_mut().into_iter().for_each(|r| {
                r.push(' ');
                r.push_str(word);
            });
        } else {
            if !fresh {
                rows.push(indent.clone());
            }
            break_word(word, room, &mut rows);
        }
    }
    rows
}

/// Appends a word to the last row, going on in new rows where it does not fit.
fn break_word(word: &str, room: usize, rows: &mut Vec<String>) {
    for c in word.chars() {
        let full = rows.last().is_none_or(|r| Span::raw(r.as_str()).width() + Span::raw(c.to_string()).width() > room);
        if full {
            rows.push(String::new());
        }
        rows.last_mut().into_iter().for_each(|r| r.push(c));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(transcript: &mut Transcript, width: u16, rows: u16) -> Vec<String> {
        transcript.view(width, rows, &Theme::plain()).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn lines_break_at_blanks_and_long_words_anywhere() {
        assert_eq!(wrap("the vase jumps up", 9), ["the vase", "jumps up"]);
        assert_eq!(wrap("  object.vase.material", 12), ["  object.vas", "e.material"]);
        assert_eq!(wrap("a bb", 4), ["a bb"]);
    }

    #[test]
    fn the_end_is_shown_and_pages_go_back() {
        let mut transcript = Transcript::default();
        (0..20).for_each(|i| transcript.add(Voice::Agent, format!("line {i}")));
        assert_eq!(texts(&mut transcript, 40, 3), ["line 17", "line 18", "line 19"]);
        transcript.scroll_pages(2);
        assert_eq!(texts(&mut transcript, 40, 3), ["line 15", "line 16", "line 17"]);
        transcript.scroll_pages(100);
        assert_eq!(texts(&mut transcript, 40, 3), ["line 0", "line 1", "line 2"]);
        transcript.add(Voice::You, "more");
        assert_eq!(texts(&mut transcript, 40, 1), ["> more"]);
    }
}
