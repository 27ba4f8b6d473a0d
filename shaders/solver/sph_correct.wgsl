// A round of a correction, second half: what error is left, and the pressures that go against it,
// a relaxed Jacobi step (Bender and Koschier 2017).

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> solve: Solve;
@group(0) @binding(2) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> neighbours: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> near: array<u32>;
@group(0) @binding(5) var<storage, read> density: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> answer: array<f32>;
@group(0) @binding(7) var<storage, read> corrected: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> pressure: array<f32>;
@group(0) @binding(9) var<storage, read_write> errors: array<atomic<u32>>;
// Pressures before they were carried on.
@group(0) @binding(10) var<storage, read_write> reached: array<f32>;
var<immediate> substep: Substep;

// What a neighbour's velocity adds to it, without the common factor.
fn rate(j: u32, at: vec3<f32>, liquid: bool) -> f32 {
    let other = place[j];
    let y = (at - other.xyz) * params.per_m;
    let q = length(y);
    return abs(other.w) * select(solid_steepness(q), steepness(q), liquid) * dot(corrected[j].xyz, y);
}

// Relative change of density in the substep.
fn compression(i: u32, list: Near) -> f32 {
    let at = place[i].xyz;
    var sum = dot(corrected[i].xyz, density[i].xyz);
    for (var k = 0u; k < list.liquids; k += 4u) {
        let j = liquids_from(k, i);
        sum -= (rate(j.x, at, true) + rate(j.y, at, true)) + (rate(j.z, at, true) + rate(j.w, at, true));
    }
    for (var k = 0u; k < list.solids; k += 4u) {
        let j = solids_from(k, i);
        sum -= (rate(j.x, at, false) + rate(j.y, at, false)) + (rate(j.z, at, false) + rate(j.w, at, false));
    }
    return sum * params.per_m * substep.dt_s;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let i = min(id.x, params.count - 1u);
    let list = unpack_near(near[i]);
    let stop = settled(substep.job, atomicLoad(&errors[slot_before(substep.job)]));
    var units = 0u;
    if (!stop && list.liquid && id.x < params.count) {
        // What is too dense from the start is not thrown apart at once.
        let dense = solve.of_density * min(density[i].w - 1.0, THIN_OUT * substep.dt_s);
        // Few neighbours tell little about a divergence.
        let tells = solve.of_density > 0.0 || list.liquids + list.solids >= FEW_NEIGHBOURS;
        let error = select(0.0, dense + compression(i, list), tells);
        let step_m = substep.dt_s * params.per_m;
        let before = pressure[solve.pressure + i];
        let next = select(0.0, max(before + SPH_RELAX * error * answer[i] / (step_m * step_m), 0.0), tells);
        // Nesterov's momentum: what the last rounds had in common goes on.
        let round = f32(substep.job);
        let onward = min(round / (round + 3.0), MOMENTUM) * (next - reached[i]);
        reached[i] = next;
        pressure[solve.pressure + i] = max(next + onward, 0.0);
        // Where there is pressure, too little density is an error too: a pressure too much.
        let left = select(error, abs(error), before > 0.0);
        units = u32(clamp(left / tolerated(substep.dt_s), 0.0, 15.9) * 16.0);
    }
    let sum = subgroupAdd(units);
    if (lane == 0u && sum > 0u) {
        atomicAdd(&errors[solve.slot + substep.job], sum);
    }
}
