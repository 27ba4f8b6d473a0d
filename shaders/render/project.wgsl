// World to screen: cull, project (EWA, Zwicker et al. 2001), colour, and the bins each Gaussian touches.
// Comparisons are phrased so that NaN fails them: what is not a proper Gaussian falls out here.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> geometry: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> sh: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> splats: array<Splat>;
@group(0) @binding(4) var<storage, read_write> covers: array<Cover>;
@group(0) @binding(5) var<storage, read_write> visible: array<u32>;
// Largest of ~bits(z) and of bits(z) over what is visible: bits of positive floats order as they do.
@group(0) @binding(6) var<storage, read_write> depth_range: array<atomic<u32>, 2>;

// Bins of a rectangle that the ellipse of the smallest drawn alpha reaches.
fn hits_in(splat: Splat, corner: vec2<u32>, size: vec2<u32>) -> u32 {
    if (size.x * size.y == 1u) { return 1u; }
    let masked = size.x * size.y <= 32u;
    var hits = 0u;
    var bit = 0u;
    for (var y = 0u; y < size.y; y++) {
        for (var x = 0u; x < size.x; x++) {
            let hit = select(0u, 1u, reaches(splat, corner + vec2<u32>(x, y)));
            hits += select(hit, hit << bit, masked);
            bit = (bit + 1u) & 31u;
        }
    }
    return hits;
}

fn project(g: u32) -> Cover {
    let mean = geometry[4u * g];
    let p = vec4<f32>(mean.xyz, 1.0);
    let at = vec3<f32>(dot(frame.camera[0], p), dot(frame.camera[1], p), dot(frame.camera[2], p));
    if (!(at.z > frame.near && at.z < FAR)) { return NO_COVER; }
    let centre = frame.focal * at.xy / at.z + frame.centre;
    if (!(abs(centre.x) < FAR && abs(centre.y) < FAR)) { return NO_COVER; }

    // Covariance in pixels: J W S W^T J^T, with the slope of the projection at a bounded tangent.
    let s = geometry[4u * g + 1u];
    let last = geometry[4u * g + 2u];
    let slope = frame.focal / at.z;
    let bend = slope * clamp(at.xy / at.z, frame.tangent_low, frame.tangent_high);
    let to_x = slope.x * frame.camera[0].xyz - bend.x * frame.camera[2].xyz;
    let to_y = slope.y * frame.camera[1].xyz - bend.y * frame.camera[2].xyz;
    let s_x = vec3<f32>(dot(s.xyz, to_x), dot(vec3<f32>(s.yw, last.x), to_x), dot(vec3<f32>(s.z, last.xy), to_x));
    let s_y = vec3<f32>(dot(s.xyz, to_y), dot(vec3<f32>(s.yw, last.x), to_y), dot(vec3<f32>(s.z, last.xy), to_y));
    let sharp = vec3<f32>(dot(to_x, s_x), dot(to_x, s_y), dot(to_y, s_y));
    let xx = sharp.x + frame.dilation;
    let yy = sharp.z + frame.dilation;
    if (!(sharp.x >= 0.0 && sharp.z >= 0.0 && xx < VARIANCE_MAX && yy < VARIANCE_MAX && abs(sharp.y) < VARIANCE_MAX)) {
        return NO_COVER;
    }
    // Keeps the form positive in single precision where an ellipse is a thousand times longer than wide.
    let xy = clamp(sharp.y, -CORRELATION_MAX * sqrt(xx * yy), CORRELATION_MAX * sqrt(xx * yy));
    let det = xx * yy - xy * xy;

    var opacity = mean.w;
    if (frame.compensation_floor > 0.0) {
        let before = max(sharp.x * sharp.z - sharp.y * sharp.y, 0.0);
        opacity *= max(sqrt(before / det), frame.compensation_floor);
    }
    if (!(opacity >= frame.alpha_min && opacity <= OPACITY_MAX)) { return NO_COVER; }

    let rectangle = bins_of(centre, vec3<f32>(xx, xy, yy), det, opacity);
    let corner = rectangle.xy;
    let size = rectangle.zw;
    if (size.x == 0u || size.y == 0u) { return NO_COVER; }

    let look = normalize(mean.xyz - frame.eye);
    let turn = geometry[4u * g + 3u];
    var raw: vec3<f32>;
    if (last.w > 0.0) {
        raw = lit(SH_C0 * sh[g].xyz + 0.5, turn.xyz, last.w - 1.0, look);
    } else {
        raw = colour_from_sh(g, frame.count, frame.sh_degree, turn_back(turn, look)) + 0.5;
    }
    if (!(all(abs(raw) < vec3<f32>(FAR)) && abs(last.z) < FAR)) { return NO_COVER; }
    let colour = max(raw, vec3<f32>(0.0)) * last.z;

    let inverse = vec3<f32>(yy, -xy, xx) / det;
    let splat = Splat(
        vec4<f32>(centre, 0.5 * LOG2_E * inverse.x, LOG2_E * inverse.y),
        vec4<f32>(0.5 * LOG2_E * inverse.z, log2(opacity), xy / xx, xy / yy),
        vec4<f32>(colour, at.z),
    );
    splats[g] = splat;
    // INRIA's square is filled whole, an ellipse only where it reaches.
    var hits = size.x * size.y;
    if (frame.sigmas == 0.0) {
        hits = hits_in(splat, corner, size);
    } else if (hits <= 32u) {
        hits = 0xffffffffu >> (32u - hits);
    }
    return Cover(corner.x | corner.y << 16u, size.x | size.y << 16u, hits, bitcast<u32>(at.z));
}

// First bin and number of bins, x and y, of the box around an ellipse.
fn bins_of(centre: vec2<f32>, variance: vec3<f32>, det: f32, opacity: f32) -> vec4<u32> {
    let side = f32(1u << frame.bin_shift);
    let corner = centre - 0.5;
    var first: vec2<f32>;
    var end: vec2<f32>;
    if (frame.sigmas > 0.0) {
        let middle = 0.5 * (variance.x + variance.z);
        let radius = ceil(frame.sigmas * sqrt(middle + sqrt(max(0.1, middle * middle - det))));
        first = floor((corner - radius) / side);
        end = floor((corner + radius + side - 1.0) / side);
    } else {
        let reach = sqrt(2.0 * log(opacity / frame.alpha_min)) * sqrt(vec2<f32>(variance.x, variance.z)) * REACH_SLACK + REACH_SLACK - 1.0;
        first = floor((corner - reach) / side);
        end = floor((corner + reach) / side) + 1.0;
    }
    let limit = vec2<f32>(frame.bins);
    let low = vec2<u32>(clamp(first, vec2<f32>(0.0), limit));
    let high = vec2<u32>(clamp(end, vec2<f32>(0.0), limit));
    return vec4<u32>(low, max(high, low) - low);
}

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32, @builtin(subgroup_invocation_id) lane: u32,
) {
    let g = thread_index(group, groups, local);
    var cover = NO_COVER;
    if (g < frame.count) {
        cover = project(g);
        if (touched(cover) == 0u) { cover = NO_COVER; }
        covers[g] = cover;
        visible[g] = select(0u, 1u, cover.hits != 0u);
    }
    // One atomic a subgroup, and none where the range is known to be wider already.
    let near = subgroupMax(select(0u, ~cover.depth, cover.hits != 0u));
    let far = subgroupMax(cover.depth);
    if (lane == 0u) {
        if (near > atomicLoad(&depth_range[0])) { atomicMax(&depth_range[0], near); }
        if (far > atomicLoad(&depth_range[1])) { atomicMax(&depth_range[1], far); }
    }
}
