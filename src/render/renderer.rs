//! Draws Gaussians.

use super::buffers::{Capacity, FrameBuffers};
use super::passes::Passes;
use super::picture::Picture;
use super::profile::DEPTH_BITS;
use super::uniform::{Planes, Uniform, bin_side};
use super::{Profile, View, shadow};
use crate::gpu::{Gpu, GpuError, Recording, Tier};
use crate::skin::Splats;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Pairs of bin and Gaussian that there is room for at first, as a multiple of the Gaussians.
const PAIRS_A_GAUSSIAN: u32 = 3;
/// And at least.
const PAIRS_MIN: u32 = 1 << 16;

/// What is drawn beside colour, and how.
#[derive(Clone, Debug, Default)]
pub struct RenderOptions {
    /// Whose constants.
    pub profile: Profile,
    /// Gaussians no further than this are dropped, in the scene's units; 0 takes the default, 0.01.
    pub near: f32,
    /// Whether the picture has premultiplied colours in f32, for EXR.
    pub colour: bool,
    /// Whether it has depths.
    pub depth: bool,
    /// Whether it has object ids.
    pub id: bool,
    /// A plain ground under everything, with a contact shadow.
    pub ground: Option<GroundLook>,
}

/// A plain ground plane: the background's colour, darker where the shadow falls.
#[derive(Clone, Debug)]
pub struct GroundLook {
    /// World height of the plane.
    pub height_m: f32,
    /// The factors on its colour, as [`super::shadow`] keeps them; without them it is not seen.
    pub shadow: Option<wgpu::Buffer>,
    /// World x, y and radius of a pool of darker tone that makes the plane read as a floor; radius 0 for none.
    pub pool_m: [f32; 3],
}

/// Draws frames on one device. Frames in flight each have buffers of their own, used again once
/// their picture was read or dropped.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    pub(super) shared: Arc<Shared>,
}

/// What the renderer and its pictures on their way back have in common.
#[derive(Debug)]
pub(super) struct Shared {
    pub passes: Passes,
    /// Side of the bins that suits the device.
    bin: u32,
    free: Mutex<Vec<FrameBuffers>>,
    /// Room for pairs that new buffers get: what the fullest frame so far needed, and some more.
    pairs: AtomicU32,
}

impl Renderer {
    /// The form for this device.
    pub fn new(gpu: &Gpu) -> Renderer {
        let limits = gpu.device.limits();
        let wide = limits.max_compute_invocations_per_workgroup >= 512 && limits.max_compute_workgroup_size_x >= 512;
        // Small bins where each pair is dear to blend, large ones where it is dear to sort.
        let bin = if gpu.tier == Tier::Gpu && wide { 32 } else { 16 };
        Renderer::with_form(gpu, gpu.tier, bin)
    }

    /// A given form and side of bins, so that tests and benchmarks can run all on one device.
    pub fn with_form(gpu: &Gpu, tier: Tier, bin: u32) -> Renderer {
        let shared = Shared { passes: Passes::new(gpu, tier), bin, free: Mutex::default(), pairs: AtomicU32::new(0) };
        Renderer { gpu: gpu.clone(), shared: Arc::new(shared) }
    }

    /// Submits one frame and starts its way back. The device goes on with what is submitted next.
    pub fn draw(&mut self, splats: &Splats, view: &View, options: &RenderOptions) -> Result<Picture, GpuError> {
        let frame = self.prepare(splats, view, options)?;
        self.gpu.submit(&frame.record(&self.gpu, &self.shared.passes, splats));
        Ok(Picture::start(&self.gpu, frame, self.shared.clone()))
    }

    /// One frame's passes as data, with room for all it draws, for benchmarks: to be submitted any
    /// number of times.
    pub fn recording(&self, splats: &Splats, view: &View, options: &RenderOptions) -> Result<Recording, GpuError> {
        loop {
            let frame = self.prepare(splats, view, options)?;
            let recording = frame.record(&self.gpu, &self.shared.passes, splats);
            self.gpu.submit(&recording);
            let pairs: Vec<u32> = self.gpu.read(&frame.buffers.pairs.buffer, 2)?;
            if pairs[0] == pairs[1] {
                return Ok(recording);
            }
            self.shared.wants_pairs(pairs[1]);
        }
    }

