//! Gaussians: read and write formats, up axis, prune, select, the built-in demo scene.

mod frame;
mod gaussians;

pub use frame::SceneFrame;
pub use gaussians::{Gaussians, morton_order};
