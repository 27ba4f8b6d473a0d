// One thread a moving Gaussian: the weighted maps of its particles, applied to its centre, its
// covariance and the frame of its spherical harmonics.

struct Immediates {
    origin: vec3<f32>,
    count: u32,
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

fn weighed(sum: Delta, i: u32, w: f32) -> Delta {
    let d = delta[i];
    return Delta(sum.x + w * d.x, sum.y + w * d.y, sum.z + w * d.z);
}

fn blended(slot: u32) -> Delta {
    var sum = zero_delta();
    for (var v = 0u; v < VECTORS; v++) {
        let i = particle[slot * VECTORS + v];
        let w = weight[slot * VECTORS + v];
        sum = weighed(sum, i.x, w.x);
        sum = weighed(sum, i.y, w.y);
        sum = weighed(sum, i.z, w.z);
        sum = weighed(sum, i.w, w.w);
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
    let d = blended(slot);
    let centre = rest[at];
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
