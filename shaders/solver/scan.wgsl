// Sums over one workgroup, in a fixed order.

var<workgroup> lanes: array<vec3<u32>, SCAN_LANES>;

struct Scanned {
    before: vec3<u32>,
    total: vec3<u32>,
}

// Exclusive prefix sum.
fn scan(lane: u32, value: vec3<u32>) -> Scanned {
    lanes[lane] = value;
    workgroupBarrier();
    for (var step = 1u; step < SCAN_LANES; step <<= 1u) {
        var sum = lanes[lane];
        if (lane >= step) {
            sum += lanes[lane - step];
        }
        workgroupBarrier();
        lanes[lane] = sum;
        workgroupBarrier();
    }
    let total = lanes[SCAN_LANES - 1u];
    let before = lanes[lane] - value;
    workgroupBarrier();
    return Scanned(before, total);
}
