// Sort, third pass: where each block's particles begin, and the list of active blocks in ascending
// order. Leaves `block_info` zeroed for the next sort.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> block_info: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> chunk_sums: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> block_start: array<u32>;
// Active blocks; the first word is their number.
@group(0) @binding(4) var<storage, read_write> active_blocks: array<u32>;
// Workgroup counts of a pass with one workgroup for each active block.
@group(0) @binding(5) var<storage, read_write> active_groups: array<u32>;

@compute @workgroup_size(SCAN_LANES)
fn main(
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    var earlier = vec2<u32>(0u);
    for (var k = lane; k < group.x; k += SCAN_LANES) {
        earlier += chunk_sums[k];
    }
    let chunk = scan(lane, earlier).zw;

    let total = params.blocks.x * params.blocks.y * params.blocks.z;
    let first = (group.x * SCAN_LANES + lane) * SCAN_RUN;
    let last = min(first + SCAN_RUN, total);
    var sum = vec2<u32>(0u);
    for (var k = first; k < last; k++) {
        sum += block_info[k];
    }
    let scanned = scan(lane, sum);
    var next = chunk + scanned.xy;
    for (var k = first; k < last; k++) {
        let info = block_info[k];
        block_start[k] = next.x;
        if (info.y != 0u) {
            active_blocks[1u + next.y] = k;
        }
        next += info;
        block_info[k] = vec2<u32>(0u);
    }
    if (group.x == groups.x - 1u && lane == 0u) {
        let number = chunk.y + scanned.w;
        active_blocks[0] = number;
        active_groups[0] = min(number, GROUPS_ACROSS);
        active_groups[1] = (number + GROUPS_ACROSS - 1u) / GROUPS_ACROSS;
        active_groups[2] = 1u;
    }
}
