//! Device tiers, buffers, kernels, recordings, timing: everything that touches wgpu directly.
//!
//! A pass is a [`KernelSource`] (its WGSL, what it binds, what it is called); compiled it is a
//! [`Kernel`]; bound and sized it is a step of a [`Recording`], which is plain data: it can be
//! listed, replayed and timed.

mod buffers;
mod device;
mod extent;
mod kernel;
mod recording;
mod scan;
mod sort;
#[cfg(test)]
mod twin;

pub use buffers::Readback;
pub use device::{DeviceRequest, Gpu, GpuError, Tier, list_adapters};
pub use extent::{Blocks, Extent, ExtentPass, THREADS, fold};
pub use kernel::{Access, Constant, Kernel, KernelSource};
pub use recording::{PassTime, Recording, Step};
pub use scan::Scan;
pub use sort::{RadixSort, SortBuffers, SortPlan};
