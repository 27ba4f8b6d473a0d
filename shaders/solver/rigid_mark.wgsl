// Soft particles beside bodies mark the nodes that they reach: with the gap to a body of another object,
// with the bond to one of their own. What flows or falls apart hangs on nothing.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> bodies: array<Body>;
@group(0) @binding(4) var<storage, read> shapes: array<Shape>;
@group(0) @binding(5) var<storage, read> field: array<f32>;
@group(0) @binding(6) var<storage, read_write> nears: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read> substances: array<Substance>;

fn mark(node: u32, contact: u32, bond: u32, beside: bool) {
    if (contact != 0u && beside) {
        atomicMax(&nears[4u * node + 2u], contact);
    }
    if (bond != 0u) {
        atomicMax(&nears[4u * node + 3u], bond);
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let n = params.count;
    if (id.x >= n) {
        return;
    }
    let tag = bitcast<u32>(matter[3u * n + id.x].y);
    let x = kinematics[id.x].xyz;
    let base = base_node(x);
    let first = base - params.origin;
    if (!on_grid(tag) || !in_window(first)) {
        return;
    }
    let kind = substances[row_of(tag)].kind;
    let loose = kind == LIQUID || kind == SAND || kind == SNOW;
    // Without a shear modulus there is no Coulomb friction either.
    let slides = select(0u, SLIDES, matter[id.x].w == 0.0);
    var contact = 0u;
    var bond = 0u;
    var normal = vec3<f32>(0.0);
    for (var b = 0u; b < arrayLength(&bodies); b++) {
        let own = !loose && shapes[b].object == (tag & 0xffffu);
        let d = x - bodies[b].centre.xyz;
        let reach_m = shapes[b].radius_m + 2.0 * params.cell_m;
        if (dot(d, d) > reach_m * reach_m) {
            continue;
        }
        let level = level_at(b, turned_back(bodies[b].turn, d));
        if (own && level.distance_m < 2.0 * params.cell_m) {
            bond = max(bond, b + 1u);
        }
        let gap_m = level.distance_m - REST_CELLS * params.cell_m;
        if (!own && gap_m < params.reach_m) {
            let value = pack_near(gap_m, b | slides);
            if (value > contact) {
                contact = value;
                normal = turned(bodies[b].turn, level.gradient * inverseSqrt(max(dot(level.gradient, level.gradient), 1e-12)));
            }
        }
    }
    if ((contact | bond) == 0u) {
        return;
    }
    let s = in_layer(stencil(x, base, vec3<u32>(first)), layer_of(tag));
    for (var k = 0u; k < 9u; k++) {
        let r = row(s, k);
        let d = vec3<f32>(-s.place.x, r.dy, r.dz);
        // Nodes above the particle are its own matter's, as in p2g.
        mark(r.nodes.x, contact, bond, dot(normal, d) <= 0.5);
        mark(r.nodes.y, contact, bond, dot(normal, d + vec3<f32>(1.0, 0.0, 0.0)) <= 0.5);
        mark(r.nodes.z, contact, bond, dot(normal, d + vec3<f32>(2.0, 0.0, 0.0)) <= 0.5);
    }
}
