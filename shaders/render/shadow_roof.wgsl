// One thread a static Gaussian: the highest static surface below the casters, and within each of their layers. What
// lies below one is out of the light of that layer, and of those above it, already.

@group(0) @binding(0) var<storage, read> receiver: array<u32>;
@group(0) @binding(1) var<storage, read> geometry: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> bounds: array<u32>;
@group(0) @binding(3) var<storage, read_write> roof: array<atomic<u32>>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if i >= params.count {
        return;
    }
    let mean = geometry[receiver[i] * 4u];
    let map = current_map();
    if mean.w < ROOF_OPACITY || mean.z > map.low + map.height + map.texel {
        return;
    }
    let slot = select(layer_of(map, mean.z) + 1u, 0u, mean.z <= map.low + map.texel);
    let cov = geometry[receiver[i] * 4u + 1u];
    // A wall covers nothing.
    if geometry[receiver[i] * 4u + 2u].y > ROOF_STEEP * (cov.x + cov.w) {
        return;
    }
    let centre = (mean.xy - map.origin) / (map.texel * ROOF_TEXELS);
    let reach = min(1.5 * sqrt(vec2(cov.x, cov.w)) / (map.texel * ROOF_TEXELS), vec2(ROOF_REACH));
    let first = max(vec2<i32>(floor(centre - reach)), vec2(0));
    let last = min(vec2<i32>(floor(centre + reach)), vec2(i32(ROOF_SIDE) - 1));
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            atomicMax(&roof[(slot * ROOF_SIDE + u32(y)) * ROOF_SIDE + u32(x)], ordered(mean.z));
        }
    }
}
