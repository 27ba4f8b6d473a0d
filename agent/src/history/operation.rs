//! Operations as they lie on disk: one line of a log each, never changed again. The log chains them by checksums.

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
        /// The version that it follows; none is the base.
        parent: Option<u32>,
        /// The version that the edits were made on, where another process added the parent meanwhile.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        made_on: Option<Place>,
        /// How.
        how: How,
        /// What undo or redo restored.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        restored: Option<Place>,
        /// Who made the edits.
        #[serde(default)]
        author: Author,
        /// What the user typed.
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
        /// The results that it needs, as "stage/key".
        #[serde(default)]
        results: Vec<String>,
    },
}

/// A version, or the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Place {
    /// The scene as found.
    Base,
    /// A version.
    Version(u32),
}

impl From<Option<u32>> for Place {
    fn from(number: Option<u32>) -> Place {
        number.map_or(Place::Base, Place::Version)
    }
}

impl Place {
    /// The version's number, none for the base.
    pub(super) fn number(self) -> Option<u32> {
        match self {
            Place::Base => None,
            Place::Version(number) => Some(number),
        }
    }
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

/// Who made the edits of a version: whether they can be made again on another spec.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Author {
    /// The phrasebook, from the words: the edits may depend on the spec that the words were said to.
    #[default]
    Phrasebook,
    /// The user gave the edits themselves: they depend on nothing.
    Literal,
    /// Undo, redo and going back: the whole spec is that of an older version.
    Travel,
}

/// A session was used: the order of these lines is the order of use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Use {
    /// The session's name.
    pub(super) session: String,
    /// The folder that the program ran in, relative to the one that holds the store where it lies below.
    #[serde(default)]
    pub(super) folder: String,
}
