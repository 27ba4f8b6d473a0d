// What fields did to the particles of bodies since they were put in place: momentum and angular momentum
// of each body, in fixed point of two words, whose sums do not depend on who comes first nor end with the words: what
// overflows the low one is carried to the high one.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> bodies: array<Body>;
@group(0) @binding(4) var<storage, read> shapes: array<Shape>;
// In the original order: place in the body frame, and the body's number.
@group(0) @binding(5) var<storage, read> anchors: array<vec4<f32>>;
// Twelve words a body: high and low of the momentum, high and low of the angular momentum.
@group(0) @binding(6) var<storage, read_write> driven: array<atomic<u32>>;

fn add(at: u32, value: vec3<f32>) {
    let high = floor(value * (1.0 / DRIVEN_LOW));
    let low = vec3<u32>(round(value - high * DRIVEN_LOW));
    for (var k = 0u; k < 3u; k++) {
        let before = atomicAdd(&driven[at + 3u + k], low[k]);
        let carry = select(0u, 1u << (32u - DRIVEN_BITS), before + low[k] < before);
        atomicAdd(&driven[at + k], bitcast<u32>(i32(high[k])) + carry);
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let n = params.count;
    if (id.x >= n) {
        return;
    }
    let tag = matter[3u * n + id.x];
    if (!is_rigid(bitcast<u32>(tag.y)) || has_left(id.x)) {
        return;
    }
    let anchor = anchors[bitcast<u32>(tag.x)];
    let b = bitcast<u32>(anchor.w);
    let spin = spin_of(shapes[b].inverse, bodies[b].turn, bodies[b].angular_momentum.xyz);
    let arm = turned(bodies[b].turn, anchor.xyz);
    let change = kinematics[n + id.x].xyz - (bodies[b].velocity.xyz + cross(spin, arm));
    let share = kinematics[id.x].w / shapes[b].inertia[0].w / DRIVEN_UNIT;
    add(12u * b, share * change);
    add(12u * b + 6u, share / shapes[b].radius_m * cross(arm, change));
}
