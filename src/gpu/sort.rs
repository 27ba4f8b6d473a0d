//! Stable radix sort of u32 keys with u32 values on the device.
//!
//! Reduce-then-scan over digits of at most 8 bits (Merrill and Grimshaw 2011): count the digits of each
//! block, prefix the counts, scatter. No block waits for another. On a GPU a key's rank within its
//! subgroup comes from ballots, one a bit; on a CPU one invocation walks a block alone.

use super::extent::Blocks;
use super::{Access, Constant, Extent, Gpu, GpuError, Kernel, KernelSource, Recording, Tier};
use std::collections::BTreeSet;
use std::sync::OnceLock;

const BLOCK: (&str, &str) = ("gpu/block.wgsl", include_str!("../../shaders/gpu/block.wgsl"));
const SERIAL: (&str, &str) = ("gpu/sort_serial.wgsl", include_str!("../../shaders/gpu/sort_serial.wgsl"));

/// Widest digit, in bits.
const DIGIT_BITS_MAX: u32 = 8;

/// The passes of one digit width.
#[derive(Debug)]
struct Digit {
    count: Kernel,
    rows: Kernel,
    scatter: Kernel,
}

/// The sort; its passes are compiled when a digit width is first needed.
#[derive(Debug)]
pub struct RadixSort {
    tier: Tier,
    /// How keys are cut into blocks.
    pub blocks: Blocks,
    digits: [OnceLock<Digit>; DIGIT_BITS_MAX as usize + 1],
}

/// Keys and values, twice each, and what the passes keep between them.
#[derive(Clone, Debug)]
pub struct SortBuffers {
    /// Unsorted in the first; see [`SortPlan::sorted`].
    pub keys: [wgpu::Buffer; 2],
    /// Beside the keys.
    pub values: [wgpu::Buffer; 2],
    histogram: wgpu::Buffer,
    totals: wgpu::Buffer,
}

/// A sort recorded: the steps, and which of the two buffers holds the result.
#[derive(Clone, Debug)]
pub struct SortPlan {
    /// The passes.
    pub recording: Recording,
    /// Index of the buffers that hold the sorted keys and values.
    pub sorted: usize,
}

impl RadixSort {
    /// The form for this device.
    pub fn new(gpu: &Gpu) -> RadixSort {
        RadixSort::with_tier(gpu, gpu.tier)
    }

    /// A given form, so that tests can run both on one device.
    pub fn with_tier(gpu: &Gpu, tier: Tier) -> RadixSort {
        RadixSort { tier, blocks: Blocks::of(tier, gpu.subgroup_lanes), digits: Default::default() }
    }

    /// Room for up to `capacity` keys.
    pub fn buffers(&self, gpu: &Gpu, label: &str, capacity: u32) -> Result<SortBuffers, GpuError> {
        let keys = || gpu.storage::<u32>(label, capacity as usize);
        let histogram = (self.blocks.count(capacity).max(1) as usize) << DIGIT_BITS_MAX;
        Ok(SortBuffers {
            keys: [keys()?, keys()?],
            values: [keys()?, keys()?],
            histogram: gpu.storage::<u32>(label, histogram)?,
            totals: gpu.storage::<u32>(label, 1 << DIGIT_BITS_MAX)?,
        })
    }

    /// Compiles what sorts keys of so many bits.
    pub fn prepare(&self, gpu: &Gpu, bits: u32) {
        let widths: BTreeSet<u32> = digit_widths(bits).collect();
        let sources: Vec<KernelSource> = widths.into_iter().flat_map(|width| sources(&self.blocks, self.tier, width)).collect();
        gpu.prepare(&sources);
    }

    /// Sorts the first `extent` pairs by the lowest `bits` bits of their keys, equal keys in the order
    /// they came.
    pub fn plan(&self, gpu: &Gpu, buffers: &SortBuffers, extent: &Extent, bits: u32) -> SortPlan {
        let mut recording = Recording::default();
        let (mut shift, mut from) = (0u32, 0);
        for width in digit_widths(bits) {
            self.record_digit(gpu, &mut recording, buffers, extent, from, width, shift);
            (shift, from) = (shift + width, 1 - from);
        }
        SortPlan { recording, sorted: from }
    }

