//! Replays operations into versions, and knows where undo and redo lead.
//!
//! Undo walks as in jj. The undo target of a version made by edits is itself; that of one made by undo or redo is the
//! version whose spec it restored. Undo goes from the head's undo target to its parent's, so that repeated undo walks
//! further back; redo takes the walk back in turn, and anything else ends it. Going back to a version by name is a change
//! of its own, which undo undoes.

use phystalk::spec::{Camera, Edit, Spec};
use serde::Serialize;

use super::operation::{Author, How, Operation, Place};

/// One version of a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Version {
    /// `v1`, `v2`, …
    pub name: String,
    /// The version that it was made from; none where that is the scene as found.
    pub parent: Option<String>,
    /// What was said.
    pub words: String,
    /// The edits that lead from the parent here.
    pub edits: Vec<Edit>,
    /// Hash of its spec.
    pub spec_hash: String,
    /// "back to v1", "forward to v3"; empty where it was edited.
    pub note: String,
    /// When: seconds since 1970, UTC.
    pub time_s: u64,
    /// The version that its edits were made on, where that is not its parent: another process added the parent meanwhile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub made_on: Option<String>,
    /// Who made its edits.
    pub author: Author,
    /// What "auto" came to, once it has run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resolved: Option<serde_json::Value>,
    /// The results that it needs, as "stage/key", once it has run.
    #[serde(skip)]
    pub results: Vec<String>,
    /// Its spec.
    #[serde(skip)]
    pub spec: Spec,
    #[serde(skip)]
    pub(super) number: u32,
    #[serde(skip)]
    parent_number: Option<u32>,
    /// Where the walk of undo is at it; none is the base.
    #[serde(skip)]
    undo_target: Option<u32>,
}

/// A session as its operations tell it.
#[derive(Clone, Debug)]
pub(super) struct Timeline {
    pub(super) base: Spec,
    /// Versions that are missing for damage, at most: their numbers are not given again.
    pub(super) lost: u32,
    pub(super) versions: Vec<Version>,
    pub(super) camera: Option<Camera>,
    /// What was undone since the last other change, the nearest last.
    undone: Vec<Option<u32>>,
}

/// Where a walk ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Target(pub(super) Option<u32>);

impl Timeline {
    /// Replays a session of which so many lines are lost; none where nothing is left of it. Where its start is lost, the
    /// oldest version stands in for the scene as found.
    pub(super) fn replay(operations: Vec<Operation>, lost: usize) -> Option<Timeline> {
        let start = operations.iter().find_map(|operation| match operation {
            Operation::Start { base, .. } => Some(base),
            _ => None,
        });
        let oldest = || {
            operations.iter().find_map(|operation| match operation {
                Operation::Version { spec, .. } => Some(spec),
                _ => None,
            })
        };
        let base = Spec::clone(start.or_else(oldest)?);
        let mut timeline =
            Timeline { base, lost: u32::try_from(lost).unwrap_or(u32::MAX / 2), versions: Vec::new(), camera: None, undone: Vec::new() };
        operations.into_iter().for_each(|operation| timeline.push(operation));
        Some(timeline)
    }

    /// Takes up the next operation.
    pub(super) fn push(&mut self, operation: Operation) {
        match operation {
            // Only the first line starts a session.
            Operation::Start { .. } => {}
            Operation::Camera { camera } => self.camera = Some(camera),
            Operation::Resolved { number, values, results } => {
                if let Some(version) = self.versions.iter_mut().find(|version| version.number == number) {
                    version.resolved = Some(values);
                    version.results = results;
                }
            }
            Operation::Version { number, parent, made_on, how, restored, author, words, edits, spec, time_s } => {
                let (walked, note) = self.walk(number, how, restored);
                self.versions.push(Version {
                    name: name(number),
                    parent: parent.map(name),
                    words,
                    edits,
                    spec_hash: spec.hash(),
                    note,
                    time_s,
                    made_on: made_on.map(|place| place_name(place.number())),
                    author,
                    resolved: None,
                    results: Vec::new(),
                    spec: *spec,
                    number,
                    parent_number: parent,
                    undo_target: restored.map_or(walked, Place::number),
                });
            }
        }
    }

