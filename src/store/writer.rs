//! An entry in the making: blobs stream to disk, and all of it appears at once.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use serde_json::Value;

use super::entry::{Blob, MANIFEST, Manifest, SEAL, USED};
use super::folder::Folder;
use super::{Entry, Store, StoreError};

type Blobs = Arc<Mutex<BTreeMap<String, Blob>>>;

/// Writes an entry. Dropped before `finish`, it leaves nothing.
#[derive(Debug)]
pub struct EntryWriter {
    store: Store,
    stage: String,
    key: String,
    tmp: Folder,
    /// The folder in `tmp`, and its name there.
    folder: Folder,
    name: String,
    blobs: Blobs,
    // Holds the exclusive lock that keeps a sweep away; none once finished.
    used: Option<File>,
}

impl EntryWriter {
    pub(super) fn begin(store: &Store, stage: &str, key: &str) -> Result<EntryWriter, StoreError> {
        let (stage, key) = (super::checked(stage)?.to_owned(), super::checked(key)?.to_owned());
        // A sweep holds the lock too: it never sees a folder whose `used` is not locked yet.
        let guard = store.lock()?;
        let tmp = guard.root().make(super::TMP)?;
        let (name, folder) = tmp.make_temporary()?;
        let used = folder.create(USED)?;
        used.lock().map_err(StoreError::io("locked", &folder.path_of(USED)))?;
        Ok(EntryWriter { store: store.clone(), stage, key, tmp, folder, name, blobs: Arc::default(), used: Some(used) })
    }

    /// Starts a blob; several may be open at once. It belongs to the entry once it is finished.
    pub fn write(&self, name: &str) -> Result<BlobWriter, StoreError> {
        let file = self.folder.create(blob_name(name)?)?;
        Ok(BlobWriter {
            name: name.to_owned(),
            file: BufWriter::with_capacity(1 << 16, file),
            folder: self.folder.clone(),
            bytes: 0,
            hasher: Box::default(),
            blobs: Some(self.blobs.clone()),
        })
    }

    /// Writes a whole blob.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let mut blob = self.write(name)?;
        blob.write_all(bytes).map_err(StoreError::io("written", &self.folder.path_of(name)))?;
        blob.finish()
    }

    /// Takes over a blob of another entry, without copying it where the disk can.
    pub fn adopt(&self, entry: &Entry, name: &str, new_name: &str) -> Result<(), StoreError> {
        let blob = entry.blob(name)?.clone();
        self.folder.adopt(entry.folder(), name, blob_name(new_name)?)?;
        lock(&self.blobs).insert(new_name.to_owned(), blob);
        Ok(())
    }

    /// Brings everything to disk and makes the entry visible; then makes room if the store has grown too big. An entry that is
    /// there already and has all of this one's blobs stays in its place: whoever looks finds one at any time.
    pub fn finish(mut self, meta: Value) -> Result<Entry, StoreError> {
        let blobs = lock(&self.blobs).clone();
        blobs.par_iter().try_for_each(|(name, _)| sync(&self.folder, name))?;
        let manifest = Manifest { meta, blobs };
        let bytes = manifest.bytes() + manifest.write(&self.folder)?;
        let guard = self.store.lock()?;
        let stage = guard.root().make(super::CACHE)?.make(&self.stage)?;
        if let Some(there) = self.store.open_entry(&self.stage, &self.key).ok().flatten().filter(|there| there.holds(&manifest.blobs)) {
            return Ok(there);
        }
        self.store.take_away(&guard, &self.stage, &self.key)?;
        // From here on it is an entry like any other: what follows takes it up by its own lock.
        drop(self.used.take());
        let moved = self.tmp.rename(&self.name, &stage, &self.key).and_then(|()| stage.sync());
        if let Err(error) = moved {
            let _ = self.tmp.remove_own(&self.name);
            return Err(error);
        }
        let vanished = || StoreError::damaged(&stage.path_of(&self.key), "it vanished");
        let entry = self.store.open_entry(&self.stage, &self.key)?.ok_or_else(vanished)?;
        self.store.grew(&guard, bytes)?;
        Ok(entry)
    }
}

/// A name for a blob, which the entry's own files have not.
fn blob_name(name: &str) -> Result<&str, StoreError> {
    let reserved = [MANIFEST, SEAL, USED].contains(&name);
    if reserved { Err(StoreError::Name { name: name.to_owned() }) } else { super::checked(name) }
}

impl Drop for EntryWriter {
    fn drop(&mut self) {
        if self.used.take().is_some() {
            // What cannot be removed now is swept at the next start.
            let _ = self.tmp.remove_own(&self.name);
        }
    }
}

/// A blob in the making; `finish` makes it part of its entry.
#[derive(Debug)]
pub struct BlobWriter {
    name: String,
    folder: Folder,
    file: BufWriter<File>,
    bytes: u64,
    hasher: Box<blake3::Hasher>,
    // None once finished.
    blobs: Option<Blobs>,
}

impl BlobWriter {
    /// Ends the blob.
    pub fn finish(mut self) -> Result<(), StoreError> {
        self.file.flush().map_err(StoreError::io("written", &self.folder.path_of(&self.name)))?;
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
            let _ = self.folder.remove_file(&self.name);
        }
    }
}

fn lock(blobs: &Blobs) -> std::sync::MutexGuard<'_, BTreeMap<String, Blob>> {
    blobs.lock().unwrap_or_else(PoisonError::into_inner)
}

fn sync(folder: &Folder, name: &str) -> Result<(), StoreError> {
    let path = folder.path_of(name);
    let Some(file) = folder.file(name, false)? else { return Err(StoreError::damaged(&path, "it vanished")) };
    file.sync_all().map_err(StoreError::io("written", &path))
}