    #[expect(clippy::too_many_arguments, reason = "one digit's pass is named by all of them")]
    fn record_digit(&self, gpu: &Gpu, recording: &mut Recording, buffers: &SortBuffers, extent: &Extent, from: usize, width: u32, shift: u32) {
        let digit = self.digits[width as usize].get_or_init(|| {
            let [count, rows, scatter] = sources(&self.blocks, self.tier, width);
            Digit { count: gpu.kernel(&count), rows: gpu.kernel(&rows), scatter: gpu.kernel(&scatter) }
        });
        let (histogram, totals) = (&buffers.histogram, &buffers.totals);
        let (keys, values) = (&buffers.keys, &buffers.values);
        let all: [&wgpu::Buffer; 7] = [&extent.buffer, &keys[from], &values[from], histogram, totals, &keys[1 - from], &values[1 - from]];
        let bind = |kernel: &Kernel, split: &[&wgpu::Buffer]| match self.tier {
            Tier::Gpu => gpu.bind(kernel, split),
            Tier::Cpu => gpu.bind(kernel, &all),
        };
        let count = bind(&digit.count, &[&extent.buffer, &keys[from], histogram]);
        let rows = bind(&digit.rows, &[&extent.buffer, histogram, totals]);
        let scatter = bind(&digit.scatter, &all);
        let row_groups = match self.tier {
            Tier::Gpu => 1 << width,
            Tier::Cpu => (1u32 << width).div_ceil(self.blocks.workgroup),
        };
        recording.indirect_with(&digit.count, &count, &shift, &extent.buffer, Extent::BLOCKS_AT);
        recording.dispatch_with(&digit.rows, &rows, &shift, [row_groups, 1, 1]);
        recording.indirect_with(&digit.scatter, &scatter, &shift, &extent.buffer, Extent::BLOCKS_AT);
    }
}

/// As few digits as fit, as even as they can be.
fn digit_widths(bits: u32) -> impl Iterator<Item = u32> {
    let passes = bits.div_ceil(DIGIT_BITS_MAX).max(1);
    (0..passes).map(move |p| (bits.max(1) + passes - 1 - p) / passes)
}

