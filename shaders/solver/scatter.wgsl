// Sort, sixth pass: each particle takes a slot of its cell, in whatever order they come; the next
// pass puts them in order. Counts are back at zero when all are placed.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> cell_count: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read> cell_start: array<u32>;
// (cell, original index, present index, 0)
@group(0) @binding(5) var<storage, read_write> slots: array<vec4<u32>>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let cell = stored(clamped_cell(base_node(kinematics[id.x].xyz) - params.origin), sorted_into(bitcast<u32>(matter[3u * params.count + id.x].y)));
    let slot = cell_start[cell] + atomicSub(&cell_count[cell], 1u) - 1u;
    slots[slot] = vec4<u32>(cell, bitcast<u32>(matter[3u * params.count + id.x].x), id.x, 0u);
}
