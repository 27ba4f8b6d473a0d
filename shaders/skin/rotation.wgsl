// The rotation and the stretch of a deformation gradient.

/// Rows of the cofactor matrix are cross products of the columns; over the determinant it is F^-T.
fn cofactor(f: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3(cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1]));
}

fn squared_norm(f: mat3x3<f32>) -> f32 {
    return dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
}

/// The rotation R of F = R S, by Newton's iteration R <- (R + R^-T) / 2 (Higham 1986), which
/// converges to a rotation for every F of positive determinant.
fn polar_rotation(f: mat3x3<f32>) -> mat3x3<f32> {
    var r = f;
    for (var step = 0u; step < POLAR_STEPS; step++) {
        let next = 0.5 * (r + cofactor(r) * (1.0 / determinant(r)));
        let change = squared_norm(next - r);
        r = next;
        if change < 1e-12 {
            break;
        }
    }
    return r;
}

/// Quaternion (x, y, z, w) of a rotation: from the largest of its four components, so that nothing
/// is divided by a small number (Shepperd 1978).
fn quaternion(r: mat3x3<f32>) -> vec4<f32> {
    let trace = r[0].x + r[1].y + r[2].z;
    var q: vec4<f32>;
    if trace > 0.0 {
        q = vec4(r[1].z - r[2].y, r[2].x - r[0].z, r[0].y - r[1].x, trace + 1.0);
    } else if r[0].x >= r[1].y && r[0].x >= r[2].z {
        q = vec4(1.0 + r[0].x - r[1].y - r[2].z, r[0].y + r[1].x, r[2].x + r[0].z, r[1].z - r[2].y);
    } else if r[1].y >= r[2].z {
        q = vec4(r[0].y + r[1].x, 1.0 + r[1].y - r[2].z - r[0].x, r[1].z + r[2].y, r[2].x - r[0].z);
    } else {
        q = vec4(r[2].x + r[0].z, r[1].z + r[2].y, 1.0 + r[2].z - r[0].x - r[1].y, r[0].y - r[1].x);
    }
    return normalize(q);
}

/// The turn b, then the turn a.
fn quaternion_product(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}

/// Turns the axes i and j of a symmetric matrix so that its entry (i, j) vanishes, and the vectors
/// with them: one step of Jacobi's eigenvalue method.
fn jacobi(s: ptr<function, mat3x3<f32>>, v: ptr<function, mat3x3<f32>>, i: u32, j: u32) {
    let off = (*s)[i][j];
    if abs(off) < 1e-12 {
        return;
    }
    let theta = ((*s)[j][j] - (*s)[i][i]) / (2.0 * off);
    let t = select(-1.0, 1.0, theta >= 0.0) / (abs(theta) + sqrt(theta * theta + 1.0));
    let c = inverseSqrt(t * t + 1.0);
    var turn = mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    turn[i][i] = c;
    turn[j][j] = c;
    turn[j][i] = t * c;
    turn[i][j] = -t * c;
    *s = transpose(turn) * *s * turn;
    *v = *v * turn;
}

/// F with its principal stretches held within STRETCH_LOW and STRETCH_HIGH, given its rotation.
fn limited(f: mat3x3<f32>, r: mat3x3<f32>) -> mat3x3<f32> {
    // The largest stretch is at most |F|, the smallest at least det F over the most that the other
    // two can make together: most Gaussians pass without an eigenvalue.
    let norm2 = squared_norm(f);
    if norm2 <= STRETCH_HIGH * STRETCH_HIGH && determinant(f) >= STRETCH_LOW * 0.5 * norm2 {
        return f;
    }
    var s = transpose(r) * f;
    s = 0.5 * (s + transpose(s));
    var v = mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    for (var sweep = 0u; sweep < JACOBI_SWEEPS; sweep++) {
        jacobi(&s, &v, 0u, 1u);
        jacobi(&s, &v, 0u, 2u);
        jacobi(&s, &v, 1u, 2u);
    }
    let stretch = vec3(s[0].x, s[1].y, s[2].z);
    let held = clamp(stretch, vec3(STRETCH_LOW), vec3(STRETCH_HIGH));
    if all(held == stretch) {
        return f;
    }
    return r * mat3x3(v[0] * held.x, v[1] * held.y, v[2] * held.z) * transpose(v);
}