    /// The undo target of a new version, and how its note reads.
    fn walk(&mut self, number: u32, how: How, restored: Option<Place>) -> (Option<u32>, String) {
        // Where lines before this one are lost, the walk cannot be taken again: what was recorded holds.
        let recorded = |at: Option<u32>| restored.map_or(at, Place::number);
        match how {
            How::Edit => {
                self.undone.clear();
                (Some(number), String::new())
            }
            How::Back(to) => {
                self.undone.clear();
                (Some(number), format!("back to {}", place_name(to)))
            }
            How::Undo(steps) => {
                let mut at = self.at();
                let mut taken = 0;
                while taken < steps
                    && let Some(before) = self.before(at)
                {
                    self.undone.push(at);
                    at = before;
                    taken += 1;
                }
                (at, format!("back to {}{}", place_name(recorded(at)), if recorded(at) == at { fewer(taken, steps) } else { String::new() }))
            }
            How::Redo(steps) => {
                let mut at = self.at();
                let mut taken = 0;
                while taken < steps
                    && let Some(after) = self.undone.pop()
                {
                    at = after;
                    taken += 1;
                }
                (at, format!("forward to {}{}", place_name(recorded(at)), if recorded(at) == at { fewer(taken, steps) } else { String::new() }))
            }
        }
    }

    /// Where some steps back lead, if there is one to take.
    pub(super) fn undo_target(&self, steps: u32) -> Option<Target> {
        let mut at = self.at();
        let mut moved = false;
        for _ in 0..steps {
            let Some(before) = self.before(at) else { break };
            (at, moved) = (before, true);
        }
        moved.then_some(Target(at))
    }

    /// Where some steps forward lead, if there is one to take.
    pub(super) fn redo_target(&self, steps: u32) -> Option<Target> {
        let last = self.undone.len().checked_sub((steps as usize).min(self.undone.len()))?;
        self.undone.get(last).map(|at| Target(*at))
    }

    /// The newest version.
    pub(super) fn head(&self) -> Option<&Version> {
        self.versions.last()
    }

    /// A version by its number.
    pub(super) fn version(&self, number: u32) -> Option<&Version> {
        self.versions.iter().find(|version| version.number == number)
    }

    /// The spec of a version, or of the base.
    pub(super) fn spec(&self, number: Option<u32>) -> &Spec {
        number.and_then(|number| self.version(number)).map_or(&self.base, |version| &version.spec)
    }

    /// The number of the next version.
    pub(super) fn next_number(&self) -> u32 {
        self.versions.iter().map(|version| version.number).max().unwrap_or(0).saturating_add(self.lost).saturating_add(1)
    }

    /// Where the walk of undo is.
    fn at(&self) -> Option<u32> {
        self.head().and_then(|head| head.undo_target)
    }

    /// The undo target of a version's parent; none at the start, and where the first version is the
    /// base itself, taken over as it was.
    fn before(&self, at: Option<u32>) -> Option<Option<u32>> {
        let version = self.version(at?)?;
        let before = version.parent_number.and_then(|parent| self.version(parent)).and_then(|parent| parent.undo_target);
        let is_base = before.is_none() && version.spec_hash == self.base.hash();
        (!is_base).then_some(before)
    }
}

/// `v3`.
pub(super) fn name(number: u32) -> String {
    format!("v{number}")
}

/// Says that a walk ended before its last step.
fn fewer(taken: u32, asked: u32) -> String {
    if taken < asked { format!(", all that there is: {taken} of {asked} steps") } else { String::new() }
}

fn place_name(number: Option<u32>) -> String {
    number.map_or_else(|| "the start".to_owned(), name)
}
