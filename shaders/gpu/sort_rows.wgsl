// Radix sort, second pass of a digit: one workgroup a digit value turns its row of counts into
// exclusive prefixes over the blocks, and keeps the row's total.

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read_write> histogram: array<u32>;
@group(0) @binding(2) var<storage, read_write> totals: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(subgroup_id) subgroup: u32, @builtin(num_subgroups) subgroups: u32,
    @builtin(subgroup_invocation_id) lane: u32, @builtin(subgroup_size) lanes: u32,
) {
    let at = Lane(subgroup, subgroups, lane, lanes);
    let block_size = WORKGROUP * ELEMENTS_A_THREAD;
    let blocks = (extent[0] + block_size - 1u) / block_size;
    let row = group.x * blocks;
    var carry = 0u;
    for (var start = 0u; start < blocks; start += WORKGROUP) {
        let block = start + subgroup * lanes + lane;
        var count = 0u;
        if (block < blocks) { count = histogram[row + block]; }
        let scanned = workgroup_exclusive(count, at);
        if (block < blocks) { histogram[row + block] = carry + scanned.x; }
        carry += scanned.y;
    }
    if (subgroup == 0u && lane == 0u) { totals[group.x] = carry; }
}
