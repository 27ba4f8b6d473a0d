// A round of the correction, second half: what error is left, and the pressures that go against it,
// a relaxed Jacobi step (Bender and Koschier 2017).
//
// One set of pressures serves both of their corrections. Velocities are made free of divergence, but for what takes
// a share of the density's drift back (Cornelis et al. 2019 on such source terms); room that is still free
// may be closed. So the pressures change slowly, and a substep starts from those of the last.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> solve: Solve;
@group(0) @binding(2) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> neighbours: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> slopes: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> near: array<u32>;
@group(0) @binding(6) var<storage, read> density: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> answer: array<f32>;
@group(0) @binding(8) var<storage, read> corrected: array<vec4<f32>>;
@group(0) @binding(9) var<storage, read_write> pressure: array<f32>;
@group(0) @binding(10) var<storage, read_write> errors: array<atomic<u32>>;
// Pressures before they were carried on.
@group(0) @binding(11) var<storage, read_write> reached: array<f32>;
var<immediate> substep: Substep;

// What a neighbour's velocity adds to it, without the common factor.
fn rate(j: u32, slope: f32, at: vec3<f32>) -> f32 {
    return slope * dot(corrected[j].xyz, at - place[j].xyz);
}

// Relative change of density in the substep.
fn compression(i: u32, list: Near) -> f32 {
    let at = place[i].xyz;
    var sum = 0.0;
    for (var k = 0u; k < list.liquids; k += 4u) {
        let entry = liquids_from(k, i);
        let j = neighbours[entry];
        let slope = slopes[entry];
        sum += (rate(j.x, slope.x, at) + rate(j.y, slope.y, at)) + (rate(j.z, slope.z, at) + rate(j.w, slope.w, at));
    }
    for (var k = 0u; k < list.solids; k += 4u) {
        let entry = solids_from(k, i);
        let j = neighbours[entry];
        let slope = slopes[entry];
        sum += (rate(j.x, slope.x, at) + rate(j.y, slope.y, at)) + (rate(j.z, slope.z, at) + rate(j.w, slope.w, at));
    }
    return (dot(corrected[i].xyz, density[i].xyz) - params.per_m * sum) * params.per_m * substep.dt_s;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let round = substep.job;
    let i = min(id.x, params.count - 1u);
    let list = unpack_near(near[i]);
    let stop = settled(round, atomicLoad(&errors[max(round, 1u) - 1u]));
    var units = 0u;
    if (!stop && list.liquid && id.x < params.count) {
        // What is too dense from the start is not thrown apart at once.
        let excess = density[i].w - 1.0;
        let drift = select(min(DRIFT_SHARE * excess, THIN_OUT * substep.dt_s), excess, excess < 0.0);
        let error = drift + compression(i, list);
        let step_m = substep.dt_s * params.per_m;
        let before = pressure[i];
        let next = max(before + SPH_RELAX * error * answer[i] / (step_m * step_m), 0.0);
        // Nesterov's momentum: what the last rounds had in common goes on.
        let onward = min(f32(round) / (f32(round) + 3.0), MOMENTUM) * (next - select(before, reached[i], round > 0u));
        reached[i] = next;
        pressure[i] = max(next + onward, 0.0);
        // Where there is pressure, too little density is an error too: a pressure too much.
        let left = select(error, abs(error), before > 0.0);
        units = u32(clamp(left / TOLERATED, 0.0, 15.9) * 16.0);
    }
    let sum = subgroupAdd(units);
    if (lane == 0u && sum > 0u) {
        atomicAdd(&errors[round], sum);
    }
}
