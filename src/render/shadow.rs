//! The contact shadow: what moves darkens the ground and the static Gaussians below it.
//!
//! The light is a soft one from above: a cone about the vertical. What moves is cut into layers by
//! height; each layer is a map of how much it covers, with a pyramid of blurred copies. A point
//! loses, for each layer above it, the share of the cone that the layer covers where the cone
//! passes. So the shadow is dark and tight at contact, wide and faint under a thing that has risen,
//! and it follows whatever the thing does. All of it is made anew each frame from the geometry that
//! skinning wrote.
//!
//! Light that was captured is in the colours already: static Gaussians cast nothing onto each other, and what lies below one
//! (a floor below a table) is shaded by the layers between the two only.

pub mod twin;

#[cfg(test)]
mod tests;

use crate::gpu::{Access, Constant, Gpu, GpuError, Kernel, KernelSource, Recording, Tier};
use crate::skin::Splats;
use bytemuck::{Pod, Zeroable};

/// Version of what the contact shadow computes; part of the keys of pictures.
pub const VERSION: u32 = 3;

/// Texels along a side of the map, a power of two.
pub const SIDE: u32 = 128;

/// Layers of what casts.
const LAYERS: u32 = 8;

/// Levels of the pyramid: sides from `SIDE` to 1.
const LEVELS: u32 = SIDE.ilog2() + 1;

/// Texels of one layer, all levels together.
const PYRAMID_SIZE: u32 = (4 * SIDE * SIDE - 1) / 3;

/// Standard deviation of the light's cone a metre away: half the tangent of its half angle, 33 degrees.
const SPREAD: f32 = 0.32;

/// How much of the light on a surface comes from the cone. The rest is bounced about and stays.
const DARKNESS: f32 = 0.72;

/// The smallest texel, metres; larger ones are this times powers of 1.25.
const SMALLEST_TEXEL: f32 = 1e-4;

/// Steps of 1.25 at most: up to a texel of 50 km.
const TEXEL_STEPS: u32 = 90;

/// Share of the map's side over which the shadow fades out at its border.
const MAP_EDGE: f32 = 0.08;

/// One unit of optical depth in the integer sums.
const DEPTH_UNIT: f32 = 65_536.0;

/// Optical depth one Gaussian adds at most, which is opaque many times over: the sums cannot overflow
/// below 500 such Gaussians in one texel.
const LARGEST_DEPTH: f32 = 128.0;

/// Half width of the tent a caster is spread with, texels, at most.
const WIDEST_TENT: f32 = 3.0;

/// Texels of the map along a cell of the static surface's map.
const ROOF_TEXELS: u32 = 4;

/// Cells a static Gaussian reaches to each side, at most.
const ROOF_REACH: f32 = 3.0;

/// Static Gaussians fainter than this are no surface.
const ROOF_OPACITY: f32 = 0.3;

/// Nor are those that stand: variance along the vertical over that along both others, 0.5 of a ball, 1 of an upright disc.
const ROOF_STEEP: f32 = 0.75;

/// Slots of the static surface's map: below all casters, and of each layer.
const ROOF_SLOTS: u32 = LAYERS + 1;

/// Threads of a workgroup: of most passes, and of the bounds.
const GROUP_SIZE: u32 = 64;
const BOUNDS_GROUP: u32 = 128;

/// Workgroups that find the bounds.
const BOUNDS_GROUPS: u32 = 64;

/// Threads that build one layer's pyramid: as many as a GPU lets meet at a barrier; few on a CPU, where
/// barriers are dear.
fn pyramid_group(gpu: &Gpu) -> u32 {
    match gpu.tier {
        Tier::Gpu => gpu.device.limits().max_compute_invocations_per_workgroup.clamp(64, 1024),
        Tier::Cpu => 64,
    }
}

/// WGSL of `fn ground_shade(p: vec2<f32>) -> f32`, the factor of the plain ground at a place. The pass
/// that includes it declares `ground_map` as the buffer of [`Shadow::ground_map`] and the constant `SIDE`.
pub const GROUND_PARTS: [(&str, &str); 2] = [SPLINE, ("render/shadow_ground.wgsl", include_str!("../../shaders/render/shadow_ground.wgsl"))];

/// What every pass receives.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Immediates {
    count: u32,
    grounded: u32,
    ground_m: f32,
    spare: u32,
}

/// The contact shadow of one scene.
#[derive(Debug)]
pub struct Shadow {
    casters: u32,
    receivers: u32,
    ground_m: Option<f32>,
    bounds: wgpu::Buffer,
    depth: wgpu::Buffer,
    roof: wgpu::Buffer,
    ground_map: wgpu::Buffer,
    passes: Vec<(Pass, Kernel, wgpu::BindGroup)>,
}

