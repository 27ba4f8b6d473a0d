//! Commits of turns: what was made on a version that is no longer the newest is merged, or refused with the reason.
//!
//! A turn's edits were computed from the spec that its speaker saw. Where another process added versions meanwhile, both
//! changes are kept if neither sets what the other one sets and neither was computed from what the other one sets. The
//! latter is found by making the edits again: on the spec that holds the other change, they must come out the same.

use super::{Conversation, Event, Listener, rehearse};
use crate::cli::exit::Failure;
use crate::history::{Author, HistoryError, Moved, Session, Version, changed_paths, merge};
use crate::language::Reply;
use phystalk::spec::{Edit, Spec};

/// A turn's change, made on the head of the session as its speaker saw it.
pub(super) struct Change<'a> {
    pub words: &'a str,
    pub author: Author,
    pub edits: &'a [Edit],
    /// The spec that the edits lead to.
    pub after: &'a Spec,
}

impl Conversation {
    /// Makes a version of a change, merged with what other processes added since.
    pub(super) fn commit(&mut self, change: &Change<'_>, listener: &mut dyn Listener) -> Result<Version, Failure> {
        let Change { words, author, edits, after } = *change;
        let mut moved = match self.session.commit(words, author, edits, after) {
            Err(HistoryError::Moved { moved }) => *moved,
            done => return Ok(done?),
        };
        let seen = self.session.clone();
        // Each round means that another process made a version: of all that wait, one always gets on.
        loop {
            self.session.go_on()?;
            let others = self.session.since(&seen);
            let merged = self.merge(change, &seen, &others, &moved)?;
            match self.session.commit_merged(words, author, edits, &merged, Some(&seen)) {
                Err(HistoryError::Moved { moved: again }) => moved = *again,
                done => {
                    let version = done?;
                    let names = others.iter().map(|other| format!("{} ({:?})", other.name, other.words)).collect::<Vec<_>>().join(", ");
                    listener.event(Event::Message { text: format!("{names} was added by another process meanwhile; both changes hold") });
                    return Ok(version);
                }
            }
        }
    }

    /// The spec with a change and with what others added since it was made.
    fn merge(&mut self, change: &Change<'_>, seen: &Session, others: &[Version], moved: &Moved) -> Result<Spec, Failure> {
        let refuse = |paths: Vec<String>, how: &'static str| Failure::from(HistoryError::Conflict { moved: Box::new(moved.clone()), paths, how });
        let theirs = self.session.spec().clone();
        let merged = merge(seen.spec(), change.after, &theirs, change.edits)
            .map_err(|conflict| refuse(conflict.paths, "which this turn sets to something else"))?;
        let previous = self.session.head().and_then(|head| self.session.spec_before(head)).cloned();
        if !self.comes_out_the_same(change.author, change.words, change.edits, &theirs, previous.as_ref()) {
            return Err(refuse(changed_paths(seen.spec(), &theirs), "from which this turn is computed"));
        }
        for other in others {
            let Some(on) = self.session.spec_before(other).cloned() else { continue };
            let made_on = other.parent.as_deref().and_then(|parent| self.session.find(parent).ok());
            let previous = made_on.and_then(|version| self.session.spec_before(version)).cloned();
            let with_ours = on.apply(change.edits);
            if !with_ours.is_ok_and(|spec| self.comes_out_the_same(other.author, &other.words, &other.edits, &spec, previous.as_ref())) {
                return Err(refuse(changed_paths(&on, &other.spec), "computed from a value that this turn sets"));
            }
        }
        Ok(merged)
    }

    /// Whether words lead to the same edits on another spec.
    fn comes_out_the_same(&mut self, author: Author, words: &str, edits: &[Edit], on: &Spec, previous: Option<&Spec>) -> bool {
        match author {
            // Given as they are, or restored from an older version: computed from nothing that is in the spec now.
            Author::Literal | Author::Travel => true,
            Author::Phrasebook => {
                let again = rehearse::hear(&mut self.engine, &self.options, on, previous, words);
                matches!(again, Ok(Reply::Edits { edits: again, .. }) if again == edits)
            }
        }
    }
}
