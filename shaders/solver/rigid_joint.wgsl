// A body and the nodes that it meets as one rigid thing.

// Of these nodes, summed over chunks of members: mass, its moments about the body's centre, and a momentum and an angular
// momentum that they bring.
struct Burden {
    mass: f32,
    moment: vec3<f32>,
    // xx yy zz, then xy xz yz.
    square: vec3<f32>,
    mixed: vec3<f32>,
    momentum: vec3<f32>,
    turning: vec3<f32>,
}

fn burden_of(shape: Shape) -> Burden {
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
    return Burden(s0.x, s0.yzw, s1.xyz, vec3<f32>(s1.w, s2.xy), vec3<f32>(s2.zw, s3.x), s3.yzw);
}

struct Joint {
    velocity: vec3<f32>,
    spin: vec3<f32>,
}

// How both move with this momentum and angular momentum.
fn joint(body: Body, shape: Shape, load: Burden, p: vec3<f32>, l: vec3<f32>) -> Joint {
    let mass = shape.inertia[0].w + load.mass;
    let moment = load.moment;
    let r = rotation_of(body.turn);
    let own = r * mat3x3<f32>(shape.inertia[0].xyz, shape.inertia[1].xyz, shape.inertia[2].xyz) * transpose(r);
    // Inertia of both about the body's centre, less what the shifted centre of mass takes.
    let square = load.square - moment * moment / mass;
    let mixed = load.mixed - moment.xxy * moment.yzz / mass;
    let both = own + mat3x3<f32>(
        vec3<f32>(square.y + square.z, -mixed.x, -mixed.y),
        vec3<f32>(-mixed.x, square.x + square.z, -mixed.z),
        vec3<f32>(-mixed.y, -mixed.z, square.x + square.y),
    );
    // In units of its own size: of a grain of a millimetre the cube of an inertia is below all that f32 holds.
    let unit = 1.0 / (both[0].x + both[1].y + both[2].z);
    let one = both * unit;
    let right = (l - cross(moment, p) / mass) * unit;
    let omega = vec3<f32>(
        dot(right, cross(one[1], one[2])),
        dot(one[0], cross(right, one[2])),
        dot(one[0], cross(one[1], right)),
    ) / dot(one[0], cross(one[1], one[2]));
    return Joint((p - cross(omega, moment)) / mass, omega);
}
