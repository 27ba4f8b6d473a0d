// One thread a moving Gaussian: the weighted maps of its particles, applied to its centre, its
// covariance and the frame of its spherical harmonics.

struct Immediates {
    origin: vec3<f32>,
    count: u32,
    // Between the particles that a Gaussian follows at rest.
    span_m: f32,
}
var<immediate> params: Immediates;

/// Which Gaussians move, ascending.
@group(0) @binding(0) var<storage, read> moving: array<u32>;
/// The particles of each moving Gaussian, nearest first, in groups of four.
@group(0) @binding(1) var<storage, read> particle: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> weight: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> delta: array<Delta>;
@group(0) @binding(4) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> geometry: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> sheds: array<f32>;
/// How far each moving Gaussian has lost its shape, 0 to 1; below 0 where it keeps it whatever happens.
@group(0) @binding(7) var<storage, read_write> loose: array<f32>;

/// Share of a Gaussian's weight whose particles went elsewhere.
var<private> left: f32 = 0.0;

fn weighed(sum: Delta, i: u32, w: f32) -> Delta {
    let d = delta[i];
    return Delta(sum.x + w * d.x, sum.y + w * d.y, sum.z + w * d.z);
}

/// How far apart, squared, four particles and the nearest one carry a centre.
fn apart2(i: vec4<u32>, centre: vec3<f32>, there: vec3<f32>) -> vec4<f32> {
    let x = moved_by(delta[i.x], centre) - there;
    let y = moved_by(delta[i.y], centre) - there;
    let z = moved_by(delta[i.z], centre) - there;
    let w = moved_by(delta[i.w], centre) - there;
    return vec4(dot(x, x), dot(y, y), dot(z, z), dot(w, w));
}

/// Weights of particles that went elsewhere fade out: what breaks, pours or crumbles takes its
/// Gaussians along instead of spanning the gap with them. Whole motion, affine above all, is not touched.
fn together(slot: u32, whole: Delta, centre: vec3<f32>) -> Delta {
    let low2 = PART_LOW * PART_LOW * params.span_m * params.span_m;
    let there = moved_by(delta[particle[slot * VECTORS].x], centre);
    var widest = 0.0;
    for (var v = 0u; v < VECTORS; v++) {
        let apart = select(vec4(0.0), apart2(particle[slot * VECTORS + v], centre, there), weight[slot * VECTORS + v] > vec4(0.0));
        widest = max(widest, max(max(apart.x, apart.y), max(apart.z, apart.w)));
    }
    if widest <= low2 {
        return whole;
    }
    var sum = zero_delta();
    var total = 0.0;
    for (var v = 0u; v < VECTORS; v++) {
        let i = particle[slot * VECTORS + v];
        let apart = sqrt(apart2(i, centre, there)) / params.span_m;
        let w = weight[slot * VECTORS + v] * (1.0 - smoothstep(vec4(PART_LOW), vec4(PART_HIGH), apart));
        total += w.x + w.y + w.z + w.w;
        sum = weighed(sum, i.x, w.x);
        sum = weighed(sum, i.y, w.y);
        sum = weighed(sum, i.z, w.z);
        sum = weighed(sum, i.w, w.w);
    }
    left = 1.0 - total;
    return Delta(sum.x / total, sum.y / total, sum.z / total);
}

fn blended(slot: u32, centre: vec3<f32>) -> Delta {
    var sum = zero_delta();
    for (var v = 0u; v < VECTORS; v++) {
        let i = particle[slot * VECTORS + v];
        let w = weight[slot * VECTORS + v];
        sum = weighed(sum, i.x, w.x);
        sum = weighed(sum, i.y, w.y);
        sum = weighed(sum, i.z, w.z);
        sum = weighed(sum, i.w, w.w);
    }
    if !PAPER && is_finite(sum) {
        sum = together(slot, sum, centre);
    }
    if !is_finite(sum) {
        sum = delta[particle[slot * VECTORS].x];
        if !is_finite(sum) {
            sum = zero_delta();
        }
    }
    return sum;
}

fn gradient(d: Delta) -> mat3x3<f32> {
    return linear_of(d) + mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
}

/// The blend's gradient; where opposite turns cancelled out, the nearest particle's; where that is
/// flat or turned inside out, none.
fn proper_gradient(d: Delta, slot: u32) -> mat3x3<f32> {
    var f = gradient(d);
    if determinant(f) < SMALLEST_DETERMINANT {
        let nearest = delta[particle[slot * VECTORS].x];
        f = gradient(nearest);
        if !is_finite(nearest) || determinant(f) < SMALLEST_DETERMINANT {
            f = gradient(zero_delta());
        }
    }
    return f;
}

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if slot >= params.count {
        return;
    }
    let at = moving[slot] * 4u;
    let centre = rest[at];
    let d = blended(slot, centre.xyz - params.origin);
    loose[slot] = select(-1.0, smoothstep(LEFT_LOW, LEFT_HIGH, left), !PAPER && sheds[particle[slot * VECTORS].x] > 0.5);
    var a = rest[at + 1u];
    var b = rest[at + 2u];
    var turn = rest[at + 3u];

    // What was only carried along keeps its shape to the bit.
    if any(d.x.xyz != vec3(0.0)) || any(d.y.xyz != vec3(0.0)) || any(d.z.xyz != vec3(0.0)) {
        var f = gradient(d);
        if !PAPER {
            f = proper_gradient(d, slot);
            let r = polar_rotation(f);
            f = limited(f, r);
            turn = normalize(quaternion_product(quaternion(r), turn));
        }
        let c = f * mat3x3(a.x, a.y, a.z, a.y, a.w, b.x, a.z, b.x, b.y) * transpose(f);
        a = vec4(c[0].x, c[0].y, c[0].z, c[1].y);
        b = vec4(c[1].z, c[2].z, b.z, b.w);
    }
    var moved = vec3(d.x.w, d.y.w, d.z.w);
    if !PAPER {
        moved = moved_by(d, centre.xyz - params.origin);
    }
    geometry[at] = vec4(centre.xyz + moved, centre.w);
    geometry[at + 1u] = a;
    geometry[at + 2u] = b;
    geometry[at + 3u] = turn;
}
