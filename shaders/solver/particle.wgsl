// Particles in planes of vec4, plane p of particle i at [p * count + i].
//
// kinematics: (x, mass), (v, A00), (A01 A02 A10 A11), (A12 A20 A21 A22), where
//     A = mass C - dt (4 / cell^2) volume tau moves momentum to a node at distance d as A d.
//     Between segments A = mass C alone, so that state does not depend on the next step's length.
// matter: (F row 0, mu), (F row 1, lambda), (F row 2, volume),
//     (original index, tag, rest offset, history), integers as bits; the tag is the object in its
//     lower half, the row of the substance above it, and the top bit of what a rigid body moves; the
//     history is what the particle's law remembers beside F. The prestress, which no law remembers,
//     keeps mass over pseudo mass there.

fn read_affine(i: u32) -> mat3x3<f32> {
    let n = params.count;
    let p = kinematics[n + i].w;
    let q = kinematics[2u * n + i];
    let r = kinematics[3u * n + i];
    return transpose(mat3x3<f32>(vec3<f32>(p, q.xy), vec3<f32>(q.zw, r.x), r.yzw));
}

fn read_deformation(i: u32) -> mat3x3<f32> {
    let n = params.count;
    return transpose(mat3x3<f32>(matter[i].xyz, matter[n + i].xyz, matter[2u * n + i].xyz));
}

// Whether it takes no part in what soft matter does: a rigid body moves it, or it was left behind.
fn is_rigid(tag: u32) -> bool {
    return (tag >> 31u) != 0u;
}

// Whether the particle was left behind: nothing moves it, and it asks for no room.
fn has_left(i: u32) -> bool {
    return is_rigid(bitcast<u32>(matter[3u * params.count + i].y)) && matter[2u * params.count + i].w == 0.0;
}
