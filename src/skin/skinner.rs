//! The two passes that move Gaussians with their particles.

use super::body::{self, Body, Filling};
use super::{Bound, STATIC, Splats};
use crate::gpu::{Access, Constant, Gpu, GpuError, Kernel, KernelSource, Recording};
use crate::spec::Weights;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Version of what skinning computes; part of the keys of pictures.
pub const VERSION: u32 = 10;

/// Threads of a workgroup.
const GROUP_SIZE: u32 = 128;

/// Principal stretches a Gaussian is drawn with: beyond them it would be a needle or a flake that
/// the eye takes for an error. Centres follow the motion without limit.
pub const STRETCH: [f32; 2] = [0.3, 3.0];

/// Below this determinant a blended gradient has no rotation worth the name.
pub const SMALLEST_DETERMINANT: f32 = 1e-3;

/// How far the nearest particle of a Gaussian, where it is drawn itself, has parted from those around it when the Gaussian begins
/// to fade, and when it is gone.
pub const FADES: [f32; 2] = [0.2, 0.5];

/// Particles that carry a Gaussian's centre this far from where its nearest one does, in spans, begin
/// to lose it, and at the second number have lost it. A span is what lies between the particles that a
/// Gaussian follows at rest.
pub const PART: [f32; 2] = [0.75, 1.5];

/// Newton steps at most; 6 suffice for stretches within [`STRETCH`], 14 for [`SMALLEST_DETERMINANT`].
pub const POLAR_STEPS: u32 = 16;

/// Sweeps of Jacobi's method: three bring a 3x3 matrix to f32 precision.
pub const JACOBI_SWEEPS: u32 = 4;

/// What the two passes over captured Gaussians receive.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Immediates {
    pub origin: [f32; 3],
    pub count: u32,
    span_m: f32,
    /// Of the moving Gaussians, those from here on hang on a thread.
    first_hung: u32,
    padding: [u32; 2],
}

/// Moves the Gaussians of one scene. At rest what it writes equals `Splats::rest` bit for bit.
#[derive(Debug)]
pub struct Skinner {
    gpu: Gpu,
    delta: Kernel,
    blend: Kernel,
    blend_bindings: wgpu::BindGroup,
    bound: Uploaded,
    rest_particles: wgpu::Buffer,
    deltas: wgpu::Buffer,
    body: Option<Body>,
    particles: Immediates,
    gaussians: Immediates,
}

impl Skinner {
    /// Uploads the binding. `rest_particles` are the captured positions in the world, in the order
    /// of the motion that [`Skinner::record`] will read.
    pub fn new(gpu: &Gpu, splats: &Splats, bound: &Bound, rest_particles: &[Vec3], weights: Weights) -> Result<Skinner, GpuError> {
        let origin = centre(rest_particles);
        let packed = Packed::new(bound, origin);
        let shared = Immediates {
            origin: origin.to_array(),
            count: 0,
            span_m: span_m(bound, rest_particles),
            first_hung: packed.first_hung(),
            padding: [0; 2],
        };
        let relative: Vec<[f32; 4]> = rest_particles.iter().map(|&p| (p - origin).extend(0.0).to_array()).collect();
        let deltas = gpu.storage::<[u32; 8]>("skin.deltas", rest_particles.len())?;
        let blend = gpu.kernel(&blend_source(packed.vectors, weights));
        let bound = Uploaded {
            moving: gpu.storage_from("skin.moving", &packed.moving)?,
            index: gpu.storage_from("skin.particle", &packed.index)?,
            weight: gpu.storage_from("skin.weight", &packed.weight)?,
            held: gpu.storage_from("skin.held", if packed.held.is_empty() { &[[0.0; 4]] } else { &packed.held[..] })?,
        };
        let whole = gpu.storage_from("skin.whole", &[0.0f32])?;
        Ok(Skinner {
            delta: gpu.kernel(&delta_source(weights)),
            blend_bindings: bound.bind(gpu, &blend, splats, &deltas, &whole),
            blend,
            bound,
            rest_particles: gpu.storage_from("skin.rest_particles", &relative)?,
            deltas,
            body: None,
            particles: Immediates { count: rest_particles.len() as u32, ..shared },
            gaussians: Immediates { count: packed.moving.len() as u32, ..shared },
            gpu: gpu.clone(),
        })
    }

