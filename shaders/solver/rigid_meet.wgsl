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
    var s0 = vec4<f32>(0.0);
    var s1 = vec4<f32>(0.0);
    var s2 = vec4<f32>(0.0);
    var s3 = vec4<f32>(0.0);
    for (var k = shape.first_chunk; k < shape.first_chunk + shape.chunks; k++) {
        s0 += burdens[4u * k];
        s1 += burdens[4u * k + 1u];
        s2 += burdens[4u * k + 2u];
        s3 += burdens[4u * k + 3u];
    }
    let spin = spin_of(shape.inverse, body.turn, body.angular_momentum.xyz);
    predicted[2u * b] = vec4<f32>(body.velocity.xyz, 0.0);
    predicted[2u * b + 1u] = vec4<f32>(spin, 0.0);
    if (body.velocity.w != 0.0 || s0.x == 0.0) {
        return;
    }
    let mass = shape.inertia[0].w + s0.x;
    let moment = s0.yzw;
    let p = shape.inertia[0].w * body.velocity.xyz + vec3<f32>(s2.z, s2.w, s3.x);
    let l = body.angular_momentum.xyz + s3.yzw;
    let r = rotation_of(body.turn);
    let own = r * mat3x3<f32>(shape.inertia[0].xyz, shape.inertia[1].xyz, shape.inertia[2].xyz) * transpose(r);
    // Inertia of both about the body's centre, less what the shifted centre of mass takes.
    let xx = s1.x - moment.x * moment.x / mass;
    let yy = s1.y - moment.y * moment.y / mass;
    let zz = s1.z - moment.z * moment.z / mass;
    let xy = s1.w - moment.x * moment.y / mass;
    let xz = s2.x - moment.x * moment.z / mass;
    let yz = s2.y - moment.y * moment.z / mass;
    let both = own + mat3x3<f32>(vec3<f32>(yy + zz, -xy, -xz), vec3<f32>(-xy, xx + zz, -yz), vec3<f32>(-xz, -yz, xx + yy));
    // In units of its own size: of a grain of a millimetre the cube of an inertia is below all that f32 holds.
    let unit = 1.0 / (both[0].x + both[1].y + both[2].z);
    let one = both * unit;
    let right = (l - cross(moment, p) / mass) * unit;
    let omega = vec3<f32>(
        dot(right, cross(one[1], one[2])),
        dot(one[0], cross(right, one[2])),
        dot(one[0], cross(one[1], right)),
    ) / dot(one[0], cross(one[1], one[2]));
    predicted[2u * b] = vec4<f32>((p - cross(omega, moment)) / mass, 0.0);
    predicted[2u * b + 1u] = vec4<f32>(omega, 0.0);
}
