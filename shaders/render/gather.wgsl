// How many bins each visible Gaussian touches, nearest first.

@group(0) @binding(0) var<storage, read> extent: array<u32>;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> covers: array<Cover>;
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let rank = thread_index(group, groups, local);
    if (rank < extent[0]) { counts[rank] = touched(covers[order[rank]]); }
}
