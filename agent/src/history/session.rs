//! A session of a store: reads its operations, adds to them.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use phystalk::spec::{Camera, Edit, Spec, is_name};
use phystalk::store::{Guard, Store, StoreError};

use super::operation::{How, Operation, Use};
use super::timeline::{Target, Timeline, name};
use super::{HistoryError, Version};

/// Names the sessions in the order of use.
const SESSIONS: &str = "history/sessions.jsonl";

/// One session. Several processes may work on the same one: each operation takes up what the others
/// added before.
#[derive(Clone, Debug)]
pub struct Session {
    store: Store,
    name: String,
    timeline: Timeline,
    /// How many operations the timeline has taken up.
    seen: usize,
    /// The version that edits go on from; none is the base.
    head: Option<u32>,
    torn: bool,
}

impl Session {
    /// Starts a session with a scene as found. It counts as used from its first version on. Without a name it gets the next free number: `s1`, `s2`, …
    pub fn start(store: &Store, name: Option<&str>, base: Spec) -> Result<Session, HistoryError> {
        let base = base.absolute_from(Path::new(""))?;
        let guard = store.lock()?;
        let name = match name {
            Some(name) if !is_name(name) => return Err(HistoryError::BadName { name: name.to_owned() }),
            Some(name) if operations(&guard, name)?.0.is_some() => return Err(HistoryError::SessionExists { name: name.to_owned() }),
            Some(name) => name.to_owned(),
            None => free_name(&guard)?,
        };
        // Listed with its first version: a session in which nothing was said is nobody's last one.
        guard.append(&file(&name), &Operation::Start { time_s: now_s(), base: Box::new(base) })?;
        drop(guard);
        Session::open(store, Some(&name))
    }

    /// Opens a session, the last one where no name is given.
    pub fn open(store: &Store, name: Option<&str>) -> Result<Session, HistoryError> {
        let guard = store.lock()?;
        let known = sessions(&guard)?;
        let missing = || HistoryError::NoSuchSession { name: name.map(str::to_owned), known: known.clone() };
        let name = match name {
            Some(name) if is_name(name) => name.to_owned(),
            Some(_) => return Err(missing()),
            None => known.last().cloned().ok_or_else(missing)?,
        };
        let (timeline, seen, torn) = operations(&guard, &name)?;
        let timeline = timeline.ok_or_else(missing)?;
        let head = timeline.head().map(|head| head.number);
        Ok(Session { store: store.clone(), name, timeline, seen, head, torn })
    }

    /// Whether there is a session of this name, even one without a version.
    pub fn exists(store: &Store, name: &str) -> Result<bool, HistoryError> {
        Ok(is_name(name) && operations(&store.lock()?, name)?.0.is_some())
    }

