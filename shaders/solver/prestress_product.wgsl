// Prestress, on the grid: what the stiffness makes of the present direction, and the curvature.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<vec4<i32>>;
@group(0) @binding(3) var<storage, read_write> marks: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read_write> control: Control;
@group(0) @binding(5) var<storage, read_write> nodes: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> partial: array<vec4<f32>>;
var<immediate> substep: Substep;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place == 0u && lane == 0u) {
        atomicStore(&control.momentum[(substep.index + 1u) & 3u], 0u);
    }
    let alive = place < active_blocks[0];
    let count = active_blocks[0] * 64u;
    var share = vec4<f32>(0.0);
    if (alive) {
        let node = (1u + place) * 64u + lane;
        let k = place * 64u + lane;
        let sum = sums[node];
        sums[node] = vec4<i32>(0);
        marks[node] = vec2<u32>(0u);
        let momentum_unit = momentum_units(substep.index, substep.lag);
        let product = hold(vec3<f32>(sum.xyz) / -momentum_unit, nodes[BOUND * count + k]);
        nodes[PRODUCT * count + k] = vec4<f32>(product, 0.0);
        share = vec4<f32>(dot(product, nodes[DIRECTION * count + k].xyz), 0.0, 0.0, 0.0);
    }
    let sum = workgroup_sum(lane, share);
    if (lane == 0u && alive) {
        partial[place] = sum;
    }
}
