//! Sessions of a store: which there are, what is in one, and how operations are added.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use phystalk::spec::{Camera, Edit, Spec, is_name};
use phystalk::store::{Guard, Store, StoreError};

use super::operation::{Author, How, Operation, Place, Use};
use super::timeline::{Target, Timeline, name};
use super::{HistoryError, Moved, Version};

/// The log that names the sessions in the order of use.
const SESSIONS: &str = "sessions";
/// Begins the names of the logs of sessions.
const PREFIX: &str = "session-";

/// The sessions of a store, as seen from a folder.
#[derive(Clone, Debug)]
pub struct Sessions {
    store: Store,
    /// The folder that the program runs in, relative to the one that holds the store where it lies below.
    folder: String,
    /// Whether the last session may be one of another folder: the user named the store.
    any_folder: bool,
}

/// One session. Several processes may work on the same one: each operation takes up what the others
/// added before.
#[derive(Clone, Debug)]
pub struct Session {
    sessions: Sessions,
    name: String,
    timeline: Timeline,
    /// The newest version that this process knows, which edits go on from; none is the base.
    head: Option<u32>,
    damage: Vec<String>,
    torn: bool,
}

impl Sessions {
    /// The sessions of a store, used from a folder.
    pub fn seen_from(store: &Store, cwd: &Path) -> Sessions {
        let cwd = std::fs::canonicalize(cwd).unwrap_or_else(|_| cwd.to_owned());
        let home = store.dir().parent().unwrap_or(Path::new(""));
        let folder = cwd.strip_prefix(home).unwrap_or(&cwd).to_string_lossy().into_owned();
        Sessions { store: store.clone(), folder, any_folder: false }
    }

    /// Where none was used in this folder, the last session may then be one of another folder.
    pub fn of_any_folder(self, any_folder: bool) -> Sessions {
        Sessions { any_folder, ..self }
    }

    /// Starts a session with a scene as found. It counts as used from its first version on. Without a name it gets the next
    /// free number: `s1`, `s2`, …
    pub fn start(&self, name: Option<&str>, base: Spec) -> Result<Session, HistoryError> {
        let base = base.absolute_from(Path::new(""))?;
        let guard = self.store.lock()?;
        let logs = self.store.logs()?;
        let is_taken = |name: &str| logs.iter().any(|known| *known == log(name));
        let name = match name {
            Some(name) if !is_name(name) => return Err(HistoryError::BadName { name: name.to_owned() }),
            Some(name) if is_taken(name) => return Err(HistoryError::SessionExists { name: name.to_owned() }),
            Some(name) => name.to_owned(),
            None => free_name(self.used()?.len() + 1, is_taken),
        };
        // Listed with its first version: a session in which nothing was said is nobody's last one.
        guard.append(&log(&name), &Operation::Start { time_s: now_s(), base: Box::new(base) })?;
        drop(guard);
        self.open(Some(&name))
    }

    /// Opens a session; without a name the last one that was used in this folder.
    pub fn open(&self, name: Option<&str>) -> Result<Session, HistoryError> {
        let known = self.used()?;
        let missing = || HistoryError::NoSuchSession { name: name.map(str::to_owned), known: known.clone() };
        let name = match name {
            Some(name) if is_name(name) => name.to_owned(),
            Some(_) => return Err(missing()),
            None => {
                let here = known.iter().rev().find(|(_, folder)| *folder == self.folder);
                let here = here.or_else(|| known.last().filter(|_| self.any_folder));
                here.map(|(name, _)| name.clone()).ok_or_else(missing)?
            }
        };
        let (timeline, damage, torn) = read(&self.store, &name)?;
        let timeline = timeline.ok_or_else(missing)?;
        let head = timeline.head().map(|head| head.number);
        Ok(Session { sessions: self.clone(), name, timeline, head, damage, torn })
    }

    /// Whether there is a session of this name, even one without a version.
    pub fn has(&self, name: &str) -> Result<bool, HistoryError> {
        Ok(is_name(name) && self.store.logs()?.contains(&log(name)))
    }

    /// All sessions that have a version, in the order of use, the last one last, each with the folder that it was used in.
    /// Sessions that the list does not name, because it is damaged, come first.
    pub fn used(&self) -> Result<Vec<(String, String)>, HistoryError> {
        let mut used: Vec<(String, String)> = Vec::new();
        let list = self.store.read_log::<Use>(SESSIONS)?;
        for Use { session, folder } in list.lines {
            used.retain(|(name, _)| *name != session);
            used.push((session, folder));
        }
        if list.lost > 0 {
            let logs = self.store.logs()?;
            let names = logs.iter().filter_map(|log| log.strip_prefix(PREFIX));
            let unlisted = names.filter(|name| used.iter().all(|(known, _)| known != name)).map(|name| (name.to_owned(), String::new()));
            let unlisted: Vec<_> = unlisted.collect();
            used.splice(0..0, unlisted);
        }
        Ok(used)
    }

