// Affine maps kept as what they add to the identity: three rows of [G - I | t]. All zeros is rest,
// and adding zeros changes no bit.

struct Delta {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}

/// As it lies in memory: t, then G - I row by row as nine halves, and how it flows: what a frame of motion has
/// of it, with t for the place.
struct PackedDelta {
    a: vec4<u32>,
    b: vec4<u32>,
}

fn unpacked(d: PackedDelta) -> Delta {
    let t = bitcast<vec3<f32>>(d.a.xyz);
    let h0 = unpack2x16float(d.a.w);
    let h1 = unpack2x16float(d.b.x);
    let h2 = unpack2x16float(d.b.y);
    let h3 = unpack2x16float(d.b.z);
    let h4 = unpack2x16float(d.b.w);
    return Delta(vec4(h0, h1.x, t.x), vec4(h1.y, h2, t.y), vec4(h3, h4.x, t.z));
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
