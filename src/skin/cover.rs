//! The shape of Gaussians that have lost theirs: in liquids and grains it follows how densely the Gaussians
//! lie, so that a sheet stays whole and even, a heap is no fog and a drop is round.

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(super) mod twin;

use super::Splats;
use super::skinner::{self, Immediates, ROTATION, groups};
use crate::gpu::{Access, Constant, Gpu, GpuError, Kernel, KernelSource, Recording};

/// Gaussians within this many spans of a Gaussian count as around it.
pub const REACH: f32 = 4.0;
/// Fixed-point units of the area of a square of the span: 131,000 of the largest Gaussians fit a cell.
pub const UNITS: f32 = 16_384.0;
/// What has been piled up shrinks no further, in radii.
pub const LEAST: f32 = 0.6;
/// What has spread grows no further.
pub const MOST: f32 = 4.0;
/// Share of the area around it that is a Gaussian's own: from the first number on it counts as alone, all of it at the second.
pub const ALONE: [f32; 2] = [0.5, 0.9];
/// Ratio of the two least spreads, squared, up to which Gaussians lie in a sheet, and from which in a heap.
pub const SHEET: [f32; 2] = [0.1, 0.5];
/// Added to both, squares of the reach: few Gaussians in a row are no sheet.
pub const SPREAD_LEAST: f32 = 0.005;
/// In a sheet a Gaussian is no thinner than this, in radii.
pub const SHEET_LEAST: f32 = 0.1;
/// Share of a Gaussian's weight that has left it at which it begins to lose its shape, and has lost it.
pub const LEFT: [f32; 2] = [0.1, 0.6];
/// Places that are looked through for a cell; half of the table's are empty.
const PROBES: u32 = 256;

/// The table of cells and the passes over it.
#[derive(Debug)]
pub(super) struct Cover {
    pour: Kernel,
    shape: Kernel,
    pour_bindings: wgpu::BindGroup,
    shape_bindings: wgpu::BindGroup,
    keys: wgpu::Buffer,
    sums: wgpu::Buffer,
}

impl Cover {
    /// Measures the captured pose. `moving` are the Gaussians that move, `loose` how far each has lost its shape.
    pub fn new(gpu: &Gpu, splats: &Splats, moving: &wgpu::Buffer, loose: &wgpu::Buffer, immediates: &Immediates) -> Result<Cover, GpuError> {
        let places = (2 * immediates.count as usize).next_power_of_two().max(64);
        let keys = gpu.storage::<u32>("skin.keys", places)?;
        let sums = gpu.storage::<[i32; 11]>("skin.sums", places)?;
        let sizes = gpu.storage::<[f32; 4]>("skin.sizes", immediates.count.max(1) as usize)?;
        let all = gpu.storage::<f32>("skin.all", immediates.count.max(1) as usize)?;
        let [size, pour, count, shape] = sources().map(|source| gpu.kernel(&source));
        let mut recording = Recording::default();
        let dispatches = groups(immediates.count);
        let mut run =
            |kernel: &Kernel, buffers: &[&wgpu::Buffer]| recording.dispatch_with(kernel, &gpu.bind(kernel, buffers), immediates, dispatches);
        run(&size, &[moving, &splats.rest, &sizes]);
        run(&pour, &[moving, &all, &sizes, &splats.rest, &keys, &sums]);
        run(&count, &[moving, &splats.rest, &keys, &sums, &sizes]);
        gpu.submit(&recording);
        Ok(Cover {
            pour_bindings: gpu.bind(&pour, &[moving, loose, &sizes, &splats.geometry, &keys, &sums]),
            shape_bindings: gpu.bind(&shape, &[moving, loose, &sizes, &keys, &sums, &splats.geometry]),
            pour,
            shape,
            keys,
            sums,
        })
    }

    /// Adds what follows the blending.
    pub fn record(&self, immediates: &Immediates, recording: &mut Recording) {
        recording.clear(&self.keys);
        recording.clear(&self.sums);
        recording.dispatch_with(&self.pour, &self.pour_bindings, immediates, groups(immediates.count));
        recording.dispatch_with(&self.shape, &self.shape_bindings, immediates, groups(immediates.count));
    }
}

macro_rules! part {
    ($name:literal) => {
        (concat!("skin/", $name, ".wgsl"), include_str!(concat!("../../shaders/skin/", $name, ".wgsl")))
    };
}

/// The passes, in the order in which they first run.
pub(super) fn sources() -> [KernelSource; 4] {
    use Access::{Read, Write};
    let pass = |label, part, bindings| KernelSource {
        label,
        entry: "main",
        parts: vec![ROTATION, part!("principal"), part!("cover"), part],
        constants: constants(),
        bindings,
        immediate_bytes: size_of::<Immediates>() as u32,
    };
    let looking = |source: KernelSource| {
        let mut parts = source.parts;
        parts.insert(3, part!("cover_around"));
        KernelSource { parts, ..source }
    };
    [
        pass("skin.cover_size", part!("cover_size"), vec![Read, Read, Write]),
        pass("skin.cover_pour", part!("cover_pour"), vec![Read, Read, Read, Read, Write, Write]),
        looking(pass("skin.cover_count", part!("cover_count"), vec![Read, Read, Read, Read, Write])),
        looking(pass("skin.cover_shape", part!("cover_shape"), vec![Read, Read, Read, Read, Read, Write])),
    ]
}

fn constants() -> Vec<(&'static str, Constant)> {
    let mut all = skinner::constants();
    let numbers = [
        ("COVER_REACH", REACH),
        ("COVER_UNITS", UNITS),
        ("COVER_LEAST", LEAST),
        ("COVER_MOST", MOST),
        ("ALONE_LOW", ALONE[0]),
        ("ALONE_HIGH", ALONE[1]),
        ("SHEET_LOW", SHEET[0]),
        ("SHEET_HIGH", SHEET[1]),
        ("SPREAD_LEAST", SPREAD_LEAST),
        ("SHEET_LEAST", SHEET_LEAST),
    ];
    all.extend(numbers.map(|(name, value)| (name, Constant::F32(value))));
    all.push(("PROBES", Constant::U32(PROBES)));
    all
}
