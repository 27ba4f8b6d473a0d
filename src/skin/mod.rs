//! Motion to moving Gaussians: binding, blending, SH rotation.
//!
//! [`bind`] picks the particles each Gaussian follows, once, in the captured pose. A [`Skinner`]
//! then turns the motion of the particles into the geometry of the Gaussians, frame by frame, on
//! the device; what has lost its shape takes one from how densely the Gaussians lie. [`twin`] is the same in plain Rust.

mod bench;
mod bind;
mod cover;
mod neighbours;
mod skinner;
mod splats;
pub mod twin;
pub mod validate;

pub use bench::bench_skin;
pub use bind::{Bound, STATIC, bind};
pub use skinner::{Skinner, VERSION, kernels, prepare, shader_text};
pub use splats::Splats;

#[cfg(test)]
mod tests;
