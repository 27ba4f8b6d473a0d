// Prefix sum for devices where barriers are dear: one invocation owns a block and walks it alone.

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read> values: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<u32>;
@group(0) @binding(3) var<storage, read_write> prefix: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn reduce(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let block = (group.y * groups.x + group.x) * WORKGROUP + local;
    let start = block * ELEMENTS_A_THREAD;
    let n = extent[0];
    if (start >= n) { return; }
    let end = min(start + ELEMENTS_A_THREAD, n);
    var sum = 0u;
    for (var i = start; i < end; i++) { sum += values[i]; }
    sums[1u + block] = sum;
}

@compute @workgroup_size(1)
fn spine() {
    let n = extent[0];
    let blocks = (n + ELEMENTS_A_THREAD - 1u) / ELEMENTS_A_THREAD;
    var carry = 0u;
    for (var block = 0u; block < blocks; block++) {
        let sum = sums[1u + block];
        sums[1u + block] = carry;
        carry += sum;
    }
    prefix[n] = carry;
    sums[0] = carry;
}

@compute @workgroup_size(WORKGROUP)
fn sweep(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let block = (group.y * groups.x + group.x) * WORKGROUP + local;
    let start = block * ELEMENTS_A_THREAD;
    let n = extent[0];
    if (start >= n) { return; }
    let end = min(start + ELEMENTS_A_THREAD, n);
    var carry = sums[1u + block];
    for (var i = start; i < end; i++) {
        let value = values[i];
        prefix[i] = carry;
        carry += value;
    }
}
