//! Append-only files of JSON lines. A line is on disk before `append` returns; a line that a crash
//! tore is dropped, and said.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Guard, StoreError};

/// What an append-only file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Log<T> {
    /// Its whole lines.
    pub lines: Vec<T>,
    /// Whether an unfinished last line was dropped.
    pub torn: bool,
}

impl Guard {
    /// Adds a line to a file of the store, given by its path inside it.
    pub fn append(&self, file: &str, line: &impl Serialize) -> Result<(), StoreError> {
        let path = self.path(file)?;
        let mut bytes = serde_json::to_vec(line).map_err(|error| StoreError::damaged(&path, error))?;
        bytes.push(b'\n');
        append(&path, &bytes).map_err(StoreError::io("written", &path))
    }

    /// Reads a file of the store line by line; a file that is not there is empty.
    pub fn read<T: DeserializeOwned>(&self, file: &str) -> Result<Log<T>, StoreError> {
        let path = self.path(file)?;
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(StoreError::io("read", &path)(error)),
        };
        let whole = whole_lines(&bytes);
        let mut lines = Vec::new();
        for (index, line) in bytes[..whole].split_inclusive(|byte| *byte == b'\n').enumerate() {
            lines.push(serde_json::from_slice(line).map_err(|error| StoreError::damaged(&path, format!("line {}: {error}", index + 1)))?);
        }
        Ok(Log { lines, torn: whole < bytes.len() })
    }

    fn path(&self, file: &str) -> Result<PathBuf, StoreError> {
        let mut path = self.dir().to_owned();
        for part in file.split('/') {
            path.push(super::checked(part)?);
        }
        Ok(path)
    }
}

/// Bytes up to the end of the last whole line.
fn whole_lines(bytes: &[u8]) -> usize {
    bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1)
}

fn append(path: &Path, line: &[u8]) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let is_new = !path.exists();
    let mut file = File::options().create(true).read(true).write(true).truncate(false).open(path)?;
    let end = cut_torn_line(&mut file)?;
    file.seek(SeekFrom::Start(end))?;
    file.write_all(line)?;
    file.sync_all()?;
    if is_new { super::atomic::sync_folder(folder) } else { Ok(()) }
}

/// Takes off what a crash left after the last whole line, and says where that ends.
fn cut_torn_line(file: &mut File) -> io::Result<u64> {
    let length = file.metadata()?.len();
    if length == 0 {
        return Ok(0);
    }
    file.seek(SeekFrom::End(-1))?;
    let mut last = [0_u8];
    file.read_exact(&mut last)?;
    if last == *b"\n" {
        return Ok(length);
    }
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.read_to_end(&mut bytes)?;
    let whole = whole_lines(&bytes) as u64;
    file.set_len(whole)?;
    Ok(whole)
}
