//! Files that appear whole or not at all.

use super::ExportError;
use crate::store::before_write;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A file under a temporary name beside its own; it takes its own name when it is finished and
/// vanishes when it is dropped before.
#[derive(Debug)]
pub(super) struct Pending {
    path: PathBuf,
    temporary: PathBuf,
    file: Option<BufWriter<File>>,
}

impl Pending {
    /// Opens the temporary file, making the folders it needs.
    pub(super) fn create(path: &Path) -> Result<Pending, ExportError> {
        // Two threads of one process may write the same picture.
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let open = || {
            let name = path.file_name().ok_or(io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"))?;
            if let Some(folder) = path.parent() {
                fs::create_dir_all(folder)?;
            }
            let unique = format!(".{}.{}-{}.tmp", name.to_string_lossy(), std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
            let temporary = path.with_file_name(unique);
            before_write();
            let file = OpenOptions::new().write(true).create_new(true).open(&temporary)?;
            Ok((temporary, file))
        };
        let (temporary, file) = open().map_err(|e| ExportError::write(path, e))?;
        Ok(Pending { path: path.to_owned(), temporary, file: Some(BufWriter::new(file)) })
    }

    /// The path the file will have.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes through `fill`; an error names the file.
    pub(super) fn with(&mut self, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), ExportError> {
        let closed = || io::Error::new(io::ErrorKind::BrokenPipe, "the file was already closed");
        self.file.as_mut().ok_or_else(closed).and_then(fill).map_err(|e| ExportError::write(&self.path, e))
    }

    /// Gives the file its name.
    pub(super) fn finish(mut self) -> Result<(), ExportError> {
        self.with(|file| file.flush())?;
        self.file = None;
        before_write();
        fs::rename(&self.temporary, &self.path).map_err(|e| ExportError::write(&self.path, e))
    }
}

impl Drop for Pending {
    fn drop(&mut self) {
        self.file = None;
        // After `finish` there is nothing under this name; a failure here leaves a hidden file, no more.
        let _ = fs::remove_file(&self.temporary);
    }
}

/// Writes a file through `fill`. A reader sees the old file or the new one, never a part; folders
/// on the way are made.
pub fn write_atomic(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), ExportError> {
    let mut pending = Pending::create(path)?;
    pending.with(fill)?;
    pending.finish()
}

/// Removes from a folder the temporary files of processes that are gone: `.NAME.PID-N.tmp`.
pub fn remove_leftovers(folder: &Path) {
    let Ok(listing) = fs::read_dir(folder) else { return };
    for child in listing.filter_map(Result::ok) {
        if child.file_name().to_str().and_then(process_of).is_some_and(|process| !is_alive(process)) {
            // What cannot be removed now is tried again the next time.
            let _ = fs::remove_file(child.path());
        }
    }
}

/// The process that a temporary file is of.
fn process_of(name: &str) -> Option<u32> {
    let (process, count) = name.strip_prefix('.')?.strip_suffix(".tmp")?.rsplit_once('.')?.1.split_once('-')?;
    count.parse::<u32>().ok().and(process.parse().ok())
}

#[cfg(unix)]
fn is_alive(process: u32) -> bool {
    use rustix::process::{Pid, test_kill_process};
    let found = i32::try_from(process).ok().and_then(Pid::from_raw).map(test_kill_process);
    // A process that may not be signalled is alive too.
    !matches!(found, None | Some(Err(rustix::io::Errno::SRCH)))
}

/// Without a way to ask, nothing is removed.
#[cfg(not(unix))]
fn is_alive(_: u32) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/picture.png");
        write_atomic(&path, |file| file.write_all(b"old")).unwrap();
        let failed = write_atomic(&path, |file| file.write_all(b"new").and(Err(io::ErrorKind::StorageFull.into())));
        let text = failed.unwrap_err().to_string();
        assert!(text.contains("picture.png") && text.contains("free some space"), "{text}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn a_file_in_the_place_of_a_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("out"), b"").unwrap();
        let error = write_atomic(&folder.path().join("out/0000.png"), |_| Ok(())).unwrap_err().to_string();
        assert!(error.contains("0000.png") && error.contains("--out"), "{error}");
        assert!(write_atomic(Path::new("/"), |_| Ok(())).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn leftovers_of_dead_processes_go_and_all_else_stays() {
        let folder = tempfile::tempdir().unwrap();
        let mut child = std::process::Command::new("true").spawn().unwrap();
        child.wait().unwrap();
        let dead = format!(".0000.png.{}-3.tmp", child.id());
        let alive = format!(".0000.png.{}-3.tmp", std::process::id());
        for name in [&dead, &alive, ".notes.tmp", "0000.png"] {
            fs::write(folder.path().join(name), b"").unwrap();
        }
        remove_leftovers(folder.path());
        let left = |name: &str| folder.path().join(name).exists();
        assert!(!left(&dead) && left(&alive) && left(".notes.tmp") && left("0000.png"));
    }
}
