//! A finished entry: named blobs with their sizes and checksums, and what the stage said of them.

use std::collections::BTreeMap;
use std::fs::{File, FileTimes, TryLockError};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::StoreError;
use super::folder::{Folder, Kind};

/// Lists an entry's blobs; written last.
pub(super) const MANIFEST: &str = "entry.json";
/// BLAKE3 of that list.
pub(super) const SEAL: &str = "entry.blake3";
/// Locked while an entry is in use; its time is that of the last use.
pub(super) const USED: &str = "used";

/// Size and checksum of a blob.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Blob {
    pub(super) bytes: u64,
    pub(super) blake3: String,
}

/// What `entry.json` holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Manifest {
    pub(super) meta: Value,
    pub(super) blobs: BTreeMap<String, Blob>,
}

/// What a stage kept under a key. While it lives it is in use and not evicted.
#[derive(Debug)]
pub struct Entry {
    folder: Folder,
    manifest: Manifest,
    // Holds the shared lock.
    _used: File,
}

impl Manifest {
    /// Writes it into an entry's folder; the bytes that took.
    pub(super) fn write(&self, folder: &Folder) -> Result<u64, StoreError> {
        let bytes = serde_json::to_vec(self).map_err(|error| StoreError::damaged(&folder.path_of(MANIFEST), error))?;
        let seal = blake3::hash(&bytes).to_hex();
        folder.write(SEAL, seal.as_bytes())?;
        // The list makes the entry: it comes last.
        folder.write(MANIFEST, &bytes)?;
        Ok((bytes.len() + seal.len()) as u64)
    }

    /// Reads it from an entry's folder.
    fn read(folder: &Folder) -> Result<Manifest, StoreError> {
        let path = folder.path_of(MANIFEST);
        let read = |name: &str| folder.read(name)?.ok_or_else(|| StoreError::damaged(&folder.path_of(name), "it is missing"));
        let (bytes, seal) = (read(MANIFEST)?, read(SEAL)?);
        if blake3::hash(&bytes).to_hex().as_bytes() != seal {
            return Err(StoreError::damaged(&path, "its checksum differs"));
        }
        serde_json::from_slice(&bytes).map_err(|error| StoreError::damaged(&path, error))
    }

    /// Bytes of all blobs.
    pub(super) fn bytes(&self) -> u64 {
        self.blobs.values().map(|blob| blob.bytes).sum()
    }
}

impl Entry {
    /// Opens a finished entry, none where another process is taking it away; sizes are compared, and the checksum of their
    /// list, contents are not.
    pub(super) fn open_in(folder: Folder) -> Result<Option<Entry>, StoreError> {
        let Some(used) = use_entry(&folder)? else { return Ok(None) };
        let manifest = Manifest::read(&folder)?;
        let sizes: BTreeMap<String, u64> =
            folder.children()?.into_iter().filter(|child| child.kind == Kind::File).map(|child| (child.name, child.bytes)).collect();
        for (name, blob) in &manifest.blobs {
            super::checked(name).map_err(|error| StoreError::damaged(&folder.path_of(MANIFEST), error))?;
            match sizes.get(name) {
                Some(bytes) if *bytes == blob.bytes => {}
                Some(bytes) => return Err(StoreError::damaged(&folder.path_of(name), format!("{bytes} bytes instead of {}", blob.bytes))),
                None => return Err(StoreError::damaged(&folder.path_of(name), "it is missing")),
            }
        }
        Ok(Some(Entry { folder, manifest, _used: used }))
    }

    /// What the stage said of it.
    pub fn meta(&self) -> &Value {
        &self.manifest.meta
    }

