// Static colliders. What a particle touches is named by a feature, collider * 8 + face, so that the
// node which the particle marks can find the same normal from its own place.

struct Collider {
    // Centre of a box, a point of a plane, one end of a capsule's axis; w: 0 plane, 1 box, 2 capsule.
    at: vec4<f32>,
    // Half the edges of a box, the unit normal of a plane, the axis of a capsule, none of a sphere; w: its radius.
    shape: vec4<f32>,
    // Friction, restitution.
    surface: vec4<f32>,
}

struct Touch {
    // Signed distance to the surface, metres, negative inside.
    distance_m: f32,
    // Which face of a box: axis, plus 4 on its negative side.
    face: u32,
}

// From the nearest point of a capsule's axis.
fn off_axis(c: Collider, x: vec3<f32>) -> vec3<f32> {
    let d = x - c.at.xyz;
    let axis = c.shape.xyz;
    return d - axis * clamp(dot(d, axis) / max(dot(axis, axis), 1e-30), 0.0, 1.0);
}

fn touch(c: Collider, x: vec3<f32>) -> Touch {
    let d = x - c.at.xyz;
    if (c.at.w == 0.0) {
        return Touch(dot(d, c.shape.xyz), 0u);
    }
    if (c.at.w == 2.0) {
        return Touch(length(off_axis(c, x)) - c.shape.w, 0u);
    }
    // The face that separates most. Edges stay sharp: distances beyond them are those of a face.
    let q = abs(d) - c.shape.xyz;
    var axis = 2u;
    if (q.x > q.y && q.x > q.z) {
        axis = 0u;
    } else if (q.y > q.z) {
        axis = 1u;
    }
    return Touch(q[axis], axis + select(0u, 4u, d[axis] < 0.0));
}

fn surface_normal(c: Collider, face: u32, x: vec3<f32>) -> vec3<f32> {
    if (c.at.w == 0.0) {
        return c.shape.xyz;
    }
    if (c.at.w == 2.0) {
        let d = off_axis(c, x);
        return select(vec3<f32>(0.0, 0.0, 1.0), d * inverseSqrt(max(dot(d, d), 1e-20)), dot(d, d) > 1e-20);
    }
    let side = select(1.0, -1.0, face >= 4u);
    let axis = face & 3u;
    return vec3<f32>(select(0.0, side, axis == 0u), select(0.0, side, axis == 1u), select(0.0, side, axis == 2u));
}

// Mark of a contact on a node: the nearer the larger, so that the nearest particle wins a maximum;
// zero where there is none. 21 bits of nearness above 11 bits of feature, the topmost SLIPS.
fn pack_mark(gap_m: f32, feature: u32) -> u32 {
    let near = 1.0 - clamp(gap_m / params.reach_m, 0.0, 1.0);
    return ((u32(near * GAP_STEPS) + 1u) << 11u) | feature;
}

fn mark_gap_m(mark: u32) -> f32 {
    return params.reach_m * (1.0 - f32((mark >> 11u) - 1u) / GAP_STEPS);
}
