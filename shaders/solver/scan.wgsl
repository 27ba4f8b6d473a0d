// Sums over one workgroup, in a fixed order.

var<workgroup> lanes: array<vec2<u32>, SCAN_LANES>;

// Exclusive prefix sum; `.zw` of what it returns is the total.
fn scan(lane: u32, value: vec2<u32>) -> vec4<u32> {
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
    return vec4<u32>(before, total);
}
