//! The window of the lattice that is stored, and the buffers over it.

use super::constants::{SCAN_LANES, SCAN_RUN};
use super::liquid::LiquidFields;
use super::types::SolverError;
use crate::gpu::{Gpu, Tier};
use glam::{IVec3, UVec3};

/// A box of 4^3 blocks of an endless lattice whose nodes stand at integer multiples of the cell size.
/// Where it lies decides only what is stored: no sum depends on it.
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

/// Buffers over the window's nodes and blocks. All but `velocity`, `masses` and the liquids' fields hold zeros between segments.
#[derive(Clone, Debug)]
pub(super) struct GridBuffers {
    /// Blocks that there is room for.
    pub capacity: u64,
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
    pub active_groups: wgpu::Buffer,
    /// Of liquids, where there are any.
    pub liquid: Option<LiquidFields>,
    /// What rigid bodies and soft matter share, where there are both.
    pub meeting: Option<MeetingBuffers>,
}

/// See `shaders/solver/rigid_meeting.wgsl`.
#[derive(Clone, Debug)]
pub(super) struct MeetingBuffers {
    pub nears: wgpu::Buffer,
    pub meetings: wgpu::Buffer,
}

/// Bytes of all buffers for one node, for it in each layer, and there with rigid bodies.
const NODE_BYTES: u64 = 12;
const LAYER_BYTES: u64 = 44;
const MEETING_BYTES: u64 = 76;
/// A software adapter shares the machine's memory and is slow over much of it.
const CPU_GRID_BYTES: u64 = 768 << 20;
/// Room for other programs and for the picture is left on a GPU.
const GPU_GRID_BYTES: u64 = 6 << 30;

/// What a scene asks of its grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GridKind {
    /// How many groups of objects have velocities of their own.
    pub layers: u32,
    /// Whether there are liquids on it.
    pub wet: bool,
    /// Whether soft matter meets rigid bodies.
    pub meets: bool,
}

/// Blocks that the device holds.
pub(super) fn allowed_blocks(gpu: &Gpu, kind: GridKind) -> u64 {
    let layers = u64::from(kind.layers);
    let limits = gpu.device.limits();
    let widest = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let bytes = match gpu.tier {
        Tier::Cpu => CPU_GRID_BYTES,
        Tier::Gpu => GPU_GRID_BYTES,
    };
    let layer_bytes = LAYER_BYTES + if kind.meets { MEETING_BYTES } else { 0 };
    let node_bytes = NODE_BYTES + layer_bytes * layers + if kind.wet { LiquidFields::NODE_BYTES } else { 0 };
    (widest / if kind.meets { 64 } else { 16 } / layers).min(bytes / node_bytes) / 64
}

impl GridBuffers {
    pub fn new(gpu: &Gpu, blocks: u64, kind: GridKind) -> Result<GridBuffers, SolverError> {
        let (layers, wet) = (kind.layers, kind.wet);
        let nodes = blocks as usize * 64;
        let layered = nodes * layers as usize;
        let chunks = blocks.div_ceil(u64::from(SCAN_LANES * SCAN_RUN)) as usize;
        Ok(GridBuffers {
            capacity: blocks,
            kind,
            sums: gpu.storage::<[i32; 4]>("solver.sums", layered)?,
            marks: gpu.storage::<[u32; 2]>("solver.marks", layered)?,
            velocity: gpu.storage::<[f32; 4]>("solver.velocity", layered)?,
            masses: gpu.storage::<f32>("solver.masses", if layers > 1 { layered } else { 1 })?,
            cell_count: gpu.storage::<u32>("solver.cell_count", nodes)?,
            cell_start: gpu.storage::<u32>("solver.cell_start", nodes)?,
            cell_end: gpu.storage::<u32>("solver.cell_end", nodes)?,
            block_info: gpu.storage::<[u32; 2]>("solver.block_info", blocks as usize)?,
            block_start: gpu.storage::<u32>("solver.block_start", blocks as usize)?,
            chunk_sums: gpu.storage::<[u32; 2]>("solver.chunk_sums", chunks)?,
            active_blocks: gpu.storage::<u32>("solver.active_blocks", blocks as usize + 1)?,
            active_groups: gpu.storage::<u32>("solver.active_groups", 4)?,
            liquid: if wet { Some(LiquidFields::new(gpu, nodes)?) } else { None },
            meeting: if kind.meets { Some(MeetingBuffers::new(gpu, layered)?) } else { None },
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
            nears: gpu.storage::<[u32; 3]>("solver.rigid.nears", nodes)?,
            meetings: gpu.storage::<[f32; 16]>("solver.rigid.meetings", nodes)?,
        })
    }
}
