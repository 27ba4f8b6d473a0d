// One thread a caster: its optical depth, spread over the texels of its layer. Sums are integers, so
// that the order in which they arrive does not show.

@group(0) @binding(0) var<storage, read> caster: array<u32>;
@group(0) @binding(1) var<storage, read> geometry: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> bounds: array<u32>;
@group(0) @binding(3) var<storage, read_write> depth: array<atomic<u32>>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if i >= params.count {
        return;
    }
    let at = caster[i] * 4u;
    let mean = geometry[at];
    let a = geometry[at + 1u];
    let b = geometry[at + 2u];
    let map = current_map();

    // Light comes from a cone about the vertical: seen along it, what is tall is wide.
    let lean = SPREAD * SPREAD * b.y;
    let area = (a.x + lean) * (a.w + lean) - a.y * a.y;
    let total = min(mean.w * 6.2831853 * sqrt(max(area, 0.0)) / (map.texel * map.texel), LARGEST_DEPTH);

    // A tent of half width w texels has a standard deviation of w / sqrt(6).
    let width = clamp(2.4494897 * sqrt(vec2(a.x, a.w) + lean) / map.texel, vec2(1.0), vec2(WIDEST_TENT));
    let centre = (mean.xy - map.origin) / map.texel - 0.5;
    let first = vec2<i32>(ceil(centre - width));
    let last = vec2<i32>(floor(centre + width));
    let layer = layer_of(map, mean.z) * SIDE * SIDE;
    for (var y = max(first.y, 0); y <= min(last.y, i32(SIDE) - 1); y++) {
        for (var x = max(first.x, 0); x <= min(last.x, i32(SIDE) - 1); x++) {
            let tent = max(1.0 - abs(vec2(f32(x), f32(y)) - centre) / width, vec2(0.0)) / width;
            atomicAdd(&depth[layer + u32(y) * SIDE + u32(x)], u32(total * tent.x * tent.y * DEPTH_UNIT + 0.5));
        }
    }
}
