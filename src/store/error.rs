//! What goes wrong with a store, and what to do about it.

use std::io;
use std::path::{Path, PathBuf};

/// A fault of the store.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Made by a later version of the program.
    #[error("the store {} has format {found}, this program knows {known}: use a newer phystalk, or another folder with --store", dir.display())]
    Newer {
        /// The store.
        dir: PathBuf,
        /// Its format.
        found: u32,
        /// The newest known one.
        known: u32,
    },
    /// A folder of something else.
    #[error("{} is not a store and not empty: name another folder with --store", dir.display())]
    NotAStore {
        /// The folder.
        dir: PathBuf,
    },
    /// A store that this user neither made nor accepted.
    #[error(
        "the store {} is not yours: {why}; its contents decide which files are removed and what is run\n\
         if you trust it: phystalk store accept {}",
        dir.display(), dir.display()
    )]
    NotAccepted {
        /// The store.
        dir: PathBuf,
        /// "it belongs to user 1000", …
        why: String,
    },
    /// A part of the store that is not what the store makes under that name.
    #[error("{} is {found}, and a store has {expected} there: phystalk follows and removes nothing through it; take it away and run again", path.display())]
    Foreign {
        /// The part.
        path: PathBuf,
        /// "a symbolic link", …
        found: &'static str,
        /// "a folder" or "a file".
        expected: &'static str,
    },
    /// Bytes that are not what was written.
    #[error("{} is damaged ({why}); phystalk store verify --repair mends what can be mended and keeps a copy", path.display())]
    Damaged {
        /// The file or folder.
        path: PathBuf,
        /// What gave it away.
        why: String,
    },
    /// A result whose content is not what was written.
    #[error("{} is damaged (its checksum differs); it is made anew next time", path.display())]
    Spoilt {
        /// The file.
        path: PathBuf,
    },
    /// Another process holds the lock.
    #[error("the store {} is still locked by another process after {waited_s} s: wait for it to end, or use another folder with --store", dir.display())]
    Locked {
        /// The store.
        dir: PathBuf,
        /// How long it was waited for.
        waited_s: f64,
    },
    /// A store that can be read and not written.
    #[error("the store {} cannot be written to ({why}): it can be read, but nothing can be added; use another folder with --store", dir.display())]
    ReadOnly {
        /// The store.
        dir: PathBuf,
        /// Why.
        why: String,
    },
    /// A name that could lead out of the store.
    #[error("`{name}` is not a name in a store: a-z, 0-9, _, - and . inside")]
    Name {
        /// The name.
        name: String,
    },
    /// The system refused.
    #[error("{} cannot be {doing}: {source}", path.display())]
    Io {
        /// "read", "written", "locked", …
        doing: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

impl StoreError {
    /// For `map_err`: what was being done to which path.
    pub(super) fn io(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> StoreError {
        move |source| StoreError::Io { doing, path: path.to_owned(), source }
    }

    /// Bytes that are not what was written.
    pub(super) fn damaged(path: &Path, why: impl ToString) -> StoreError {
        StoreError::Damaged { path: path.to_owned(), why: why.to_string() }
    }
}
