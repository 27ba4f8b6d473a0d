//! Gaussians: read and write formats, up axis, prune, select, the built-in demo scene.

mod codec;
pub mod demo;
mod error;
mod file;
mod frame;
mod gaussians;
mod info;
mod memory;
mod neighbours;
mod ply;
mod ply_header;
mod prune;
mod select;
mod source;
mod splat;
mod up;

pub use codec::SH_C0;
pub use error::SceneError;
pub use file::{Format, Loaded, digest, parse, read, write};
pub use frame::SceneFrame;
pub use gaussians::{Gaussians, morton_order};
pub use info::{Bounds, SceneInfo, info};
pub use prune::floaters;
pub use select::{in_box, in_sphere, select};
pub use up::{UpGuess, guess_up};

#[cfg(test)]
mod tests;
