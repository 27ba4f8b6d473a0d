//! Numbers that look random and are always the same, in f32 as on the device: `shaders/solver/chance.wgsl`
//! has the same functions.

/// PCG hash (Jarzynski and Olano 2020).
pub fn hash(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// From 0 to 1, by the bits of the argument; the two zeros are one.
pub fn random(value: f32) -> f32 {
    (hash((value + 0.0).to_bits()) >> 8) as f32 / 16_777_216.0
}

/// Coordinates end here: beyond, f32 has no room for features of size 1.
const FARTHEST: f32 = 1e6;

/// Gradient noise (Perlin 2002: quintic fade), -1 to 1 and mostly within a half, 0 on whole coordinates.
pub fn noise(place: [f32; 3]) -> f32 {
    let place = place.map(|p| p.clamp(-FARTHEST, FARTHEST));
    let low = place.map(f32::floor);
    let inner = [place[0] - low[0], place[1] - low[1], place[2] - low[2]];
    let fade = inner.map(|f| f * f * f * (f * (f * 6.0 - 15.0) + 10.0));
    let mut sum = 0.0;
    for corner in 0..8u32 {
        let bit = [corner & 1, corner >> 1 & 1, corner >> 2];
        let mut weight = 1.0;
        let mut cell = [0u32; 3];
        let mut from = [0.0f32; 3];
        for axis in 0..3 {
            weight *= if bit[axis] == 1 { fade[axis] } else { 1.0 - fade[axis] };
            cell[axis] = (low[axis] as i32).wrapping_add(bit[axis] as i32) as u32;
            from[axis] = inner[axis] - bit[axis] as f32;
        }
        let slope = slope(cell);
        sum += weight * (slope[0] * from[0] + slope[1] * from[1] + slope[2] * from[2]);
    }
    sum.clamp(-1.0, 1.0)
}

/// Gradient at a whole place, each component from -1 to 1.
fn slope(cell: [u32; 3]) -> [f32; 3] {
    let bits = hash(cell[0] ^ hash(cell[1] ^ hash(cell[2])));
    [bits & 1023, bits >> 10 & 1023, bits >> 20 & 1023].map(|b| b as f32 * (2.0 / 1023.0) - 1.0)
}
