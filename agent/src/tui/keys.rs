//! Terminal input decoder: bytes become keys and pastes.
//!
//! In: bytes as they are read, split anywhere, and the moments at which they came. Out: [`Input`]s. The decoder finds where a
//! sequence ends (ECMA-48, section 5.4; xterm's bracketed paste) and `terminput` names the key. No sequence stays open for
//! ever: each ends at a byte that does not belong to it, at a length, or at a time.

use super::keyboard::Input;
use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use std::time::{Duration, Instant};

/// ESC alone is the key Esc after this time. Shorter, and a sequence that a slow line splits becomes Esc and letters; longer,
/// and Esc feels late. 25 to 100 ms are usual (vim's `ttimeoutlen`, tmux's `escape-time`).
const ESCAPE: Duration = Duration::from_millis(50);
/// A sequence that began, or a character of several bytes, is given up after this time.
const SEQUENCE: Duration = Duration::from_millis(500);
/// An open paste ends when no text came for this time.
const PASTE: Duration = Duration::from_secs(1);
/// Text of one paste, bytes; more is dropped. A sentence has some hundred.
const PASTE_BYTES: usize = 1 << 20;
/// Bytes of a sequence; the longest that terminals send for a key have some thirty.
const SEQUENCE_BYTES: usize = 128;

const ESC: u8 = 0x1b;
const CTRL_C: u8 = 0x03;
const PASTE_BEGIN: &[u8] = b"\x1b[200~";
const PASTE_END: &[u8] = b"\x1b[201~";

/// Turns bytes into inputs.
#[derive(Debug, Default)]
pub struct Decoder {
    /// Bytes of a sequence whose end did not come yet.
    pending: Vec<u8>,
    paste: Option<Paste>,
    /// When the last byte of the open sequence or paste came.
    last: Option<Instant>,
}

/// A paste whose end did not come yet.
#[derive(Debug, Default)]
struct Paste {
    text: Vec<u8>,
    lost: usize,
    /// The last bytes, where they may begin the end.
    end: Vec<u8>,
    /// Times Ctrl-C came since the last byte of text.
    interrupts: usize,
}

/// What the bytes of a sequence are so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scan {
    /// More has to come.
    Open,
    /// All of it.
    Whole,
    /// The last byte does not belong to it.
    Broken,
}

impl Decoder {
    /// Takes bytes.
    pub fn feed(&mut self, bytes: &[u8], now: Instant) -> Vec<Input> {
        let mut inputs = Vec::new();
        for &byte in bytes {
            match &mut self.paste {
                Some(paste) => {
                    // Ctrl-C does not reset the timer: pressed repeatedly in a dead paste, it still ends it.
                    if byte != CTRL_C {
                        self.last = Some(now);
                    }
                    if paste.take(byte) {
                        self.end_paste(&mut inputs);
                    }
                }
                None => {
                    self.last = Some(now);
                    self.take(byte, &mut inputs);
                }
            }
        }
        inputs
    }

    /// When what is open counts as ended, if nothing comes before.
    pub fn deadline(&self) -> Option<Instant> {
        let patience = match (&self.paste, self.pending.len()) {
            (Some(_), _) => PASTE,
            (None, 0) => return None,
            (None, 1 | 2) if self.pending[0] == ESC => ESCAPE,
            _ => SEQUENCE,
        };
        self.last.map(|last| last + patience)
    }

    /// Ends what is open, where its time is over.
    pub fn expire(&mut self, now: Instant) -> Vec<Input> {
        let mut inputs = Vec::new();
        if self.deadline().is_some_and(|end| end <= now) {
            if self.paste.is_some() {
                self.end_paste(&mut inputs);
            } else {
                self.give_up(&mut inputs);
            }
        }
        inputs
    }

    /// Takes a byte outside of a paste.
    fn take(&mut self, byte: u8, inputs: &mut Vec<Input>) {
        self.pending.push(byte);
        match scan(&self.pending) {
            Scan::Open if self.pending.len() < SEQUENCE_BYTES => {}
            Scan::Open => self.pending.clear(),
            Scan::Whole => {
                let sequence = std::mem::take(&mut self.pending);
                if sequence == PASTE_BEGIN {
                    self.paste = Some(Paste::default());
                } else {
                    inputs.extend(key(&sequence).map(Input::Key));
                }
            }
            Scan::Broken => {
                self.pending.pop();
                self.give_up(inputs);
                // A byte alone is never broken, so this goes one deep.
                self.take(byte, inputs);
            }
        }
    }

