// Rigid bodies: what all their passes share. The body frame is the world's when the body was
// made, in the captured pose or later, with its origin at the centre of mass.

struct Body {
    centre: vec4<f32>,
    // The centre as whole metres, a whole number of quanta beyond them, and what is left: its sum of steps loses nothing.
    metre: vec4<i32>,
    whole: vec4<i32>,
    // w: how far inside its support the body stood when it was made, 0 or less.
    low: vec4<f32>,
    // Quaternion from the body frame to the world's.
    turn: vec4<f32>,
    // w: 1 where a pin holds the body.
    velocity: vec4<f32>,
    // About the centre, world frame.
    angular_momentum: vec4<f32>,
}

struct Shape {
    // Columns of the inertia tensor, body frame; w of the first is the mass.
    inertia: array<vec4<f32>, 3>,
    inverse: array<vec4<f32>, 3>,
    // First coefficient of the distance field, and how far they are apart.
    low: vec3<f32>,
    voxel_m: f32,
    size: vec3<u32>,
    first_coefficient: u32,
    first_point: u32,
    points: u32,
    // Of a sphere about the centre that holds the body.
    radius_m: f32,
    // Between the surface's points.
    apart_m: f32,
    friction: f32,
    restitution: f32,
    object: u32,
    // 1 where soft parts of the same object hang on it.
    bonded: u32,
    // Chunks of members, see rigid_meeting.wgsl.
    first_chunk: u32,
    chunks: u32,
}

// Where one body meets one other thing: a collider, or a body at `collider_count` and above.
struct Manifold {
    other: u32,
    count: u32,
    // Manifolds of one colour share no body.
    colour: u32,
    padding: u32,
    friction: f32,
    restitution: f32,
    spare: vec2<f32>,
}

struct Contact {
    // In the body's frame; w the gap.
    local: vec4<f32>,
    // Away from the other; w the speed of approach before the contact acted.
    normal: vec4<f32>,
    // From the centre, world frame; w the mass that moves along the normal.
    arm: vec4<f32>,
    // From the other's centre.
    arm_other: vec4<f32>,
    // x: the mass that moves along the surface; w: the largest normal impulse of the substep.
    grip: vec4<f32>,
    // Along the surface; w along the normal.
    impulse: vec4<f32>,
}

fn turned(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

fn turned_back(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    return turned(vec4<f32>(-q.xyz, q.w), v);
}

fn tensor(columns: array<vec4<f32>, 3>, v: vec3<f32>) -> vec3<f32> {
    return columns[0].xyz * v.x + columns[1].xyz * v.y + columns[2].xyz * v.z;
}

// Angular velocity of a body with this orientation and angular momentum.
fn spin_of(inverse: array<vec4<f32>, 3>, q: vec4<f32>, momentum: vec3<f32>) -> vec3<f32> {
    return turned(q, tensor(inverse, turned_back(q, momentum)));
}

fn rotation_of(q: vec4<f32>) -> mat3x3<f32> {
    return mat3x3<f32>(turned(q, vec3<f32>(1.0, 0.0, 0.0)), turned(q, vec3<f32>(0.0, 1.0, 0.0)), turned(q, vec3<f32>(0.0, 0.0, 1.0)));
}

// As `held_back`: the share that is followed of a velocity of a body's centre and of its spin, for the body's rim.
fn followed_share(body: Body, shape: Shape, v: vec3<f32>) -> f32 {
    let rim = shape.radius_m * length(spin_of(shape.inverse, body.turn, body.angular_momentum.xyz));
    return min(1.0, params.speed_most / max(length(v) + rim, 1e-30));
}
