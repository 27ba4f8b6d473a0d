//! The size of the cache: what it holds, what may go, what a dead process left.
//!
//! A running total lies in the file `size`, so that finishing an entry costs no look at all the others. It is an estimate
//! that each full look corrects; only a total over the cap leads to one.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::TryLockError;
use std::io::{Read, Write};
use std::time::SystemTime;

use serde::Serialize;

use super::entry::USED;
use super::folder::{Folder, GONE, Kind, is_temporary};
use super::{ASIDE, CACHE, Guard, PINS, SIZE_FILE, Store, StoreError, TMP, checked, fault};

/// How full a store is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Usage {
    /// Bytes of all entries.
    pub bytes: u64,
    /// How many there are.
    pub entries: usize,
    /// The size that eviction keeps them under.
    pub cap_bytes: u64,
    /// Entries and their bytes by stage.
    pub stages: BTreeMap<String, (usize, u64)>,
    /// Bytes of sessions and their copies: never evicted.
    pub history_bytes: u64,
}

/// What a clean-up took away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Collected {
    /// Entries.
    pub entries: usize,
    /// Their bytes.
    pub bytes: u64,
}

struct Candidate {
    stage: String,
    key: String,
    bytes: u64,
    used: SystemTime,
}

impl Candidate {
    fn name(&self) -> String {
        format!("{}/{}", self.stage, self.key)
    }
}

impl Store {
    /// How full it is: looks at everything.
    pub fn usage(&self) -> Result<Usage, StoreError> {
        let mut usage = Usage { cap_bytes: self.cap_bytes, ..Usage::default() };
        for entry in self.candidates()? {
            usage.bytes += entry.bytes;
            usage.entries += 1;
            let stage = usage.stages.entry(entry.stage).or_default();
            *stage = (stage.0 + 1, stage.1 + entry.bytes);
        }
        for name in [super::HISTORY, super::BACKUP] {
            usage.history_bytes += self.root.folder(name)?.map_or(Ok(0), |folder| bytes_below(&folder))?;
        }
        Ok(usage)
    }

