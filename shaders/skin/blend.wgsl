// One thread a moving Gaussian: the weighted maps of its particles, applied to its centre, its
// covariance and the frame of its spherical harmonics.

struct Immediates {
    origin: vec3<f32>,
    count: u32,
    // Between the particles that a Gaussian follows at rest.
    span_m: f32,
    // Those from here on hang on a thread.
    first_hung: u32,
}
var<immediate> params: Immediates;

/// Which Gaussians move, ascending.
@group(0) @binding(0) var<storage, read> moving: array<u32>;
/// The particles of each moving Gaussian, nearest first, in groups of four.
@group(0) @binding(1) var<storage, read> particle: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> weight: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> delta: array<PackedDelta>;
@group(0) @binding(4) var<storage, read> rest: array<vec4<f32>>;
/// How far each particle that is drawn itself has parted from those around it, 0 to 1; a single 0 where none are.
@group(0) @binding(5) var<storage, read> parted: array<f32>;
/// Where those of threads are held, from the origin; they go and turn with what is there, as if stiff.
@group(0) @binding(6) var<storage, read> held: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> geometry: array<vec4<f32>>;

fn delta_of(i: u32) -> Delta {
    return unpacked(delta[i]);
}

/// Whether a particle's matter keeps no shape.
fn sheds(i: u32) -> bool {
    return unpack2x16float(delta[i].b.w).y > 0.5;
}

/// Whether it flew out of what is followed.
fn has_left(i: u32) -> bool {
    return unpack2x16float(delta[i].b.w).y < -0.5;
}

fn added(sum: Delta, d: Delta, w: f32) -> Delta {
    return Delta(sum.x + w * d.x, sum.y + w * d.y, sum.z + w * d.z);
}

/// A blend in the making, and how far apart, squared, any of its particles and the nearest one carry the centre.
struct Blend {
    sum: Delta,
    widest2: f32,
}

fn joined(b: Blend, i: u32, w: f32, centre: vec3<f32>, there: vec3<f32>) -> Blend {
    let d = delta_of(i);
    let apart = moved_by(d, centre) - there;
    return Blend(added(b.sum, d, w), select(b.widest2, max(b.widest2, dot(apart, apart)), !PAPER && w > 0.0));
}

/// As [`joined`], where weights of particles that went elsewhere fade out.
fn joined_near(sum: Delta, total: ptr<function, f32>, i: u32, w: f32, centre: vec3<f32>, there: vec3<f32>) -> Delta {
    let d = delta_of(i);
    let apart = moved_by(d, centre) - there;
    let kept = w * (1.0 - smoothstep(PART_LOW, PART_HIGH, sqrt(dot(apart, apart)) / params.span_m));
    *total += kept;
    return added(sum, d, kept);
}

/// What breaks, pours or crumbles takes its Gaussians along instead of spanning the gap with them.
fn together(slot: u32, centre: vec3<f32>, there: vec3<f32>) -> Delta {
    var sum = zero_delta();
    var total = 0.0;
    for (var v = 0u; v < VECTORS; v++) {
        let i = particle[slot * VECTORS + v];
        let w = weight[slot * VECTORS + v];
        sum = joined_near(sum, &total, i.x, w.x, centre, there);
        sum = joined_near(sum, &total, i.y, w.y, centre, there);
        sum = joined_near(sum, &total, i.z, w.z, centre, there);
        sum = joined_near(sum, &total, i.w, w.w, centre, there);
    }
    return Delta(sum.x / total, sum.y / total, sum.z / total);
}

/// Each particle's map is read once: that is what takes the time.
fn blended(slot: u32, centre: vec3<f32>) -> Delta {
    let nearest = delta_of(particle[slot * VECTORS].x);
    let there = moved_by(nearest, centre);
    var blend = Blend(zero_delta(), 0.0);
    for (var v = 0u; v < VECTORS; v++) {
        let i = particle[slot * VECTORS + v];
        let w = weight[slot * VECTORS + v];
        blend = joined(blend, i.x, w.x, centre, there);
        blend = joined(blend, i.y, w.y, centre, there);
        blend = joined(blend, i.z, w.z, centre, there);
        blend = joined(blend, i.w, w.w, centre, there);
    }
    // Whole motion, affine above all, is not touched.
    if blend.widest2 > PART_LOW * PART_LOW * params.span_m * params.span_m && is_finite(blend.sum) {
        blend.sum = together(slot, centre, there);
    }
    if is_finite(blend.sum) {
        return blend.sum;
    }
    if is_finite(nearest) {
        return nearest;
    }
    return zero_delta();
}

fn gradient(d: Delta) -> mat3x3<f32> {
    return linear_of(d) + mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
}

/// The blend's gradient; where opposite turns cancelled out, the nearest particle's; where that is
/// flat or turned inside out, none.
fn proper_gradient(d: Delta, slot: u32) -> mat3x3<f32> {
    var f = gradient(d);
    if determinant(f) < SMALLEST_DETERMINANT {
        let nearest = delta_of(particle[slot * VECTORS].x);
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
    let hangs = !PAPER && slot >= params.first_hung;
    let own = centre.xyz - params.origin;
    var root = own;
    if hangs {
        root = held[slot - params.first_hung].xyz;
    }
    let d = blended(slot, root);
    var moved = vec3(d.x.w, d.y.w, d.z.w);
    if !PAPER {
        moved = moved_by(d, root);
    }
    var seen = 1.0;
    if !PAPER && sheds(particle[slot * VECTORS].x) {
        seen -= smoothstep(FADES_LOW, FADES_HIGH, parted[min(particle[slot * VECTORS].x, arrayLength(&parted) - 1u)]);
    }
    if has_left(particle[slot * VECTORS].x) {
        seen = 0.0;
    }
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
            if hangs {
                f = r;
                moved += r * (own - root) - (own - root);
            }
            turn = normalize(quaternion_product(quaternion(r), turn));
        }
        let c = f * mat3x3(a.x, a.y, a.z, a.y, a.w, b.x, a.z, b.x, b.y) * transpose(f);
        a = vec4(c[0].x, c[0].y, c[0].z, c[1].y);
        b = vec4(c[1].z, c[2].z, b.z, b.w);
    }
    geometry[at] = vec4(centre.xyz + moved, centre.w * seen);
    geometry[at + 1u] = a;
    geometry[at + 2u] = b;
    geometry[at + 3u] = turn;
}
