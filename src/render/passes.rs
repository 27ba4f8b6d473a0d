//! The renderer's passes: their text, what they bind, their compiled form.

use super::profile::{CORRELATION_MAX, DEPTH_BITS, EXPONENT_SLACK, FAR, LIT_LOOK, OPACITY_MAX, POOL_TONE, REACH_SLACK, VARIANCE_MAX};
use super::shadow;
use crate::gpu::{Access, Constant, ExtentPass, Gpu, Kernel, KernelSource, RadixSort, Scan, THREADS, Tier};
use std::sync::OnceLock;

const FRAME: (&str, &str) = ("render/frame.wgsl", include_str!("../../shaders/render/frame.wgsl"));
const SPLAT: (&str, &str) = ("render/splat.wgsl", include_str!("../../shaders/render/splat.wgsl"));
const REACH: (&str, &str) = ("render/reach.wgsl", include_str!("../../shaders/render/reach.wgsl"));
const SH: (&str, &str) = ("render/sh.wgsl", include_str!("../../shaders/render/sh.wgsl"));
const LIT: (&str, &str) = ("render/lit.wgsl", include_str!("../../shaders/render/lit.wgsl"));
const PROJECT: (&str, &str) = ("render/project.wgsl", include_str!("../../shaders/render/project.wgsl"));
const COMPACT: (&str, &str) = ("render/compact.wgsl", include_str!("../../shaders/render/compact.wgsl"));
const GATHER: (&str, &str) = ("render/gather.wgsl", include_str!("../../shaders/render/gather.wgsl"));
const EMIT: (&str, &str) = ("render/emit.wgsl", include_str!("../../shaders/render/emit.wgsl"));
const RANGES: (&str, &str) = ("render/ranges.wgsl", include_str!("../../shaders/render/ranges.wgsl"));
const GROUND: (&str, &str) = ("render/ground.wgsl", include_str!("../../shaders/render/ground.wgsl"));
const PIXEL: (&str, &str) = ("render/pixel.wgsl", include_str!("../../shaders/render/pixel.wgsl"));
const RASTER: (&str, &str) = ("render/raster.wgsl", include_str!("../../shaders/render/raster.wgsl"));
const RASTER_SERIAL: (&str, &str) = ("render/raster_serial.wgsl", include_str!("../../shaders/render/raster_serial.wgsl"));

/// How one bin is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RasterForm {
    /// Which of the two kernels.
    pub tier: Tier,
    /// Side of a bin, 16 or 32 pixels.
    pub bin: u32,
    /// Whether depths are summed.
    pub depth: bool,
    /// Whether the heaviest Gaussian is kept.
    pub id: bool,
    /// Whether a subgroup may have more than 32 lanes.
    pub wide: bool,
}

impl RasterForm {
    /// Threads of a bin: 32 pixels a thread on a CPU, one or two on a GPU.
    fn workgroup(&self) -> u32 {
        match self.tier {
            Tier::Cpu => self.bin * self.bin / 32,
            Tier::Gpu => self.bin * self.bin / self.pixels_a_thread(),
        }
    }

    fn pixels_a_thread(&self) -> u32 {
        if self.bin == 32 { 2 } else { 1 }
    }

    fn slot(&self) -> usize {
        usize::from(self.bin == 32) * 4 + usize::from(self.depth) * 2 + usize::from(self.id)
    }

    /// The pass of this form.
    pub fn source(&self) -> KernelSource {
        let kernel = match self.tier {
            Tier::Cpu => RASTER_SERIAL,
            Tier::Gpu => RASTER,
        };
        let mut constants = shared_constants();
        constants.extend([
            ("WORKGROUP", Constant::U32(self.workgroup())),
            ("BIN", Constant::U32(self.bin)),
            ("PIXELS_A_THREAD", Constant::U32(self.pixels_a_thread())),
            ("BATCH", Constant::U32(if self.bin == 32 { 256 } else { 128 })),
            ("WITH_DEPTH", Constant::Bool(self.depth)),
            ("WITH_ID", Constant::Bool(self.id)),
            ("WIDE", Constant::Bool(self.wide)),
            ("INFINITY_BITS", Constant::U32(f32::INFINITY.to_bits())),
        ]);
        let (r, w) = (Access::Read, Access::Write);
        KernelSource {
            label: "render.raster",
            entry: "main",
            parts: vec![FRAME, SPLAT, PIXEL, kernel],
            constants,
            bindings: vec![r, r, r, r, r, r, w],
            immediate_bytes: 0,
        }
    }
}

fn shared_constants() -> Vec<(&'static str, Constant)> {
    vec![("THREADS", Constant::U32(THREADS)), ("EXPONENT_SLACK", Constant::F32(EXPONENT_SLACK))]
}

