// Sums over one workgroup. Of whole numbers: no order matters.

// Sums of the subgroups.
var<workgroup> parts: array<vec3<u32>, SCAN_LANES>;

// Where a thread is: which subgroup of how many, and its place in that.
struct Place {
    @builtin(subgroup_id) subgroup: u32,
    @builtin(num_subgroups) subgroups: u32,
    @builtin(subgroup_invocation_id) sublane: u32,
    @builtin(subgroup_size) lanes: u32,
}

// Its place in the workgroup, such that those of a subgroup follow each other.
fn lane_of(at: Place) -> u32 {
    return at.subgroup * at.lanes + at.sublane;
}

struct Scanned {
    before: vec3<u32>,
    total: vec3<u32>,
}

// Exclusive prefix sum in the order of the lanes.
fn scan(at: Place, value: vec3<u32>) -> Scanned {
    let within = subgroupExclusiveAdd(value);
    let all = subgroupAdd(value);
    if (at.sublane == 0u) {
        parts[at.subgroup] = all;
    }
    workgroupBarrier();
    var before = within;
    var total = vec3<u32>(0u);
    for (var k = 0u; k < at.subgroups; k++) {
        before += select(vec3<u32>(0u), parts[k], k < at.subgroup);
        total += parts[k];
    }
    workgroupBarrier();
    return Scanned(before, total);
}