    /// Ends an unfinished sequence: ESC and a character were the keys Esc or Alt, more than that is dropped.
    fn give_up(&mut self, inputs: &mut Vec<Input>) {
        let key = match std::mem::take(&mut self.pending).as_slice() {
            [ESC] => Some(KeyEvent::new(KeyCode::Esc, KeyModifiers::NONE)),
            [ESC, c] if c.is_ascii_graphic() => Some(KeyEvent::new(KeyCode::Char(char::from(*c)), KeyModifiers::ALT)),
            _ => None,
        };
        inputs.extend(key.map(Input::Key));
    }

    fn end_paste(&mut self, inputs: &mut Vec<Input>) {
        let Some(paste) = self.paste.take() else { return };
        let text = String::from_utf8_lossy(&paste.text).into_owned();
        if !text.is_empty() {
            inputs.push(Input::Paste { text, lost: paste.lost });
        }
        let interrupt = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        inputs.extend((0..paste.interrupts).map(|_| Input::Key(interrupt)));
    }
}

impl Paste {
    /// Takes a byte; whether it was the last one of the end.
    fn take(&mut self, byte: u8) -> bool {
        if byte == CTRL_C {
            self.interrupts += 1;
            return false;
        }
        self.interrupts = 0;
        self.end.push(byte);
        while !PASTE_END.starts_with(&self.end) {
            let byte = self.end.remove(0);
            if self.text.len() < PASTE_BYTES { self.text.push(byte) } else { self.lost += 1 }
        }
        self.end == PASTE_END
    }
}

/// How far a sequence is. It is scanned after each byte, so only the last byte can break it.
fn scan(sequence: &[u8]) -> Scan {
    match sequence {
        [ESC] => Scan::Open,
        // The Linux console's F1 to F5.
        [ESC, b'[', b'['] => Scan::Open,
        [ESC, b'[', b'[', 0x20..=0x7e] => Scan::Whole,
        [ESC, b'[', b'[', _] => Scan::Broken,
        [ESC, b'[' | b'O'] | [ESC, b'_'] | [ESC, b'_', b'G'] => Scan::Open,
        [ESC, b'[' | b'O', .., last] => match last {
            0x20..=0x3f => Scan::Open,
            0x40..=0x7e => Scan::Whole,
            _ => Scan::Broken,
        },
        // The answer to a question about kitty graphics, which may come late.
        [ESC, b'_', b'G', .., ESC, b'\\'] => Scan::Whole,
        [ESC, b'_', b'G', .., last] => {
            if *last == ESC || (0x20..0x7f).contains(last) {
                Scan::Open
            } else {
                Scan::Broken
            }
        }
        [ESC, b'_', _] => Scan::Broken,
        // Esc twice, or Esc before a sequence.
        [ESC, ESC] => Scan::Broken,
        [ESC, character @ ..] => scan_character(character),
        character => scan_character(character),
    }
}

/// How far a character in UTF-8 is. A byte that begins none is whole, and no key.
fn scan_character(bytes: &[u8]) -> Scan {
    let length = match bytes.first() {
        Some(0xc2..=0xdf) => 2,
        Some(0xe0..=0xef) => 3,
        Some(0xf0..=0xf4) => 4,
        _ => 1,
    };
    match bytes {
        [_, .., last] if !(0x80..=0xbf).contains(last) => Scan::Broken,
        _ if bytes.len() < length => Scan::Open,
        _ => Scan::Whole,
    }
}

/// The key of a whole sequence. Reports of the mouse and of the terminal are dropped: the REPL enables none, and terminput
/// subtracts from their coordinates without a check.
fn key(sequence: &[u8]) -> Option<KeyEvent> {
    if matches!(sequence, [ESC, b'[', b'<'..=b'?', ..] | [ESC, b'[', .., b'M' | b'm' | b'c']) || sequence.starts_with(b"\x1b_G") {
        return None;
    }
    match terminput::Event::parse_from(sequence) {
        Ok(Some(terminput::Event::Key(key))) => Some(terminput_crossterm::to_crossterm_key(key)),
        _ => None,
    }
}

#[cfg(test)]
#[path = "keys_tests.rs"]
mod tests;
