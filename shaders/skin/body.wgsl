// Matter that keeps no shape, seen as its particles: what the passes share. Particles are found by the cell
// they lie in, whose hash is their key; those of one key lie together, in their own order, so that sums are
// always taken in the same one.

struct Immediates {
    origin: vec3<f32>,
    // Particles.
    count: u32,
    // Side of a cell: particles so far apart see each other.
    reach_m: f32,
    // Between particles where they fill the room.
    spacing_m: f32,
    // The Gaussian of the first particle.
    first: u32,
    // Keys are below this and one; what keeps its shape has the next.
    mask: u32,
    // Gaussians of each particle: of what is grains several.
    grains: u32,
}
var<immediate> params: Immediates;

fn cell_of(x: vec3<f32>) -> vec3<i32> {
    return vec3<i32>(floor((x - params.origin) / params.reach_m));
}

fn stirred(word: u32) -> u32 {
    var h = word;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 16u);
}

/// 0 to 1.
fn chance(word: u32) -> f32 {
    return f32(word >> 8u) / 16777216.0;
}

fn key_of(cell: vec3<i32>) -> u32 {
    let c = bitcast<vec3<u32>>(cell);
    return stirred(c.x ^ stirred(c.y ^ stirred(c.z))) & params.mask;
}

fn proper(x: vec3<f32>) -> bool {
    return (bitcast<u32>(x.x + x.y + x.z) & 0x7f800000u) != 0x7f800000u;
}

fn cubed(x: f32) -> f32 {
    return x * x * x;
}
