// One workgroup a layer: optical depth to coverage, and coverage halved again and again. No layer
// reads another, so a barrier within the workgroup is enough.

@group(0) @binding(0) var<storage, read> depth: array<u32>;
@group(0) @binding(1) var<storage, read_write> pyramid: array<f32>;

/// Where a level of side SIDE >> level starts within its layer.
fn level_start(level: u32) -> u32 {
    var start = 0u;
    for (var l = 0u; l < level; l++) {
        start += (SIDE >> l) * (SIDE >> l);
    }
    return start;
}

@compute @workgroup_size(PYRAMID_GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let base = group.x * PYRAMID_SIZE;
    for (var t = lane; t < SIDE * SIDE; t += PYRAMID_GROUP) {
        pyramid[base + t] = 1.0 - exp(-f32(depth[group.x * SIDE * SIDE + t]) / DEPTH_UNIT);
    }
    for (var level = 1u; level < LEVELS; level++) {
        storageBarrier();
        let side = i32(SIDE >> level);
        let finer = base + level_start(level - 1u);
        let coarser = base + level_start(level);
        for (var t = lane; t < u32(side * side); t += PYRAMID_GROUP) {
            let corner = 2 * vec2<i32>(i32(t) % side, i32(t) / side) - 1;
            var sum = 0.0;
            for (var k = 0; k < 16; k++) {
                // 1 3 3 1 in both directions: round enough that a small thing far up casts a round shadow.
                let tap = vec2(k % 4, k / 4);
                let p = corner + tap;
                if all(p >= vec2(0)) && all(p < vec2(2 * side)) {
                    let w = select(vec2(1.0), vec2(3.0), (tap == vec2(1)) | (tap == vec2(2)));
                    sum += w.x * w.y * pyramid[finer + u32(p.y * 2 * side + p.x)];
                }
            }
            pyramid[coarser + t] = sum / 64.0;
        }
    }
}
