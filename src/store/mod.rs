//! Content that outlives a run: what stages made, and what the agent remembers. No GPU here.
//!
//! ```text
//! .phystalk/
//!   format               version of this layout
//!   lock                 held for one operation
//!   cache/STAGE/KEY/     a finished entry: its blobs, entry.json (sizes, checksums, meta) with its
//!                        own in entry.blake3, used
//!   pins/NAME.json       entries that eviction leaves alone
//!   tmp/                 entries in the making or on their way out; swept at start
//! ```
//! Files appear whole or not at all. An entry that is open, here or in another process, holds a
//! shared lock on its `used` file, and one in the making an exclusive one; both vanish with the
//! process. The time of `used` is that of the last use.

mod atomic;
mod entry;
mod error;
mod evict;
mod lock;
mod log;
#[cfg(test)]
mod tests;
mod writer;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde_json::Value;

pub use atomic::write_atomic;
pub use entry::{BlobReader, Entry};
pub use error::StoreError;
pub use evict::Usage;
pub use lock::Guard;
pub use log::Log;
pub use writer::{BlobWriter, EntryWriter};

/// The layout described above.
const FORMAT: u32 = 1;
/// The folder that is looked for, walking up.
const FOLDER: &str = ".phystalk";
/// Largest size, where the disk allows it.
const CAP_BYTES: u64 = 10 << 30;
/// Share of the free disk that the store may take: a tenth.
const CAP_SHARE: u64 = 10;
/// How long an operation waits for another process.
const LOCK_WAIT: Duration = Duration::from_secs(10);

/// A folder with stage results and history. Cheap to clone; every clone is the same store.
#[derive(Clone, Debug)]
pub struct Store {
    dir: Arc<Path>,
    cap_bytes: u64,
    wait: Duration,
    /// What was found damaged and not yet said.
    damage: Arc<Mutex<Vec<String>>>,
}

impl Store {
    /// Opens `dir`, or else the `.phystalk` nearest above `cwd`, or else makes one there. Removes what
    /// a process that died left half written.
    pub fn open(dir: Option<&Path>, cwd: &Path) -> Result<Store, StoreError> {
        let dir = match dir {
            Some(dir) => cwd.join(dir),
            None => {
                let above = cwd.ancestors().map(|folder| folder.join(FOLDER)).find(|folder| folder.join("format").exists());
                above.unwrap_or_else(|| cwd.join(FOLDER))
            }
        };
        fs::create_dir_all(&dir).map_err(StoreError::io("made", &dir))?;
        let free = free_bytes(&dir).map_err(StoreError::io("measured", &dir))?;
        let mut store = Store { dir: dir.into(), cap_bytes: CAP_BYTES, wait: LOCK_WAIT, damage: Arc::default() };
        store.check_format()?;
        let guard = store.lock()?;
        store.sweep(&guard)?;
        // What the store already holds is its own to use again.
        store.cap_bytes = CAP_BYTES.min((free + store.bytes()?) / CAP_SHARE);
        Ok(store)
    }

    /// The same store with another size cap.
    pub fn with_cap(mut self, bytes: u64) -> Store {
        self.cap_bytes = bytes;
        self
    }

    /// The same store with another patience.
    pub fn with_wait(mut self, wait: Duration) -> Store {
        self.wait = wait;
        self
    }

    /// Its folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The size that eviction keeps it under.
    pub fn cap_bytes(&self) -> u64 {
        self.cap_bytes
    }

    /// What a stage made under a key, if it is there; it is not evicted while the entry lives. An
    /// entry that is damaged is taken away and counts as none: `take_damage` tells of it.
    pub fn get(&self, stage: &str, key: &str) -> Result<Option<Entry>, StoreError> {
        let path = self.entry_path(stage, key)?;
        match Entry::open_at(&path) {
            Err(damage @ StoreError::Damaged { .. }) => {
                self.remove(stage, key)?;
                self.tell_damage(&format!("{damage}; it was taken away and is made anew"));
                Ok(None)
            }
            found => found,
        }
    }