    /// What is wrong with the list of sessions.
    pub fn damage(&self) -> Result<Vec<String>, HistoryError> {
        Ok(self.store.read_log::<Use>(SESSIONS)?.damage)
    }

    /// Names every session in the list again that it lost; how many. The last one stays the last.
    pub fn relist(&self) -> Result<usize, HistoryError> {
        let uses = self.store.read_log::<Use>(SESSIONS)?.lines;
        let last = uses.last().cloned();
        let listed: Vec<String> = uses.into_iter().map(|used| used.session).collect();
        let mut count = 0;
        for log in self.store.logs()? {
            let Some(session) = log.strip_prefix(PREFIX).filter(|name| !listed.iter().any(|known| known == name)) else { continue };
            if self.open(Some(session)).is_ok_and(|session| session.head.is_some()) {
                self.store.lock()?.append(SESSIONS, &Use { session: session.to_owned(), folder: String::new() })?;
                count += 1;
            }
        }
        if let Some(last) = last.filter(|_| count > 0) {
            self.store.lock()?.append(SESSIONS, &last)?;
        }
        Ok(count)
    }

    fn note_use(&self, guard: &Guard, session: &str) -> Result<(), HistoryError> {
        let entry = (session.to_owned(), self.folder.clone());
        if self.used()?.last() != Some(&entry) {
            guard.append(SESSIONS, &Use { session: entry.0, folder: entry.1 })?;
        }
        Ok(())
    }
}

impl Session {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The sessions that it is one of.
    pub fn sessions(&self) -> &Sessions {
        &self.sessions
    }

    /// The spec before any turn.
    pub fn base(&self) -> &Spec {
        &self.timeline.base
    }

    /// The version that edits go on from: the newest that this process knows.
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