/// Count, rows, scatter of one digit width.
pub(super) fn sources(blocks: &Blocks, tier: Tier, width: u32) -> [KernelSource; 3] {
    let (r, w) = (Access::Read, Access::Write);
    let constants = || {
        let mut constants = blocks.constants();
        constants.extend([("DIGIT_BITS", Constant::U32(width)), ("DIGITS", Constant::U32(1 << width)), ("WIDE", Constant::Bool(blocks.wide))]);
        constants
    };
    let whole = |label, parts: &[(&'static str, &'static str)], bindings: &[Access], immediate_bytes| KernelSource {
        label,
        entry: "main",
        parts: parts.to_vec(),
        constants: constants(),
        bindings: bindings.to_vec(),
        immediate_bytes,
    };
    let serial = |label, entry| KernelSource {
        label,
        entry,
        parts: vec![SERIAL],
        constants: constants(),
        bindings: vec![r, r, r, w, w, w, w],
        immediate_bytes: 4,
    };
    match tier {
        Tier::Gpu => [
            whole("gpu.sort_count", &[("gpu/sort_count.wgsl", include_str!("../../shaders/gpu/sort_count.wgsl"))], &[r, r, w], 4),
            whole("gpu.sort_rows", &[BLOCK, ("gpu/sort_rows.wgsl", include_str!("../../shaders/gpu/sort_rows.wgsl"))], &[r, w, w], 4),
            whole(
                "gpu.sort_scatter",
                &[BLOCK, ("gpu/sort_scatter.wgsl", include_str!("../../shaders/gpu/sort_scatter.wgsl"))],
                &[r, r, r, r, r, w, w],
                4,
            ),
        ],
        Tier::Cpu => [serial("gpu.sort_count", "count"), serial("gpu.sort_rows", "rows"), serial("gpu.sort_scatter", "scatter")],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{ExtentPass, twin};
    use proptest::prelude::*;

    fn run(gpu: &Gpu, sort: &RadixSort, keys: &[u32], bits: u32) -> (Vec<u32>, Vec<u32>) {
        let n = keys.len() as u32;
        let buffers = sort.buffers(gpu, "test.sort", n).unwrap();
        let extent = Extent::known(gpu, "test.extent", n, &sort.blocks).unwrap();
        gpu.upload(&buffers.keys[0], keys);
        gpu.upload(&buffers.values[0], &(0..n).collect::<Vec<_>>());
        let plan = sort.plan(gpu, &buffers, &extent, bits);
        gpu.submit(&plan.recording);
        let read = |buffer| gpu.read(buffer, keys.len()).unwrap();
        (read(&buffers.keys[plan.sorted]), read(&buffers.values[plan.sorted]))
    }

    fn hashed(n: u32, bits: u32) -> Vec<u32> {
        (0..n).map(|i| (i ^ 0x9e37).wrapping_mul(2_654_435_761).rotate_left(13).wrapping_mul(2_246_822_519) >> (32 - bits)).collect()
    }

    #[test]
    fn both_forms_sort_stably_at_awkward_counts() {
        let gpu = Gpu::shared_for_tests().unwrap();
        let sorts = [Tier::Gpu, Tier::Cpu].map(|tier| RadixSort::with_tier(&gpu, tier));
        for n in [0, 1, 255, 256, 257, 4095, 65_537] {
            for bits in [1, 5, 11, 24, 32] {
                let keys = hashed(n, bits);
                let expected = twin::sort(&keys, bits);
                for sort in &sorts {
                    assert!(run(&gpu, sort, &keys, bits) == expected, "{:?} form, n = {n}, {bits} bits", sort.tier);
                }
            }
        }
    }

    #[test]
    fn ballots_of_more_than_one_word_agree_too() {
        let gpu = Gpu::shared_for_tests().unwrap();
        let wide = Gpu { subgroup_lanes: (gpu.subgroup_lanes.0, 128), ..gpu.clone() };
        let keys = hashed(3000, 20);
        assert!(run(&gpu, &RadixSort::with_tier(&wide, Tier::Gpu), &keys, 20) == twin::sort(&keys, 20));
    }

    #[test]
    fn equal_keys_keep_their_order() {
        let gpu = Gpu::shared_for_tests().unwrap();
        for tier in [Tier::Gpu, Tier::Cpu] {
            let (_, values) = run(&gpu, &RadixSort::with_tier(&gpu, tier), &[3; 5000], 8);
            assert!(values.iter().copied().eq(0..5000), "{tier:?}");
        }
    }

    #[test]
    fn the_count_may_come_from_the_device_and_is_clamped() {
        let gpu = Gpu::shared_for_tests().unwrap();
        for tier in [Tier::Gpu, Tier::Cpu] {
            let sort = RadixSort::with_tier(&gpu, tier);
            let keys = hashed(1000, 12);
            let buffers = sort.buffers(&gpu, "test.sort", 1000).unwrap();
            gpu.upload(&buffers.keys[0], &keys);
            gpu.upload(&buffers.values[0], &(0..1000).collect::<Vec<u32>>());
            let extent = Extent::empty(&gpu, "test.extent").unwrap();
            let count = gpu.storage_from("test.count", &[0u32, 0, 5000]).unwrap();
            let mut recording = Recording::default();
            ExtentPass::new(&gpu, &sort.blocks).record(&gpu, &mut recording, &count, 2, 700, &extent);
            let plan = sort.plan(&gpu, &buffers, &extent, 12);
            recording.extend(&plan.recording);
            gpu.submit(&recording);
            let sorted: Vec<u32> = gpu.read(&buffers.values[plan.sorted], 700).unwrap();
            assert_eq!(sorted, twin::sort(&keys[..700], 12).1);
            assert_eq!(gpu.read::<u32>(&extent.buffer, 2).unwrap(), [700, 5000], "clamped, and what was wanted");
        }
    }

    #[test]
    fn digits_are_even_and_cover_all_bits() {
        for bits in 1..=32 {
            let widths: Vec<u32> = digit_widths(bits).collect();
            assert_eq!(widths.iter().sum::<u32>(), bits);
            assert!(widths.iter().all(|&w| (1..=8).contains(&w)));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn any_keys(keys in proptest::collection::vec(any::<u32>(), 0..3000)) {
            let gpu = Gpu::shared_for_tests().unwrap();
            let expected = twin::sort(&keys, 32);
            for tier in [Tier::Gpu, Tier::Cpu] {
                prop_assert!(run(&gpu, &RadixSort::with_tier(&gpu, tier), &keys, 32) == expected);
            }
        }
    }
}
