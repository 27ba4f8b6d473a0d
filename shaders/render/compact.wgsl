// The visible Gaussians, in their own order, with their depth as key. The key's bits are spread over
// the depths that occur, so that 24 of them are as good as 32.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> covers: array<Cover>;
@group(0) @binding(2) var<storage, read> visible: array<u32>;
@group(0) @binding(3) var<storage, read> place: array<u32>;
@group(0) @binding(4) var<storage, read> depth_range: array<u32, 2>;
@group(0) @binding(5) var<storage, read_write> keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let g = thread_index(group, groups, local);
    if (g >= frame.count || visible[g] == 0u) { return; }
    let nearest = ~depth_range[0];
    let width = 32u - countLeadingZeros(depth_range[1] - nearest);
    let shift = max(width, DEPTH_BITS) - DEPTH_BITS;
    let to = place[g];
    keys[to] = (covers[g].depth - nearest) >> shift;
    values[to] = g;
}
