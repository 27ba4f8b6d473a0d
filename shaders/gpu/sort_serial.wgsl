// Radix sort for devices where barriers are dear: one invocation owns a block of keys and its column
// of the histogram, all in global memory. Far too slow on a GPU.

var<immediate> shift: u32;

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read> keys: array<u32>;
@group(0) @binding(2) var<storage, read> values: array<u32>;
@group(0) @binding(3) var<storage, read_write> histogram: array<u32>;
@group(0) @binding(4) var<storage, read_write> totals: array<u32>;
@group(0) @binding(5) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> sorted_values: array<u32>;

fn block_count() -> u32 {
    return (extent[0] + ELEMENTS_A_THREAD - 1u) / ELEMENTS_A_THREAD;
}

@compute @workgroup_size(WORKGROUP)
fn count(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let block = (group.y * groups.x + group.x) * WORKGROUP + local;
    let blocks = block_count();
    if (block >= blocks) { return; }
    for (var d = 0u; d < DIGITS; d++) { histogram[d * blocks + block] = 0u; }
    let start = block * ELEMENTS_A_THREAD;
    let end = min(start + ELEMENTS_A_THREAD, extent[0]);
    for (var i = start; i < end; i++) {
        let slot = ((keys[i] >> shift) & (DIGITS - 1u)) * blocks + block;
        histogram[slot] += 1u;
    }
}

@compute @workgroup_size(WORKGROUP)
fn rows(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= DIGITS) { return; }
    let blocks = block_count();
    var carry = 0u;
    for (var i = id.x * blocks; i < (id.x + 1u) * blocks; i++) {
        let count = histogram[i];
        histogram[i] = carry;
        carry += count;
    }
    totals[id.x] = carry;
}

@compute @workgroup_size(WORKGROUP)
fn scatter(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let block = (group.y * groups.x + group.x) * WORKGROUP + local;
    let blocks = block_count();
    if (block >= blocks) { return; }
    var smaller = 0u;
    for (var d = 0u; d < DIGITS; d++) {
        histogram[d * blocks + block] += smaller;
        smaller += totals[d];
    }
    let start = block * ELEMENTS_A_THREAD;
    let end = min(start + ELEMENTS_A_THREAD, extent[0]);
    for (var i = start; i < end; i++) {
        let key = keys[i];
        let slot = ((key >> shift) & (DIGITS - 1u)) * blocks + block;
        let to = histogram[slot];
        histogram[slot] = to + 1u;
        sorted_keys[to] = key;
        sorted_values[to] = values[i];
    }
}
