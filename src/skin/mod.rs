//! Motion to moving Gaussians: binding, blending, SH rotation.
//!
//! [`bind`] picks the particles each Gaussian follows, once, in the captured pose. A [`Skinner`]
//! then turns the motion of the particles into the geometry of the Gaussians, frame by frame, on
//! the device; of what keeps no shape the particles are drawn themselves. [`twin`] is the same in plain Rust.

mod bench;
mod bind;
mod body;
mod neighbours;
mod skinner;
mod splats;
pub mod twin;
pub mod validate;

pub use bench::bench_skin;
pub use bind::{Bound, STATIC, bind};
pub use body::Filling;
pub use skinner::{Skinner, VERSION, kernels, prepare, shader_text};
pub use splats::Splats;

#[cfg(test)]
mod tests;
