//! Moving Gaussians and a camera to an image.
//!
//! One frame, in order: project (and colour, and the bins touched), scan and compact what is visible,
//! sort it by depth, count and scan the bins touched in that order, emit pairs of bin and Gaussian,
//! sort them stably by bin, find each bin's range, blend. No pass appends through an atomic, so equal
//! depths fall in the Gaussians' own order and the same frame gives the same bits.

mod bench;
mod buffers;
mod passes;
mod picture;
pub mod profile;
mod renderer;
pub mod shadow;
mod uniform;
mod view;

#[cfg(test)]
mod tests;

pub use bench::{Bench, bench_recording, bench_render, bench_sort, bench_with};
pub use passes::kernels;
pub use picture::{Developed, Image, Picture};
pub use profile::Profile;
pub use renderer::{GroundLook, RenderOptions, Renderer, prepare};
pub use view::{View, parse_colour};

/// Raised when the picture of the same Gaussians may change.
pub const VERSION: u32 = 2;

/// The whole text of every shader that a picture passes through, for cache keys.
pub fn shader_text() -> String {
    kernels().iter().chain(&crate::gpu::kernels()).map(crate::gpu::KernelSource::wgsl).collect()
}