impl Shadow {
    /// `casters` are the Gaussians that move (those far off anything, floaters, are better left out: the
    /// map stretches to hold all), `receivers` those that do not, `ground_m` the plain ground's height.
    pub fn new(gpu: &Gpu, splats: &Splats, casters: &[u32], receivers: &[u32], ground_m: Option<f32>) -> Result<Shadow, GpuError> {
        let texels = (SIDE * SIDE) as usize;
        let roof_cells = (SIDE / ROOF_TEXELS * (SIDE / ROOF_TEXELS) * ROOF_SLOTS) as usize;
        let caster = gpu.storage_from("shadow.casters", casters)?;
        let receiver = gpu.storage_from("shadow.receivers", receivers)?;
        let bounds = gpu.storage::<u32>("shadow.bounds", 6)?;
        let depth = gpu.storage::<u32>("shadow.depth", texels * LAYERS as usize)?;
        let pyramid = gpu.storage::<f32>("shadow.pyramid", (PYRAMID_SIZE * LAYERS) as usize)?;
        let roof = gpu.storage::<u32>("shadow.roof", roof_cells)?;
        // Full light until the first frame, and for good where nothing casts.
        let ground_map = gpu.storage_from("shadow.ground_map", &vec![1.0f32; texels + 4])?;
        let geometry = &splats.geometry;
        let buffers = |pass: Pass| match pass {
            Pass::Bounds => vec![&caster, geometry, &bounds],
            Pass::Splat => vec![&caster, geometry, &bounds, &depth],
            Pass::Roof => vec![&receiver, geometry, &bounds, &roof],
            Pass::Pyramid => vec![&depth, &pyramid],
            Pass::Receive => vec![&receiver, &bounds, &pyramid, &roof, geometry],
            Pass::Plane => vec![&bounds, &pyramid, &roof, &ground_map],
        };
        prepare(gpu);
        let passes = Pass::ALL.into_iter().map(|pass| {
            let kernel = gpu.kernel(&pass.source(pyramid_group(gpu)));
            let bindings = gpu.bind(&kernel, &buffers(pass));
            (pass, kernel, bindings)
        });
        let passes = passes.collect();
        Ok(Shadow { casters: casters.len() as u32, receivers: receivers.len() as u32, ground_m, bounds, depth, roof, ground_map, passes })
    }

    /// Records the passes that write `shade` of the receivers and the ground's map from the geometry
    /// as it is then: after skinning, before drawing.
    pub fn record(&self, recording: &mut Recording) {
        if self.casters == 0 {
            return;
        }
        for buffer in [&self.bounds, &self.depth, &self.roof] {
            recording.clear(buffer);
        }
        for (pass, kernel, bindings) in &self.passes {
            let (count, groups) = match pass {
                Pass::Bounds => (self.casters, [BOUNDS_GROUPS, 1, 1]),
                Pass::Splat => (self.casters, groups(self.casters)),
                Pass::Roof | Pass::Receive => (self.receivers, groups(self.receivers)),
                Pass::Pyramid => (LAYERS, [LAYERS, 1, 1]),
                Pass::Plane => (u32::from(self.ground_m.is_some()), groups(SIDE * SIDE)),
            };
            if count == 0 {
                continue;
            }
            let (grounded, ground_m) = (u32::from(self.ground_m.is_some()), self.ground_m.unwrap_or(0.0));
            recording.dispatch_with(kernel, bindings, &Immediates { count, grounded, ground_m, spare: 0 }, groups);
        }
    }

    /// The factors of the plain ground: origin x and y in metres, texels a metre, a spare; then `SIDE` x
    /// `SIDE` values of 0 to 1, rows along x.
    pub fn ground_map(&self) -> &wgpu::Buffer {
        &self.ground_map
    }
}

/// Workgroups for `count` threads, folded into two dimensions where one has not enough.
fn groups(count: u32) -> [u32; 3] {
    let groups = count.div_ceil(GROUP_SIZE);
    let rows = groups.div_ceil(65_535).max(1);
    [groups.div_ceil(rows), rows, 1]
}

/// The passes, in the order they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    Bounds,
    Splat,
    Roof,
    Pyramid,
    Receive,
    Plane,
}

type Part = (&'static str, &'static str);
const MAP: Part = ("render/shadow_map.wgsl", include_str!("../../shaders/render/shadow_map.wgsl"));
const PLACE: Part = ("render/shadow_place.wgsl", include_str!("../../shaders/render/shadow_place.wgsl"));
const SPLINE: Part = ("render/shadow_spline.wgsl", include_str!("../../shaders/render/shadow_spline.wgsl"));
const SHADE: Part = ("render/shadow_shade.wgsl", include_str!("../../shaders/render/shadow_shade.wgsl"));

