var<workgroup> terms: array<vec4<f32>, 64>;

// Sum over the workgroup, in a fixed order.
fn workgroup_sum(lane: u32, value: vec4<f32>) -> vec4<f32> {
    terms[lane] = value;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half >>= 1u) {
        if (lane < half) {
            terms[lane] += terms[lane + half];
        }
        workgroupBarrier();
    }
    return terms[0];
}
