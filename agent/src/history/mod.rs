//! What was said and what came of it: sessions, versions, undo.
//!
//! A session is one append-only file of operations in the store. Whatever changes it is on disk
//! before it is reported, and nothing is ever taken back: undo is an operation too, and makes a
//! version whose spec is an older one's.

mod error;
mod operation;
mod session;
#[cfg(test)]
mod tests;
mod timeline;

pub use error::HistoryError;
pub use session::Session;
pub use timeline::Version;
