//! An entry in the making: blobs stream to disk, and all of it appears at once.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use serde_json::Value;

use super::entry::{Blob, MANIFEST, Manifest, SEAL, USED};
use super::{Entry, Store, StoreError, atomic, evict};

type Blobs = Arc<Mutex<BTreeMap<String, Blob>>>;

/// Writes an entry. Dropped before `finish`, it leaves nothing.
#[derive(Debug)]
pub struct EntryWriter {
    store: Store,
    target: PathBuf,
    folder: PathBuf,
    blobs: Blobs,
    // Holds the exclusive lock that keeps a sweep away; none once finished.
    used: Option<File>,
}

impl EntryWriter {
    pub(super) fn begin(store: &Store, target: PathBuf) -> Result<EntryWriter, StoreError> {
        let tmp = store.dir().join("tmp");
        // A sweep holds the lock too: it never sees a folder whose `used` is not locked yet.
        let _guard = store.lock()?;
        fs::create_dir_all(&tmp).map_err(StoreError::io("made", &tmp))?;
        let folder = fresh_folder(&tmp)?;
        let used_path = folder.join(USED);
        let used = File::create_new(&used_path).map_err(StoreError::io("written", &used_path))?;
        used.lock().map_err(StoreError::io("locked", &used_path))?;
        Ok(EntryWriter { store: store.clone(), target, folder, blobs: Arc::default(), used: Some(used) })
    }

    /// Starts a blob; several may be open at once. It belongs to the entry once it is finished.
    pub fn write(&self, name: &str) -> Result<BlobWriter, StoreError> {
        let path = self.blob_path(name)?;
        let file = File::create_new(&path).map_err(StoreError::io("written", &path))?;
        Ok(BlobWriter {
            name: name.to_owned(),
            file: BufWriter::with_capacity(1 << 16, file),
            path,
            bytes: 0,
            hasher: Box::default(),
            blobs: Some(self.blobs.clone()),
        })
    }

    /// Writes a whole blob.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let mut blob = self.write(name)?;
        let path = blob.path.clone();
        blob.write_all(bytes).map_err(StoreError::io("written", &path))?;
        blob.finish()
    }

    /// Takes over a blob of another entry, without copying it where the disk can.
    pub fn adopt(&self, entry: &Entry, name: &str, new_name: &str) -> Result<(), StoreError> {
        let (from, blob) = entry.blob(name)?;
        let to = self.blob_path(new_name)?;
        fs::hard_link(&from, &to).or_else(|_| fs::copy(&from, &to).map(drop)).map_err(StoreError::io("written", &to))?;
        lock(&self.blobs).insert(new_name.to_owned(), blob.clone());
        Ok(())
    }

    /// Brings everything to disk and makes the entry visible; then makes room if the store has grown too big. An entry that is
    /// there already and has all of this one's blobs stays in its place: whoever looks finds one at any time.
    pub fn finish(mut self, meta: Value) -> Result<Entry, StoreError> {
        let blobs = lock(&self.blobs).clone();
        blobs.par_iter().try_for_each(|(name, _)| sync(&self.folder.join(name)))?;
        let manifest = Manifest { meta, blobs };
        manifest.write(&self.folder)?;

        let stage = self.target.parent().unwrap_or(Path::new("."));
        fs::create_dir_all(stage).map_err(StoreError::io("made", stage))?;
        let guard = self.store.lock()?;
        if let Some(there) = Entry::open_at(&self.target).ok().flatten().filter(|there| there.holds(&manifest.blobs)) {
            return Ok(there);
        }
        let gone = self.store.take_out(&guard, &self.target)?;
        // From here on it is an entry like any other: what follows takes it up by its own lock.
        drop(self.used.take());
        let moved = fs::rename(&self.folder, &self.target).and_then(|()| atomic::sync_folder(stage));
        if let Err(error) = moved {
            let _ = fs::remove_dir_all(&self.folder);
            return Err(StoreError::io("written", &self.target)(error));
        }
        gone.map_or(Ok(()), |gone| evict::remove_folder(&gone))?;
        let entry = Entry::open_at(&self.target)?.ok_or_else(|| StoreError::damaged(&self.target, "it vanished"))?;
        self.store.evict(&guard)?;
        Ok(entry)
    }

    fn blob_path(&self, name: &str) -> Result<PathBuf, StoreError> {
        let reserved = [MANIFEST, SEAL, USED].contains(&name);
        if reserved { Err(StoreError::Name { name: name.to_owned() }) } else { Ok(self.folder.join(super::checked(name)?)) }
    }
}

impl Drop for EntryWriter {
    fn drop(&mut self) {
        if self.used.take().is_some() {
            // What cannot be removed now is swept at the next start.
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}

/// A blob in the making; `finish` makes it part of its entry.
#[derive(Debug)]
pub struct BlobWriter {
    name: String,
    path: PathBuf,
    file: BufWriter<File>,
    bytes: u64,
    hasher: Box<blake3::Hasher>,
    // None once finished.
    blobs: Option<Blobs>,
}

impl BlobWriter {
    /// Ends the blob.
    pub fn finish(mut self) -> Result<(), StoreError> {
        self.file.flush().map_err(StoreError::io("written", &self.path))?;
        let blob = Blob { bytes: self.bytes, blake3: self.hasher.finalize().to_hex().to_string() };
        if let Some(blobs) = self.blobs.take() {
            lock(&blobs).insert(self.name.clone(), blob);
        }
        Ok(())
    }

    /// Bytes written so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Write for BlobWriter {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let count = self.file.write(buffer)?;
        self.hasher.update(&buffer[..count]);
        self.bytes += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for BlobWriter {
    fn drop(&mut self) {
        if self.blobs.is_some() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn lock(blobs: &Blobs) -> std::sync::MutexGuard<'_, BTreeMap<String, Blob>> {
    blobs.lock().unwrap_or_else(PoisonError::into_inner)
}

fn sync(path: &Path) -> Result<(), StoreError> {
    File::open(path).and_then(|file| file.sync_all()).map_err(StoreError::io("written", path))
}

/// A folder in `tmp` that was not there before.
pub(super) fn fresh_folder(tmp: &Path) -> Result<PathBuf, StoreError> {
    loop {
        let folder = atomic::temp_in(tmp);
        match fs::create_dir(&folder) {
            Ok(()) => return Ok(folder),
            // Left by a dead process that had our number.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(StoreError::io("made", &folder)(error)),
        }
    }
}