    /// Buffers that are large enough, and what the frame's passes need to know.
    pub(super) fn prepare(&self, splats: &Splats, view: &View, options: &RenderOptions) -> Result<Frame, GpuError> {
        let size = [view.width.max(1), view.height.max(1)];
        let planes = Planes { size, colour: options.colour, depth: options.depth, id: options.id };
        let bin = bin_side(&options.profile.constants(), self.shared.bin);
        let mut uniform = Uniform::new(view, options, &planes, bin, splats.count, splats.sh_degree);
        let need = Capacity {
            gaussians: splats.count,
            pairs: self.shared.pairs.load(Ordering::Relaxed).max(splats.count.saturating_mul(PAIRS_A_GAUSSIAN)).max(PAIRS_MIN),
            bins: uniform.bin_count(),
            words: planes.starts()[3],
            backdrop: if uniform.shaded == 1 { size[0] * size[1] } else { 1 },
        };
        let buffers = match self.shared.take(&need) {
            Some(buffers) => buffers,
            None => FrameBuffers::new(&self.gpu, &self.shared.passes, need)?,
        };
        uniform.capacity = buffers.capacity.pairs;
        self.gpu.queue.write_buffer(&buffers.uniform, 0, bytemuck::bytes_of(&uniform));
        let ground_map = options.ground.as_ref().and_then(|ground| ground.shadow.clone());
        Ok(Frame { buffers, uniform, planes, object: splats.object.clone(), ground_map })
    }
}

impl Shared {
    /// Free buffers that a frame fits in; free ones that are too small are given back.
    fn take(&self, need: &Capacity) -> Option<FrameBuffers> {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        free.retain(|buffers| buffers.capacity.holds(need));
        free.pop()
    }

    /// Takes buffers back for a later frame.
    pub fn put(&self, buffers: FrameBuffers) {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(buffers);
    }

    /// Notes how many pairs a frame wanted; returns the room that frames should have from now on.
    pub fn wants_pairs(&self, wanted: u32) -> u32 {
        let room = wanted.saturating_add(wanted / 2).max(PAIRS_MIN);
        self.pairs.fetch_max(room, Ordering::Relaxed).max(room)
    }
}

/// Compiles the passes of pictures of a size with colour alone.
pub fn prepare(gpu: &Gpu, size: [u32; 2]) {
    shadow::prepare(gpu);
    let shared = Renderer::new(gpu).shared;
    shared.passes.raster(gpu, shared.bin, false, false);
    let bins: u32 = size.map(|side| side.div_ceil(shared.bin)).iter().product();
    [DEPTH_BITS, u32::BITS - bins.leading_zeros()].into_iter().for_each(|bits| shared.passes.sort.prepare(gpu, bits));
}

/// One frame in flight.
#[derive(Debug)]
pub(super) struct Frame {
    pub buffers: FrameBuffers,
    pub uniform: Uniform,
    pub planes: Planes,
    object: wgpu::Buffer,
    ground_map: Option<wgpu::Buffer>,
}

impl Frame {
    /// All passes of the frame.
    pub fn record(&self, gpu: &Gpu, passes: &Passes, splats: &Splats) -> Recording {
        let mut recording = Recording::default();
        self.buffers.record_project(gpu, passes, splats, &mut recording);
        if let Some(map) = &self.ground_map {
            self.buffers.record_ground(gpu, passes, map, &self.planes, &mut recording);
        }
        self.record_picture(gpu, passes, &mut recording);
        recording
    }

    /// The passes from the projected Gaussians to the picture.
    pub fn record_picture(&self, gpu: &Gpu, passes: &Passes, recording: &mut Recording) {
        self.buffers.record_picture(gpu, passes, &self.uniform, &self.planes, &self.object, recording);
    }

    /// Draws the frame again with more room for pairs.
    pub fn redraw(&mut self, gpu: &Gpu, passes: &Passes, pairs: u32) -> Result<(), GpuError> {
        self.buffers.grow_pairs(gpu, passes, pairs)?;
        self.uniform.capacity = pairs;
        gpu.queue.write_buffer(&self.buffers.uniform, 0, bytemuck::bytes_of(&self.uniform));
        let mut recording = Recording::default();
        self.record_picture(gpu, passes, &mut recording);
        gpu.submit(&recording);
        Ok(())
    }
}
