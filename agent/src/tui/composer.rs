//! The line editor: several lines, a history, the usual keys.

use crate::cli::sanitise::is_unprintable;
use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::text::Span;

/// Most entries kept in the history.
const HISTORY: usize = 500;

/// What is being typed.
#[derive(Clone, Debug, Default)]
pub struct Composer {
    text: Vec<char>,
    cursor: usize,
    history: Vec<String>,
    /// Position in the history while walking it, and what was being typed before.
    recall: Option<(usize, Vec<char>)>,
}

/// What a key meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Typed {
    /// Nothing to the composer.
    Ignored,
    /// The text or the cursor changed.
    Changed,
    /// Enter: the finished text.
    Sent(String),
}

impl Composer {
    /// The text as it is.
    pub fn text(&self) -> String {
        self.text.iter().collect()
    }

    /// Whether nothing is typed.
    pub fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    /// Replaces the text, cursor at its end.
    pub fn set(&mut self, text: &str) {
        self.text = text.chars().collect();
        self.cursor = self.text.len();
        self.recall = None;
    }

    /// Inserts pasted text without its control characters.
    pub fn paste(&mut self, text: &str) {
        let clean = text.replace("\r\n", "\n").replace(['\r', '\t'], " ");
        let before = self.text.len();
        self.text.splice(self.cursor..self.cursor, clean.chars().filter(|c| !is_unprintable(*c)));
        self.cursor += self.text.len() - before;
        self.recall = None;
    }

    /// Takes a key.
    pub fn key(&mut self, key: KeyEvent) -> Typed {
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        let alt = key.modifiers.contains(KeyModifiers::ALT);
        match key.code {
            KeyCode::Enter if alt || key.modifiers.contains(KeyModifiers::SHIFT) => self.insert('\n'),
            KeyCode::Enter => return self.send(),
            KeyCode::Char('j') if control => self.insert('\n'),
            KeyCode::Char('a') if control => self.cursor = self.line_start(),
            KeyCode::Char('e') if control => self.cursor = self.line_end(),
            KeyCode::Char('b') if control => self.cursor = self.cursor.saturating_sub(1),
            KeyCode::Char('f') if control => self.cursor = (self.cursor + 1).min(self.text.len()),
            KeyCode::Char('w') if control => self.delete(self.word_left(), self.cursor),
            KeyCode::Char('u') if control => self.delete(self.line_start(), self.cursor),
            KeyCode::Char('k') if control => self.delete(self.cursor, self.line_end()),
            KeyCode::Char('b') if alt => self.cursor = self.word_left(),
            KeyCode::Char('f') if alt => self.cursor = self.word_right(),
            KeyCode::Left if control || alt => self.cursor = self.word_left(),
            KeyCode::Right if control || alt => self.cursor = self.word_right(),
            KeyCode::Left => self.cursor = self.cursor.saturating_sub(1),
            KeyCode::Right => self.cursor = (self.cursor + 1).min(self.text.len()),
            KeyCode::Home => self.cursor = self.line_start(),
            KeyCode::End => self.cursor = self.line_end(),
            KeyCode::Backspace if self.cursor > 0 => self.delete(if alt { self.word_left() } else { self.cursor - 1 }, self.cursor),
            KeyCode::Backspace => return Typed::Changed,
            KeyCode::Delete => self.delete(self.cursor, (self.cursor + 1).min(self.text.len())),
            KeyCode::Up => self.up(),
            KeyCode::Down => self.down(),
            KeyCode::Char(c) if !control && !alt && !is_unprintable(c) => self.insert(c),
            _ => return Typed::Ignored,
        }
        Typed::Changed
    }

    fn insert(&mut self, c: char) {
        self.text.insert(self.cursor, c);
        self.cursor += 1;
        self.recall = None;
    }

    fn delete(&mut self, from: usize, to: usize) {
        self.text.drain(from..to);
        self.cursor = from;
        self.recall = None;
    }

    fn send(&mut self) -> Typed {
        let text = self.text().trim().to_owned();
        if text.is_empty() {
            return Typed::Changed;
        }
        if self.history.last() != Some(&text) {
            self.history.push(text.clone());
            self.history.drain(..self.history.len().saturating_sub(HISTORY));
        }
        self.set("");
        Typed::Sent(text)
    }

    fn line_start(&self) -> usize {
        self.text[..self.cursor].iter().rposition(|c| *c == '\n').map_or(0, |i| i + 1)
    }

    fn line_end(&self) -> usize {
        self.text[self.cursor..].iter().position(|c| *c == '\n').map_or(self.text.len(), |i| self.cursor + i)
    }

    fn word_left(&self) -> usize {
        let skipped = self.text[..self.cursor].iter().rposition(|c| c.is_alphanumeric()).map_or(0, |i| i + 1);
        self.text[..skipped].iter().rposition(|c| !c.is_alphanumeric()).map_or(0, |i| i + 1)
    }

    fn word_right(&self) -> usize {
        let rest = &self.text[self.cursor..];
        let start = rest.iter().position(|c| c.is_alphanumeric()).unwrap_or(rest.len());
        let word = rest[start..].iter().position(|c| !c.is_alphanumeric()).unwrap_or(rest.len() - start);
        self.cursor + start + word
    }

