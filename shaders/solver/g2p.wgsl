// Grid to particles: gathers velocity and its gradient, and moves each particle.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> velocity: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> colliders: array<Collider>;
// Acceleration of each object, beside gravity.
@group(0) @binding(5) var<storage, read> objects: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> control: Control;
@group(0) @binding(7) var<storage, read> substances: array<Substance>;
var<immediate> substep: Substep;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let alive = id.x < params.count;
    let i = min(id.x, params.count - 1u);
    let known = matter_of(i);
    let position = known.position;
    let base = base_node(position.xyz);
    let cell = vec3<u32>(clamp(base - params.origin, vec3<i32>(0), vec3<i32>(params.blocks * 4u) - vec3<i32>(3)));
    let m = moved(i, known, gather(in_layer(stencil(position.xyz, base, cell), layer_of(bitcast<u32>(known.label.y)))), alive);
    if (alive && m.carried) {
        write_motion(i, m.v, m.affine);
    }
    note(ordered_bits(m.momentum), ordered_bits(m.speed), lane);
}