    /// Readies it for matter that keeps no shape, liquids and grains, of which the motion tells: its particles are drawn once
    /// they part, as the last Gaussians of `splats`, and captured Gaussians fade where they do. Without this those go on as
    /// their particles turn and stretch.
    pub fn fill(&mut self, splats: &Splats, filling: &Filling) -> Result<(), GpuError> {
        if self.particles.count > 0 && filling.rest_m.len() == self.particles.count as usize {
            let body = Body::new(&self.gpu, splats, filling, Vec3::from(self.particles.origin))?;
            self.blend_bindings = self.bound.bind(&self.gpu, &self.blend, splats, &self.deltas, &body.parted);
            self.body = Some(body);
        }
        Ok(())
    }

    /// Records the passes that read `motion` (8 u32 a particle, see the solver) and write `Splats::geometry`
    /// of the Gaussians that follow particles. Static Gaussians are not touched.
    pub fn record(&self, motion: &wgpu::Buffer, recording: &mut Recording) {
        if let Some(body) = &self.body {
            body.record(&self.gpu, motion, &self.rest_particles, recording);
        }
        if self.gaussians.count == 0 || self.particles.count == 0 {
            return;
        }
        let bindings = self.gpu.bind(&self.delta, &[motion, &self.rest_particles, &self.deltas]);
        recording.dispatch_with(&self.delta, &bindings, &self.particles, groups(self.particles.count));
        recording.dispatch_with(&self.blend, &self.blend_bindings, &self.gaussians, groups(self.gaussians.count));
    }
}

/// The binding on the device.
#[derive(Debug)]
struct Uploaded {
    moving: wgpu::Buffer,
    index: wgpu::Buffer,
    weight: wgpu::Buffer,
    held: wgpu::Buffer,
}

impl Uploaded {
    /// What the pass over Gaussians reads and writes; `parted` is of particles that are drawn themselves, or a single 0.
    fn bind(&self, gpu: &Gpu, blend: &Kernel, splats: &Splats, deltas: &wgpu::Buffer, parted: &wgpu::Buffer) -> wgpu::BindGroup {
        gpu.bind(blend, &[&self.moving, &self.index, &self.weight, deltas, &splats.rest, parted, &self.held, &splats.geometry])
    }
}

/// The binding without the static Gaussians, in groups of four neighbours; those that hang on threads last.
struct Packed {
    vectors: u32,
    moving: Vec<u32>,
    index: Vec<[u32; 4]>,
    weight: Vec<[f32; 4]>,
    /// Where those of threads are held, from the origin.
    held: Vec<[f32; 4]>,
}

impl Packed {
    fn new(bound: &Bound, origin: Vec3) -> Packed {
        let k = bound.neighbours.max(1) as usize;
        let vectors = k.div_ceil(4);
        let mut packed = Packed { vectors: vectors as u32, moving: Vec::new(), index: Vec::new(), weight: Vec::new(), held: Vec::new() };
        let moving: Vec<u32> = (0u32..).zip(bound.index.chunks_exact(k)).filter(|(_, index)| index[0] != STATIC).map(|(g, _)| g).collect();
        let (hung, free): (Vec<u32>, Vec<u32>) = moving.into_iter().partition(|&g| bound.held_at(g).is_some());
        packed.held = hung.iter().filter_map(|&g| bound.held_at(g)).map(|at| (at - origin).extend(0.0).to_array()).collect();
        packed.moving = [free, hung].concat();
        for &g in &packed.moving {
            let own = g as usize * k..(g as usize + 1) * k;
            let (index, weight) = (&bound.index[own.clone()], &bound.weight[own]);
            for v in 0..vectors {
                let slot = |s: usize| v * 4 + s;
                packed.index.push(std::array::from_fn(|s| index.get(slot(s)).copied().unwrap_or(index[0])));
                packed.weight.push(std::array::from_fn(|s| weight.get(slot(s)).copied().unwrap_or(0.0)));
            }
        }
        packed
    }

    fn first_hung(&self) -> u32 {
        (self.moving.len() - self.held.len()) as u32
    }
}

/// Positions are taken relative to their centre, so that a scene far from the origin loses no digits.
pub(super) fn centre(points: &[Vec3]) -> Vec3 {
    let sum = points.iter().fold(glam::DVec3::ZERO, |sum, p| sum + p.as_dvec3());
    (sum / points.len().max(1) as f64).as_vec3()
}