    /// One line up, or back in the history from the first line.
    fn up(&mut self) {
        let start = self.line_start();
        if start > 0 {
            let column = self.cursor - start;
            self.cursor = start - 1;
            self.cursor = (self.line_start() + column).min(start - 1);
            return;
        }
        let at = self.recall.as_ref().map_or(self.history.len(), |(i, _)| *i);
        if at > 0 {
            self.show_history(at - 1);
        }
    }

    /// One line down, or forward in the history from the last line.
    fn down(&mut self) {
        let end = self.line_end();
        if end < self.text.len() {
            let column = self.cursor - self.line_start();
            self.cursor = end + 1;
            self.cursor = (self.cursor + column).min(self.line_end());
            return;
        }
        match self.recall.take() {
            Some((i, typed)) if i + 1 >= self.history.len() => {
                self.cursor = typed.len();
                self.text = typed;
            }
            Some((i, typed)) => {
                self.recall = Some((i, typed));
                self.show_history(i + 1);
            }
            None => {}
        }
    }

    fn show_history(&mut self, index: usize) {
        let typed = self.recall.take().map_or_else(|| self.text.clone(), |(_, typed)| typed);
        self.text = self.history[index].chars().collect();
        self.cursor = self.text.len();
        self.recall = Some((index, typed));
    }

    /// The text as rows of at most `width` columns, and the cursor's column and row.
    pub fn rows(&self, width: u16) -> (Vec<String>, (u16, u16)) {
        let width = usize::from(width.max(2));
        let (mut rows, mut cursor) = (vec![String::new()], (0, 0));
        let mut column = 0;
        for (index, c) in self.text.iter().copied().chain(std::iter::once(' ')).enumerate() {
            let wide = if c == '\n' { 0 } else { Span::raw(c.to_string()).width() };
            if column + wide > width {
                rows.push(String::new());
                column = 0;
            }
            if index == self.cursor {
                cursor = (column as u16, rows.len() as u16 - 1);
            }
            if index == self.text.len() {
                break;
            }
            if c == '\n' {
                rows.push(String::new());
                column = 0;
            } else if let Some(row) = rows.last_mut() {
                row.push(c);
                column += wide;
            }
        }
        (rows, cursor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn press(composer: &mut Composer, code: KeyCode, modifiers: KeyModifiers) -> Typed {
        composer.key(KeyEvent::new(code, modifiers))
    }

    fn type_text(composer: &mut Composer, text: &str) {
        text.chars().for_each(|c| {
            press(composer, KeyCode::Char(c), KeyModifiers::NONE);
        });
    }

    #[test]
    fn words_lines_and_deletions() {
        let mut composer = Composer::default();
        type_text(&mut composer, "drop it from 2 m");
        press(&mut composer, KeyCode::Char('w'), KeyModifiers::CONTROL);
        assert_eq!(composer.text(), "drop it from 2 ");
        press(&mut composer, KeyCode::Left, KeyModifiers::ALT);
        type_text(&mut composer, "about ");
        assert_eq!(composer.text(), "drop it from about 2 ");
        press(&mut composer, KeyCode::Char('j'), KeyModifiers::CONTROL);
        type_text(&mut composer, "x");
        assert_eq!(composer.rows(40).0, ["drop it from about ", "x2 "]);
        press(&mut composer, KeyCode::Up, KeyModifiers::NONE);
        press(&mut composer, KeyCode::Char('k'), KeyModifiers::CONTROL);
        assert_eq!(composer.text(), "d\nx2 ");
        press(&mut composer, KeyCode::Char('u'), KeyModifiers::CONTROL);
        assert_eq!(composer.text(), "\nx2 ");
    }

    #[test]
    fn history_gives_back_what_was_being_typed() {
        let mut composer = Composer::default();
        for line in ["softer", "on the moon"] {
            type_text(&mut composer, line);
            assert_eq!(press(&mut composer, KeyCode::Enter, KeyModifiers::NONE), Typed::Sent(line.to_owned()));
        }
        type_text(&mut composer, "push");
        let mut seen = Vec::new();
        for code in [KeyCode::Up, KeyCode::Up, KeyCode::Up, KeyCode::Down, KeyCode::Down] {
            press(&mut composer, code, KeyModifiers::NONE);
            seen.push(composer.text());
        }
        assert_eq!(seen, ["on the moon", "softer", "softer", "on the moon", "push"]);
    }

    #[test]
    fn an_empty_line_is_not_sent() {
        let mut composer = Composer::default();
        type_text(&mut composer, "  ");
        assert_eq!(press(&mut composer, KeyCode::Enter, KeyModifiers::NONE), Typed::Changed);
    }

    #[test]
    fn rows_wrap_and_the_cursor_follows() {
        let mut composer = Composer::default();
        composer.paste("abcdef\r\ngh\u{7}");
        assert_eq!(composer.rows(4), (vec!["abcd".into(), "ef".into(), "gh".into()], (2, 2)));
        composer.set("日本");
        assert_eq!(composer.rows(3), (vec!["日".into(), "本".into()], (2, 1)));
    }
}
