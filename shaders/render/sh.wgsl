// Real spherical harmonics to degree 3 with the Condon-Shortley signs of Kerbl et al. 2023.
// Float f of Gaussian g is component f % 4 of sh[(f / 4) * count + g]: four coefficients of three
// channels fill three planes.

const SH_C0 = 0.28209479177387814;
const SH_C1 = 0.4886025119029199;

fn colour_from_sh(g: u32, count: u32, degree: u32, d: vec3<f32>) -> vec3<f32> {
    let p0 = sh[g];
    var colour = SH_C0 * p0.xyz;
    if (degree == 0u) { return colour; }
    let p1 = sh[count + g];
    let p2 = sh[2u * count + g];
    colour += SH_C1 * (d.z * vec3<f32>(p1.zw, p2.x) - d.y * vec3<f32>(p0.w, p1.xy) - d.x * p2.yzw);
    if (degree == 1u) { return colour; }
    let s = d * d;
    let p3 = sh[3u * count + g];
    let p4 = sh[4u * count + g];
    let p5 = sh[5u * count + g];
    let p6 = sh[6u * count + g];
    colour += 1.0925484305920792 * d.x * d.y * p3.xyz
        - 1.0925484305920792 * d.y * d.z * vec3<f32>(p3.w, p4.xy)
        + 0.31539156525252005 * (2.0 * s.z - s.x - s.y) * vec3<f32>(p4.zw, p5.x)
        - 1.0925484305920792 * d.x * d.z * p5.yzw
        + 0.5462742152960396 * (s.x - s.y) * p6.xyz;
    if (degree == 2u) { return colour; }
    let p7 = sh[7u * count + g];
    let p8 = sh[8u * count + g];
    let p9 = sh[9u * count + g];
    let p10 = sh[10u * count + g];
    let p11 = sh[11u * count + g];
    colour += -0.5900435899266435 * d.y * (3.0 * s.x - s.y) * vec3<f32>(p6.w, p7.xy)
        + 2.890611442640554 * d.x * d.y * d.z * vec3<f32>(p7.zw, p8.x)
        - 0.4570457994644658 * d.y * (4.0 * s.z - s.x - s.y) * p8.yzw
        + 0.3731763325901154 * d.z * (2.0 * s.z - 3.0 * s.x - 3.0 * s.y) * p9.xyz
        - 0.4570457994644658 * d.x * (4.0 * s.z - s.x - s.y) * vec3<f32>(p9.w, p10.xy)
        + 1.445305721320277 * d.z * (s.x - s.y) * vec3<f32>(p10.zw, p11.x)
        - 0.5900435899266435 * d.x * (s.x - 3.0 * s.y) * p11.yzw;
    return colour;
}

// v turned by the inverse of a unit quaternion (x, y, z, w).
fn turn_back(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let t = 2.0 * cross(v, q.xyz);
    return v + q.w * t + cross(t, q.xyz);
}