fn source(label: &'static str, parts: &[(&'static str, &'static str)], bindings: &[Access]) -> KernelSource {
    let mut constants = shared_constants();
    constants.extend([
        ("FAR", Constant::F32(FAR)),
        ("POOL_TONE", Constant::F32(POOL_TONE)),
        ("VARIANCE_MAX", Constant::F32(VARIANCE_MAX)),
        ("CORRELATION_MAX", Constant::F32(CORRELATION_MAX)),
        ("OPACITY_MAX", Constant::F32(OPACITY_MAX)),
        ("REACH_SLACK", Constant::F32(REACH_SLACK)),
        ("LOG2_E", Constant::F32(std::f32::consts::LOG2_E)),
        ("DEPTH_BITS", Constant::U32(DEPTH_BITS)),
    ]);
    if parts.contains(&LIT) {
        let [x, y, z] = LIT_LOOK.window;
        let look = [
            ("LIT_BELOW", LIT_LOOK.matt[0]),
            ("LIT_ABOVE", LIT_LOOK.matt[1]),
            ("MIRROR", LIT_LOOK.mirror),
            ("ROOM_BELOW", LIT_LOOK.room[0]),
            ("ROOM_ABOVE", LIT_LOOK.room[1]),
            ("WINDOW", LIT_LOOK.window_light),
            ("WINDOW_EDGE", LIT_LOOK.window_edge[0]),
            ("WINDOW_CORE", LIT_LOOK.window_edge[1]),
            ("WINDOW_X", x),
            ("WINDOW_Y", y),
            ("WINDOW_Z", z),
        ];
        constants.extend(look.map(|(name, value)| (name, Constant::F32(value))));
    }
    KernelSource { label, entry: "main", parts: parts.to_vec(), constants, bindings: bindings.to_vec(), immediate_bytes: 0 }
}

/// Project, compact, gather, emit, ranges.
fn sources() -> [KernelSource; 5] {
    let (r, w) = (Access::Read, Access::Write);
    [
        source("render.project", &[FRAME, SPLAT, REACH, SH, LIT, PROJECT], &[r, r, r, w, w, w, w]),
        source("render.compact", &[FRAME, COMPACT], &[r, r, r, r, r, w, w]),
        source("render.gather", &[FRAME, GATHER], &[r, r, r, w]),
        source("render.emit", &[FRAME, SPLAT, REACH, EMIT], &[r, r, r, r, r, r, w, w]),
        source("render.ranges", &[FRAME, RANGES], &[r, r, r, w]),
    ]
}

/// The plain ground's factor behind each pixel.
fn ground_source() -> KernelSource {
    let [spline, shade] = shadow::GROUND_PARTS;
    let mut ground = source("render.ground", &[FRAME, spline, shade, GROUND], &[Access::Read, Access::Read, Access::Write]);
    ground.constants.push(("SIDE", Constant::U32(shadow::SIDE)));
    ground
}

/// Every pass of the room in every form, for validation and cache keys.
pub fn kernels() -> Vec<KernelSource> {
    let mut all = sources().to_vec();
    all.push(ground_source());
    all.extend(shadow::kernels());
    for tier in [Tier::Cpu, Tier::Gpu] {
        for bin in [16, 32] {
            for (depth, id) in [(false, false), (true, true)] {
                all.push(RasterForm { tier, bin, depth, id, wide: bin == 16 }.source());
            }
        }
    }
    all
}

/// The compiled passes; those with several forms are compiled when first needed.
#[derive(Debug)]
pub(super) struct Passes {
    pub tier: Tier,
    pub scan: Scan,
    pub sort: RadixSort,
    pub extent: ExtentPass,
    pub project: Kernel,
    pub compact: Kernel,
    pub gather: Kernel,
    pub emit: Kernel,
    pub ranges: Kernel,
    pub ground: Kernel,
    raster: [OnceLock<Kernel>; 8],
}

impl Passes {
    pub fn new(gpu: &Gpu, tier: Tier) -> Passes {
        gpu.prepare(&sources());
        let scan = Scan::with_tier(gpu, tier);
        let [project, compact, gather, emit, ranges] = sources().map(|s| gpu.kernel(&s));
        Passes {
            tier,
            extent: ExtentPass::new(gpu, &scan.blocks),
            scan,
            sort: RadixSort::with_tier(gpu, tier),
            project,
            compact,
            gather,
            emit,
            ranges,
            ground: gpu.kernel(&ground_source()),
            raster: Default::default(),
        }
    }

    pub fn raster(&self, gpu: &Gpu, bin: u32, depth: bool, id: bool) -> &Kernel {
        let form = RasterForm { tier: self.tier, bin, depth, id, wide: gpu.subgroup_lanes.1 > 32 };
        self.raster[form.slot()].get_or_init(|| gpu.kernel(&form.source()))
    }
}
