// Numbers that look random and are always the same; `src/spec/expression/noise.rs` has the same functions.

// From 0 to 1, by the bits of the argument; the two zeros are one.
fn random(value: f32) -> f32 {
    return f32(hash(bitcast<u32>(value + 0.0)) >> 8u) / 16777216.0;
}

// Gradient at a whole place, each component from -1 to 1.
fn slope_at(cell: vec3<u32>) -> vec3<f32> {
    let bits = hash(cell.x ^ hash(cell.y ^ hash(cell.z)));
    return vec3<f32>((vec3<u32>(bits) >> vec3<u32>(0u, 10u, 20u)) & vec3<u32>(1023u)) * (2.0 / 1023.0) - vec3<f32>(1.0);
}

// Gradient noise (Perlin 2002: quintic fade), -1 to 1, 0 on whole coordinates.
fn noise(x: f32, y: f32, z: f32) -> f32 {
    let place = clamp(vec3<f32>(x, y, z), vec3<f32>(-1e6), vec3<f32>(1e6));
    let low = floor(place);
    let inner = place - low;
    let fade = inner * inner * inner * (inner * (inner * 6.0 - vec3<f32>(15.0)) + vec3<f32>(10.0));
    var sum = 0.0;
    for (var corner = 0u; corner < 8u; corner++) {
        let bit = vec3<u32>(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let high = bit == vec3<u32>(1u);
        let weights = select(vec3<f32>(1.0) - fade, fade, high);
        let slope = slope_at(bitcast<vec3<u32>>(vec3<i32>(low) + vec3<i32>(bit)));
        sum += weights.x * weights.y * weights.z * dot(slope, inner - vec3<f32>(bit));
    }
    return clamp(sum, -1.0, 1.0);
}
