// Sort, fourth pass: counts the particles of each cell.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> cell_count: array<atomic<u32>>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let tag = bitcast<u32>(matter[3u * params.count + id.x].y);
    atomicAdd(&cell_count[stored(clamped_cell(base_node(kinematics[id.x].xyz) - params.origin), sorted_into(tag))], 1u);
}
