// Sort, second pass: sums over each chunk of SCAN_LANES * SCAN_RUN blocks of the window.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> block_info: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read_write> chunk_sums: array<vec3<u32>>;

@compute @workgroup_size(SCAN_LANES)
fn main(@builtin(workgroup_id) group: vec3<u32>, at: Place) {
    let lane = lane_of(at);
    let total = params.blocks.x * params.blocks.y * params.blocks.z * params.layers;
    let first = (group.x * SCAN_LANES + lane) * SCAN_RUN;
    var sum = vec3<u32>(0u);
    for (var k = first; k < min(first + SCAN_RUN, total); k++) {
        sum += worth(block_info[k]);
    }
    let scanned = scan(at, sum);
    if (lane == 0u) {
        chunk_sums[group.x] = scanned.total;
    }
}
