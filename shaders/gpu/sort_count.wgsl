// Radix sort, first pass of a digit: how often each digit value occurs in each block.
// histogram[value * blocks + block].

var<immediate> shift: u32;

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read_write> histogram: array<u32>;

var<workgroup> tally: array<atomic<u32>, DIGITS>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let block_size = WORKGROUP * ELEMENTS_A_THREAD;
    let n = extent[0];
    let blocks = (n + block_size - 1u) / block_size;
    let block = group.y * groups.x + group.x;
    for (var d = local; d < DIGITS; d += WORKGROUP) { atomicStore(&tally[d], 0u); }
    workgroupBarrier();
    for (var round = 0u; round < ELEMENTS_A_THREAD; round++) {
        let i = block * block_size + round * WORKGROUP + local;
        if (i < n) { atomicAdd(&tally[(keys[i] >> shift) & (DIGITS - 1u)], 1u); }
    }
    workgroupBarrier();
    if (block >= blocks) { return; }
    for (var d = local; d < DIGITS; d += WORKGROUP) { histogram[d * blocks + block] = atomicLoad(&tally[d]); }
}