    /// All sessions that have a version, in the order of use, the last one last.
    #[cfg(test)]
    pub fn list(store: &Store) -> Result<Vec<String>, HistoryError> {
        Ok(sessions(&store.lock()?)?)
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The spec before any turn.
    pub fn base(&self) -> &Spec {
        &self.timeline.base
    }

    /// The version that edits go on from.
    pub fn head(&self) -> Option<&Version> {
        self.timeline.version(self.head?)
    }

    /// The spec that edits go on from: the head's, or the base.
    pub fn spec(&self) -> &Spec {
        self.timeline.spec(self.head)
    }

    /// All versions, oldest first.
    pub fn versions(&self) -> &[Version] {
        &self.timeline.versions
    }

    /// Whether a crash had left an unfinished operation, which was dropped.
    pub fn dropped_torn_line(&self) -> bool {
        self.torn
    }

    /// A version by name: `v2`, `2`, `first`, `last`, `previous`.
    pub fn find(&self, reference: &str) -> Result<&Version, HistoryError> {
        let versions = self.versions();
        let found = match reference.trim().to_ascii_lowercase().as_str() {
            "first" => versions.first(),
            "last" | "latest" | "newest" | "head" | "@" => self.head(),
            "previous" | "@-" => versions.iter().rev().nth(1),
            text => text.strip_prefix('v').unwrap_or(text).parse().ok().and_then(|number| self.timeline.version(number)),
        };
        found.ok_or_else(|| HistoryError::NoSuchVersion {
            reference: reference.to_owned(),
            session: self.name.clone(),
            known: match versions {
                [] => "none yet".to_owned(),
                [only] => only.name.clone(),
                [first, .., last] => format!("{} to {}", first.name, last.name),
            },
        })
    }

    /// The spec of a version, by name.
    pub fn spec_of(&self, version: &str) -> Result<Spec, HistoryError> {
        self.find(version).map(|version| version.spec.clone())
    }

    /// Makes a version of accepted edits and the spec that came of them.
    pub fn commit(&mut self, words: &str, edits: &[Edit], spec: &Spec) -> Result<Version, HistoryError> {
        let guard = self.store.lock()?;
        // Edits were made on the head as it was seen here, whatever others added since.
        let parent = self.head;
        self.catch_up(&guard)?;
        self.add(&guard, How::Edit, parent, words, edits.to_vec(), spec.clone())
    }

    /// Goes some steps back: a new version with an older spec. Fewer steps where the start is nearer.
    pub fn undo(&mut self, words: &str, steps: u32) -> Result<Version, HistoryError> {
        let guard = self.store.lock()?;
        self.catch_up(&guard)?;
        let target = self.timeline.undo_target(steps).ok_or_else(|| HistoryError::NothingToUndo { session: self.name.clone() })?;
        self.go(&guard, How::Undo(steps), words, &target)
    }

    /// Takes back some steps of undo.
    pub fn redo(&mut self, words: &str, steps: u32) -> Result<Version, HistoryError> {
        let guard = self.store.lock()?;
        self.catch_up(&guard)?;
        let target = self.timeline.redo_target(steps).ok_or_else(|| HistoryError::NothingToRedo { session: self.name.clone() })?;
        self.go(&guard, How::Redo(steps), words, &target)
    }

    /// Goes to a version by name, or to the `start`: a change like any other, which undo undoes.
    pub fn back_to(&mut self, words: &str, to: &str) -> Result<Version, HistoryError> {
        let guard = self.store.lock()?;
        self.catch_up(&guard)?;
        let to = if to.eq_ignore_ascii_case("start") { None } else { Some(self.find(to)?.number) };
        self.go(&guard, How::Back(to), words, &Target(to))
    }

    /// Keeps the camera that every version of the session is seen from.
    pub fn keep_camera(&mut self, camera: &Camera) -> Result<(), HistoryError> {
        self.note(Operation::Camera { camera: *camera })
    }

    /// The camera that was kept.
    pub fn camera(&self) -> Option<Camera> {
        self.timeline.camera
    }

    /// Keeps what "auto" came to in a version.
    pub fn keep_resolved(&mut self, version: &str, values: serde_json::Value) -> Result<(), HistoryError> {
        let number = self.find(version)?.number;
        self.note(Operation::Resolved { number, values })
    }

    fn note(&mut self, operation: Operation) -> Result<(), HistoryError> {
        let guard = self.store.lock()?;
        let head = self.head;
        self.catch_up(&guard)?;
        self.head = head;
        self.append(&guard, operation)
    }

    fn go(&mut self, guard: &Guard, how: How, words: &str, target: &Target) -> Result<Version, HistoryError> {
        let spec = self.timeline.spec(target.0).clone();
        let edits = self.spec().edits_to(&spec);
        self.add(guard, how, self.head, words, edits, spec)
    }

    fn add(&mut self, guard: &Guard, how: How, parent: Option<u32>, words: &str, edits: Vec<Edit>, spec: Spec) -> Result<Version, HistoryError> {
        let number = self.timeline.next_number();
        let operation = Operation::Version { number, parent, how, words: words.to_owned(), edits, spec: Box::new(spec), time_s: now_s() };
        self.append(guard, operation)?;
        self.head = Some(number);
        note_use(guard, &self.name)?;
        self.find(&name(number)).cloned()
    }

    fn append(&mut self, guard: &Guard, operation: Operation) -> Result<(), HistoryError> {
        guard.append(&file(&self.name), &operation)?;
        self.timeline.push(operation);
        self.seen += 1;
        Ok(())
    }

    /// Takes up what other processes added.
    fn catch_up(&mut self, guard: &Guard) -> Result<(), HistoryError> {
        let log = guard.read::<Operation>(&file(&self.name))?;
        let news = log.lines.into_iter().skip(self.seen);
        for operation in news {
            self.timeline.push(operation);
            self.seen += 1;
        }
        self.head = self.timeline.head().map(|head| head.number);
        Ok(())
    }
}

fn file(session: &str) -> String {
    format!("history/session-{session}.jsonl")
}

/// The session as it lies on disk, how many operations it has, and whether the last one was torn.
fn operations(guard: &Guard, session: &str) -> Result<(Option<Timeline>, usize, bool), StoreError> {
    let log = guard.read::<Operation>(&file(session))?;
    let count = log.lines.len();
    Ok((Timeline::replay(log.lines), count, log.torn))
}

/// Sessions in the order of their last use.
fn sessions(guard: &Guard) -> Result<Vec<String>, StoreError> {
    let mut names: Vec<String> = Vec::new();
    for Use { session } in guard.read::<Use>(SESSIONS)?.lines {
        names.retain(|name| *name != session);
        names.push(session);
    }
    Ok(names)
}

fn note_use(guard: &Guard, session: &str) -> Result<(), StoreError> {
    if sessions(guard)?.last().is_some_and(|last| last == session) {
        return Ok(());
    }
    guard.append(SESSIONS, &Use { session: session.to_owned() })
}

/// The first number that no session has, listed or not.
fn free_name(guard: &Guard) -> Result<String, StoreError> {
    let mut number = sessions(guard)?.len() + 1;
    loop {
        let name = format!("s{number}");
        if operations(guard, &name)?.0.is_none() {
            return Ok(name);
        }
        number += 1;
    }
}

/// Seconds since 1970, UTC.
fn now_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
