// Once, in the captured pose: how densely each Gaussian's surroundings are covered.

@group(0) @binding(0) var<storage, read> moving: array<u32>;
@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> keys: array<u32>;
@group(0) @binding(3) var<storage, read> sums: array<i32>;
@group(0) @binding(4) var<storage, read_write> sizes: array<vec4<f32>>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if slot < params.count {
        sizes[slot].z = around(in_cells(rest[moving[slot] * 4u].xyz)).area;
    }
}
