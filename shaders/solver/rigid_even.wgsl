// Nodes that leave a body, or slide along it, give it less than what takes it to the velocity that was predicted, or more
// where they pull against each other. What is left over moves body and nodes together: alone, a body that is light beside
// them would be shot off by it.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> shapes: array<Shape>;
// Of the nodes that respond; their momentum is what they give.
@group(0) @binding(3) var<storage, read> burdens: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> predicted: array<vec4<f32>>;
// Two vec4 a body: velocity and spin that both gain.
@group(0) @binding(5) var<storage, read_write> evened: array<vec4<f32>>;

@compute @workgroup_size(RIGID_BODIES)
fn main(@builtin(local_invocation_index) b: u32) {
    if (b >= arrayLength(&bodies)) {
        return;
    }
    let body = bodies[b];
    let shape = shapes[b];
    let load = burden_of(shape);
    var both = Joint(vec3<f32>(0.0), vec3<f32>(0.0));
    if (body.velocity.w == 0.0 && load.mass > 0.0) {
        let spin = spin_of(shape.inverse, body.turn, body.angular_momentum.xyz);
        let turning = turned(body.turn, tensor(shape.inertia, turned_back(body.turn, predicted[2u * b + 1u].xyz - spin)));
        let momentum = shape.inertia[0].w * (predicted[2u * b].xyz - body.velocity.xyz);
        both = joint(body, shape, load, load.momentum - momentum, load.turning - turning);
    }
    evened[2u * b] = vec4<f32>(both.velocity, 0.0);
    evened[2u * b + 1u] = vec4<f32>(both.spin, 0.0);
}
