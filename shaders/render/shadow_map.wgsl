// Where the map of occlusion lies this frame, and how heights fall into its layers. A layer is a
// horizontal slab of everything that casts; slabs are thin at the bottom, where contact is.

struct Immediates {
    count: u32,
    grounded: u32,
    ground_m: f32,
    spare: u32,
}
var<immediate> params: Immediates;

struct Map {
    origin: vec2<f32>,
    texel: f32,
    low: f32,
    height: f32,
}

/// Floats as unsigned numbers of the same order, so that integer atomics find the largest.
fn ordered(v: f32) -> u32 {
    let b = bitcast<u32>(v);
    return select(b | 0x80000000u, ~b, b >> 31u == 1u);
}

// Of 0, which no float has, 0: nothing is seen.
fn from_ordered(k: u32) -> f32 {
    return bitcast<f32>(select(select(~k, k & 0x7fffffffu, k >> 31u == 1u), 0u, k == 0u));
}

/// Lays the map around the casters: a square with a margin for the penumbra. Its texel grows in
/// steps and its origin moves by whole texels, so that nothing shimmers while a thing moves.
fn map_around(low: vec3<f32>, high: vec3<f32>) -> Map {
    let extent = max(high.x - low.x, high.y - low.y);
    let height = max(high.z - low.z, SMALLEST_TEXEL);
    var lift = 0.0;
    if params.grounded == 1u {
        lift = max(low.z - params.ground_m, 0.0);
    }
    let side = extent + max(extent, height) + 4.0 * SPREAD * lift;
    var texel = SMALLEST_TEXEL;
    for (var step = 0u; step < TEXEL_STEPS && texel * f32(SIDE - 2u) < side; step++) {
        texel *= 1.25;
    }
    let middle = floor(0.5 * (low.xy + high.xy) / texel);
    return Map((middle - f32(SIDE / 2u)) * texel, texel, low.z, height);
}

/// The lower boundary of a layer; that of the layer after the last is the top.
fn boundary(map: Map, layer: u32) -> f32 {
    let t = f32(layer) / f32(LAYERS);
    return map.low + map.height * t * t;
}

fn layer_of(map: Map, z: f32) -> u32 {
    let t = sqrt(clamp((z - map.low) / map.height, 0.0, 1.0));
    return min(u32(t * f32(LAYERS)), LAYERS - 1u);
}
