//! A finished entry: named blobs with their sizes and checksums, and what the stage said of them.

use std::collections::BTreeMap;
use std::fs::{self, File, FileTimes};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::StoreError;

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
    path: PathBuf,
    manifest: Manifest,
    // Holds the shared lock.
    _used: File,
}

impl Manifest {
    /// Writes it into an entry's folder.
    pub(super) fn write(&self, folder: &Path) -> Result<(), StoreError> {
        let path = folder.join(MANIFEST);
        let bytes = serde_json::to_vec(self).map_err(|error| StoreError::damaged(&path, error))?;
        let seal = blake3::hash(&bytes).to_hex();
        // The list makes the entry: it comes last.
        for (name, bytes) in [(SEAL, seal.as_bytes()), (MANIFEST, &bytes)] {
            let path = folder.join(name);
            super::write_atomic(&path, bytes).map_err(StoreError::io("written", &path))?;
        }
        Ok(())
    }

    /// Reads it from an entry's folder; none where the entry was evicted meanwhile.
    fn read(folder: &Path) -> Result<Option<Manifest>, StoreError> {
        let path = folder.join(MANIFEST);
        let read = |path: &Path| match fs::read(path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == io::ErrorKind::NotFound && !folder.exists() => Ok(None),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Err(StoreError::damaged(path, "it is missing")),
            Err(error) => Err(StoreError::io("read", path)(error)),
        };
        let (Some(bytes), Some(seal)) = (read(&path)?, read(&folder.join(SEAL))?) else { return Ok(None) };
        if blake3::hash(&bytes).to_hex().as_bytes() != seal {
            return Err(StoreError::damaged(&path, "its checksum differs"));
        }
        let manifest = serde_json::from_value(super::parse(&path, &bytes)?);
        manifest.map(Some).map_err(|error| StoreError::damaged(&path, error))
    }
}

impl Entry {
    /// Opens a finished entry, none where there is none; sizes are compared, and the checksum of their list, contents are not.
    pub(super) fn open_at(path: &Path) -> Result<Option<Entry>, StoreError> {
        let Some(used) = use_entry(path)? else { return Ok(None) };
        let Some(manifest) = Manifest::read(path)? else { return Ok(None) };
        for (name, blob) in &manifest.blobs {
            let file = path.join(super::checked(name).map_err(|error| StoreError::damaged(&path.join(MANIFEST), error))?);
            match fs::metadata(&file) {
                Ok(found) if found.len() == blob.bytes => {}
                Ok(found) => return Err(StoreError::damaged(&file, format!("{} bytes instead of {}", found.len(), blob.bytes))),
                Err(error) => return Err(StoreError::damaged(&file, error)),
            }
        }
        Ok(Some(Entry { path: path.to_owned(), manifest, _used: used }))
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
        let (path, blob) = self.blob(name)?;
        let file = File::open(&path).map_err(StoreError::io("read", &path))?;
        let state = Checking { hasher: Box::default(), left: blob.bytes, expected: blob.blake3.clone() };
        Ok(BlobReader { file: BufReader::with_capacity(1 << 16, file), path, checking: Some(state) })
    }

    /// Reads a whole blob and compares its checksum; where it differs, the entry is given up.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, StoreError> {
        let (path, blob) = self.blob(name)?;
        let bytes = fs::read(&path).map_err(StoreError::io("read", &path))?;
        if blake3::hash(&bytes).to_hex().as_str() == blob.blake3 { Ok(bytes) } else { Err(give_up(&path)) }
    }

    /// Whether it has all of some blobs, byte for byte.
    pub(super) fn holds(&self, blobs: &BTreeMap<String, Blob>) -> bool {
        blobs.iter().all(|(name, blob)| self.manifest.blobs.get(name) == Some(blob))
    }

    /// Where a blob lies, for programs that need a file. Not to be written.
    pub fn path(&self, name: &str) -> Result<PathBuf, StoreError> {
        self.blob(name).map(|(path, _)| path)
    }

    pub(super) fn blob(&self, name: &str) -> Result<(PathBuf, &Blob), StoreError> {
        match self.manifest.blobs.get(name) {
            Some(blob) => Ok((self.path.join(name), blob)),
            None => Err(StoreError::damaged(&self.path.join(name), "the entry has no such blob")),
        }
    }
}

/// Spoils the entry of a blob whose content is not what was written, so that it is not found again.
fn give_up(blob: &Path) -> StoreError {
    // Where that fails too, the checksum will say the same next time.
    let _ = fs::remove_file(blob.with_file_name(MANIFEST));
    StoreError::damaged(blob, "its checksum differs; it will be made anew next time")
}

/// Takes the shared lock of an entry and notes the use; none where there is no entry.
fn use_entry(path: &Path) -> Result<Option<File>, StoreError> {
    let used_path = path.join(USED);
    let used = match File::options().read(true).write(true).open(&used_path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound && !path.exists() => return Ok(None),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(StoreError::damaged(&used_path, "it is missing")),
        Err(error) => return Err(StoreError::io("opened", &used_path)(error)),
    };
    match used.try_lock_shared() {
        Ok(()) => {}
        // On its way out.
        Err(fs::TryLockError::WouldBlock) => return Ok(None),
        Err(fs::TryLockError::Error(error)) => return Err(StoreError::io("locked", &used_path)(error)),
    }
    used.set_times(FileTimes::new().set_modified(SystemTime::now())).map_err(StoreError::io("touched", &used_path))?;
    Ok(Some(used))
}

/// Reads a blob.
#[derive(Debug)]
pub struct BlobReader {
    file: BufReader<File>,
    path: PathBuf,
    checking: Option<Checking>,
}

#[derive(Debug)]
struct Checking {
    hasher: Box<blake3::Hasher>,
    left: u64,
    expected: String,
}

impl Read for BlobReader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        if let Some(checking) = &mut self.checking {
            checking.hasher.update(&buffer[..count]);
            checking.left = checking.left.saturating_sub(count as u64);
            let ended = checking.left == 0 || (count == 0 && !buffer.is_empty());
            if ended && checking.hasher.finalize().to_hex().as_str() != checking.expected {
                return Err(io::Error::new(io::ErrorKind::InvalidData, give_up(&self.path)));
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
