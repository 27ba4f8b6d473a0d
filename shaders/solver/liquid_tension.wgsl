// Liquids: continuum surface force (Brackbill, Kothe and Zemach 1992). With c the share of the room
// that is full, n its gradient made a unit and kappa = -div n, the force sigma kappa grad c times 2 c
// brings the liquid an acceleration of 2 sigma / rho kappa grad c: none grows where hardly any is.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> share: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> slopes: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> pull: array<vec4<f32>>;

// The unit normal at a node, 0 where there is no surface.
fn normal_at(node: u32) -> vec3<f32> {
    let gradient = slopes[node].xyz;
    let size = length(gradient);
    if (share[node].w == 0.0 || size * params.cell_m < SURFACE_LEAST) {
        return vec3<f32>(0.0);
    }
    return gradient / size;
}

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
    let here = share[node.index];
    let normal = normal_at(node.index);
    if (here.y <= 0.0 || all(normal == vec3<f32>(0.0))) {
        return;
    }
    var spread = 0.0;
    for (var k = 0u; k < 27u; k++) {
        let step = step_of(k);
        let other = normal_at(beside(node, step));
        spread += dot(slope(step), select(other, normal, all(other == vec3<f32>(0.0))));
    }
    let curved = clamp(-spread, -1.0, 1.0) * params.per_m;
    // From the level through this node to that of the surface, which is nearer to the centre or
    // farther from it: the curvature of a sphere there.
    let gradient = slopes[node.index].xyz;
    let depth_m = clamp((here.x - 0.5) / length(gradient), -1.5 * params.cell_m, 1.5 * params.cell_m);
    let curvature = curved / max(1.0 + 0.5 * curved * depth_m, 0.3);
    pull[node.index] = vec4<f32>(gradient * (2.0 * here.y * curvature), here.z);
}
