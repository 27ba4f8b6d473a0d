// Sort, first pass: counts the particles of each block, and marks the blocks that they may reach before
// the next sort.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
// Two words a block of the window: particles, and whether it is active.
@group(0) @binding(3) var<storage, read_write> block_info: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> control: Control;

// Stencil and slack span two blocks along each axis, or three.
fn reach(low: vec3<u32>, high: vec3<u32>, layer: u32) {
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                atomicStore(&block_info[2u * block_number(vec3<u32>(x, y, z), layer) + 1u], 1u);
            }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    if (id.x >= params.count) {
        return;
    }
    let first = base_node(kinematics[id.x].xyz) - params.origin;
    let tag = bitcast<u32>(matter[3u * params.count + id.x].y);
    let slack = vec3<i32>(params.slack);
    if (!in_window(first - slack) || !in_window(first + slack)) {
        atomicStore(&control.window, 1u);
    }
    // Neighbours mostly share a block since the last sort.
    let block = block_number(clamped_cell(first) >> vec3<u32>(2u), sorted_into(tag));
    if (subgroupAll(block == subgroupBroadcastFirst(block))) {
        let together = subgroupAdd(1u);
        if (lane == subgroupMin(lane)) {
            atomicAdd(&block_info[2u * block], together);
        }
    } else {
        atomicAdd(&block_info[2u * block], 1u);
    }
    let low = clamped_cell(first - slack) >> vec3<u32>(2u);
    let high = clamped_cell(first + vec3<i32>(2) + slack) >> vec3<u32>(2u);
    reach(low, high, layer_of(tag));
    if (params.pools != 0u && layer_of(tag) != 0u) {
        reach(low, high, 0u);
    }
}
