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
}

/// Bytes of all buffers for one node, and for it in each layer.
const NODE_BYTES: u64 = 12;
const LAYER_BYTES: u64 = 44;
/// A software adapter shares the machine's memory and is slow over much of it.
const CPU_GRID_BYTES: u64 = 768 << 20;
/// Room for other programs and for the picture is left on a GPU.
const GPU_GRID_BYTES: u64 = 6 << 30;

/// Blocks that the device holds in so many layers.
pub(super) fn allowed_blocks(gpu: &Gpu, layers: u32, wet: bool) -> u64 {
    let layers = u64::from(layers);
    let limits = gpu.device.limits();
    let widest = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let bytes = match gpu.tier {
        Tier::Cpu => CPU_GRID_BYTES,
        Tier::Gpu => GPU_GRID_BYTES,
    };
    let node_bytes = NODE_BYTES + LAYER_BYTES * layers + if wet { LiquidFields::NODE_BYTES } else { 0 };
    (widest / 16 / layers).min(bytes / node_bytes) / 64
}

impl GridBuffers {
    pub fn new(gpu: &Gpu, blocks: u64, layers: u32, wet: bool) -> Result<GridBuffers, SolverError> {
        let nodes = blocks as usize * 64;
        let layered = nodes * layers as usize;
        let chunks = blocks.div_ceil(u64::from(SCAN_LANES * SCAN_RUN)) as usize;
        Ok(GridBuffers {
            capacity: blocks,
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
        })
    }

    /// What a segment that went wrong may have left behind.
    pub fn dirty(&self) -> impl Iterator<Item = &wgpu::Buffer> {
        [&self.sums, &self.marks, &self.cell_count, &self.block_info].into_iter().chain(self.liquid.as_ref().map(|l| &l.fill))
    }
}
