//! The buffers of one frame in flight, and the passes recorded on them.

use super::passes::Passes;
use super::profile::DEPTH_BITS;
use super::uniform::{Planes, Uniform};
use crate::gpu::{Extent, Gpu, GpuError, Recording, SortBuffers, THREADS, fold};
use crate::skin::Splats;

/// Bytes of a projected Gaussian (`struct Splat`) and of what it covers (`struct Cover`).
const SPLAT_BYTES: u64 = 48;
const COVER_BYTES: u64 = 16;

/// What there is room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Capacity {
    /// Gaussians.
    pub gaussians: u32,
    /// Pairs of bin and Gaussian.
    pub pairs: u32,
    /// Bins.
    pub bins: u32,
    /// Words of the picture's planes.
    pub words: u32,
    /// Pixels of the backdrop, 1 where there is none.
    pub backdrop: u32,
}

impl Capacity {
    /// Whether a frame that needs `other` fits.
    pub fn holds(&self, other: &Capacity) -> bool {
        self.gaussians >= other.gaussians
            && self.pairs >= other.pairs
            && self.bins >= other.bins
            && self.words >= other.words
            && self.backdrop >= other.backdrop
    }
}

/// Everything that one frame writes between the Gaussians and its picture. A picture on its way back
/// keeps its own, so that it can be drawn again from the projected Gaussians while later frames run.
#[derive(Debug)]
pub(super) struct FrameBuffers {
    pub capacity: Capacity,
    pub uniform: wgpu::Buffer,
    pub splats: wgpu::Buffer,
    pub covers: wgpu::Buffer,
    visible: wgpu::Buffer,
    place: wgpu::Buffer,
    depth_range: wgpu::Buffer,
    sums: wgpu::Buffer,
    pub counts: wgpu::Buffer,
    start: wgpu::Buffer,
    gaussians: Extent,
    pub shown: Extent,
    pub pairs: Extent,
    pub by_depth: SortBuffers,
    pub by_bin: SortBuffers,
    pub starts: wgpu::Buffer,
    pub backdrop: wgpu::Buffer,
    pub pixels: wgpu::Buffer,
}

impl FrameBuffers {
    pub fn new(gpu: &Gpu, passes: &Passes, capacity: Capacity) -> Result<FrameBuffers, GpuError> {
        let n = capacity.gaussians.max(1) as usize;
        let words = |label, count: usize| gpu.storage::<u32>(label, count);
        Ok(FrameBuffers {
            capacity,
            uniform: gpu.storage::<Uniform>("render.frame", 1)?,
            splats: gpu.storage_bytes("render.splats", SPLAT_BYTES * n as u64)?,
            covers: gpu.storage_bytes("render.covers", COVER_BYTES * n as u64)?,
            visible: words("render.visible", n)?,
            place: words("render.place", n + 1)?,
            depth_range: words("render.depth_range", 2)?,
            sums: passes.scan.sums(gpu, "render.sums", capacity.gaussians)?,
            counts: words("render.counts", n)?,
            start: words("render.start", n + 1)?,
            gaussians: Extent::empty(gpu, "render.gaussians")?,
            shown: Extent::empty(gpu, "render.shown")?,
            pairs: Extent::empty(gpu, "render.pairs")?,
            by_depth: passes.sort.buffers(gpu, "render.by_depth", capacity.gaussians)?,
            by_bin: passes.sort.buffers(gpu, "render.by_bin", capacity.pairs)?,
            starts: words("render.starts", capacity.bins as usize + 2)?,
            backdrop: words("render.backdrop", capacity.backdrop as usize)?,
            pixels: words("render.pixels", capacity.words as usize)?,
        })
    }

    /// Exchanges the room for pairs for a larger one.
    pub fn grow_pairs(&mut self, gpu: &Gpu, passes: &Passes, pairs: u32) -> Result<(), GpuError> {
        self.by_bin = passes.sort.buffers(gpu, "render.by_bin", pairs)?;
        self.capacity.pairs = pairs;
        Ok(())
    }

