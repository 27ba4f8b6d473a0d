// Sort, first pass: counts the particles of each block, numbers them in whatever order they come, and marks the blocks
// that they may reach before the next sort.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
// Two words a block of the window: particles, and whether it is active.
@group(0) @binding(3) var<storage, read_write> block_info: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> control: Control;
@group(0) @binding(5) var<storage, read_write> number_in_block: array<u32>;

// Stencil and slack span two blocks along each axis, or three: bits of the 3^3 around the particle's own.
fn reached(at: vec3<u32>, low: vec3<u32>, high: vec3<u32>) -> u32 {
    let before = vec3<u32>(low < at);
    let after = vec3<u32>(high > at);
    let row = before.x | 2u | (after.x << 2u);
    let slab = row * (before.y | 8u | (after.y << 6u));
    return slab * (before.z | 512u | (after.z << 18u));
}

// Blocks that any of the subgroup's particles reach, all of one block: each lane marks some of them.
fn reach_together(at: vec3<u32>, bits: u32, layer: u32, lane: u32, lanes: u32) {
    for (var k = lane; k < 27u; k += lanes) {
        if (((bits >> k) & 1u) != 0u) {
            let block = at + vec3<u32>(k % 3u, k / 3u % 3u, k / 9u) - vec3<u32>(1u);
            atomicStore(&block_info[2u * block_number(block, layer) + 1u], 1u);
            if (params.pools != 0u) {
                atomicStore(&block_info[2u * block_number(block, 0u) + 1u], 1u);
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
    let left = has_left(id.x);
    if (!left && (!in_window(first - slack) || !in_window(first + slack))) {
        atomicStore(&control.window, 1u);
    }
    let low = clamped_cell(first - slack) >> vec3<u32>(2u);
    let high = clamped_cell(first + vec3<i32>(2) + slack) >> vec3<u32>(2u);
    let layer = layer_of(tag);
    let at = clamped_cell(first) >> vec3<u32>(2u);
    let mine = vec2<u32>(block_number(at, sorted_into(tag)), layer);
    // What was left behind lies somewhere at the edge: only its own block.
    let bits = select(reached(at, low, high), 1u << 13u, left);
    // Neighbours mostly share a block, or a few: the lanes of one after the other.
    let lanes = subgroupAdd(1u);
    var waits = true;
    while (subgroupAny(waits)) {
        let speaker = subgroupMin(select(0xffffffffu, lane, waits));
        let block = subgroupShuffle(mine, speaker);
        let counts = waits && all(mine == block);
        let one = select(0u, 1u, counts);
        let together = subgroupAdd(one);
        let before = subgroupExclusiveAdd(one);
        var number = 0u;
        if (lane == speaker) {
            number = atomicAdd(&block_info[2u * block.x], together);
        }
        number = subgroupShuffle(number, speaker) + before;
        if (counts) {
            number_in_block[id.x] = number;
        }
        reach_together(subgroupShuffle(at, speaker), subgroupOr(select(0u, bits, counts)), block.y, lane, lanes);
        waits = waits && !counts;
    }
}
