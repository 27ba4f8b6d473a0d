// What the nodes that a body meets would add to it if they moved with it: mass, its moments about the
// body's centre, momentum and angular momentum, summed over a chunk of members in their order. And once they have
// responded the same of those that did, with the momentum that they give.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> members: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> owners: array<u32>;
@group(0) @binding(4) var<storage, read> meetings: array<Meeting>;
// Four vec4 a chunk: (mass, first moments), (xx yy zz, xy), (xz yz, momentum x y), (momentum z, angular
// momentum).
@group(0) @binding(5) var<storage, read_write> burdens: array<vec4<f32>>;

var<workgroup> sums0: array<vec4<f32>, RIGID_LANES>;
var<workgroup> sums1: array<vec4<f32>, RIGID_LANES>;
var<workgroup> sums2: array<vec4<f32>, RIGID_LANES>;
var<workgroup> sums3: array<vec4<f32>, RIGID_LANES>;

fn burden(lane: u32, b: u32, node: u32, weighted_kg: f32, r: vec3<f32>) {
    let rigid_kg = meetings[node].rigid_kg;
    if (rigid_kg == 0.0 || (meetings[node].body & (SLIDES - 1u)) != b) {
        return;
    }
    let share = weighted_kg / rigid_kg;
    let m = share * meetings[node].soft_kg;
    let p = share * meetings[node].momentum;
    let l = cross(r, p);
    sums0[lane] += vec4<f32>(m, m * r);
    sums1[lane] += m * vec4<f32>(r * r, r.x * r.y);
    sums2[lane] += vec4<f32>(m * r.x * r.z, m * r.y * r.z, p.x, p.y);
    sums3[lane] += vec4<f32>(p.z, l);
}

@compute @workgroup_size(RIGID_LANES)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let member = members[id.x];
    let b = owners[group.x];
    let arm = turned(bodies[b].turn, member.xyz);
    let x = bodies[b].centre.xyz + arm;
    let base = base_node(x);
    let first = base - params.origin;
    sums0[lane] = vec4<f32>(0.0);
    sums1[lane] = vec4<f32>(0.0);
    sums2[lane] = vec4<f32>(0.0);
    sums3[lane] = vec4<f32>(0.0);
    let layers = select(0u, params.layers, member.w > 0.0 && in_window(first));
    for (var layer = 0u; layer < layers; layer++) {
        let s = in_layer(stencil(x, base, vec3<u32>(max(first, vec3<i32>(0)))), layer);
        for (var k = 0u; k < 9u; k++) {
            let r = row(s, k);
            let d = arm + params.cell_m * vec3<f32>(-s.place.x, r.dy, r.dz);
            burden(lane, b, r.nodes.x, member.w * r.weights.x, d);
            burden(lane, b, r.nodes.y, member.w * r.weights.y, d + vec3<f32>(params.cell_m, 0.0, 0.0));
            burden(lane, b, r.nodes.z, member.w * r.weights.z, d + vec3<f32>(2.0 * params.cell_m, 0.0, 0.0));
        }
    }
    workgroupBarrier();
    for (var half = RIGID_LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            sums0[lane] += sums0[lane + half];
            sums1[lane] += sums1[lane + half];
            sums2[lane] += sums2[lane + half];
            sums3[lane] += sums3[lane + half];
        }
        workgroupBarrier();
    }
    if (lane == 0u) {
        burdens[4u * group.x] = sums0[0];
        burdens[4u * group.x + 1u] = sums1[0];
        burdens[4u * group.x + 2u] = sums2[0];
        burdens[4u * group.x + 3u] = sums3[0];
    }
}
