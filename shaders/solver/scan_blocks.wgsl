// Sort, third pass: which blocks are stored, in ascending order, where, where the particles of each begin,
// and how workgroups share them. Leaves `block_info` zeroed for the next sort.

@group(0) @binding(0) var<storage, read_write> params: Params;
@group(0) @binding(1) var<storage, read_write> block_info: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> chunk_sums: array<vec3<u32>>;
@group(0) @binding(3) var<storage, read_write> block_start: array<u32>;
// Numbers of the active blocks, each where it is stored; the first word is how many there are.
@group(0) @binding(4) var<storage, read_write> active_blocks: array<u32>;
// What a workgroup takes: where a block is stored, its number, its first particle and where they end.
// The first is how many there are.
@group(0) @binding(5) var<storage, read_write> items: array<vec4<u32>>;
// Workgroup counts of a pass with one workgroup for each active block, and of one with one for each item.
@group(0) @binding(6) var<storage, read_write> active_groups: array<vec4<u32>, 2>;
@group(0) @binding(7) var<storage, read_write> control: Control;

fn groups_for(number: u32) -> vec4<u32> {
    return vec4<u32>(min(number, GROUPS_ACROSS), (number + GROUPS_ACROSS - 1u) / GROUPS_ACROSS, 1u, 0u);
}

@compute @workgroup_size(SCAN_LANES)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, at: Place) {
    let lane = lane_of(at);
    var earlier = vec3<u32>(0u);
    for (var k = lane; k < group.x; k += SCAN_LANES) {
        earlier += chunk_sums[k];
    }
    let chunk = scan(at, earlier).total;

    let total = params.blocks.x * params.blocks.y * params.blocks.z * params.layers;
    let first = (group.x * SCAN_LANES + lane) * SCAN_RUN;
    let last = min(first + SCAN_RUN, total);
    var sum = vec3<u32>(0u);
    for (var k = first; k < last; k++) {
        sum += worth(block_info[k]);
    }
    let scanned = scan(at, sum);
    var next = chunk + scanned.before;
    for (var k = first; k < last; k++) {
        let info = block_info[k];
        let slot = next.y + 1u;
        let fits = info.y != 0u && slot < arrayLength(&active_blocks);
        params.slots[k] = select(0u, slot, fits);
        if (fits) {
            active_blocks[slot] = k;
            block_start[slot] = next.x;
        }
        let taken = worth(info);
        for (var item = 0u; item < taken.z; item++) {
            let start = next.x + item * params.item_particles;
            items[1u + next.z + item] = vec4<u32>(slot, k, start, min(start + params.item_particles, next.x + info.x));
        }
        next += taken;
        block_info[k] = vec2<u32>(0u);
    }
    if (group.x == groups.x - 1u && lane == 0u) {
        let wanted = chunk.y + scanned.total.y;
        let number = min(wanted, arrayLength(&active_blocks) - 1u);
        atomicMax(&control.blocks, wanted);
        active_blocks[0] = number;
        active_groups[0] = groups_for(number);
        let shared_by = chunk.z + scanned.total.z;
        items[0] = vec4<u32>(shared_by);
        active_groups[1] = groups_for(shared_by);
    }
}
