//! What can go wrong with a file, in the user's words.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Why a picture could not be written, read or compared.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The file system refused.
    #[error("cannot write {}: {reason}; {advice}", path.display())]
    Write {
        /// The file that was to appear.
        path: PathBuf,
        /// What the system said.
        reason: io::Error,
        /// What to do.
        advice: &'static str,
    },
    /// A picture could not be read.
    #[error("cannot read {} as a PNG picture: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the decoder or the system said.
        reason: String,
    },
    /// A codec refused, in memory.
    #[error("cannot encode or decode {what}: {reason}")]
    Encode {
        /// Of what.
        what: &'static str,
        /// What it said.
        reason: String,
    },
    /// A thread could not be started, or its work panicked.
    #[error(transparent)]
    Thread(#[from] crate::threads::ThreadError),
    /// A frame came in another size than those before it.
    #[error("{}: a frame of {}x{} pixels cannot follow frames of {}x{}", path.display(), got[0], got[1], expected[0], expected[1])]
    Size {
        /// The file being written.
        path: PathBuf,
        /// The size of the first frame.
        expected: [u32; 2],
        /// The size that came.
        got: [u32; 2],
    },
    /// A picture holds another number of pixels than its size says.
    #[error("a picture of {}x{} pixels needs {needed} values and has {got}", size[0], size[1])]
    Pixels {
        /// Width and height.
        size: [u32; 2],
        /// Values that the size asks for.
        needed: usize,
        /// Values there are.
        got: usize,
    },
}

impl ExportError {
    /// A failed write, with advice by its kind.
    pub(super) fn write(path: &Path, reason: io::Error) -> ExportError {
        let advice = match reason.kind() {
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "choose a folder you may write to (--out)",
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "free some space, or choose another folder (--out)",
            ErrorKind::NotADirectory | ErrorKind::AlreadyExists => "a file stands where a folder is needed: choose another folder (--out)",
            ErrorKind::IsADirectory => "a folder of that name is in the way: choose another name",
            _ => "check the path, or choose another folder (--out)",
        };
        ExportError::Write { path: path.to_owned(), reason, advice }
    }
}