    /// What is wrong with its log, one sentence each: versions that are named there are missing.
    pub fn damage(&self) -> &[String] {
        &self.damage
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

    /// Makes a version of accepted edits and the spec that came of them: a compare-and-swap on the head. Where another
    /// process added a version since this one looked, nothing is added: [`HistoryError::Moved`].
    pub fn commit(&mut self, words: &str, author: Author, edits: &[Edit], spec: &Spec) -> Result<Version, HistoryError> {
        self.commit_merged(words, author, edits, spec, None)
    }

    /// The same of edits that were made on an older version, the head of the session as it was `seen`, and hold on the newest.
    pub fn commit_merged(
        &mut self,
        words: &str,
        author: Author,
        edits: &[Edit],
        spec: &Spec,
        seen: Option<&Session>,
    ) -> Result<Version, HistoryError> {
        let guard = self.lock_unmoved()?;
        let made_on = seen.map(|seen| Place::from(seen.head));
        self.add(&guard, Made { how: How::Edit, restored: None, made_on, author, words, edits: edits.to_vec(), spec: spec.clone() })
    }

    /// Goes some steps back: a new version with an older spec. Fewer steps where the start is nearer.
    pub fn undo(&mut self, words: &str, steps: u32) -> Result<Version, HistoryError> {
        let guard = self.lock_unmoved()?;
        let target = self.timeline.undo_target(steps).ok_or_else(|| HistoryError::NothingToUndo { session: self.name.clone() })?;
        self.go(&guard, How::Undo(steps), words, &target)
    }

    /// Takes back some steps of undo.
    pub fn redo(&mut self, words: &str, steps: u32) -> Result<Version, HistoryError> {
        let guard = self.lock_unmoved()?;
        let target = self.timeline.redo_target(steps).ok_or_else(|| HistoryError::NothingToRedo { session: self.name.clone() })?;
        self.go(&guard, How::Redo(steps), words, &target)
    }

    /// Goes to a version by name, or to the `start`: a change like any other, which undo undoes.
    pub fn back_to(&mut self, words: &str, to: &str) -> Result<Version, HistoryError> {
        let guard = self.lock_unmoved()?;
        let to = if to.eq_ignore_ascii_case("start") { None } else { Some(self.find(to)?.number) };
        self.go(&guard, How::Back(to), words, &Target(to))
    }

    /// Goes on from the newest version of all, whoever made it.
    pub fn go_on(&mut self) -> Result<(), HistoryError> {
        self.read_again()?;
        self.head = self.timeline.head().map(|head| head.number);
        Ok(())
    }

    /// The versions that came after the head of this session as it was `seen`.
    pub fn since(&self, seen: &Session) -> Vec<Version> {
        self.versions().iter().filter(|version| Some(version.number) > seen.head).cloned().collect()
    }

    /// The spec that a version was made from; none where that is lost.
    pub fn spec_before(&self, version: &Version) -> Option<&Spec> {
        match version.parent.as_deref() {
            Some(parent) => self.find(parent).ok().map(|parent| &parent.spec),
            None => Some(self.base()),
        }
    }

    /// Keeps the camera that every version of the session is seen from.
    pub fn keep_camera(&mut self, camera: &Camera) -> Result<(), HistoryError> {
        self.note(&Operation::Camera { camera: *camera })
    }

    /// The camera that was kept.
    pub fn camera(&self) -> Option<Camera> {
        self.timeline.camera
    }

    /// Keeps what "auto" came to in a version, and the names of its results in the store.
    pub fn keep_resolved(&mut self, version: &str, values: serde_json::Value, results: Vec<String>) -> Result<(), HistoryError> {
        let number = self.find(version)?.number;
        self.note(&Operation::Resolved { number, values, results })
    }

    /// Adds what holds whatever others added.
    fn note(&mut self, operation: &Operation) -> Result<(), HistoryError> {
        let guard = self.sessions.store.lock()?;
        guard.append(&log(&self.name), operation)?;
        self.read_again()
    }

    /// Takes the lock where the head is still the one that this process knows.
    fn lock_unmoved(&mut self) -> Result<Guard, HistoryError> {
        let guard = self.sessions.store.lock()?;
        self.read_again()?;
        match self.timeline.head() {
            Some(now) if Some(now.number) != self.head => {
                let (seen, now, words) = (self.head.map(name), now.name.clone(), now.words.clone());
                Err(HistoryError::Moved { moved: Box::new(Moved { session: self.name.clone(), seen, now, words }) })
            }
            _ => Ok(guard),
        }
    }

    /// Reads what other processes added; the head stays where this one knows it.
    fn read_again(&mut self) -> Result<(), HistoryError> {
        let (timeline, damage, torn) = read(&self.sessions.store, &self.name)?;
        if let Some(timeline) = timeline {
            (self.timeline, self.damage) = (timeline, damage);
            self.torn |= torn;
        }
        Ok(())
    }

    fn go(&mut self, guard: &Guard, how: How, words: &str, target: &Target) -> Result<Version, HistoryError> {
        let spec = self.timeline.spec(target.0).clone();
        let edits = self.spec().edits_to(&spec);
        // Going back by name is an edit to undo; a step of undo or redo is where it leads.
        let restored = if matches!(how, How::Back(_)) { None } else { Some(target.0.into()) };
        self.add(guard, Made { how, restored, made_on: None, author: Author::Travel, words, edits, spec })
    }

    fn add(&mut self, guard: &Guard, made: Made<'_>) -> Result<Version, HistoryError> {
        let number = self.timeline.next_number();
        let Made { how, restored, made_on, author, words, edits, spec } = made;
        let parent = self.head;
        let words = words.to_owned();
        let operation = Operation::Version { number, parent, made_on, how, restored, author, words, edits, spec: Box::new(spec), time_s: now_s() };
        guard.append(&log(&self.name), &operation)?;
        self.timeline.push(operation);
        self.head = Some(number);
        self.sessions.note_use(guard, &self.name)?;
        self.find(&name(number)).cloned()
    }
}

/// What a new version is made of.
struct Made<'a> {
    how: How,
    restored: Option<Place>,
    made_on: Option<Place>,
    author: Author,
    words: &'a str,
    edits: Vec<Edit>,
    spec: Spec,
}

fn log(session: &str) -> String {
    format!("{PREFIX}{session}")
}

/// The session as it lies on disk, what is wrong with it, and whether its last operation was torn.
fn read(store: &Store, session: &str) -> Result<(Option<Timeline>, Vec<String>, bool), StoreError> {
    let log = store.read_log::<Operation>(&log(session))?;
    Ok((Timeline::replay(log.lines, log.lost), log.damage, log.torn))
}

/// The first number that no session has.
fn free_name(from: usize, is_taken: impl Fn(&str) -> bool) -> String {
    let mut number = from;
    while is_taken(&format!("s{number}")) {
        number += 1;
    }
    format!("s{number}")
}

/// Seconds since 1970, UTC.
fn now_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
