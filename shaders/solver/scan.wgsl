// Sums over one workgroup. Of whole numbers: no order matters.

// Sums of the subgroups.
var<workgroup> parts: array<vec3<u32>, SCAN_LANES>;

// Where a thread is in its workgroup and in its subgroup.
struct Place {
    lane: u32,
    // Which subgroup, and how many there are.
    subgroup: u32,
    subgroups: u32,
    sublane: u32,
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
