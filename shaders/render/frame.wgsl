// What every pass of a frame knows, and what passes hand to each other. Mirrors `uniform.rs`.

struct Frame {
    camera: array<vec4<f32>, 3>,  // rows of world_to_camera; x right, y down, z forward
    eye: vec3<f32>,               // world
    near: f32,                    // Gaussians at z <= near are dropped
    focal: vec2<f32>,             // pixels
    centre: vec2<f32>,            // pixels; pixel centres lie at +0.5
    tangent_low: vec2<f32>,       // the projection's slope is taken no further out than these
    tangent_high: vec2<f32>,
    background: vec3<f32>,        // display-referred
    dilation: f32,                // square pixels added to both variances
    size: vec2<u32>,              // pixels
    bins: vec2<u32>,              // of 1 << bin_shift pixels a side
    bin_shift: u32,
    count: u32,                   // Gaussians
    sh_degree: u32,
    capacity: u32,                // pairs of bin and Gaussian that there is room for
    compensation_floor: f32,      // 0: opacity is not compensated for the dilation
    opacity_cap: f32,
    sigmas: f32,                  // 0: extent from opacity; else a square of this many deviations
    stop: f32,                    // a pixel ends before the splat that takes its transmittance to this
    alpha_min_log2: f32,          // log2 of the smallest alpha that is drawn
    alpha_min: f32,
    shaded: u32,                  // 1: the backdrop has a factor a pixel
    colour_at: u32,               // word of `pixels` where each optional plane starts
    depth_at: u32,
    id_at: u32,
    ground_m: f32,               // world height of the plain ground
    pad: u32,
    pool: vec4<f32>,              // world x, y and radius of the tone under the object; radius 0: none
}

// The bins that one Gaussian touches.
struct Cover {
    corner: u32,  // first bin, x in the low half, y in the high half
    size: u32,    // bins across and down, packed alike
    hits: u32,    // up to 32 bins: one bit each, row by row; more: how many are touched
    depth: u32,   // bits of z
}

const NO_COVER = Cover(0u, 0u, 0u, 0u);

fn low(packed: u32) -> u32 { return packed & 0xffffu; }
fn high(packed: u32) -> u32 { return packed >> 16u; }

// Whether `hits` has a bit for each bin.
fn is_masked(cover: Cover) -> bool { return low(cover.size) * high(cover.size) <= 32u; }

// How many bins are touched. The one place that says so, for whoever counts and whoever emits.
fn touched(cover: Cover) -> u32 {
    return select(cover.hits, countOneBits(cover.hits), is_masked(cover));
}

// Index of a thread in a dispatch that may be folded into y.
fn thread_index(group: vec3<u32>, groups: vec3<u32>, local: u32) -> u32 {
    return (group.y * groups.x + group.x) * THREADS + local;
}