    /// Keeps entries from eviction under a name, instead of those that it kept before.
    pub fn pin<'a>(&self, name: &str, entries: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<(), StoreError> {
        let mut kept = Vec::new();
        for (stage, key) in entries {
            kept.push(format!("{}/{}", checked(stage)?, checked(key)?));
        }
        let file = format!("{}.json", checked(name)?);
        let guard = self.lock()?;
        let pins = guard.root().make(PINS)?;
        let bytes = serde_json::to_vec(&kept).map_err(|error| StoreError::damaged(&pins.path_of(&file), error))?;
        pins.write(&file, &bytes)
    }

    /// Removes entries that are not in `reached` (as "stage/key"), then those used longest ago until the rest is at most
    /// `most_bytes`; none that is in use.
    pub fn collect(&self, reached: &BTreeSet<String>, most_bytes: Option<u64>) -> Result<Collected, StoreError> {
        let guard = self.lock()?;
        let (kept, unreached): (Vec<_>, Vec<_>) = self.candidates()?.into_iter().partition(|entry| reached.contains(&entry.name()));
        let kept_bytes = kept.iter().map(|entry| entry.bytes).sum();
        let mut done = self.take_away_oldest(&guard, unreached, 0, &BTreeSet::new())?;
        if let Some(most) = most_bytes {
            let more = self.take_away_oldest(&guard, kept, most.min(kept_bytes), &BTreeSet::new())?;
            done = Collected { entries: done.entries + more.entries, bytes: done.bytes + more.bytes };
        }
        self.recount(&guard)?;
        Ok(done)
    }

    /// Takes every entry away that is not in use, and the folders of their stages.
    pub(super) fn collect_all(&self, guard: &Guard) -> Result<(), StoreError> {
        self.take_away_oldest(guard, self.candidates()?, 0, &BTreeSet::new())?;
        let Some(cache) = guard.root().folder(CACHE)? else { return Ok(()) };
        for stage in cache.children()?.into_iter().filter(|child| child.kind == Kind::Folder) {
            cache.remove_own(&stage.name)?;
        }
        Ok(())
    }

    /// Counts what an entry added; makes room where that is too much.
    pub(super) fn grew(&self, guard: &Guard, bytes: u64) -> Result<(), StoreError> {
        let total = match read_total(guard.root()) {
            Some(total) => total + bytes,
            None => self.candidates()?.iter().map(|entry| entry.bytes).sum(),
        };
        if total > self.cap_bytes {
            let pinned = self.pinned()?;
            self.take_away_oldest(guard, self.candidates()?, self.cap_bytes, &pinned)?;
            return self.recount(guard).map(drop);
        }
        write_total(guard.root(), total)
    }

    /// The running total; counted where there is none.
    pub(super) fn bytes(&self, guard: &Guard) -> Result<u64, StoreError> {
        read_total(guard.root()).map_or_else(|| self.recount(guard), Ok)
    }

    fn recount(&self, guard: &Guard) -> Result<u64, StoreError> {
        let total = self.candidates()?.iter().map(|entry| entry.bytes).sum();
        write_total(guard.root(), total).map(|()| total)
    }

    /// Takes away what was used longest ago until the rest is at most so many bytes, except what is pinned or in use.
    fn take_away_oldest(
        &self,
        guard: &Guard,
        mut entries: Vec<Candidate>,
        most_bytes: u64,
        pinned: &BTreeSet<String>,
    ) -> Result<Collected, StoreError> {
        entries.sort_by_key(|entry| (entry.used, entry.name()));
        let mut bytes: u64 = entries.iter().map(|entry| entry.bytes).sum();
        let mut done = Collected::default();
        for entry in entries {
            if bytes <= most_bytes {
                break;
            }
            if !pinned.contains(&entry.name()) && self.take_away_unused(guard, &entry)? {
                bytes -= entry.bytes;
                done = Collected { entries: done.entries + 1, bytes: done.bytes + entry.bytes };
            }
        }
        Ok(done)
    }

    fn take_away_unused(&self, guard: &Guard, entry: &Candidate) -> Result<bool, StoreError> {
        let Some(stage) = self.stage_folder(&entry.stage)? else { return Ok(false) };
        match stage.folder(&entry.key) {
            Ok(Some(folder)) if is_used(&folder)? => return Ok(false),
            Ok(None) => return Ok(false),
            // Something else in the place of an entry is put aside.
            Ok(_) | Err(StoreError::Foreign { .. }) => {}
            Err(error) => return Err(error),
        }
        self.take_away(guard, &entry.stage, &entry.key)?;
        Ok(true)
    }

    /// Takes an entry away at once, if it is there; whoever reads it reads on where the system can. What is found in it
    /// that no store makes is put aside, never removed.
    pub(super) fn take_away(&self, guard: &Guard, stage: &str, key: &str) -> Result<(), StoreError> {
        let Some(stage) = self.stage_folder(stage)? else { return Ok(()) };
        if stage.kind(key)?.is_none() {
            return Ok(());
        }
        let tmp = guard.root().make(TMP)?;
        let (name, folder) = tmp.make_temporary()?;
        // The rename takes the entry away as a whole; its removal may take time.
        stage.rename(key, &folder, GONE)?;
        self.remove_or_put_aside(guard, &tmp, &name)
    }

    fn remove_or_put_aside(&self, guard: &Guard, tmp: &Folder, name: &str) -> Result<(), StoreError> {
        if tmp.remove_own(name)? {
            return Ok(());
        }
        let (place, folder) = guard.root().make(ASIDE)?.make_temporary()?;
        tmp.rename(name, &folder, GONE)?;
        let path = folder.path_of(GONE);
        self.tell_damage(&format!(
            "{} holds files that no store makes: they were put aside as {place}; look at them and remove them",
            path.display()
        ));
        Ok(())
    }

    /// Removes what is in the making by nobody alive, and what is half removed.
    pub(super) fn sweep(&self, guard: &Guard) -> Result<(), StoreError> {
        if let Some(tmp) = guard.root().folder(TMP)? {
            for child in tmp.children()? {
                let ours = child.kind == Kind::Folder && is_temporary(&child.name);
                if ours && !tmp.folder(&child.name)?.map_or(Ok(false), |folder| is_used(&folder))? {
                    self.remove_or_put_aside(guard, &tmp, &child.name)?;
                }
            }
        }
        // Single files are written under the lock, which is ours now.
        for folder in [Some(guard.root().clone()), guard.root().folder(PINS)?, guard.root().folder(super::HISTORY)?].into_iter().flatten() {
            for child in folder.children()?.iter().filter(|child| child.kind == Kind::File && is_temporary(&child.name)) {
                folder.remove_file(&child.name)?;
            }
        }
        Ok(())
    }

    fn candidates(&self) -> Result<Vec<Candidate>, StoreError> {
        let mut found = Vec::new();
        let Some(cache) = self.root.folder(CACHE)? else { return Ok(found) };
        for stage in cache.children()?.into_iter().filter(|child| child.kind == Kind::Folder && checked(&child.name).is_ok()) {
            let Some(folder) = cache.folder(&stage.name)? else { continue };
            for entry in folder.children()?.into_iter().filter(|child| checked(&child.name).is_ok()) {
                let files =
                    if entry.kind == Kind::Folder { folder.folder(&entry.name)?.map_or(Ok(Vec::new()), |f| f.children())? } else { Vec::new() };
                let used = files.iter().find(|file| file.name == USED).map_or(SystemTime::UNIX_EPOCH, |file| file.modified);
                let bytes = files.iter().filter(|file| file.kind == Kind::File).map(|file| file.bytes).sum();
                found.push(Candidate { stage: stage.name.clone(), key: entry.name, bytes, used });
            }
        }
        Ok(found)
    }

    /// Names of entries that are kept from eviction. A list that cannot be read keeps none: it is taken away, and that is
    /// reported.
    fn pinned(&self) -> Result<BTreeSet<String>, StoreError> {
        let mut pinned = BTreeSet::new();
        let Some(pins) = self.root.folder(PINS)? else { return Ok(pinned) };
        for child in pins.children()?.into_iter().filter(|child| child.kind == Kind::File && checked(&child.name).is_ok()) {
            let bytes = pins.read(&child.name)?.unwrap_or_default();
            match serde_json::from_slice::<Vec<String>>(&bytes) {
                Ok(names) => pinned.extend(names),
                Err(why) => {
                    self.tell_damage(&format!("{} was damaged ({why}): what it kept from eviction may go", pins.path_of(&child.name).display()));
                    pins.remove_file(&child.name)?;
                }
            }
        }
        Ok(pinned)
    }
}

