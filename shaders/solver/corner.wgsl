// Where colliders meet: marks of each on the nodes, so that a node in a corner answers to all that its particles are near.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> colliders: array<Collider>;
@group(0) @binding(4) var<storage, read> substances: array<Substance>;
// `params.corners` of each node, one for each place that colliders have.
@group(0) @binding(5) var<storage, read_write> corners: array<atomic<u32>>;

// Whether a place is beside a face and not beyond its edges: where boxes lie beside each other nothing that slides from one
// to the next meets the side that they share. Less than half a cell below an edge what is nearest decides alone.
fn beside_face(c: Collider, face: u32, x: vec3<f32>) -> bool {
    if (c.at.w != 1.0) {
        return true;
    }
    let within = c.shape.xyz - abs(x - c.at.xyz) - vec3<f32>(0.5 * params.cell_m);
    let axis = face & 3u;
    return (axis == 0u || within.x > 0.0) && (axis == 1u || within.y > 0.0) && (axis == 2u || within.z > 0.0);
}

fn mark_nodes(s: Stencil, near: Near) {
    let place = u32(colliders[(near.mark & 1023u) >> 3u].surface.z);
    for (var k = 0u; k < 27u; k++) {
        let r = row(s, k / 3u);
        let mark = mark_on(near, vec3<f32>(f32(k % 3u) - s.place.x, r.dy, r.dz));
        if (mark != 0u) {
            atomicMax(&corners[pick_offset(r.nodes, k % 3u) * params.corners + place], mark);
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.count) {
        return;
    }
    let x = kinematics[i].xyz;
    let label = matter[3u * params.count + i];
    let tag = bitcast<u32>(label.y);
    let base = base_node(x);
    let first = base - params.origin;
    if (!in_window(first) || !on_grid(tag)) {
        return;
    }
    let shears = matter[i].w != 0.0;
    let own = nearest(params.has_ground, params.collider_count, x, label.z, shears);
    if (own.mark == 0u) {
        return;
    }
    let s = in_layer(stencil(x, base, vec3<u32>(first)), layer_of(tag));
    for (var c = params.has_ground; c < params.collider_count; c++) {
        let near = nearest(c, c + 1u, x, label.z, shears);
        if (near.mark != 0u && (near.mark == own.mark || beside_face(colliders[c], near.mark & 7u, x))) {
            mark_nodes(s, near);
        }
    }
}