/// Median distance at rest between the nearest and the farthest particle that a Gaussian follows, metres.
pub(super) fn span_m(bound: &Bound, rest_particles: &[Vec3]) -> f32 {
    let k = bound.neighbours.max(1) as usize;
    let followed = bound.index.chunks_exact(k).filter(|index| index[0] != STATIC);
    let between = |index: &[u32]| index.iter().map(|&i| rest_particles[i as usize].distance(rest_particles[index[0] as usize])).fold(0.0, f32::max);
    let mut spans: Vec<f32> = followed.map(between).collect();
    let middle = spans.len() / 2;
    if spans.is_empty() { 0.0 } else { spans.select_nth_unstable_by(middle, f32::total_cmp).1.max(f32::MIN_POSITIVE) }
}

/// Workgroups for `count` threads, folded into two dimensions where one has not enough.
pub(super) fn groups(count: u32) -> [u32; 3] {
    let groups = count.div_ceil(GROUP_SIZE);
    let rows = groups.div_ceil(65_535).max(1);
    [groups.div_ceil(rows), rows, 1]
}

pub(super) const AFFINE: (&str, &str) = ("skin/affine.wgsl", include_str!("../../shaders/skin/affine.wgsl"));
const DELTA: (&str, &str) = ("skin/delta.wgsl", include_str!("../../shaders/skin/delta.wgsl"));
pub(super) const ROTATION: (&str, &str) = ("skin/rotation.wgsl", include_str!("../../shaders/skin/rotation.wgsl"));
const BLEND: (&str, &str) = ("skin/blend.wgsl", include_str!("../../shaders/skin/blend.wgsl"));

fn delta_source(weights: Weights) -> KernelSource {
    KernelSource {
        label: "skin.delta",
        entry: "main",
        parts: vec![AFFINE, DELTA],
        constants: vec![("GROUP_SIZE", Constant::U32(GROUP_SIZE)), ("PAPER", Constant::Bool(weights == Weights::Paper))],
        bindings: vec![Access::Read, Access::Read, Access::Write],
        immediate_bytes: size_of::<Immediates>() as u32,
    }
}

fn blend_source(vectors: u32, weights: Weights) -> KernelSource {
    KernelSource {
        label: "skin.blend",
        entry: "main",
        parts: vec![AFFINE, ROTATION, BLEND],
        constants: [constants(), vec![("VECTORS", Constant::U32(vectors)), ("PAPER", Constant::Bool(weights == Weights::Paper))]].concat(),
        bindings: [[Access::Read; 7].as_slice(), &[Access::Write]].concat(),
        immediate_bytes: size_of::<Immediates>() as u32,
    }
}

pub(super) fn constants() -> Vec<(&'static str, Constant)> {
    vec![
        ("GROUP_SIZE", Constant::U32(GROUP_SIZE)),
        ("PART_LOW", Constant::F32(PART[0])),
        ("PART_HIGH", Constant::F32(PART[1])),
        ("FADES_LOW", Constant::F32(FADES[0])),
        ("FADES_HIGH", Constant::F32(FADES[1])),
        ("STRETCH_LOW", Constant::F32(STRETCH[0])),
        ("STRETCH_HIGH", Constant::F32(STRETCH[1])),
        ("SMALLEST_DETERMINANT", Constant::F32(SMALLEST_DETERMINANT)),
        ("POLAR_STEPS", Constant::U32(POLAR_STEPS)),
        ("JACOBI_SWEEPS", Constant::U32(JACOBI_SWEEPS)),
    ]
}

/// Compiles the passes for K = 8.
pub fn prepare(gpu: &Gpu, weights: Weights) {
    gpu.prepare(&[delta_source(weights), blend_source(2, weights)]);
}

/// Every pass of this room, in the forms that K = 8 and both kinds of weights give.
pub fn kernels() -> Vec<KernelSource> {
    let weighed = [Weights::Exact, Weights::Paper].into_iter().flat_map(|weights| [delta_source(weights), blend_source(2, weights)]);
    weighed.chain(body::sources()).collect()
}

/// All WGSL of this room, for the keys of stages.
pub fn shader_text() -> String {
    kernels().iter().map(KernelSource::wgsl).collect()
}
