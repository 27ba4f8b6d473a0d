// Prefix sum, first pass: the sum of each block, in sums[1 + block].

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read> values: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<u32>;

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
    let total = workgroup_exclusive(sum, at).y;
    if (subgroup == 0u && lane == 0u && block * WORKGROUP * ELEMENTS_A_THREAD < n) { sums[1u + block] = total; }
}
