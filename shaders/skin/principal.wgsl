// The principal axes of a symmetric matrix.

struct Principal {
    // Descending.
    values: vec3<f32>,
    // Unit vectors of the largest and of the least.
    most: vec3<f32>,
    least: vec3<f32>,
}

fn principal(matrix: mat3x3<f32>) -> Principal {
    let size = max(abs(matrix[0].x) + abs(matrix[1].y) + abs(matrix[2].z), 1e-30);
    var s = matrix * (1.0 / size);
    var v = mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    for (var sweep = 0u; sweep < JACOBI_SWEEPS; sweep++) {
        jacobi(&s, &v, 0u, 1u);
        jacobi(&s, &v, 0u, 2u);
        jacobi(&s, &v, 1u, 2u);
    }
    let e = vec3(s[0].x, s[1].y, s[2].z);
    let most = max(e.x, max(e.y, e.z));
    let least = min(e.x, min(e.y, e.z));
    var long = v[0];
    if e.z == most {
        long = v[2];
    } else if e.y == most {
        long = v[1];
    }
    var short = v[0];
    if e.z == least {
        short = v[2];
    } else if e.y == least {
        short = v[1];
    }
    return Principal(vec3(most, e.x + e.y + e.z - most - least, least) * size, long, short);
}
