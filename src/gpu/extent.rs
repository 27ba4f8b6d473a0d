//! How many elements a chain of passes works on, when only the device knows.

use super::{Access, Constant, Gpu, GpuError, Kernel, KernelSource, Recording, Tier};
use bytemuck::{Pod, Zeroable};

/// Threads of a pass that works on one element a thread.
pub const THREADS: u32 = 256;

/// Groups in x above which a dispatch is folded into y.
const FOLD: u32 = 32768;

/// How the blocks of scan and sort are cut on a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    /// Threads of a workgroup.
    pub workgroup: u32,
    /// Elements each of them owns.
    pub elements_a_thread: u32,
    /// Subgroups of a workgroup at most.
    pub subgroups: u32,
    /// Elements of a block: of a workgroup on a GPU, of one invocation on a CPU.
    pub elements: u32,
    /// Whether a subgroup may have more than 32 lanes.
    pub wide: bool,
}

impl Blocks {
    /// What suits a device whose subgroups have `lanes.0` to `lanes.1` lanes: eight of the smallest and
    /// 16 elements a thread on a GPU; one invocation with 512 elements on a CPU, eight of them a group
    /// so that they fill its vector lanes.
    pub fn of(tier: Tier, lanes: (u32, u32)) -> Blocks {
        match tier {
            Tier::Gpu => {
                let smallest = lanes.0.max(4);
                let workgroup = (8 * smallest).min(256);
                Blocks { workgroup, elements_a_thread: 16, subgroups: workgroup / smallest, elements: workgroup * 16, wide: lanes.1 > 32 }
            }
            Tier::Cpu => Blocks { workgroup: 8, elements_a_thread: 512, subgroups: 1, elements: 512, wide: false },
        }
    }

    /// Elements of a whole workgroup.
    pub fn group_elements(&self) -> u32 {
        self.workgroup * self.elements_a_thread
    }

    /// Blocks that `n` elements take.
    pub fn count(&self, n: u32) -> u32 {
        n.div_ceil(self.elements)
    }

    /// The WGSL constants that scan and sort share.
    pub(super) fn constants(&self) -> Vec<(&'static str, Constant)> {
        vec![
            ("WORKGROUP", Constant::U32(self.workgroup)),
            ("ELEMENTS_A_THREAD", Constant::U32(self.elements_a_thread)),
            ("SUBGROUPS", Constant::U32(self.subgroups)),
        ]
    }
}

/// Workgroups in x, y and z for a number of groups that may pass the limit of x alone.
pub fn fold(groups: u32) -> [u32; 3] {
    let rows = groups.div_ceil(FOLD).max(1);
    [if rows > 1 { FOLD } else { groups }, rows, 1]
}

/// A count on the device and the dispatches that follow from it: eight u32, as `extent.wgsl` says.
#[derive(Clone, Debug)]
pub struct Extent {
    /// `[n, n wanted, groups of one thread an element x 3, groups of one block each x 3]`.
    pub buffer: wgpu::Buffer,
}

impl Extent {
    /// Byte offset of the groups of [`THREADS`] threads, one an element and one more.
    pub const THREADS_AT: u64 = 8;
    /// Byte offset of the groups of one block each.
    pub const BLOCKS_AT: u64 = 20;
    /// Bytes of the whole.
    pub const BYTES: u64 = 32;

    /// An extent of nothing, for an [`ExtentPass`] to fill.
    pub fn empty(gpu: &Gpu, label: &str) -> Result<Extent, GpuError> {
        Ok(Extent { buffer: gpu.storage::<u32>(label, 8)? })
    }

    /// An extent that the host knows.
    pub fn known(gpu: &Gpu, label: &str, n: u32, blocks: &Blocks) -> Result<Extent, GpuError> {
        let extent = Extent::empty(gpu, label)?;
        extent.set(gpu, n, blocks);
        Ok(extent)
    }

    /// Replaces the count from the host, in order with what was submitted before.
    pub fn set(&self, gpu: &Gpu, n: u32, blocks: &Blocks) {
        let threads = fold(n / THREADS + 1);
        let groups = fold(n.div_ceil(blocks.group_elements()));
        gpu.upload(&self.buffer, &[n, n, threads[0], threads[1], threads[2], groups[0], groups[1], groups[2]]);
    }
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Request {
    source: u32,
    capacity: u32,
}

/// The pass that fills an [`Extent`] from a count in a buffer.
#[derive(Clone, Debug)]
pub struct ExtentPass {
    kernel: Kernel,
}

impl ExtentPass {
    /// Compiles the pass for the blocks of one device.
    pub fn new(gpu: &Gpu, blocks: &Blocks) -> ExtentPass {
        ExtentPass { kernel: gpu.kernel(&source(blocks)) }
    }

    /// Takes word `index` of `count`, clamped to `capacity`, and keeps what was wanted beside it.
    pub fn record(&self, gpu: &Gpu, recording: &mut Recording, count: &wgpu::Buffer, index: u32, capacity: u32, extent: &Extent) {
        let bindings = gpu.bind(&self.kernel, &[count, &extent.buffer]);
        recording.dispatch_with(&self.kernel, &bindings, &Request { source: index, capacity }, [1, 1, 1]);
    }
}

pub(super) fn source(blocks: &Blocks) -> KernelSource {
    KernelSource {
        label: "gpu.extent",
        entry: "main",
        parts: vec![("gpu/extent.wgsl", include_str!("../../shaders/gpu/extent.wgsl"))],
        constants: vec![
            ("FOLD", Constant::U32(FOLD)),
            ("THREADS", Constant::U32(THREADS)),
            ("GROUP_ELEMENTS", Constant::U32(blocks.group_elements())),
        ],
        bindings: vec![Access::Read, Access::Write],
        immediate_bytes: size_of::<Request>() as u32,
    }
}
