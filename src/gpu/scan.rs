//! Exclusive prefix sums of u32 on the device: reduce, scan the block sums, sweep.
//!
//! No block waits for another, so no forward progress is assumed. Two forms, chosen by tier: whole
//! workgroups with subgroup sums on a GPU, one invocation a block without barriers on a CPU.

use super::extent::Blocks;
use super::{Access, Extent, Gpu, GpuError, Kernel, KernelSource, Recording, Tier};

const BLOCK: (&str, &str) = ("gpu/block.wgsl", include_str!("../../shaders/gpu/block.wgsl"));
const SERIAL: (&str, &str) = ("gpu/scan_serial.wgsl", include_str!("../../shaders/gpu/scan_serial.wgsl"));

/// The compiled passes of a prefix sum.
#[derive(Clone, Debug)]
pub struct Scan {
    tier: Tier,
    /// How elements are cut into blocks.
    pub blocks: Blocks,
    reduce: Kernel,
    spine: Kernel,
    sweep: Kernel,
}

impl Scan {
    /// The form for this device.
    pub fn new(gpu: &Gpu) -> Scan {
        Scan::with_tier(gpu, gpu.tier)
    }

    /// A given form, so that tests can run both on one device.
    pub fn with_tier(gpu: &Gpu, tier: Tier) -> Scan {
        let blocks = Blocks::of(tier, gpu.subgroup_lanes);
        let [reduce, spine, sweep] = sources(&blocks, tier);
        Scan { tier, blocks, reduce: gpu.kernel(&reduce), spine: gpu.kernel(&spine), sweep: gpu.kernel(&sweep) }
    }

    /// Room for the total and the block sums of up to `capacity` elements.
    pub fn sums(&self, gpu: &Gpu, label: &str, capacity: u32) -> Result<wgpu::Buffer, GpuError> {
        gpu.storage::<u32>(label, self.blocks.count(capacity) as usize + 1)
    }

    /// Writes `prefix[i] = values[0] + .. + values[i - 1]` for i in 0..=n: the total comes last, so
    /// `prefix` holds one element more than `values`. The total is in `sums[0]` too, where an
    /// [`super::ExtentPass`] finds it without knowing n.
    pub fn record(&self, gpu: &Gpu, recording: &mut Recording, extent: &Extent, values: &wgpu::Buffer, sums: &wgpu::Buffer, prefix: &wgpu::Buffer) {
        let bind = |kernel: &Kernel, split: &[&wgpu::Buffer]| match self.tier {
            Tier::Gpu => gpu.bind(kernel, split),
            Tier::Cpu => gpu.bind(kernel, &[&extent.buffer, values, sums, prefix]),
        };
        let reduce = bind(&self.reduce, &[&extent.buffer, values, sums]);
        let spine = bind(&self.spine, &[&extent.buffer, sums, prefix]);
        let sweep = bind(&self.sweep, &[&extent.buffer, values, sums, prefix]);
        recording.indirect(&self.reduce, &reduce, &extent.buffer, Extent::BLOCKS_AT);
        recording.dispatch(&self.spine, &spine, [1, 1, 1]);
        recording.indirect(&self.sweep, &sweep, &extent.buffer, Extent::BLOCKS_AT);
    }
}

/// Reduce, spine, sweep.
pub(super) fn sources(blocks: &Blocks, tier: Tier) -> [KernelSource; 3] {
    let (r, w) = (Access::Read, Access::Write);
    let whole = |label, text, bindings: &[Access]| KernelSource {
        label,
        entry: "main",
        parts: vec![BLOCK, text],
        constants: blocks.constants(),
        bindings: bindings.to_vec(),
        immediate_bytes: 0,
    };
    let serial = |label, entry| KernelSource {
        label,
        entry,
        parts: vec![SERIAL],
        constants: blocks.constants(),
        bindings: vec![r, r, w, w],
        immediate_bytes: 0,
    };
    match tier {
        Tier::Gpu => [
            whole("gpu.scan_reduce", ("gpu/scan_reduce.wgsl", include_str!("../../shaders/gpu/scan_reduce.wgsl")), &[r, r, w]),
            whole("gpu.scan_spine", ("gpu/scan_spine.wgsl", include_str!("../../shaders/gpu/scan_spine.wgsl")), &[r, w, w]),
            whole("gpu.scan_sweep", ("gpu/scan_sweep.wgsl", include_str!("../../shaders/gpu/scan_sweep.wgsl")), &[r, r, r, w]),
        ],
        Tier::Cpu => [serial("gpu.scan_reduce", "reduce"), serial("gpu.scan_spine", "spine"), serial("gpu.scan_sweep", "sweep")],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::twin;

    fn run(gpu: &Gpu, tier: Tier, values: &[u32]) -> Vec<u32> {
        let n = values.len() as u32;
        let scan = Scan::with_tier(gpu, tier);
        let extent = Extent::known(gpu, "test.extent", n, &scan.blocks).unwrap();
        let input = gpu.storage_from("test.values", values).unwrap();
        let sums = scan.sums(gpu, "test.sums", n).unwrap();
        let prefix = gpu.storage::<u32>("test.prefix", values.len() + 1).unwrap();
        let mut recording = Recording::default();
        scan.record(gpu, &mut recording, &extent, &input, &sums, &prefix);
        gpu.submit(&recording);
        let prefix = gpu.read(&prefix, values.len() + 1).unwrap();
        assert_eq!(gpu.read::<u32>(&sums, 1).unwrap()[0], prefix[values.len()]);
        prefix
    }

    #[test]
    fn both_forms_equal_the_twin() {
        let gpu = Gpu::shared_for_tests().unwrap();
        for n in [0u32, 1, 7, 8, 255, 256, 257, 511, 513, 4097, 65_537, 150_000] {
            let values: Vec<u32> = (0..n).map(|i| i.wrapping_mul(2_654_435_761) >> 20).collect();
            let expected = twin::scan(&values);
            assert!(run(&gpu, Tier::Gpu, &values) == expected, "GPU form, n = {n}");
            assert!(run(&gpu, Tier::Cpu, &values) == expected, "CPU form, n = {n}");
        }
    }
}
