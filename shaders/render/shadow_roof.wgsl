// One thread a static Gaussian: the highest static surface below the casters. What lies below it is
// out of the light already.

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
    let cell = vec2<i32>(floor((mean.xy - map.origin) / (map.texel * ROOF_TEXELS)));
    let inside = all(cell >= vec2(0)) && all(cell < vec2(i32(ROOF_SIDE)));
    if inside && mean.w >= ROOF_OPACITY && mean.z <= map.low + map.texel {
        atomicMax(&roof[u32(cell.y) * ROOF_SIDE + u32(cell.x)], ordered(mean.z));
    }
}
