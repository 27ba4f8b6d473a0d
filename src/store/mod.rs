//! Content that outlives a run: what stages made, and what the agent remembers. No GPU here.
//!
//! ```text
//! .phystalk/
//!   format               version of this layout
//!   id                   tells this store from every other one
//!   lock                 held for one operation
//!   size                 bytes of all entries, about
//!   cache/STAGE/KEY/     a finished entry: its blobs, entry.json (sizes, checksums, meta) with its
//!                        own in entry.blake3, used
//!   history/NAME.jsonl   append-only logs, each with its NAME.head
//!   pins/NAME.json       entries that eviction leaves alone
//!   tmp/                 entries in the making or on their way out; swept at start
//!   aside/               what was found in an entry and no store makes; removed by nobody but the user
//!   backup/              logs as they were before they were migrated or repaired
//! ```
//! Files appear whole or not at all. An entry that is open, here or in another process, holds a
//! shared lock on its `used` file, and one in the making an exclusive one; both vanish with the
//! process. The time of `used` is that of the last use. No link under the store is followed, and
//! nothing is removed but files of the names above.

mod atomic;
mod entry;
mod error;
mod evict;
mod fault;
mod folder;
mod lock;
mod log;
mod place;
#[cfg(test)]
mod tests;
mod trust;
mod verify;
mod writer;

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde::de::DeserializeOwned;

use folder::{Folder, Kind};
use log::HISTORY;
use place::Format;

pub use atomic::write_atomic;
pub use entry::{BlobReader, Entry};
pub use error::StoreError;
pub use evict::{Collected, Usage};
pub(crate) use fault::before_write;
pub use lock::Guard;
pub use log::Log;
pub use place::{FOLDER, Place, new_store_dir};
pub use trust::AcceptedStores;
pub use verify::Finding;
pub use writer::{BlobWriter, EntryWriter};

/// The layout described above.
const FORMAT: u32 = 2;
/// Begins the name of every file that is being written.
const TEMP: &str = ".tmp-";
const CACHE: &str = "cache";
const PINS: &str = "pins";
const TMP: &str = "tmp";
const ASIDE: &str = "aside";
const BACKUP: &str = "backup";
const SIZE_FILE: &str = "size";
/// What drivers wrote to standard error while the terminal interface had the screen.
const DRIVER_LOG: &str = "repl.log";
/// The parts of a store, and what each must be.
const PARTS: [(&str, Kind); 12] = [
    (place::FORMAT_FILE, Kind::File),
    (place::ID_FILE, Kind::File),
    (lock::LOCK_FILE, Kind::File),
    (SIZE_FILE, Kind::File),
    (DRIVER_LOG, Kind::File),
    (".gitignore", Kind::File),
    (CACHE, Kind::Folder),
    (HISTORY, Kind::Folder),
    (PINS, Kind::Folder),
    (TMP, Kind::Folder),
    (ASIDE, Kind::Folder),
    (BACKUP, Kind::Folder),
];
/// Largest size, where the disk allows it.
const CAP_BYTES: u64 = 10 << 30;
/// Share of the free disk that the store may take: a tenth.
const CAP_SHARE: u64 = 10;
/// How long an operation waits for another process.
const LOCK_WAIT: Duration = Duration::from_secs(10);

/// A folder with stage results and history. Cheap to clone; every clone is the same store.
#[derive(Clone, Debug)]
pub struct Store {
    root: Folder,
    id: Option<String>,
    format: Format,
    /// Why nothing can be added, where that is so.
    read_only: Option<Arc<str>>,
    cap_bytes: u64,
    wait: Duration,
    /// What was found damaged and not yet reported.
    damage: Arc<Mutex<Vec<String>>>,
    /// The folder of a scratch store, which goes with its last clone.
    _scratch: Option<Arc<tempfile::TempDir>>,
}

impl Store {
    /// Opens the store in a folder, made where there is none. Whose it is, the caller has decided.
    pub fn open(dir: &Path) -> Result<Store, StoreError> {
        match Place::at(dir)? {
            Some(place) => place.open(),
            None => Place::make(dir)?.open(),
        }
    }

    /// A store of its own in a private folder under an unguessable name, which is gone with its last clone.
    pub fn scratch() -> Result<Store, StoreError> {
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        let folder = builder.prefix("phystalk-").tempdir().map_err(StoreError::io("made", &std::env::temp_dir()))?;
        let store = Store::open(folder.path())?;
        Ok(Store { _scratch: Some(Arc::new(folder)), ..store })
    }

    pub(super) fn open_place(place: Place) -> Result<Store, StoreError> {
        let Place { root, id, format } = place;
        let damage = Arc::default();
        let mut store = Store { root, id, format, read_only: None, cap_bytes: CAP_BYTES, wait: LOCK_WAIT, damage, _scratch: None };
        let guard = match store.lock() {
            Ok(guard) => guard,
            Err(StoreError::Io { source, .. }) => {
                store.read_only = Some(source.to_string().into());
                return Ok(store);
            }
            Err(error) => return Err(error),
        };
        if let Format::Damaged(why) = &store.format {
            let path = store.root.path_of(place::FORMAT_FILE);
            store.read_only = Some(format!("{} is damaged ({why}): phystalk store verify --repair", path.display()).into());
            return Ok(store);
        }
        if let Format::Old(format) = store.format {
            store.migrate(&guard, format)?;
        }
        store.sweep(&guard)?;
        let free = free_bytes(store.dir()).map_err(StoreError::io("measured", store.dir()))?;
        // What the store already holds is its own to use again.
        store.cap_bytes = CAP_BYTES.min((free + store.bytes(&guard)?) / CAP_SHARE);
        Ok(store)
    }

