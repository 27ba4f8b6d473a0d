//! What can go wrong between a file and its Gaussians.

use std::io;

/// Each message says which file, what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file could not be opened or read.
    #[error("cannot read {file}: {reason}; {advice}")]
    Read {
        /// The path as given.
        file: String,
        /// What is in the way.
        reason: String,
        /// What to do.
        advice: &'static str,
    },
    /// The file could not be written; what stood there before is untouched.
    #[error("cannot write {file}: {source}; choose a folder that is writable and has room")]
    Write {
        /// The path as given.
        file: String,
        /// The system's answer.
        source: io::Error,
    },
    /// The content is a known format that is not read.
    #[error("{file} is {found}, which is not supported yet; {advice}")]
    Unsupported {
        /// The name of the file.
        file: String,
        /// The format, by its content.
        found: String,
        /// How to convert it.
        advice: &'static str,
    },
    /// The content is nothing that holds Gaussians.
    #[error("{file} is not a splat file: {found}; expected an INRIA binary .ply or a .splat of 32-byte records")]
    NotAScene {
        /// The name of the file.
        file: String,
        /// What it looks like.
        found: String,
    },
    /// The format is right and the content is not.
    #[error("{file} is damaged: {found} at {at}; expected {expected}; {advice}")]
    Damaged {
        /// The name of the file.
        file: String,
        /// Where.
        at: String,
        /// What was found.
        found: String,
        /// What should be there.
        expected: String,
        /// What to do.
        advice: &'static str,
    },
    /// A .ply without some of the properties that make Gaussians.
    #[error("{file} lacks {missing} among the properties of its vertices; {advice}")]
    Missing {
        /// The name of the file.
        file: String,
        /// The names of the properties.
        missing: String,
        /// What the file probably is, and what to do.
        advice: &'static str,
    },
    /// Opening the file takes more memory than the system gives.
    #[error(
        "not enough memory to open {file}: its Gaussians need {mib} MiB; close other programs, raise the memory limit (`ulimit -v`), or reduce the \
         scene: fewer Gaussians or fewer spherical harmonics"
    )]
    Memory {
        /// The name of the file.
        file: String,
        /// What was asked for.
        mib: u64,
    },
    /// No Gaussians, or none that are usable.
    #[error("{file} holds no usable Gaussians: {why}; choose another file")]
    Empty {
        /// The name of the file.
        file: String,
        /// Why there are none.
        why: String,
    },
    /// The name does not say which format to write.
    #[error("cannot tell the format of {file} from its name; end it in .ply or .splat")]
    Extension {
        /// The path as given.
        file: String,
    },
}

/// Advice for a file whose bytes do not add up.
pub(super) const COPY_AGAIN: &str = "copy or export the file again";

/// Advice for a format that others convert.
pub(super) const CONVERT: &str =
    "convert it with `npx @playcanvas/splat-transform IN OUT.ply`, or open it in SuperSplat and export an uncompressed .ply";
