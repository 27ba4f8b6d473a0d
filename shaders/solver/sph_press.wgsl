// A round of the correction, first half: the velocities that the present pressures lead to. Where it is needed it
// also lets the next round run, whose workgroups are none otherwise.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> solve: Solve;
@group(0) @binding(2) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> nature: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> neighbours: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> slopes: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> near: array<u32>;
@group(0) @binding(7) var<storage, read> density: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read> pressure: array<f32>;
// Velocities that are corrected.
@group(0) @binding(9) var<storage, read> base: array<vec4<f32>>;
@group(0) @binding(10) var<storage, read> errors: array<u32>;
@group(0) @binding(11) var<storage, read_write> corrected: array<vec4<f32>>;
// Workgroups of every other round, which the one after this is among.
@group(0) @binding(12) var<storage, read_write> turns: array<vec4<u32>>;
var<immediate> substep: Substep;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let round = substep.job;
    if (id.x >= params.count || settled(round, errors[round - 1u])) {
        return;
    }
    if (id.x == 0u) {
        turns[round + 1u] = vec4<u32>(solve.groups, 1u, 1u, 0u);
    }
    let list = unpack_near(near[id.x]);
    // Nobody reads a solid that no liquid is near.
    if (list.liquid || list.liquids > 0u) {
        corrected[id.x] = vec4<f32>(base[id.x].xyz + pushed(id.x, list), 0.0);
    }
}
