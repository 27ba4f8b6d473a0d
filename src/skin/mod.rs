//! Motion to moving Gaussians: binding, blending, SH rotation.

mod splats;

pub use splats::Splats;
