// Sort, first pass: counts the particles of each cell and block, and marks the blocks that they may
// reach before the next sort.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> cell_count: array<atomic<u32>>;
// Two words a block: particles, and whether it is active.
@group(0) @binding(3) var<storage, read_write> block_info: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> control: Control;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let first = base_node(kinematics[id.x].xyz) - params.origin;
    let reach = vec3<i32>(params.slack);
    if (!in_window(first - reach) || !in_window(first + reach)) {
        atomicStore(&control.window, 1u);
    }
    let cell = clamped_cell(first);
    let offsets = axis_offsets(cell);
    let index = offsets.x + offsets.y + offsets.z;
    atomicAdd(&cell_count[index], 1u);
    atomicAdd(&block_info[2u * (index >> 6u)], 1u);

    // Stencil and slack span at most two blocks along each axis.
    let low = clamped_cell(first - reach) >> vec3<u32>(2u);
    let high = clamped_cell(first + vec3<i32>(2) + reach) >> vec3<u32>(2u);
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                let block = (z * params.blocks.y + y) * params.blocks.x + x;
                atomicStore(&block_info[2u * block + 1u], 1u);
            }
        }
    }
}
