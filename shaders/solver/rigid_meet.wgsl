// The velocity and spin that each body has once the nodes that it meets move with it: momentum and
// angular momentum of both over mass and inertia of both. Soft matter may outweigh a body at will.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> shapes: array<Shape>;
@group(0) @binding(3) var<storage, read> burdens: array<vec4<f32>>;
// Two vec4 a body: velocity, spin.
@group(0) @binding(4) var<storage, read_write> predicted: array<vec4<f32>>;

@compute @workgroup_size(RIGID_BODIES)
fn main(@builtin(local_invocation_index) b: u32) {
    if (b >= arrayLength(&bodies)) {
        return;
    }
    let body = bodies[b];
    let shape = shapes[b];
    let load = burden_of(shape);
    var both = Joint(body.velocity.xyz, spin_of(shape.inverse, body.turn, body.angular_momentum.xyz));
    if (body.velocity.w == 0.0 && load.mass > 0.0) {
        both = joint(body, shape, load, shape.inertia[0].w * body.velocity.xyz + load.momentum, body.angular_momentum.xyz + load.turning);
    }
    predicted[2u * b] = vec4<f32>(both.velocity, 0.0);
    predicted[2u * b + 1u] = vec4<f32>(both.spin, 0.0);
}
