//! The store's lock: held for one operation, never for a session.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use super::StoreError;

/// Between two tries.
const PAUSE: Duration = Duration::from_millis(10);

/// The lock, until it is dropped. The system lets go of it when the process ends, however it ends.
#[derive(Debug)]
pub struct Guard {
    // Closing the file unlocks it.
    _file: File,
    dir: PathBuf,
}

impl Guard {
    pub(super) fn take(dir: &Path, wait: Duration) -> Result<Guard, StoreError> {
        let path = dir.join("lock");
        let file = File::options().create(true).write(true).truncate(false).open(&path).map_err(StoreError::io("opened for writing", &path))?;
        let start = Instant::now();
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(Guard { _file: file, dir: dir.to_owned() }),
                Err(TryLockError::WouldBlock) if start.elapsed() < wait => thread::sleep(PAUSE),
                Err(TryLockError::WouldBlock) => return Err(StoreError::Locked { dir: dir.to_owned(), waited_s: wait.as_secs_f64() }),
                Err(TryLockError::Error(error)) => return Err(StoreError::io("locked", &path)(error)),
            }
        }
    }

    /// The store that is locked.
    pub(super) fn dir(&self) -> &Path {
        &self.dir
    }
}
