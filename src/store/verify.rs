//! Verification of a whole store: finds what is damaged, and repairs what can be repaired. What it changes it copies to
//! `backup` first, except results, which are made anew.

use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;
use serde::de::IgnoredAny;

use super::folder::{Folder, Kind, is_temporary};
use super::place::{FORMAT_FILE, Format, ID_FILE, new_id};
use super::{BACKUP, CACHE, FORMAT, Guard, HISTORY, PARTS, PINS, Store, StoreError, checked, log};

/// Something that is not as the store left it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The file or folder, relative to the store.
    pub part: String,
    /// What is wrong with it.
    pub problem: String,
    /// What a repair does, or did, about it; none where only the user can.
    pub repair: Option<String>,
}

/// One walk through a store.
struct Verification<'a> {
    store: &'a Store,
    /// None where nothing is to be changed.
    guard: Option<Guard>,
    /// The folder in `backup` for copies of this repair.
    backup: String,
    found: Vec<Finding>,
}

impl Store {
    /// Looks at every file of the store and compares every checksum; with `repair` mends what it can.
    pub fn verify(&mut self, repair: bool) -> Result<Vec<Finding>, StoreError> {
        let guard = if repair { Some(Guard::take(&self.root, self.wait)?) } else { None };
        let found = self.verify_identity(guard.as_ref())?;
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        let mut walk = Verification { store: self, guard, backup: format!("repair-{seconds}"), found };
        walk.unknown_names()?;
        walk.logs()?;
        walk.pins()?;
        walk.entries()?;
        Ok(walk.found)
    }

    /// A format that cannot be read is that of this program, or of the one before, whose stores have no identity.
    fn verify_identity(&mut self, guard: Option<&Guard>) -> Result<Vec<Finding>, StoreError> {
        let mut found = Vec::new();
        let mut find = |part: &str, problem: &str, repair: &str| {
            found.push(Finding { part: part.to_owned(), problem: problem.to_owned(), repair: Some(repair.to_owned()) });
        };
        if let Format::Damaged(why) = &self.format {
            find(FORMAT_FILE, why, "it is written anew");
        }
        if self.id.is_none() {
            find(ID_FILE, "the store has no identity", "it is given a new one");
        }
        let Some(guard) = guard else { return Ok(found) };
        if matches!(self.format, Format::Damaged(_)) {
            self.read_only = None;
            if self.id.is_none() {
                self.migrate(guard, FORMAT - 1)?;
            }
            guard.root().write(FORMAT_FILE, format!("{FORMAT}\n").as_bytes())?;
            self.format = Format::Current;
        }
        if self.id.is_none() {
            self.id = Some(new_id(guard.root())?);
        }
        Ok(found)
    }
}

impl Verification<'_> {
    fn find(&mut self, part: String, problem: impl ToString, repair: Option<&str>) {
        self.found.push(Finding { part, problem: problem.to_string(), repair: repair.map(str::to_owned) });
    }

    fn keep_copy(&self, guard: &Guard, from: &Folder, file: &str) -> Result<(), StoreError> {
        let backup = guard.root().make(BACKUP)?.make(&self.backup)?;
        backup.write(file, &from.read(file)?.unwrap_or_default())
    }

    fn unknown_names(&mut self) -> Result<(), StoreError> {
        for child in self.store.root.children()? {
            if PARTS.iter().all(|(name, _)| *name != child.name) && !is_temporary(&child.name) {
                self.find(child.name, "no store makes this; it is left alone", None);
            }
        }
        Ok(())
    }

    fn logs(&mut self) -> Result<(), StoreError> {
        let Some(history) = self.store.root.folder(HISTORY)? else { return Ok(()) };
        let names = log::names(&history)?;
        for name in &names {
            let damage = self.store.read_log::<IgnoredAny>(name)?.damage;
            let file = format!("{name}.jsonl");
            for problem in &damage {
                self.find(format!("{HISTORY}/{file}"), problem, Some("the sound lines are joined; the log as it was is kept in the folder backup"));
            }
            if let Some(guard) = self.guard.as_ref().filter(|_| !damage.is_empty()) {
                self.keep_copy(guard, &history, &file)?;
                log::relink(&history, name, false)?;
            }
        }
        for child in history.children()? {
            let Some(name) = child.name.strip_suffix(".head").filter(|name| !names.iter().any(|known| known == name)) else { continue };
            self.find(format!("{HISTORY}/{}", child.name), format!("the log {name}.jsonl is missing"), Some("a copy of this is kept"));
            if let Some(guard) = &self.guard {
                self.keep_copy(guard, &history, &child.name)?;
                history.remove_file(&child.name)?;
            }
        }
        Ok(())
    }

    fn pins(&mut self) -> Result<(), StoreError> {
        let Some(pins) = self.store.root.folder(PINS)? else { return Ok(()) };
        for child in pins.children()?.into_iter().filter(|child| !is_temporary(&child.name)) {
            let part = format!("{PINS}/{}", child.name);
            if child.kind != Kind::File {
                self.find(part, "it is no file; it is left alone", None);
                continue;
            }
            let names = serde_json::from_slice::<Vec<String>>(&pins.read(&child.name)?.unwrap_or_default());
            let Err(why) = names else { continue };
            self.find(part, why, Some("it is removed, a copy is kept; what it kept from eviction may go"));
            if let Some(guard) = &self.guard {
                self.keep_copy(guard, &pins, &child.name)?;
                pins.remove_file(&child.name)?;
            }
        }
        Ok(())
    }

    fn entries(&mut self) -> Result<(), StoreError> {
        let Some(cache) = self.store.root.folder(CACHE)? else { return Ok(()) };
        for stage in cache.children()? {
            let part = format!("{CACHE}/{}", stage.name);
            if stage.kind != Kind::Folder || checked(&stage.name).is_err() {
                self.find(part, "no store makes this; it is left alone", None);
                continue;
            }
            let Some(folder) = cache.folder(&stage.name)? else { continue };
            for entry in folder.children()? {
                self.entry(&stage.name, &entry.name)?;
            }
        }
        Ok(())
    }

    fn entry(&mut self, stage: &str, key: &str) -> Result<(), StoreError> {
        let part = format!("{CACHE}/{stage}/{key}");
        if checked(key).is_err() {
            self.find(part, "no store makes this; it is left alone", None);
            return Ok(());
        }
        let problem = match self.store.open_entry(stage, key) {
            Ok(Some(entry)) => match entry.damaged_blobs()? {
                blobs if blobs.is_empty() => return Ok(()),
                blobs => format!("the checksums of {} differ", blobs.join(", ")),
            },
            Ok(None) => return Ok(()),
            Err(StoreError::Damaged { why, .. }) => why,
            Err(other @ StoreError::Foreign { .. }) => other.to_string(),
            Err(other) => return Err(other),
        };
        self.find(part, problem, Some("it is taken away and made anew when it is needed"));
        match &self.guard {
            Some(guard) => self.store.take_away(guard, stage, key),
            None => Ok(()),
        }
    }
}
