// Puts the particles of bodies where their bodies are, with the velocity and the spin of the place.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> bodies: array<Body>;
@group(0) @binding(4) var<storage, read> shapes: array<Shape>;
// In the original order: place in the body frame, and the body's number.
@group(0) @binding(5) var<storage, read> anchors: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> control: Control;
var<immediate> substep: Substep;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let n = params.count;
    if (id.x >= n) {
        return;
    }
    let i = id.x;
    let tag = matter[3u * n + i];
    if (!is_rigid(bitcast<u32>(tag.y)) || has_left(i)) {
        return;
    }
    let anchor = anchors[bitcast<u32>(tag.x)];
    let b = bitcast<u32>(anchor.w);
    let body = bodies[b];
    let spin = spin_of(shapes[b].inverse, body.turn, body.angular_momentum.xyz);
    let arm = turned(body.turn, anchor.xyz);
    let v = body.velocity.xyz + cross(spin, arm);
    let mass = kinematics[i].w;
    kinematics[i] = vec4<f32>(body.centre.xyz + arm, mass);
    let turning = mat3x3<f32>(vec3<f32>(0.0, spin.z, -spin.y), vec3<f32>(-spin.z, 0.0, spin.x), vec3<f32>(spin.y, -spin.x, 0.0));
    write_motion(i, v, mass * turning);
    let rows = transpose(rotation_of(body.turn));
    matter[i] = vec4<f32>(rows[0], matter[i].w);
    matter[n + i] = vec4<f32>(rows[1], matter[n + i].w);
    matter[2u * n + i] = vec4<f32>(rows[2], matter[2u * n + i].w);
    // What it may hand to a node of soft matter, as the heaviest particle would.
    let heaviest = 1000.0 * params.momentum_floor;
    atomicMax(&control.momentum[(substep.index + 1u) & 3u], bitcast<u32>(heaviest * length(v)) & 0x7fffffffu);
    atomicMax(&control.speed, bitcast<u32>(length(v)) & 0x7fffffffu);
}
