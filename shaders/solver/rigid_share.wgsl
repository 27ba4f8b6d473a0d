// Bodies to grid: with what mass each body's particles reach the nodes that soft matter marked with it.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> bodies: array<Body>;
// Particles near the surface in the body frame, and their mass; 0 where a chunk is not full.
@group(0) @binding(2) var<storage, read> members: array<vec4<f32>>;
// The body of each chunk of them.
@group(0) @binding(3) var<storage, read> owners: array<u32>;
@group(0) @binding(4) var<storage, read> sums: array<vec4<i32>>;
@group(0) @binding(5) var<storage, read_write> nears: array<atomic<u32>>;

fn leave(b: u32, node: u32, mass: f32) {
    if (sums[node].w <= 0) {
        return;
    }
    let contact = atomicLoad(&nears[4u * node + 2u]);
    let bond = atomicLoad(&nears[4u * node + 3u]);
    if (bond == b + 1u) {
        atomicAdd(&nears[4u * node], u32(mass + 0.5));
    }
    if (contact != 0u && (contact & (SLIDES - 1u)) == b) {
        atomicAdd(&nears[4u * node + 1u], u32(mass + 0.5));
    }
}

@compute @workgroup_size(RIGID_LANES)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(workgroup_id) group: vec3<u32>) {
    let member = members[id.x];
    let b = owners[group.x];
    let x = bodies[b].centre.xyz + turned(bodies[b].turn, member.xyz);
    let base = base_node(x);
    let first = base - params.origin;
    if (member.w == 0.0 || !in_window(first)) {
        return;
    }
    let mass_units = member.w * params.mass_units;
    for (var layer = 0u; layer < params.layers; layer++) {
        let s = in_layer(stencil(x, base, vec3<u32>(first)), layer);
        for (var k = 0u; k < 9u; k++) {
            let r = row(s, k);
            leave(b, r.nodes.x, r.weights.x * mass_units);
            leave(b, r.nodes.y, r.weights.y * mass_units);
            leave(b, r.nodes.z, r.weights.z * mass_units);
        }
    }
}
