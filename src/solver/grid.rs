//! The window of the lattice, the blocks of it that are stored, and the buffers over both.
//!
//! Memory follows matter: only blocks that particles may reach before the next sort are stored, found anew by
//! each sort (`bin.wgsl`, `scan_blocks.wgsl`). A window costs but a few bytes a block, for the map behind
//! `Params`.

use super::constants::{SCAN_LANES, SCAN_RUN, TILE_LANES};
use super::core::{Params, Solver};
use super::liquid::LiquidFields;
use super::types::SolverError;
use super::watch::Control;
use crate::gpu::{Gpu, Recording, Tier};
use glam::{IVec3, UVec3};

/// A box of 4^3 blocks of an endless lattice whose nodes stand at integer multiples of the cell size.
/// Where it lies decides only what may be stored: no sum depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    /// First node, each coordinate a multiple of 4.
    pub origin: IVec3,
    /// Blocks along each axis.
    pub blocks: UVec3,
}

impl Window {
    /// The smallest window that holds the stencils that begin at nodes `low` to `high`, and `margin`
    /// nodes around them.
    pub fn around(low: IVec3, high: IVec3, margin: i32) -> Window {
        let first = low - IVec3::splat(margin + 1);
        let last = high + IVec3::splat(margin + 4);
        let origin = IVec3::new(first.x.div_euclid(4), first.y.div_euclid(4), first.z.div_euclid(4)) * 4;
        let blocks = ((last - origin + IVec3::splat(3)) / 4).as_uvec3();
        Window { origin, blocks }
    }

    /// Whether everything that `around` would hold is inside.
    pub fn holds(&self, low: IVec3, high: IVec3, margin: i32) -> bool {
        let first = low - self.origin - IVec3::splat(margin + 1);
        let last = high - self.origin + IVec3::splat(margin + 4);
        first.cmpge(IVec3::ZERO).all() && last.cmple((self.blocks * 4).as_ivec3()).all()
    }

    pub fn block_count(&self) -> u64 {
        u64::from(self.blocks.x) * u64::from(self.blocks.y) * u64::from(self.blocks.z)
    }
}

/// Buffers over stored blocks and over the window's. All but `velocity`, `masses` and the liquids' fields hold zeros between segments.
#[derive(Clone, Debug)]
pub(super) struct GridBuffers {
    /// Blocks that there is room for, beside the empty one.
    pub capacity: usize,
    /// Blocks that a window may have, all layers together.
    pub spread: usize,
    pub kind: GridKind,
    pub sums: wgpu::Buffer,
    pub marks: wgpu::Buffer,
    pub velocity: wgpu::Buffer,
    /// Where there are several layers.
    pub masses: wgpu::Buffer,
    pub cell_count: wgpu::Buffer,
    pub cell_start: wgpu::Buffer,
    pub cell_end: wgpu::Buffer,
    pub block_info: wgpu::Buffer,
    pub block_start: wgpu::Buffer,
    pub chunk_sums: wgpu::Buffer,
    pub active_blocks: wgpu::Buffer,
    /// What workgroups take that go by block.
    pub items: wgpu::Buffer,
    pub active_groups: wgpu::Buffer,
    /// Of liquids, where there are any.
    pub liquid: Option<LiquidFields>,
    /// Of what is nearly incompressible, where anything is; see `shaders/solver/volume.wgsl`.
    pub gains: Option<wgpu::Buffer>,
    /// What rigid bodies and soft matter share, where there are both.
    pub meeting: Option<MeetingBuffers>,
}

/// Words of `Near` of `shaders/solver/rigid_meeting.wgsl`.
pub(super) type Near = [u32; 4];
/// And of `Meeting`.
pub(super) type Meeting = [f32; 16];

/// What a node holds of those.
#[derive(Clone, Debug)]
pub(super) struct MeetingBuffers {
    pub nears: wgpu::Buffer,
    pub meetings: wgpu::Buffer,
}

/// Bytes of all buffers for one node, and beside them for one of several layers, and with rigid bodies.
const NODE_BYTES: u64 = 52;
const LAYER_BYTES: u64 = 4;
const MEETING_BYTES: u64 = (size_of::<Near>() + size_of::<Meeting>()) as u64;
const GAIN_BYTES: u64 = 8;
/// Bytes for one block of the window, and of the map.
const SPREAD_BYTES: u64 = 12;
/// A software adapter shares the machine's memory and is slow over much of it.
const CPU_GRID_BYTES: u64 = 768 << 20;
/// Room for other programs and for the picture is left on a GPU.
const GPU_GRID_BYTES: u64 = 6 << 30;
/// Of these, what the window may take.
const SPREAD_SHARE: u64 = 4;
/// Cells from the origin that anything may be: f32 tells a sixteenth of a cell there.
const LATTICE_MOST: i32 = 1 << 20;
/// The same of bodies alone, whose places are finer: that far whole numbers count cells.
const BODIES_MOST: i32 = 1 << 28;
/// Workgroups along an axis that every device runs.
pub(super) const GROUPS_MOST: u64 = 65_535;

