// Where each bin's pairs start in the sorted list: each thread fills the bins between its key and the
// one before, the thread past the end the rest. starts[bins] is where the last bin ends.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> extent: array<u32>;
@group(0) @binding(2) var<storage, read> keys: array<u32>;
@group(0) @binding(3) var<storage, read_write> starts: array<u32>;

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let i = thread_index(group, groups, local);
    let n = extent[0];
    if (i > n) { return; }
    let bins = frame.bins.x * frame.bins.y;
    var first = 0u;
    var end = bins + 1u;
    if (i > 0u) { first = keys[i - 1u] + 1u; }
    if (i < n) { end = keys[i] + 1u; }
    for (var bin = first; bin < end; bin++) { starts[bin] = i; }
}
