// Sort, fifth pass: where each cell's particles begin and end. One workgroup for each active block. Once a particle
// has left the window the run will be rolled back: then no cell has any, so that nobody looks through those
// that crowd in the cells at the edge.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> block_start: array<u32>;
@group(0) @binding(3) var<storage, read> cell_count: array<u32>;
@group(0) @binding(4) var<storage, read_write> cell_start: array<u32>;
@group(0) @binding(5) var<storage, read_write> cell_end: array<u32>;
@group(0) @binding(6) var<storage, read_write> control: Control;

@compute @workgroup_size(SCAN_LANES)
fn main(@builtin(workgroup_id) group: vec3<u32>, at: Place) {
    let lane = lane_of(at);
    let place = group.y * GROUPS_ACROSS + group.x;
    let slot = 1u + min(place, active_blocks[0] - 1u);
    let cell = slot * 64u + lane;
    let scanned = scan(at, vec3<u32>(cell_count[cell], 0u, 0u));
    let start = block_start[slot] + scanned.before.x;
    cell_start[cell] = start;
    cell_end[cell] = start + select(cell_count[cell], 0u, atomicLoad(&control.window) != 0u);
}
