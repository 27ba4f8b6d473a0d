// One thread a static Gaussian: the light that reaches it, written where the renderer reads it.

@group(0) @binding(0) var<storage, read> receiver: array<u32>;
@group(0) @binding(1) var<storage, read> bounds: array<u32>;
@group(0) @binding(2) var<storage, read> pyramid: array<f32>;
@group(0) @binding(3) var<storage, read> roof: array<u32>;
@group(0) @binding(4) var<storage, read_write> geometry: array<vec4<f32>>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if i >= params.count {
        return;
    }
    let at = receiver[i] * 4u;
    geometry[at + 2u].z = shade_at(current_map(), geometry[at].xyz);
}
