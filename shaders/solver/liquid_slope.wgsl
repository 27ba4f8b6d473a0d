// Liquids: gradient of how full the room is. Across what has no room it does not change.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> share: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> slopes: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place >= active_blocks[0]) {
        return;
    }
    let node = node_of(place, lane);
    if (node.layer != 0u) {
        return;
    }
    let here = share[node.index].x;
    var gradient = vec3<f32>(0.0);
    for (var k = 0u; k < 27u; k++) {
        let step = step_of(k);
        let full = share[beside(node, step)].x;
        gradient += slope(step) * select(full, here, full < 0.0);
    }
    slopes[node.index] = vec4<f32>(select(gradient * params.per_m, vec3<f32>(0.0), here < 0.0), 0.0);
}
