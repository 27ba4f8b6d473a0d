// Prefix sum, last pass: the exclusive prefix of each element, from its block's start.

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read> values: array<u32>;
@group(0) @binding(2) var<storage, read> sums: array<u32>;
@group(0) @binding(3) var<storage, read_write> prefix: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(subgroup_id) subgroup: u32, @builtin(num_subgroups) subgroups: u32,
    @builtin(subgroup_invocation_id) lane: u32, @builtin(subgroup_size) lanes: u32,
) {
    let at = Lane(subgroup, subgroups, lane, lanes);
    let n = extent[0];
    let block = group.y * groups.x + group.x;
    var sum = 0u;
    for (var round = 0u; round < ELEMENTS_A_THREAD; round++) {
        let i = element(block, at, round);
        if (i < n) { sum += values[i]; }
    }
    // The run of this subgroup starts after the runs of the earlier ones: lane 0's exclusive prefix.
    let run_start = subgroupBroadcastFirst(workgroup_exclusive(sum, at).x);
    if (block * WORKGROUP * ELEMENTS_A_THREAD >= n) { return; }
    var carry = sums[1u + block] + run_start;
    for (var round = 0u; round < ELEMENTS_A_THREAD; round++) {
        let i = element(block, at, round);
        var value = 0u;
        if (i < n) { value = values[i]; }
        let before = subgroupExclusiveAdd(value);
        if (i < n) { prefix[i] = carry + before; }
        carry += subgroupAdd(value);
    }
}
