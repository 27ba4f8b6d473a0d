//! The store's lock: held for one operation, never for a session.

use std::fs::{File, TryLockError};
use std::thread;
use std::time::{Duration, Instant};

use super::StoreError;
use super::folder::Folder;

/// Between two tries.
const PAUSE: Duration = Duration::from_millis(10);

/// The file that is locked.
pub(super) const LOCK_FILE: &str = "lock";

/// The lock, until it is dropped. The system lets go of it when the process ends, however it ends.
#[derive(Debug)]
pub struct Guard {
    // Closing the file unlocks it.
    _file: File,
    root: Folder,
}

impl Guard {
    pub(super) fn take(root: &Folder, wait: Duration) -> Result<Guard, StoreError> {
        let file = root.file_or_new(LOCK_FILE)?;
        let start = Instant::now();
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(Guard { _file: file, root: root.clone() }),
                Err(TryLockError::WouldBlock) if start.elapsed() < wait => thread::sleep(PAUSE),
                Err(TryLockError::WouldBlock) => {
                    return Err(StoreError::Locked { dir: root.path().to_owned(), waited_s: wait.as_secs_f64() });
                }
                Err(TryLockError::Error(error)) => return Err(StoreError::io("locked", &root.path_of(LOCK_FILE))(error)),
            }
        }
    }

    /// The store that is locked.
    pub(super) fn root(&self) -> &Folder {
        &self.root
    }
}