/// Bytes of all files in a folder and in the folders of it.
fn bytes_below(folder: &Folder) -> Result<u64, StoreError> {
    let mut bytes = 0;
    for child in folder.children()? {
        bytes += match child.kind {
            Kind::File => child.bytes,
            Kind::Folder => folder.folder(&child.name)?.map_or(Ok(0), |below| bytes_below(&below))?,
            Kind::Foreign(_) => 0,
        };
    }
    Ok(bytes)
}

/// Whether someone alive holds the entry or its making.
fn is_used(entry: &Folder) -> Result<bool, StoreError> {
    match entry.file(USED, true) {
        Ok(Some(file)) => match file.try_lock() {
            Ok(()) => Ok(false),
            Err(TryLockError::WouldBlock) => Ok(true),
            Err(TryLockError::Error(error)) => Err(StoreError::io("locked", &entry.path_of(USED))(error)),
        },
        Ok(None) | Err(StoreError::Foreign { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

fn read_total(root: &Folder) -> Option<u64> {
    let mut text = String::new();
    root.file(SIZE_FILE, false).ok()??.read_to_string(&mut text).ok()?;
    text.strip_suffix('\n')?.parse().ok()
}

/// Not brought to disk: a total that a crash spoils is counted anew.
fn write_total(root: &Folder, total: u64) -> Result<(), StoreError> {
    fault::before_write();
    let mut file = root.file_or_new(SIZE_FILE)?;
    file.set_len(0).and_then(|()| file.write_all(format!("{total}\n").as_bytes())).map_err(StoreError::io("written", &root.path_of(SIZE_FILE)))
}