/// What a scene asks of its grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GridKind {
    /// How many groups of objects have velocities of their own.
    pub layers: u32,
    /// Whether there are liquids on it.
    pub wet: bool,
    /// Whether soft matter meets rigid bodies.
    pub meets: bool,
    /// Whether anything is nearly incompressible.
    pub evens: bool,
}

/// Bytes that a grid may take.
fn allowed_bytes(gpu: &Gpu) -> u64 {
    match gpu.tier {
        Tier::Cpu => CPU_GRID_BYTES,
        Tier::Gpu => GPU_GRID_BYTES,
    }
}

fn widest_buffer(gpu: &Gpu) -> u64 {
    let limits = gpu.device.limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// Blocks that can be stored.
fn allowed_blocks(gpu: &Gpu, kind: GridKind) -> u64 {
    let more = |yes: bool, bytes: u64| if yes { bytes } else { 0 };
    let bytes = NODE_BYTES
        + more(kind.layers > 1, LAYER_BYTES)
        + more(kind.meets, MEETING_BYTES)
        + more(kind.wet, LiquidFields::NODE_BYTES)
        + more(kind.evens, GAIN_BYTES);
    (widest_buffer(gpu) / if kind.meets { 64 } else { 16 }).min(allowed_bytes(gpu) / bytes) / 64 - 4
}

/// Blocks that a window may have, all layers together.
fn allowed_spread(gpu: &Gpu) -> u64 {
    let scanned = GROUPS_MOST * u64::from(SCAN_LANES * SCAN_RUN);
    ((allowed_bytes(gpu) / SPREAD_SHARE).min(widest_buffer(gpu)) / SPREAD_BYTES).min(scanned)
}

impl GridBuffers {
    fn new(gpu: &Gpu, particles: usize, blocks: usize, spread: usize, kind: GridKind) -> Result<GridBuffers, SolverError> {
        // With the empty one; buffers come in lengths of 16 bytes.
        let stored = (blocks + 1).next_multiple_of(4);
        let nodes = stored * 64;
        let chunks = spread.div_ceil((SCAN_LANES * SCAN_RUN) as usize);
        Ok(GridBuffers {
            capacity: stored - 1,
            spread,
            kind,
            sums: gpu.storage::<[i32; 4]>("solver.sums", nodes)?,
            marks: gpu.storage::<[u32; 2]>("solver.marks", nodes)?,
            velocity: gpu.storage::<[f32; 4]>("solver.velocity", nodes)?,
            masses: gpu.storage::<f32>("solver.masses", if kind.layers > 1 { nodes } else { 1 })?,
            cell_count: gpu.storage::<u32>("solver.cell_count", nodes)?,
            cell_start: gpu.storage::<u32>("solver.cell_start", nodes)?,
            cell_end: gpu.storage::<u32>("solver.cell_end", nodes)?,
            block_info: gpu.storage::<[u32; 2]>("solver.block_info", spread)?,
            block_start: gpu.storage::<u32>("solver.block_start", stored)?,
            chunk_sums: gpu.storage::<[u32; 4]>("solver.chunk_sums", chunks)?,
            active_blocks: gpu.storage::<u32>("solver.active_blocks", stored)?,
            items: gpu.storage::<[u32; 4]>("solver.items", stored + particles / TILE_LANES as usize + 2)?,
            active_groups: gpu.storage::<[u32; 4]>("solver.active_groups", 2)?,
            liquid: if kind.wet { Some(LiquidFields::new(gpu, nodes)?) } else { None },
            gains: if kind.evens { Some(gpu.storage::<[i32; 2]>("solver.gains", nodes)?) } else { None },
            meeting: if kind.meets { Some(MeetingBuffers::new(gpu, nodes)?) } else { None },
        })
    }

    /// What a segment that went wrong may have left behind.
    pub fn dirty(&self) -> impl Iterator<Item = &wgpu::Buffer> {
        [&self.sums, &self.marks, &self.cell_count, &self.block_info]
            .into_iter()
            .chain(self.liquid.as_ref().map(|l| &l.fill))
            .chain(self.meeting.as_ref().map(|m| &m.nears))
    }
}

impl MeetingBuffers {
    fn new(gpu: &Gpu, nodes: usize) -> Result<MeetingBuffers, SolverError> {
        Ok(MeetingBuffers {
            nears: gpu.storage::<Near>("solver.rigid.nears", nodes)?,
            meetings: gpu.storage::<Meeting>("solver.rigid.meetings", nodes)?,
        })
    }
}

/// `Params` of `shaders/solver/common.wgsl`, with the map of a window of so many blocks.
pub(super) fn params_buffer(gpu: &Gpu, params: &Params, spread: usize) -> Result<wgpu::Buffer, SolverError> {
    // WGSL rounds a structure up to a multiple of 16 bytes.
    let buffer = gpu.storage_bytes("solver.params", (size_of::<Params>() + spread.max(4) * size_of::<u32>()) as u64)?;
    gpu.upload(&buffer, &[*params]);
    Ok(buffer)
}

impl Solver {
    /// What the scene asks of its grid now.
    pub(super) fn grid_kind(&self) -> GridKind {
        GridKind { layers: self.params.layers, wet: self.liquid.is_some(), meets: self.rigid.is_some() && self.soft, evens: self.volume.is_some() }
    }

    /// Blocks that a window may have, all layers together.
    pub(super) fn spread_most(&self) -> u64 {
        allowed_spread(&self.gpu)
    }

    /// Makes the window hold stencils from `low` to `high` with room around them.
    pub(super) fn fit_window(&mut self, low: IVec3, high: IVec3, margin: i32) -> Result<(), SolverError> {
        if self.window.is_some_and(|w| w.holds(low, high, margin)) {
            return Ok(());
        }
        let (lowest, highest) = (low.as_i64vec3().min_element(), high.as_i64vec3().max_element());
        let most = if self.soft { LATTICE_MOST } else { BODIES_MOST };
        if lowest.abs().max(highest.abs()) + i64::from(margin) > i64::from(most) {
            return Err(SolverError::TooFar { cell_m: self.settings.cell_m, allowed_m: most as f32 * self.settings.cell_m });
        }
        // Some more room than is needed now, so that a window lasts many frames; where that does not
        // fit, what is needed.
        let (allowed, layers) = (allowed_spread(&self.gpu), u64::from(self.params.layers));
        let roomy = Window::around(low, high, 2 * margin + 4);
        let window = if roomy.block_count() * layers <= allowed { roomy } else { Window::around(low, high, margin) };
        let spread = window.block_count() * layers;
        if spread > allowed {
            return Err(self.too_wide(window, spread, allowed));
        }
        self.params.origin = window.origin.into();
        self.params.blocks = window.blocks.into();
        self.window = Some(window);
        if self.grid.as_ref().is_none_or(|g| g.spread < spread as usize) {
            let capacity = self.grid.as_ref().map(|g| g.capacity);
            self.new_grid(capacity.unwrap_or(0), (spread + spread / 4).min(allowed) as usize)?;
            if capacity.is_none() && self.soft {
                let blocks = self.count_blocks()?;
                self.make_room(blocks, 0)?;
            }
        }
        Ok(())
    }

    /// Makes room for so many blocks, and some more to come, where there is none yet; for `spare` more where the device has it.
    pub(super) fn make_room(&mut self, blocks: usize, spare: usize) -> Result<(), SolverError> {
        let Some((capacity, spread)) = self.grid.as_ref().map(|g| (g.capacity, g.spread)) else { return Ok(()) };
        let allowed = allowed_blocks(&self.gpu, self.grid_kind());
        let blocks = blocks.max((blocks + spare).min(allowed as usize));
        if blocks <= capacity {
            return Ok(());
        }
        if let (Some(window), true) = (self.window, blocks as u64 > allowed) {
            return Err(self.too_wide(window, blocks as u64, allowed));
        }
        self.new_grid((blocks + blocks / 2 + 64).min(allowed as usize), spread)
    }

    pub(super) fn new_grid(&mut self, capacity: usize, spread: usize) -> Result<(), SolverError> {
        // The old one goes first, so that both need not fit.
        self.grid = None;
        self.grid = Some(GridBuffers::new(&self.gpu, self.params.count as usize, capacity, spread, self.grid_kind())?);
        self.params_buffer = params_buffer(&self.gpu, &self.params, spread)?;
        Ok(())
    }

    /// Blocks that the particles may reach from where they are.
    fn count_blocks(&mut self) -> Result<usize, SolverError> {
        self.start_segment();
        let bound = self.bind_both()?;
        let mut recording = Recording::default();
        self.record_blocks(&bound[self.current], &mut recording);
        self.gpu.submit(&recording);
        Ok(self.gpu.read::<Control>(&self.control, 1)?[0].watch().blocks)
    }

    fn too_wide(&self, window: Window, blocks: u64, allowed: u64) -> SolverError {
        let (cell_m, extent) = (self.settings.cell_m, (window.blocks * 4).as_vec3());
        SolverError::TooWide { extent_m: (extent * cell_m).into(), cell_m, nodes: blocks * 64, allowed: allowed * 64 }
    }
}
