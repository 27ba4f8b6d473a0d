// Affine maps kept as what they add to the identity: three rows of [G - I | t]. All zeros is rest,
// and adding zeros changes no bit.

struct Delta {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}

fn zero_delta() -> Delta {
    return Delta(vec4<f32>(), vec4<f32>(), vec4<f32>());
}

/// Where `p` goes, less `p`.
fn moved_by(d: Delta, p: vec3<f32>) -> vec3<f32> {
    return vec3(d.x.w, d.y.w, d.z.w) + linear_of(d) * p;
}

/// G - I.
fn linear_of(d: Delta) -> mat3x3<f32> {
    return transpose(mat3x3(d.x.xyz, d.y.xyz, d.z.xyz));
}

/// Comparisons with NaN are not to be trusted across drivers; the exponent's bits are.
fn is_finite(d: Delta) -> bool {
    let sum = d.x + d.y + d.z;
    return (bitcast<u32>(sum.x + sum.y + sum.z + sum.w) & 0x7f800000u) != 0x7f800000u;
}
