// Takes from the nodes what they give to bodies, as the fixed point of the grid has it.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> bodies: array<Body>;
@group(0) @binding(3) var<storage, read> evened: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> sums: array<vec4<i32>>;
@group(0) @binding(5) var<storage, read_write> meetings: array<Meeting>;
@group(0) @binding(6) var<storage, read_write> control: Control;
var<immediate> substep: Substep;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place >= active_blocks[0]) {
        return;
    }
    let at = node_of(place, lane);
    let node = at.index;
    if (meetings[node].rigid_kg == 0.0) {
        return;
    }
    let b = meetings[node].body & (SLIDES - 1u);
    let more = evened[2u * b].xyz + cross(evened[2u * b + 1u].xyz, position_of(at) - bodies[b].centre.xyz);
    let momentum_unit = momentum_units(substep.index, substep.lag);
    let change = vec3<i32>(round((meetings[node].soft_kg * more - meetings[node].momentum) * momentum_unit));
    sums[node] += vec4<i32>(change, 0);
    meetings[node].impulse = vec3<f32>(-change) / momentum_unit;
}
