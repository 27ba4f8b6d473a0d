// Takes the particles of each block together again, in whatever order they come, where workgroups go by block and
// nobody asks for cells. What a particle gives is rounded by itself and summed in whole numbers, and what it takes
// is the grid's alone, so nothing but the order in memory depends on who comes first. They were dealt out at
// the segment's first sort, and those that go together stay so: neighbours lie in different cells still.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> kinematics_out: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> matter_out: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> block_start: array<u32>;
@group(0) @binding(6) var<storage, read> number_in_block: array<u32>;
@group(0) @binding(7) var<storage, read_write> control: Control;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    if (atomicLoad(&control.window) != 0u) {
        hand_on(id.x, id.x);
        return;
    }
    let tag = bitcast<u32>(matter[3u * params.count + id.x].y);
    let cell = stored(clamped_cell(base_node(kinematics[id.x].xyz) - params.origin), sorted_into(tag));
    hand_on(id.x, block_start[cell >> 6u] + number_in_block[id.x]);
}
