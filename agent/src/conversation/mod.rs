//! Turns: words become edits, edits a version, a version a run; each leaves events and files.

mod event;
mod files;
mod kept;
mod narrate;
mod observer;
mod rehearse;
mod turn;

pub use event::{Event, Line, Lines};
pub use narrate::{duration, plan_line, plan_table};
pub use rehearse::{Rehearsal, rehearse};
pub use turn::{Conversation, Outcome};

use phystalk::Frame;

/// Whoever follows a conversation: the JSON Lines, the terminal, plain text.
pub trait Listener {
    /// Something happened.
    fn event(&mut self, event: Event);
    /// A picture is done; it comes before its [`Event::FrameReady`], if it is written at all.
    fn picture(&mut self, _: &Frame) {}
    /// Pictures of another version will come.
    fn film(&mut self, _version: &str) {}
}
