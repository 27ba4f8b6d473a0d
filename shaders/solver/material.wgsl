// Elastic solids: Kirchhoff stress from the deformation gradient.

// Rotation of the polar decomposition. Newton's iteration squares the error at each step and five
// serve stretches of 0.3 to 3; flat and inverted states take the quaternion form below.
fn polar(f: mat3x3<f32>) -> mat3x3<f32> {
    var r = f;
    if (determinant(f) < FLAT) {
        return polar_flat(f);
    }
    for (var k = 0u; k < POLAR_STEPS; k++) {
        r = 0.5 * (r + cofactors(r) * (1.0 / determinant(r)));
    }
    return r;
}

// Matrix of cofactors: det(m) times the inverse transpose.
fn cofactors(m: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3<f32>(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
}

// Mueller et al., "A robust method to extract the rotational part of deformations" (2016): turns a
// proper rotation towards f; never a reflection, whatever the determinant.
fn polar_flat(f: mat3x3<f32>) -> mat3x3<f32> {
    let x = f[0] * inverseSqrt(max(dot(f[0], f[0]), 1e-12)) + vec3<f32>(1e-6, 0.0, 0.0);
    let z = cross(x, f[1]) + vec3<f32>(0.0, 0.0, 1e-6);
    let ez = z * inverseSqrt(dot(z, z));
    let ex = x * inverseSqrt(dot(x, x));
    var r = mat3x3<f32>(ex, cross(ez, ex), ez);
    for (var k = 0u; k < FLAT_STEPS; k++) {
        let turn = cross(r[0], f[0]) + cross(r[1], f[1]) + cross(r[2], f[2]);
        let along = abs(dot(r[0], f[0]) + dot(r[1], f[1]) + dot(r[2], f[2])) + 1e-9;
        let omega = turn / along;
        let angle = length(omega);
        if (angle < 1e-7) {
            break;
        }
        let axis = omega / angle;
        for (var c = 0u; c < 3u; c++) {
            let v = r[c];
            r[c] = v * cos(angle) + cross(axis, v) * sin(angle) + axis * (dot(axis, v) * (1.0 - cos(angle)));
        }
    }
    return r;
}

// ln J without the loss that a logarithm of a number near 1 brings.
fn ln_near_one(j: f32) -> f32 {
    let s = (j - 1.0) / (j + 1.0);
    let s2 = s * s;
    let series = 2.0 * s * (1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0 + s2 * (1.0 / 9.0)))));
    return select(log(j), series, abs(s) < 0.3);
}

// Fixed corotated: tau = 2 mu (F - R) F^T + lambda J (J - 1) I (Stomakhin et al. 2012).
// Neo-Hookean: tau = mu (F F^T - I) + lambda ln J I.
fn kirchhoff(f: mat3x3<f32>, mu: f32, lambda: f32, neo_hookean: bool) -> mat3x3<f32> {
    var rotation = f;
    if (!neo_hookean) {
        rotation = polar(f);
    }
    return kirchhoff_turned(f, rotation, mu, lambda, neo_hookean);
}

// The same, the rotation R being known.
fn kirchhoff_turned(f: mat3x3<f32>, rotation: mat3x3<f32>, mu: f32, lambda: f32, neo_hookean: bool) -> mat3x3<f32> {
    let j = determinant(f);
    let unit = mat3x3<f32>(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.0, 0.0, 1.0));
    if (neo_hookean) {
        return mu * (f * transpose(f) - unit) + unit * (lambda * ln_near_one(max(j, J_FLOOR)));
    }
    return (2.0 * mu) * ((f - rotation) * transpose(f)) + unit * (lambda * j * (j - 1.0));
}