    /// Brings an older layout up to this one; copies of the logs stay in `backup`.
    fn migrate(&mut self, guard: &Guard, from: u32) -> Result<(), StoreError> {
        let root = guard.root();
        if let Some(history) = root.folder(HISTORY)? {
            let backup = root.make(BACKUP)?.make(&format!("format-{from}"))?;
            for name in log::names(&history)? {
                let file = format!("{name}.jsonl");
                // A copy that is there is from a migration that was cut short: it is the older one.
                if backup.kind(&file)?.is_none() {
                    backup.write(&file, &history.read(&file)?.unwrap_or_default())?;
                }
                log::relink(&history, &name, true)?;
            }
        }
        if self.id.is_none() {
            self.id = Some(place::new_id(root)?);
        }
        root.write(place::FORMAT_FILE, format!("{FORMAT}\n").as_bytes())?;
        self.format = Format::Current;
        Ok(())
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
        self.root.path()
    }

    /// What tells it from every other store; none in one of an old format that cannot be written.
    pub fn id(&self) -> Option<&str> {
        self.id.as_deref()
    }

    /// Why nothing can be added to it, where that is so; what is in it can be read.
    pub fn read_only(&self) -> Option<&str> {
        self.read_only.as_deref()
    }

    /// The size that eviction keeps it under.
    pub fn cap_bytes(&self) -> u64 {
        self.cap_bytes
    }

    /// What a stage made under a key, if it is there; it is not evicted while the entry lives. An
    /// entry that is damaged is taken away and counts as none: `take_damage` tells of it.
    pub fn get(&self, stage: &str, key: &str) -> Result<Option<Entry>, StoreError> {
        match self.open_entry(stage, key) {
            Err(damage @ (StoreError::Damaged { .. } | StoreError::Foreign { .. })) if self.stage_folder(stage).is_ok() => {
                let what = match damage {
                    StoreError::Damaged { path, why } => format!("{} was damaged ({why})", path.display()),
                    other => other.to_string(),
                };
                if self.read_only.is_none() {
                    self.remove(stage, key)?;
                }
                self.tell_damage(&format!("{what}; the result is made anew"));
                Ok(None)
            }
            found => found,
        }
    }

    /// The entry under a key as it lies on disk.
    fn open_entry(&self, stage: &str, key: &str) -> Result<Option<Entry>, StoreError> {
        checked(key)?;
        let Some(folder) = self.stage_folder(stage)? else { return Ok(None) };
        folder.folder(key)?.map_or(Ok(None), Entry::open_in)
    }

    fn stage_folder(&self, stage: &str) -> Result<Option<Folder>, StoreError> {
        checked(stage)?;
        self.root.folder(CACHE)?.map_or(Ok(None), |cache| cache.folder(stage))
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
        let entry = || self.stage_folder(stage).ok()??.folder(key).ok()?;
        checked(key).is_ok() && entry().is_some_and(|entry| matches!(entry.kind(entry::MANIFEST), Ok(Some(Kind::File))))
    }

    /// Starts to write an entry; nobody sees it before `finish`, and it vanishes if that never comes.
    pub fn begin(&self, stage: &str, key: &str) -> Result<EntryWriter, StoreError> {
        EntryWriter::begin(self, stage, key)
    }

    /// Forgets an entry. Whoever reads it reads on.
    pub fn remove(&self, stage: &str, key: &str) -> Result<(), StoreError> {
        checked(key)?;
        let guard = self.lock()?;
        self.take_away(&guard, stage, key)
    }

    /// Takes the store's lock for one operation; other processes wait meanwhile.
    pub fn lock(&self) -> Result<Guard, StoreError> {
        match &self.read_only {
            Some(why) => Err(StoreError::ReadOnly { dir: self.dir().to_owned(), why: why.to_string() }),
            None => Guard::take(&self.root, self.wait),
        }
    }

    /// Reads a log of the history; one that is not there is empty.
    pub fn read_log<T: DeserializeOwned>(&self, log: &str) -> Result<Log<T>, StoreError> {
        log::read(&self.root, log, matches!(self.format, Format::Old(_)))
    }

    /// Names of all logs of the history, whether or not anything lists them.
    pub fn logs(&self) -> Result<Vec<String>, StoreError> {
        self.root.folder(HISTORY)?.map_or(Ok(Vec::new()), |history| log::names(&history))
    }

    /// Removes a store in which no session was started, with all that a store makes; anything else in it stays, and it too.
    pub fn remove_unused(self) -> Result<(), StoreError> {
        if self.read_only.is_some() || !self.logs()?.is_empty() {
            return Ok(());
        }
        let guard = self.lock()?;
        self.collect_all(&guard)?;
        for (name, kind) in PARTS {
            match kind {
                Kind::Folder => drop(self.root.remove_own(name)?),
                _ if name != lock::LOCK_FILE => drop(self.root.remove_file(name)?),
                _ => {}
            }
        }
        self.root.remove_file(lock::LOCK_FILE)?;
        // One that holds anything else stays.
        let _ = std::fs::remove_dir(self.dir());
        Ok(())
    }

    /// An empty file for what drivers write to standard error while the terminal interface has the screen.
    pub fn driver_log(&self) -> Result<std::fs::File, StoreError> {
        let file = self.root.file_or_new(DRIVER_LOG)?;
        file.set_len(0).map_err(StoreError::io("written", &self.root.path_of(DRIVER_LOG)))?;
        Ok(file)
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
fn free_bytes(dir: &Path) -> std::io::Result<u64> {
    let disk = rustix::fs::statvfs(dir)?;
    Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
}

/// Without a way to ask, the fixed cap holds.
#[cfg(not(unix))]
fn free_bytes(_: &Path) -> std::io::Result<u64> {
    Ok(CAP_BYTES * CAP_SHARE)
}
