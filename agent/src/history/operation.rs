//! Operations as they lie on disk: one JSON line each, never changed again.

use phystalk::spec::{Camera, Edit, Spec};
use serde::{Deserialize, Serialize};

/// Something that happened to a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub(super) enum Operation {
    /// It began, with a scene as found; always the first line.
    Start {
        /// Seconds since 1970, UTC.
        time_s: u64,
        /// The spec before any turn; its scene's path is absolute.
        base: Box<Spec>,
    },
    /// A turn made a version.
    Version {
        /// From 1; never repeats within a session.
        number: u32,
        /// The version that it was made from; none is the base.
        parent: Option<u32>,
        /// How.
        how: How,
        /// What was said.
        words: String,
        /// The edits that were accepted; for undo and redo those that lead there.
        edits: Vec<Edit>,
        /// The spec that came of it.
        spec: Box<Spec>,
        /// Seconds since 1970, UTC.
        time_s: u64,
    },
    /// The camera that every later version shares.
    Camera {
        /// In the world's frame.
        camera: Camera,
    },
    /// What "auto" came to in a version, as its metrics say.
    Resolved {
        /// The version.
        number: u32,
        /// Path to value.
        values: serde_json::Value,
    },
}

/// How a version came to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum How {
    /// By edits.
    Edit,
    /// By some steps back.
    Undo(u32),
    /// By some steps forward again.
    Redo(u32),
    /// By going to a version; none is the base.
    Back(Option<u32>),
}

/// A session was started or used: the order of these lines is the order of use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Use {
    /// The session's name.
    pub(super) session: String,
}
