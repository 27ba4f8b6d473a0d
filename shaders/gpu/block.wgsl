// A workgroup owns a block of ELEMENTS_A_THREAD * WORKGROUP consecutive elements. Each subgroup owns a
// consecutive run of it and walks the run in rounds of one element a lane, so that loads coalesce and
// (subgroup, round, lane) is the elements' own order. No subgroup size is assumed: SUBGROUPS is the
// most that fit for the smallest one the adapter has.

struct Lane {
    subgroup: u32,   // which subgroup of the workgroup
    subgroups: u32,  // how many there are
    lane: u32,       // which lane of it
    lanes: u32,      // how many there are
}

// Index of a lane's element of one round.
fn element(block: u32, at: Lane, round: u32) -> u32 {
    let start = block * (WORKGROUP * ELEMENTS_A_THREAD) + at.subgroup * at.lanes * ELEMENTS_A_THREAD;
    return start + round * at.lanes + at.lane;
}

var<workgroup> subgroup_totals: array<u32, SUBGROUPS>;

// (sum of the values of all earlier threads, sum of all values), threads ordered by (subgroup, lane).
fn workgroup_exclusive(value: u32, at: Lane) -> vec2<u32> {
    let before = subgroupExclusiveAdd(value);
    let total = subgroupAdd(value);
    if (at.lane == 0u) { subgroup_totals[at.subgroup] = total; }
    workgroupBarrier();
    var base = 0u;
    var all = 0u;
    for (var s = 0u; s < at.subgroups; s++) {
        let t = subgroup_totals[s];
        base += select(0u, t, s < at.subgroup);
        all += t;
    }
    workgroupBarrier();
    return vec2<u32>(base + before, all);
}
