//! Device tiers, buffers, kernels, recordings, timing: everything that touches wgpu directly.
//!
//! A pass is a [`KernelSource`] (its WGSL, what it binds, what it is called); compiled it is a
//! [`Kernel`]; bound and sized it is a step of a [`Recording`], which is plain data: it can be
//! listed, replayed and timed.

mod buffers;
mod calibrate;
mod device;
mod extent;
mod kernel;
mod recording;
mod scan;
mod sort;
#[cfg(test)]
mod twin;

pub use buffers::{Arrived, Readback};
pub use calibrate::Samples;
pub use device::{DeviceRequest, Gpu, GpuError, Tier, list_adapters};
pub use extent::{Blocks, Extent, ExtentPass, THREADS, fold};
pub use kernel::{Access, Constant, Kernel, KernelSource};
pub use recording::{PassTime, Recording, Step};
pub use scan::Scan;
pub use sort::{RadixSort, SortBuffers, SortPlan};

/// Every pass of the room in every form, for validation.
pub fn kernels() -> Vec<KernelSource> {
    let forms = [(Tier::Gpu, (32, 32)), (Tier::Gpu, (8, 128)), (Tier::Cpu, (8, 8))].map(|(tier, lanes)| (tier, Blocks::of(tier, lanes)));
    let of_form = |(tier, blocks): (Tier, Blocks)| {
        let sorts = (1..=8).flat_map(move |width| sort::sources(&blocks, tier, width));
        scan::sources(&blocks, tier).into_iter().chain(sorts).chain([extent::source(&blocks)])
    };
    forms.into_iter().flat_map(of_form).chain([calibrate::source()]).collect()
}
