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
        /// What was asked for; none is the last one of this folder.
        name: Option<String>,
        /// What there is, each with the folder that it was used in last.
        known: Vec<(String, String)>,
    },
    /// Another process added a version since this session was read.
    #[error("{moved}: nothing was changed\n{}", moved.advice())]
    Moved {
        /// What was added.
        moved: Box<Moved>,
    },
    /// Another process changed what this change needs or sets.
    #[error("{moved} and changed {}, {how}: nothing was changed\n{}", paths.join(", "), moved.advice())]
    Conflict {
        /// What was added.
        moved: Box<Moved>,
        /// What both concern.
        paths: Vec<String>,
        /// "which this turn sets to something else", …
        how: &'static str,
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

/// A head that is no longer the one that a process knew.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{now} ({words:?}) was added to session {session} by another process")]
pub struct Moved {
    /// Where.
    pub session: String,
    /// The version that this process knew; none is the scene as found.
    pub seen: Option<String>,
    /// The newest one.
    pub now: String,
    /// What the user typed for that.
    pub words: String,
}

impl Moved {
    fn advice(&self) -> String {
        let compare = self.seen.as_ref().map_or_else(|| format!("phystalk show {}", self.now), |seen| format!("phystalk diff {seen} {}", self.now));
        format!("say it again to go on from {}; {compare} shows what moved", self.now)
    }
}

fn no_session(name: Option<&str>, known: &[(String, String)]) -> String {
    // By name, s2 before s10.
    let mut known = known.to_vec();
    known.sort_by_key(|(name, _)| (name.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned(), name.len(), name.clone()));
    let listed = known.iter().map(|(name, folder)| if folder.is_empty() { name.clone() } else { format!("{name} (used in {folder})") });
    let listed: Vec<String> = listed.collect();
    match (name, listed.as_slice()) {
        (_, []) => "there is no session yet: start one with phystalk exec SCENE -p TEXT".to_owned(),
        (Some(name), known) => format!("no session `{name}`: there are {}", known.join(", ")),
        (None, known) => format!("no session was used in this folder; the store has {}: name one with --session", known.join(", ")),
    }
}
