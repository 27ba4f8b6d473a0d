//! A scene's file: opened, looked at in part, then read whole. Every step is bounded by the length that the file had when it
//! was opened; devices, pipes and files that change meanwhile are errors.

use super::error::SceneError;
use super::memory;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::time::SystemTime;

/// Bytes at the front that tell a format: a .ksplat's header is the longest.
const FRONT: usize = 5120;
/// Bytes of one record of a sample.
pub(super) const RECORD: usize = 32;
/// Records of a sample, spread evenly.
const RECORDS: u64 = 1024;

/// A bounded part of a file, from which its format is told.
pub(super) struct Sample {
    /// Bytes of the whole file.
    pub length: u64,
    /// Its first bytes.
    pub front: Vec<u8>,
    /// Some of its records of 32 bytes.
    pub records: Vec<[u8; RECORD]>,
}

impl Sample {
    /// Of bytes in memory.
    pub fn of(bytes: &[u8]) -> Sample {
        let record = |&at: &u64| bytes[at as usize..].first_chunk::<RECORD>().copied();
        let length = bytes.len() as u64;
        Sample { length, front: bytes[..bytes.len().min(FRONT)].to_vec(), records: places(length).filter_map(|at| record(&at)).collect() }
    }
}

/// Where the records of a sample begin.
fn places(length: u64) -> impl Iterator<Item = u64> {
    let whole = length / RECORD as u64;
    let step = whole.div_ceil(RECORDS).max(1);
    (0..whole).step_by(usize::try_from(step).unwrap_or(usize::MAX)).map(|record| record * RECORD as u64)
}

/// A regular file that is open.
pub(super) struct Source {
    file: File,
    name: String,
    length: u64,
    modified: Option<SystemTime>,
}

impl Source {
    /// Opens a regular file. Nothing else is opened at all: a pipe would wait for its writer.
    pub fn open(path: &Path) -> Result<Source, SceneError> {
        let name = path.display().to_string();
        let explain = |error: io::Error| failed(&name, &error);
        let meta = fs::metadata(path).map_err(explain)?;
        let refuse = |reason: &str, advice: &'static str| Err(SceneError::Read { file: name.clone(), reason: reason.to_owned(), advice });
        if meta.is_dir() {
            return refuse("it is a folder", "name a .ply or .splat file in it");
        }
        if !meta.is_file() {
            return refuse("it is not a regular file", "name a .ply or .splat file on disk");
        }
        let file = File::open(path).map_err(explain)?;
        let meta = file.metadata().map_err(explain)?;
        Ok(Source { file, length: meta.len(), modified: meta.modified().ok(), name })
    }

    /// The path, for messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// A bounded part of it.
    pub fn sample(&mut self) -> Result<Sample, SceneError> {
        self.try_sample().map_err(|error| failed(&self.name, &error))
    }

    fn try_sample(&mut self) -> io::Result<Sample> {
        let mut front = Vec::new();
        self.file.seek(SeekFrom::Start(0))?;
        self.file.by_ref().take(FRONT as u64).read_to_end(&mut front)?;
        let mut records = Vec::new();
        for at in places(self.length) {
            let mut record = [0; RECORD];
            self.file.seek(SeekFrom::Start(at))?;
            self.file.read_exact(&mut record)?;
            records.push(record);
        }
        Ok(Sample { length: self.length, front, records })
    }

    /// All of its bytes.
    pub fn read(mut self) -> Result<Vec<u8>, SceneError> {
        let room = usize::try_from(self.length).unwrap_or(usize::MAX).saturating_add(1);
        let mut bytes = memory::reserved(room, &self.name)?;
        // One more than there should be, so that a file that grows is noticed and not followed.
        let read = self.file.seek(SeekFrom::Start(0)).and_then(|_| self.file.by_ref().take(self.length + 1).read_to_end(&mut bytes));
        read.map_err(|error| failed(&self.name, &error))?;
        self.check_unchanged(bytes.len() as u64)?;
        Ok(bytes)
    }

    /// BLAKE3 of its bytes, hexadecimal.
    pub fn digest(mut self) -> Result<String, SceneError> {
        let mut hasher = blake3::Hasher::new();
        let read = self.file.seek(SeekFrom::Start(0)).and_then(|_| hasher.update_reader(self.file.by_ref().take(self.length + 1)).map(|_| ()));
        read.map_err(|error| failed(&self.name, &error))?;
        self.check_unchanged(hasher.count())?;
        Ok(hasher.finalize().to_hex().to_string())
    }

    fn check_unchanged(&self, read: u64) -> Result<(), SceneError> {
        let modified = self.file.metadata().ok().and_then(|m| m.modified().ok());
        if read == self.length && modified == self.modified {
            return Ok(());
        }
        let reason = match read == self.length {
            true => "it was written to while it was read".to_owned(),
            false => format!("it changed while it was read, from {} bytes to {} or more", self.length, read),
        };
        Err(SceneError::Read { file: self.name.clone(), reason, advice: "wait until the program that writes it has finished" })
    }
}

fn failed(name: &str, error: &io::Error) -> SceneError {
    let advice = match error.kind() {
        io::ErrorKind::NotFound => "check the path and the folder you are in",
        io::ErrorKind::PermissionDenied => "make it readable to you",
        io::ErrorKind::UnexpectedEof => "wait until the program that writes it has finished",
        _ => "check the disk it is on",
    };
    SceneError::Read { file: name.to_owned(), reason: error.to_string(), advice }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn a_file_that_grows_or_shrinks_while_it_is_read_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.splat");
        for change in [1_i64, 1000, -10] {
            fs::write(&path, [7; 4096]).unwrap();
            let source = Source::open(&path).unwrap();
            let mut file = File::options().write(true).open(&path).unwrap();
            if change > 0 {
                file.seek(SeekFrom::End(0)).unwrap();
                file.write_all(&vec![1; change as usize]).unwrap();
            } else {
                file.set_len(4086).unwrap();
            }
            let message = source.read().unwrap_err().to_string();
            assert!(message.contains("changed while it was read") && message.contains("4096"), "{message}");
        }
    }

    #[test]
    fn a_sample_of_a_sparse_file_is_small_however_long_the_file_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sparse");
        File::create(&path).unwrap().set_len(1 << 36).unwrap();
        let sample = Source::open(&path).unwrap().sample().unwrap();
        assert_eq!((sample.length, sample.front.len()), (1 << 36, FRONT));
        assert!(sample.records.len() <= RECORDS as usize && sample.records.len() > 900);
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_pipes_are_refused_without_being_opened() {
        for path in ["/dev/zero", "/dev/null"] {
            let message = Source::open(Path::new(path)).err().unwrap().to_string();
            assert!(message.contains("not a regular file"), "{message}");
        }
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(Source::open(&pipe).err().unwrap().to_string().contains("not a regular file"));
    }
}
