// Start of a segment: a body with a point in a pin is held by it, still or along its path, and one that
// no pin reaches is free, as fast as substeps follow. What bodies may hand to nodes of soft matter in the first substep is measured, for its
// fixed-point scale.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> pins: array<Pin>;
@group(0) @binding(2) var<storage, read_write> bodies: array<Body>;
@group(0) @binding(3) var<storage, read> shapes: array<Shape>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> control: Control;
var<immediate> substep: Substep;

// The first point that is held.
var<workgroup> found: atomic<u32>;

fn place_of(b: u32, p: u32) -> vec3<f32> {
    return bodies[b].centre.xyz + turned(bodies[b].turn, points[shapes[b].first_point + p].xyz);
}

@compute @workgroup_size(RIGID_LANES)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let b = group.x;
    if (lane == 0u) {
        atomicStore(&found, 0xffffffffu);
    }
    workgroupBarrier();
    for (var p = lane; p < shapes[b].points; p += RIGID_LANES) {
        if (body_pinned(place_of(b, p), shapes[b].object).w > 0.0) {
            atomicMin(&found, p);
        }
    }
    workgroupBarrier();
    if (lane == 0u) {
        let first = atomicLoad(&found);
        bodies[b].velocity.w = 0.0;
        if (first != 0xffffffffu) {
            bodies[b].velocity = body_pinned(place_of(b, first), shapes[b].object);
        } else {
            // A push may have been faster than what is followed.
            let followed = followed_share(bodies[b], shapes[b], bodies[b].velocity.xyz);
            bodies[b].velocity = vec4<f32>(bodies[b].velocity.xyz * followed, 0.0);
            bodies[b].angular_momentum *= followed;
        }
        let spin = spin_of(shapes[b].inverse, bodies[b].turn, bodies[b].angular_momentum.xyz);
        let fastest = length(bodies[b].velocity.xyz) + length(spin) * shapes[b].radius_m;
        let heaviest = 1000.0 * params.momentum_floor;
        atomicMax(&control.momentum[substep.index & 3u], bitcast<u32>(heaviest * fastest) & 0x7fffffffu);
    }
}
