// Once: the size of each moving Gaussian as captured.

@group(0) @binding(0) var<storage, read> moving: array<u32>;
@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
// Radius of the disc that it covers, metres, no more than lies between particles; its least radius over that;
// how densely its surroundings are covered.
@group(0) @binding(2) var<storage, read_write> sizes: array<vec4<f32>>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if slot >= params.count {
        return;
    }
    let a = rest[moving[slot] * 4u + 1u];
    let b = rest[moving[slot] * 4u + 2u];
    let axes = principal(mat3x3(a.x, a.y, a.z, a.y, a.w, b.x, a.z, b.x, b.y));
    let disc_m = sqrt(sqrt(max(axes.values.x * axes.values.y, 0.0)));
    let thin = sqrt(max(axes.values.z, 0.0)) / max(disc_m, 1e-20);
    sizes[slot] = vec4(min(disc_m, params.span_m), min(thin, 1.0), 0.0, 0.0);
}
