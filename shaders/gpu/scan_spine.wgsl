// Prefix sum, second pass: block sums become block starts, the grand total goes to sums[0] and
// behind the prefixes.

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read_write> sums: array<u32>;
@group(0) @binding(2) var<storage, read_write> prefix: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(subgroup_id) subgroup: u32, @builtin(num_subgroups) subgroups: u32,
    @builtin(subgroup_invocation_id) lane: u32, @builtin(subgroup_size) lanes: u32,
) {
    let at = Lane(subgroup, subgroups, lane, lanes);
    let n = extent[0];
    let blocks = (n + WORKGROUP * ELEMENTS_A_THREAD - 1u) / (WORKGROUP * ELEMENTS_A_THREAD);
    var carry = 0u;
    for (var start = 0u; start < blocks; start += WORKGROUP) {
        let block = start + subgroup * lanes + lane;
        var sum = 0u;
        if (block < blocks) { sum = sums[1u + block]; }
        let scanned = workgroup_exclusive(sum, at);
        if (block < blocks) { sums[1u + block] = carry + scanned.x; }
        carry += scanned.y;
    }
    if (subgroup == 0u && lane == 0u) {
        prefix[n] = carry;
        sums[0] = carry;
    }
}
