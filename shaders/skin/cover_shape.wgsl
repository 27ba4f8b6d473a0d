// One thread a moving Gaussian that has lost its shape: what is loose takes its shape from what lies around it.
// Where that has spread it grows, so that what was covered stays covered; where it is piled up it shrinks. It is
// round in the plane of a sheet, thin across it as its volume asks, round all over in a heap or alone. What lies
// together is of one size: each covers an equal share.

@group(0) @binding(0) var<storage, read> moving: array<u32>;
@group(0) @binding(1) var<storage, read> loose: array<f32>;
@group(0) @binding(2) var<storage, read> sizes: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> keys: array<u32>;
@group(0) @binding(4) var<storage, read> sums: array<i32>;
@group(0) @binding(5) var<storage, read_write> geometry: array<vec4<f32>>;

// Covariance, square metres.
fn spaced(size: vec4<f32>, x: vec3<f32>) -> mat3x3<f32> {
    let here = around(in_cells(x));
    let share = size.x / params.span_m;
    // Of what covers the place, how much is its own: alone, nothing tells how far others are.
    let together = 1.0 - smoothstep(ALONE_LOW, ALONE_HIGH, share * share / max(here.area, 1e-20));
    let grown = mix(1.0, clamp(sqrt(size.z / max(here.area, 1e-20)), COVER_LEAST, COVER_MOST), together);
    let axes = principal(here.spread);
    // 0 in a sheet, 1 where the least spread is like the others.
    let flat = (max(axes.values.z, 0.0) + SPREAD_LEAST) / (axes.values.y + SPREAD_LEAST);
    let thinnest = clamp(size.y / (grown * grown * grown), SHEET_LEAST, 1.0);
    let thin = mix(1.0, mix(thinnest, 1.0, smoothstep(SHEET_LOW, SHEET_HIGH, flat)), together);
    let n = axes.least;
    let across = mat3x3(n * n.x, n * n.y, n * n.z);
    let unit = mat3x3(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let even_m = mix(size.x, params.span_m * sqrt(here.each), together);
    let radius_m = grown * even_m;
    return (unit - across * (1.0 - thin * thin)) * (radius_m * radius_m);
}

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if slot >= params.count || loose[slot] <= 0.0 {
        return;
    }
    let at = moving[slot] * 4u;
    let c = spaced(sizes[slot], geometry[at].xyz);
    let a = geometry[at + 1u];
    let b = geometry[at + 2u];
    geometry[at + 1u] = mix(a, vec4(c[0].x, c[0].y, c[0].z, c[1].y), loose[slot]);
    geometry[at + 2u] = vec4(mix(b.xy, vec2(c[1].z, c[2].z), loose[slot]), b.zw);
}
