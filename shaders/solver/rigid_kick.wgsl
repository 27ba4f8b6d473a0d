// Changes the velocity of one object's bodies. What is set anew loses its spin too.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> bodies: array<Body>;
@group(0) @binding(2) var<storage, read> shapes: array<Shape>;
var<immediate> kick: Kick;

@compute @workgroup_size(RIGID_BODIES)
fn main(@builtin(local_invocation_index) b: u32) {
    if (b >= arrayLength(&bodies) || shapes[b].object != kick.object) {
        return;
    }
    let body = bodies[b];
    bodies[b].velocity = vec4<f32>(body.velocity.xyz * kick.keep + kick.add_m_s, body.velocity.w);
    bodies[b].angular_momentum = body.angular_momentum * kick.keep;
}