    fn tell_damage(&self, sentence: &str) {
        self.damage.lock().unwrap_or_else(PoisonError::into_inner).push(sentence.to_owned());
    }

    /// One sentence for each damaged entry that was found since the last call.
    pub fn take_damage(&self) -> Vec<String> {
        std::mem::take(&mut *self.damage.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Whether `get` would probably find something; counts as no use.
    pub fn contains(&self, stage: &str, key: &str) -> bool {
        self.entry_path(stage, key).is_ok_and(|path| path.join(entry::MANIFEST).exists())
    }

    /// Starts to write an entry; nobody sees it before `finish`, and it vanishes if that never comes.
    pub fn begin(&self, stage: &str, key: &str) -> Result<EntryWriter, StoreError> {
        EntryWriter::begin(self, self.entry_path(stage, key)?)
    }

    /// Forgets an entry. Whoever reads it reads on.
    pub fn remove(&self, stage: &str, key: &str) -> Result<(), StoreError> {
        let path = self.entry_path(stage, key)?;
        let guard = self.lock()?;
        self.discard(&guard, &path)
    }

    /// Takes the store's lock for one operation; other processes wait meanwhile.
    pub fn lock(&self) -> Result<Guard, StoreError> {
        Guard::take(&self.dir, self.wait)
    }

    fn entry_path(&self, stage: &str, key: &str) -> Result<PathBuf, StoreError> {
        Ok(self.dir.join("cache").join(checked(stage)?).join(checked(key)?))
    }

    /// Reads the version, or writes it into a folder that is new.
    fn check_format(&self) -> Result<(), StoreError> {
        let path = self.dir.join("format");
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return self.initialise(),
            Err(error) => return Err(StoreError::io("read", &path)(error)),
        };
        match text.trim().parse::<u32>() {
            Ok(found) if found > FORMAT => Err(StoreError::Newer { dir: self.dir.to_path_buf(), found, known: FORMAT }),
            Ok(FORMAT) => Ok(()),
            _ => Err(StoreError::damaged(&path, "it holds no version")),
        }
    }

    fn initialise(&self) -> Result<(), StoreError> {
        let ours = |name: &str| name == "lock" || name == ".gitignore" || name == "format" || name.starts_with(atomic::TEMP);
        for found in fs::read_dir(&self.dir).map_err(StoreError::io("read", &self.dir))? {
            let found = found.map_err(StoreError::io("read", &self.dir))?;
            if !ours(&found.file_name().to_string_lossy()) {
                return Err(StoreError::NotAStore { dir: self.dir.to_path_buf() });
            }
        }
        let _guard = self.lock()?;
        for (name, text) in [(".gitignore", "*\n".to_owned()), ("format", format!("{FORMAT}\n"))] {
            let path = self.dir.join(name);
            write_atomic(&path, text.as_bytes()).map_err(StoreError::io("written", &path))?;
        }
        Ok(())
    }
}

/// A name that stays inside its folder.
fn checked(name: &str) -> Result<&str, StoreError> {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.');
    if !name.is_empty() && name.len() <= 128 && !name.starts_with('.') && name.bytes().all(plain) {
        Ok(name)
    } else {
        Err(StoreError::Name { name: name.to_owned() })
    }
}

/// Bytes that this user may still write on the disk of a folder.
#[cfg(unix)]
fn free_bytes(dir: &Path) -> io::Result<u64> {
    let disk = rustix::fs::statvfs(dir)?;
    Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
}

/// Without a way to ask, the fixed cap holds.
#[cfg(not(unix))]
fn free_bytes(_: &Path) -> io::Result<u64> {
    Ok(CAP_BYTES * CAP_SHARE)
}

/// Parses JSON that this store wrote.
fn parse(path: &Path, bytes: &[u8]) -> Result<Value, StoreError> {
    serde_json::from_slice(bytes).map_err(|error| StoreError::damaged(path, error))
}
