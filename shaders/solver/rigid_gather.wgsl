// Grid to bodies: momentum and angular momentum that the nodes gave, over a chunk of members in their
// order.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> members: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> owners: array<u32>;
@group(0) @binding(4) var<storage, read> meetings: array<Meeting>;
@group(0) @binding(5) var<storage, read_write> given: array<vec4<f32>>;

var<workgroup> momentum: array<vec4<f32>, RIGID_LANES>;
var<workgroup> angular: array<vec4<f32>, RIGID_LANES>;

fn take(lane: u32, b: u32, node: u32, weighted_kg: f32, r: vec3<f32>) {
    let rigid_kg = meetings[node].rigid_kg;
    if (rigid_kg > 0.0 && (meetings[node].body & (SLIDES - 1u)) == b) {
        let impulse = meetings[node].impulse * (weighted_kg / rigid_kg);
        momentum[lane] += vec4<f32>(impulse, 0.0);
        angular[lane] += vec4<f32>(cross(r, impulse), 0.0);
    }
}

@compute @workgroup_size(RIGID_LANES)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let member = members[id.x];
    let b = owners[group.x];
    let arm = turned(bodies[b].turn, member.xyz);
    let x = bodies[b].centre.xyz + arm;
    let base = base_node(x);
    let first = base - params.origin;
    momentum[lane] = vec4<f32>(0.0);
    angular[lane] = vec4<f32>(0.0);
    let layers = select(0u, params.layers, member.w > 0.0 && in_window(first));
    for (var layer = 0u; layer < layers; layer++) {
        let s = in_layer(stencil(x, base, vec3<u32>(max(first, vec3<i32>(0)))), layer);
        for (var k = 0u; k < 9u; k++) {
            let r = row(s, k);
            let d = arm + params.cell_m * vec3<f32>(-s.place.x, r.dy, r.dz);
            take(lane, b, r.nodes.x, member.w * r.weights.x, d);
            take(lane, b, r.nodes.y, member.w * r.weights.y, d + vec3<f32>(params.cell_m, 0.0, 0.0));
            take(lane, b, r.nodes.z, member.w * r.weights.z, d + vec3<f32>(2.0 * params.cell_m, 0.0, 0.0));
        }
    }
    workgroupBarrier();
    for (var half = RIGID_LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            momentum[lane] += momentum[lane + half];
            angular[lane] += angular[lane + half];
        }
        workgroupBarrier();
    }
    if (lane == 0u) {
        given[2u * group.x] = momentum[0];
        given[2u * group.x + 1u] = angular[0];
    }
}
