// Signed distance to a body: a quadratic B-spline over its own voxels.
struct Level {
    distance_m: f32,
    gradient: vec3<f32>,
}

fn coefficient_row(at: u32) -> vec3<f32> {
    return vec3<f32>(field[at], field[at + 1u], field[at + 2u]);
}

// At a point of the body frame; beyond the voxels the way to them is added.
fn level_at(shape: u32, x: vec3<f32>) -> Level {
    let voxel_m = shapes[shape].voxel_m;
    let size = shapes[shape].size;
    let free = (x - shapes[shape].low) / voxel_m;
    let u = clamp(free, vec3<f32>(0.5), vec3<f32>(size) - vec3<f32>(1.501));
    let base = floor(u - vec3<f32>(0.5));
    let t = u - base;
    let a = vec3<f32>(1.5) - t;
    let b = t - vec3<f32>(1.0);
    let c = t - vec3<f32>(0.5);
    let w0 = 0.5 * a * a;
    let w1 = vec3<f32>(0.75) - b * b;
    let w2 = 0.5 * c * c;
    let d1 = -2.0 * b;
    let first = vec3<u32>(base);
    let start = shapes[shape].first_coefficient + (first.z * size.y + first.y) * size.x + first.x;
    var value = 0.0;
    var g = vec3<f32>(0.0);
    for (var k = 0u; k < 9u; k++) {
        let y = k % 3u;
        let z = k / 3u;
        let row = coefficient_row(start + (z * size.y + y) * size.x);
        let along = dot(row, vec3<f32>(w0.x, w1.x, w2.x));
        let slope = dot(row, vec3<f32>(-a.x, d1.x, c.x));
        let wy = pick(vec3<f32>(w0.y, w1.y, w2.y), y);
        let wz = pick(vec3<f32>(w0.z, w1.z, w2.z), z);
        let dy = pick(vec3<f32>(-a.y, d1.y, c.y), y);
        let dz = pick(vec3<f32>(-a.z, d1.z, c.z), z);
        value += along * wy * wz;
        g += vec3<f32>(slope * wy * wz, along * dy * wz, along * wy * dz);
    }
    let beyond = (free - u) * voxel_m;
    let away_m = length(beyond);
    let outward = select(vec3<f32>(0.0), beyond / max(away_m, 1e-20), away_m > 0.0);
    return Level(value + away_m, g / voxel_m + outward);
}
