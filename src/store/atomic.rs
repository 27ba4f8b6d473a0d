//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::{TEMP, fault};

/// Writes a file under another name in the same folder, brings it to disk, and then renames it.
/// Makes the folder where it is not there. The error is the system's and does not name the file.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let temp = temp_in(folder);
    fault::before_write();
    let written = write_synced(&temp, bytes).and_then(|()| fs::rename(&temp, path)).and_then(|()| sync_folder(folder));
    if written.is_err() {
        // The temporary may never have come to be; what matters is the first error.
        let _ = fs::remove_file(&temp);
    }
    written
}

fn write_synced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// A path in `folder` that nothing else in this process or another one takes.
fn temp_in(folder: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    folder.join(format!("{TEMP}{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)))
}

/// Brings a rename to disk. Systems that cannot open a folder do it by themselves.
fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
