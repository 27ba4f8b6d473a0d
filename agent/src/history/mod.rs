//! What was said and what came of it: sessions, versions, undo.
//!
//! A session is one append-only log of operations in the store. Whatever changes it is on disk
//! before it is reported, and nothing is ever taken back: undo is an operation too, and makes a
//! version whose spec is an older one's. Several processes may work on one session: a commit is a
//! compare-and-swap on the newest version.

mod error;
mod merge;
mod operation;
mod session;
#[cfg(test)]
mod tests;
mod timeline;

pub use error::{HistoryError, Moved};
#[cfg(test)]
use merge::Conflict;
pub use merge::{changed_paths, merge};
pub use operation::Author;
pub use session::{Session, Sessions};
pub use timeline::Version;
