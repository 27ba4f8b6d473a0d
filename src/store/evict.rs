//! Room: what is there, what may go, what a dead process left.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::entry::USED;
use super::{Guard, Store, StoreError, atomic, checked, write_atomic, writer};

/// How full a store is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// Bytes of all entries.
    pub bytes: u64,
    /// How many there are.
    pub entries: usize,
    /// The size that eviction keeps it under.
    pub cap_bytes: u64,
}

struct Candidate {
    path: PathBuf,
    name: String,
    bytes: u64,
    used: SystemTime,
}

impl Store {
    /// How full it is.
    pub fn usage(&self) -> Result<Usage, StoreError> {
        let entries = self.candidates()?;
        Ok(Usage { bytes: entries.iter().map(|entry| entry.bytes).sum(), entries: entries.len(), cap_bytes: self.cap_bytes })
    }

    /// Keeps entries from eviction under a name, instead of those that it kept before.
    pub fn pin<'a>(&self, name: &str, entries: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<(), StoreError> {
        let mut kept = Vec::new();
        for (stage, key) in entries {
            kept.push(format!("{}/{}", checked(stage)?, checked(key)?));
        }
        let path = self.dir().join("pins").join(format!("{}.json", checked(name)?));
        let bytes = serde_json::to_vec(&kept).map_err(|error| StoreError::damaged(&path, error))?;
        let _guard = self.lock()?;
        write_atomic(&path, &bytes).map_err(StoreError::io("written", &path))
    }

    pub(super) fn bytes(&self) -> Result<u64, StoreError> {
        Ok(self.usage()?.bytes)
    }

    /// Takes away what was used longest ago until the rest fits, except what is pinned or in use.
    pub(super) fn evict(&self, guard: &Guard) -> Result<(), StoreError> {
        let mut entries = self.candidates()?;
        let mut bytes: u64 = entries.iter().map(|entry| entry.bytes).sum();
        if bytes <= self.cap_bytes {
            return Ok(());
        }
        entries.sort_by(|a, b| (a.used, &a.path).cmp(&(b.used, &b.path)));
        let pinned = self.pinned()?;
        for entry in entries {
            if bytes <= self.cap_bytes {
                break;
            }
            if !pinned.contains(&entry.name) && self.discard_unused(guard, &entry.path)? {
                bytes -= entry.bytes;
            }
        }
        Ok(())
    }

    /// Removes what is in the making by nobody alive, and what is half removed.
    pub(super) fn sweep(&self, guard: &Guard) -> Result<(), StoreError> {
        for path in children(&self.dir().join("tmp"))? {
            if !is_used(&path)? {
                remove_folder(&path)?;
            }
        }
        // Single files are written under the lock, which is ours now.
        for path in children(guard.dir())?.into_iter().chain(children(&self.dir().join("pins"))?) {
            if path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(atomic::TEMP)) {
                fs::remove_file(&path).map_err(StoreError::io("removed", &path))?;
            }
        }
        Ok(())
    }

    /// Takes an entry away at once, if it is there; whoever reads it reads on where the system can.
    pub(super) fn discard(&self, guard: &Guard, path: &Path) -> Result<(), StoreError> {
        self.take_out(guard, path)?.map_or(Ok(()), |gone| remove_folder(&gone))
    }

    /// Puts an entry out of the way, if it is there: the folder that is to be removed.
    pub(super) fn take_out(&self, _: &Guard, path: &Path) -> Result<Option<PathBuf>, StoreError> {
        if !path.exists() {
            return Ok(None);
        }
        let tmp = self.dir().join("tmp");
        fs::create_dir_all(&tmp).map_err(StoreError::io("made", &tmp))?;
        // The rename replaces an empty folder: the entry goes as a whole, its removal may take time.
        let folder = writer::fresh_folder(&tmp)?;
        fs::rename(path, folder.join("gone")).map_err(StoreError::io("removed", path))?;
        Ok(Some(folder))
    }

    fn discard_unused(&self, guard: &Guard, path: &Path) -> Result<bool, StoreError> {
        if is_used(path)? {
            return Ok(false);
        }
        self.discard(guard, path)?;
        Ok(true)
    }

    fn candidates(&self) -> Result<Vec<Candidate>, StoreError> {
        let mut found = Vec::new();
        for stage in children(&self.dir().join("cache"))? {
            for path in children(&stage)? {
                let mut bytes = 0;
                let mut used = SystemTime::UNIX_EPOCH;
                for file in children(&path)? {
                    // Gone between the two looks: nothing to count.
                    let Ok(meta) = fs::metadata(&file) else { continue };
                    bytes += meta.len();
                    if file.file_name().is_some_and(|name| name == USED) {
                        used = meta.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                    }
                }
                let part = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
                found.push(Candidate { name: format!("{}/{}", part(&stage), part(&path)), path, bytes, used });
            }
        }
        Ok(found)
    }

    /// Names of entries that are kept from eviction. A list that cannot be read keeps none: it is taken away, and that is said.
    fn pinned(&self) -> Result<BTreeSet<String>, StoreError> {
        let mut pinned = BTreeSet::new();
        for path in children(&self.dir().join("pins"))? {
            let names = fs::read(&path).map_err(|e| e.to_string()).and_then(|bytes| serde_json::from_slice(&bytes).map_err(|e| e.to_string()));
            match names {
                Ok(names) => pinned.extend::<Vec<String>>(names),
                Err(why) => {
                    self.tell_damage(&format!("{}; what it kept from eviction may go", StoreError::damaged(&path, why)));
                    remove_folder(&path)?;
                }
            }
        }
        Ok(pinned)
    }
}

/// What lies in a folder; nothing where it is not there, or no folder.
fn children(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let listing = match fs::read_dir(folder) {
        Ok(listing) => listing,
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => return Ok(Vec::new()),
        Err(error) => return Err(StoreError::io("read", folder)(error)),
    };
    listing.map(|child| child.map(|child| child.path()).map_err(StoreError::io("read", folder))).collect()
}

/// Whether someone alive holds the entry or its making.
fn is_used(path: &Path) -> Result<bool, StoreError> {
    let used_path = path.join(USED);
    match File::options().read(true).write(true).open(&used_path) {
        Ok(file) => match file.try_lock() {
            Ok(()) => Ok(false),
            Err(fs::TryLockError::WouldBlock) => Ok(true),
            Err(fs::TryLockError::Error(error)) => Err(StoreError::io("locked", &used_path)(error)),
        },
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Ok(false),
        Err(error) => Err(StoreError::io("opened", &used_path)(error)),
    }
}

pub(super) fn remove_folder(path: &Path) -> Result<(), StoreError> {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    match removed {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(StoreError::io("removed", path)(error)),
        _ => Ok(()),
    }
}