    /// The names of its blobs, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.manifest.blobs.keys().map(String::as_str)
    }

    /// Whether it has a blob of that name.
    pub fn has(&self, name: &str) -> bool {
        self.manifest.blobs.contains_key(name)
    }

    /// The size of a blob, zero where there is none.
    pub fn bytes(&self, name: &str) -> u64 {
        self.manifest.blobs.get(name).map_or(0, |blob| blob.bytes)
    }

    /// Opens a blob. Read from start to end, its checksum is compared at the end; after a seek no more.
    /// Where it differs, the entry is given up: the next `get` is a miss.
    pub fn open(&self, name: &str) -> Result<BlobReader, StoreError> {
        let blob = self.blob(name)?;
        let state = Checking { hasher: Box::default(), left: blob.bytes, expected: blob.blake3.clone() };
        let file = self.file(name)?;
        Ok(BlobReader { file: BufReader::with_capacity(1 << 16, file), folder: self.folder.clone(), name: name.to_owned(), checking: Some(state) })
    }

    /// Reads a whole blob and compares its checksum; where it differs, the entry is given up.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, StoreError> {
        let blob = self.blob(name)?;
        let mut bytes = Vec::new();
        self.file(name)?.read_to_end(&mut bytes).map_err(StoreError::io("read", &self.folder.path_of(name)))?;
        if blake3::hash(&bytes).to_hex().as_str() == blob.blake3 { Ok(bytes) } else { Err(give_up(&self.folder, name)) }
    }

    /// Compares every blob with its checksum: the names of those that differ.
    pub(super) fn damaged_blobs(&self) -> Result<Vec<String>, StoreError> {
        let mut damaged = Vec::new();
        for (name, blob) in &self.manifest.blobs {
            let mut hasher = blake3::Hasher::new();
            hasher.update_reader(self.file(name)?).map_err(StoreError::io("read", &self.folder.path_of(name)))?;
            if hasher.finalize().to_hex().as_str() != blob.blake3 {
                damaged.push(name.clone());
            }
        }
        Ok(damaged)
    }

    /// Whether it has all of some blobs, byte for byte.
    pub(super) fn holds(&self, blobs: &BTreeMap<String, Blob>) -> bool {
        blobs.iter().all(|(name, blob)| self.manifest.blobs.get(name) == Some(blob))
    }

    /// Its folder.
    pub(super) fn folder(&self) -> &Folder {
        &self.folder
    }

    pub(super) fn blob(&self, name: &str) -> Result<&Blob, StoreError> {
        let missing = || StoreError::damaged(&self.folder.path_of(name), "the entry has no such blob");
        self.manifest.blobs.get(name).ok_or_else(missing)
    }

    fn file(&self, name: &str) -> Result<File, StoreError> {
        self.folder.file(name, false)?.ok_or_else(|| StoreError::damaged(&self.folder.path_of(name), "it is missing"))
    }
}

/// Spoils the entry of a blob whose content is not what was written, so that it is not found again.
fn give_up(folder: &Folder, blob: &str) -> StoreError {
    // Where that fails too, the checksum will say the same next time.
    let _ = folder.remove_file(MANIFEST);
    StoreError::Spoilt { path: folder.path_of(blob) }
}

/// Takes the shared lock of an entry and notes the use; none where another process is taking it away.
fn use_entry(folder: &Folder) -> Result<Option<File>, StoreError> {
    let path = folder.path_of(USED);
    // In a store that cannot be written the lock is taken all the same, and the use is not noted.
    let used = match folder.file(USED, true) {
        Err(StoreError::Io { .. }) => folder.file(USED, false)?,
        opened => opened?,
    };
    let Some(used) = used else { return Err(StoreError::damaged(&path, "it is missing")) };
    match used.try_lock_shared() {
        Ok(()) => {}
        // On its way out.
        Err(TryLockError::WouldBlock) => return Ok(None),
        Err(TryLockError::Error(error)) => return Err(StoreError::io("locked", &path)(error)),
    }
    let _ = used.set_times(FileTimes::new().set_modified(SystemTime::now()));
    Ok(Some(used))
}

/// Reads a blob.
#[derive(Debug)]
pub struct BlobReader {
    file: BufReader<File>,
    folder: Folder,
    name: String,
    checking: Option<Checking>,
}

#[derive(Debug)]
struct Checking {
    hasher: Box<blake3::Hasher>,
    left: u64,
    expected: String,
}

impl BlobReader {
    /// Reads some bytes from a place on; no checksum is compared.
    pub fn read_range(&mut self, start: u64, count: usize) -> Result<Vec<u8>, StoreError> {
        let mut bytes = vec![0; count];
        let read = self.seek(SeekFrom::Start(start)).and_then(|_| self.read_exact(&mut bytes));
        read.map(|()| bytes).map_err(StoreError::io("read", &self.folder.path_of(&self.name)))
    }
}

impl Read for BlobReader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        if let Some(checking) = &mut self.checking {
            checking.hasher.update(&buffer[..count]);
            checking.left = checking.left.saturating_sub(count as u64);
            let ended = checking.left == 0 || (count == 0 && !buffer.is_empty());
            if ended && checking.hasher.finalize().to_hex().as_str() != checking.expected {
                return Err(io::Error::new(io::ErrorKind::InvalidData, give_up(&self.folder, &self.name)));
            }
        }
        Ok(count)
    }
}

impl Seek for BlobReader {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.checking = None;
        self.file.seek(to)
    }
}