    /// World to screen: everything that reads the Gaussians themselves.
    pub fn record_project(&self, gpu: &Gpu, passes: &Passes, splats: &Splats, recording: &mut Recording) {
        self.gaussians.set(gpu, splats.count, &passes.scan.blocks);
        recording.clear(&self.depth_range);
        let bindings =
            gpu.bind(&passes.project, &[&self.uniform, &splats.geometry, &splats.sh, &self.splats, &self.covers, &self.visible, &self.depth_range]);
        recording.dispatch(&passes.project, &bindings, fold(splats.count.div_ceil(THREADS)));
    }

    /// What lies behind the Gaussians.
    pub fn record_ground(&self, gpu: &Gpu, passes: &Passes, ground_map: &wgpu::Buffer, planes: &Planes, recording: &mut Recording) {
        let bindings = gpu.bind(&passes.ground, &[&self.uniform, ground_map, &self.backdrop]);
        recording.dispatch(&passes.ground, &bindings, fold((planes.size[0] * planes.size[1]).div_ceil(THREADS)));
    }

    /// The projected Gaussians to a picture. `object` is named by the raster alone.
    pub fn record_picture(&self, gpu: &Gpu, passes: &Passes, uniform: &Uniform, planes: &Planes, object: &wgpu::Buffer, recording: &mut Recording) {
        let depth = passes.sort.plan(gpu, &self.by_depth, &self.shown, DEPTH_BITS);
        self.record_visible(gpu, passes, uniform, recording);
        recording.extend(&depth.recording);
        let order = &self.by_depth.values[depth.sorted];
        self.record_pairs(gpu, passes, order, recording);

        // Padding goes to a bin past the last.
        let bits = u32::BITS - uniform.bin_count().leading_zeros();
        let bins = passes.sort.plan(gpu, &self.by_bin, &self.pairs, bits);
        recording.extend(&bins.recording);
        let ranges = gpu.bind(&passes.ranges, &[&self.uniform, &self.pairs.buffer, &self.by_bin.keys[bins.sorted], &self.starts]);
        recording.indirect(&passes.ranges, &ranges, &self.pairs.buffer, Extent::THREADS_AT);

        let raster = passes.raster(gpu, 1 << uniform.bin_shift, planes.depth, planes.id);
        let sorted = &self.by_bin.values[bins.sorted];
        let bindings = gpu.bind(raster, &[&self.uniform, &self.starts, sorted, &self.splats, object, &self.backdrop, &self.pixels]);
        recording.dispatch(raster, &bindings, [uniform.bins[0], uniform.bins[1], 1]);
    }

    /// The visible Gaussians in their own order, with depth keys.
    fn record_visible(&self, gpu: &Gpu, passes: &Passes, uniform: &Uniform, recording: &mut Recording) {
        passes.scan.record(gpu, recording, &self.gaussians, &self.visible, &self.sums, &self.place);
        passes.extent.record(gpu, recording, &self.sums, 0, uniform.count, &self.shown);
        let (keys, values) = (&self.by_depth.keys[0], &self.by_depth.values[0]);
        let compact = gpu.bind(&passes.compact, &[&self.uniform, &self.covers, &self.visible, &self.place, &self.depth_range, keys, values]);
        recording.dispatch(&passes.compact, &compact, fold(uniform.count.div_ceil(THREADS)));
    }

    /// Pairs of bin and Gaussian, nearest Gaussian first.
    fn record_pairs(&self, gpu: &Gpu, passes: &Passes, order: &wgpu::Buffer, recording: &mut Recording) {
        let gather = gpu.bind(&passes.gather, &[&self.shown.buffer, order, &self.covers, &self.counts]);
        recording.indirect(&passes.gather, &gather, &self.shown.buffer, Extent::THREADS_AT);
        passes.scan.record(gpu, recording, &self.shown, &self.counts, &self.sums, &self.start);
        passes.extent.record(gpu, recording, &self.sums, 0, self.capacity.pairs, &self.pairs);
        let (keys, values) = (&self.by_bin.keys[0], &self.by_bin.values[0]);
        let emit = gpu.bind(&passes.emit, &[&self.uniform, &self.shown.buffer, order, &self.covers, &self.start, &self.splats, keys, values]);
        recording.indirect(&passes.emit, &emit, &self.shown.buffer, Extent::THREADS_AT);
    }
}
