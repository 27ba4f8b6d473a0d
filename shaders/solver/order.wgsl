// Sort, last pass: within each cell by original index, so that the order depends on positions alone
// and every f32 sum over it repeats to the bit. Copies the particles into that order.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> slots: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> kinematics_out: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> matter_out: array<vec4<f32>>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let n = params.count;
    if (id.x >= n) {
        return;
    }
    let mine = slots[id.x];
    // Slots of a cell are adjacent: those of smaller index on either side.
    var first = id.x;
    var smaller = 0u;
    while (first > 0u && slots[first - 1u].x == mine.x) {
        first -= 1u;
        smaller += select(0u, 1u, slots[first].y < mine.y);
    }
    for (var k = id.x + 1u; k < n && slots[k].x == mine.x; k++) {
        smaller += select(0u, 1u, slots[k].y < mine.y);
    }
    let target_slot = first + smaller;
    for (var plane = 0u; plane < 4u; plane++) {
        kinematics_out[plane * n + target_slot] = kinematics[plane * n + mine.z];
        matter_out[plane * n + target_slot] = matter[plane * n + mine.z];
    }
}
