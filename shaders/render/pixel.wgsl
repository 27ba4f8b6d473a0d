// What a finished pixel becomes: rgba8 over the background, and the planes that were asked for.
// `pixels` holds the packed colours first, then each optional plane.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> starts: array<u32>;
@group(0) @binding(2) var<storage, read> order: array<u32>;
@group(0) @binding(3) var<storage, read> splats: array<Splat>;
@group(0) @binding(4) var<storage, read> object: array<u32>;
@group(0) @binding(5) var<storage, read> backdrop: array<f32>;
@group(0) @binding(6) var<storage, read_write> pixels: array<u32>;

const NOTHING = 0xffffffffu;

// Gradient noise of Jimenez 2014, 0 to 1: even over any small neighbourhood.
fn grain(at: vec2<u32>) -> f32 {
    return fract(52.9829189 * fract(dot(vec2<f32>(at), vec2<f32>(0.06711056, 0.00583715))));
}

// `depth_sum` is the sum of w z, `nearest` the Gaussian of the largest weight.
fn finish(at: vec2<u32>, colour: vec3<f32>, transmittance: f32, depth_sum: f32, heaviest: u32) {
    if (at.x >= frame.size.x || at.y >= frame.size.y) { return; }
    let i = at.y * frame.size.x + at.x;
    let alpha = 1.0 - transmittance;
    var behind = frame.background;
    if (frame.shaded == 1u) { behind *= backdrop[i]; }
    let composited = clamp(colour + transmittance * behind, vec3<f32>(0.0), vec3<f32>(1.0));
    // A ground that darkens slowly would show the steps of eight bits as rings: there they are broken up, each pixel
    // rounding at a place of its own that is the same in every picture.
    var rounding = 0.5;
    if (frame.shaded == 1u && backdrop[i] < 1.0) { rounding = mix(0.5, grain(at), transmittance); }
    let bytes = vec3<u32>(floor(composited * 255.0 + rounding));
    pixels[i] = bytes.x | bytes.y << 8u | bytes.z << 16u | 0xff000000u;
    if (frame.colour_at != NOTHING) {
        let to = frame.colour_at + 4u * i;
        pixels[to] = bitcast<u32>(colour.x);
        pixels[to + 1u] = bitcast<u32>(colour.y);
        pixels[to + 2u] = bitcast<u32>(colour.z);
        pixels[to + 3u] = bitcast<u32>(alpha);
    }
    if (WITH_DEPTH) {
        pixels[frame.depth_at + i] = select(INFINITY_BITS, bitcast<u32>(depth_sum / alpha), alpha > 0.0);
    }
    if (WITH_ID) {
        var id = NOTHING;
        if (heaviest != NOTHING) { id = object[heaviest]; }
        pixels[frame.id_at + i] = id;
    }
}
