//! What can go wrong with sessions and versions.

use phystalk::store::StoreError;

/// A fault of the history.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// No version is called that.
    #[error("no version `{reference}` in session {session}: it has {known}")]
    NoSuchVersion {
        /// What was asked for.
        reference: String,
        /// Where.
        session: String,
        /// What there is.
        known: String,
    },
    /// No session is called that, or there is none at all.
    #[error("{}", no_session(name.as_deref(), known))]
    NoSuchSession {
        /// What was asked for; none is the last one.
        name: Option<String>,
        /// What there is.
        known: Vec<String>,
    },
    /// A new session of a name that is taken.
    #[error("session {name} is there already: go on with it by --continue --session {name}, or choose another name")]
    SessionExists {
        /// The name.
        name: String,
    },
    /// Not a name.
    #[error("`{name}` is no name for a session: a-z, 0-9, _ and -")]
    BadName {
        /// The name.
        name: String,
    },
    /// The walk back is at its end.
    #[error("nothing to undo: session {session} is where it started")]
    NothingToUndo {
        /// Where.
        session: String,
    },
    /// Nothing was undone since the last edit.
    #[error("nothing to redo: the last change of session {session} was not an undo")]
    NothingToRedo {
        /// Where.
        session: String,
    },
    /// The path of the scene cannot be kept.
    #[error(transparent)]
    Spec(#[from] phystalk::spec::SpecError),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

fn no_session(name: Option<&str>, known: &[String]) -> String {
    // By name, s2 before s10.
    let mut known = known.to_vec();
    known.sort_by_key(|name| (name.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned(), name.len(), name.clone()));
    match (name, known.as_slice()) {
        (_, []) => "there is no session yet: start one with phystalk exec SCENE -p TEXT".to_owned(),
        (Some(name), known) => format!("no session `{name}`: there are {}", known.join(", ")),
        (None, known) => format!("no last session; there are {}", known.join(", ")),
    }
}