impl Pass {
    const ALL: [Pass; 6] = [Pass::Bounds, Pass::Splat, Pass::Roof, Pass::Pyramid, Pass::Receive, Pass::Plane];

    fn source(self, pyramid_group: u32) -> KernelSource {
        use Access::{Read, Write};
        let (label, parts, bindings) = match self {
            Pass::Bounds => {
                let main = ("render/shadow_bounds.wgsl", include_str!("../../shaders/render/shadow_bounds.wgsl"));
                ("shadow.bounds", vec![MAP, main], vec![Read, Read, Write])
            }
            Pass::Splat => {
                let main = ("render/shadow_splat.wgsl", include_str!("../../shaders/render/shadow_splat.wgsl"));
                ("shadow.splat", vec![MAP, PLACE, main], vec![Read, Read, Read, Write])
            }
            Pass::Roof => {
                let main = ("render/shadow_roof.wgsl", include_str!("../../shaders/render/shadow_roof.wgsl"));
                ("shadow.roof", vec![MAP, PLACE, main], vec![Read, Read, Read, Write])
            }
            Pass::Pyramid => {
                let main = ("render/shadow_pyramid.wgsl", include_str!("../../shaders/render/shadow_pyramid.wgsl"));
                ("shadow.pyramid", vec![MAP, main], vec![Read, Write])
            }
            Pass::Receive => {
                let main = ("render/shadow_receive.wgsl", include_str!("../../shaders/render/shadow_receive.wgsl"));
                ("shadow.receive", vec![MAP, PLACE, SPLINE, SHADE, main], vec![Read, Read, Read, Read, Write])
            }
            Pass::Plane => {
                let main = ("render/shadow_plane.wgsl", include_str!("../../shaders/render/shadow_plane.wgsl"));
                ("shadow.plane", vec![MAP, PLACE, SPLINE, SHADE, main], vec![Read, Read, Read, Write])
            }
        };
        let mut constants = constants();
        constants.push(("PYRAMID_GROUP", Constant::U32(pyramid_group)));
        KernelSource { label, entry: "main", parts, constants, bindings, immediate_bytes: size_of::<Immediates>() as u32 }
    }
}

fn constants() -> Vec<(&'static str, Constant)> {
    vec![
        ("SIDE", Constant::U32(SIDE)),
        ("LAYERS", Constant::U32(LAYERS)),
        ("LEVELS", Constant::U32(LEVELS)),
        ("PYRAMID_SIZE", Constant::U32(PYRAMID_SIZE)),
        ("SPREAD", Constant::F32(SPREAD)),
        ("DARKNESS", Constant::F32(DARKNESS)),
        ("SMALLEST_TEXEL", Constant::F32(SMALLEST_TEXEL)),
        ("TEXEL_STEPS", Constant::U32(TEXEL_STEPS)),
        ("MAP_EDGE", Constant::F32(MAP_EDGE)),
        ("DEPTH_UNIT", Constant::F32(DEPTH_UNIT)),
        ("LARGEST_DEPTH", Constant::F32(LARGEST_DEPTH)),
        ("WIDEST_TENT", Constant::F32(WIDEST_TENT)),
        ("ROOF_TEXELS", Constant::F32(ROOF_TEXELS as f32)),
        ("ROOF_SIDE", Constant::U32(SIDE / ROOF_TEXELS)),
        ("ROOF_REACH", Constant::F32(ROOF_REACH)),
        ("ROOF_OPACITY", Constant::F32(ROOF_OPACITY)),
        ("ROOF_STEEP", Constant::F32(ROOF_STEEP)),
        ("GROUP_SIZE", Constant::U32(GROUP_SIZE)),
        ("BOUNDS_GROUP", Constant::U32(BOUNDS_GROUP)),
        ("BOUNDS_GROUPS", Constant::U32(BOUNDS_GROUPS)),
    ]
}

/// Compiles the passes of the contact shadow.
pub(super) fn prepare(gpu: &Gpu) {
    gpu.prepare(&Pass::ALL.map(|pass| pass.source(pyramid_group(gpu))));
}

/// Every pass of the contact shadow.
pub fn kernels() -> Vec<KernelSource> {
    Pass::ALL.into_iter().map(|pass| pass.source(256)).collect()
}

/// All WGSL of the contact shadow, for the keys of stages.
pub fn shader_text() -> String {
    kernels().iter().map(KernelSource::wgsl).collect()
}
