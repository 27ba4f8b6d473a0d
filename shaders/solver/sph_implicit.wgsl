// A step of the implicit viscosity: (1 - dt L) v = v*, by Chebyshev's iteration. It needs no sums over
// all particles, and since L is antisymmetric in each pair every step keeps momentum, however far it is
// from the solution (the spectrum begins at 1 and ends before Gershgorin's bound).

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> solve: Solve;
@group(0) @binding(2) var<storage, read> colliders: array<Collider>;
@group(0) @binding(3) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> nature: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> neighbours: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read> near: array<u32>;
// v*; the present iterate; the one before, which becomes the next.
@group(0) @binding(7) var<storage, read> wanted: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read> present: array<vec4<f32>>;
@group(0) @binding(9) var<storage, read_write> next: array<vec4<f32>>;
@group(0) @binding(10) var<storage, read_write> errors: array<atomic<u32>>;
var<immediate> substep: Substep;

// Of one neighbour, without the common factor.
fn brake(j: u32, at: vec3<f32>, v: vec4<f32>) -> vec3<f32> {
    let other = place[j];
    let y = (at - other.xyz) * params.per_m;
    let q = length(y);
    let u = present[j];
    let coupling = couple_viscosity(v.w, u.w) * abs(other.w) * steepness(q) / (q * q + SOFT_DISTANCE);
    return (coupling * dot(v.xyz - u.xyz, y)) * y;
}

// Minus the viscous acceleration, times the substep.
fn braking(i: u32, list: Near, v: vec4<f32>) -> vec3<f32> {
    let mine = place[i];
    var sum = vec3<f32>(0.0);
    for (var k = 0u; k < list.liquids; k += 4u) {
        let j = neighbours[liquids_from(k, i)];
        sum -= (brake(j.x, mine.xyz, v) + brake(j.y, mine.xyz, v)) + (brake(j.z, mine.xyz, v) + brake(j.w, mine.xyz, v));
    }
    for (var k = 0u; k < list.solids; k += 4u) {
        let j = neighbours[solids_from(k, i)];
        sum -= (brake(j.x, mine.xyz, v) + brake(j.y, mine.xyz, v)) + (brake(j.z, mine.xyz, v) + brake(j.w, mine.xyz, v));
    }
    if (list.liquid) {
        for (var c = 0u; c < params.collider_count; c++) {
            let t = touch(colliders[c], mine.xyz);
            let s = t.distance_m * params.per_m;
            if (s < 1.0 && colliders[c].surface.x > 0.0) {
                let normal = surface_normal(colliders[c], t.face, mine.xyz);
                sum += (v.w * wall_drag(s)) * (v.xyz - normal * dot(v.xyz, normal));
            }
        }
    }
    return (substep.dt_s * VISCOUS * params.per_m * params.per_m * nature[i].x) * sum;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.count) {
        return;
    }
    let list = unpack_near(near[i]);
    if (!list.liquid && list.liquids == 0u) {
        return;
    }
    // The part of the spectrum that the rounds are made for: its middle, and by how much that exceeds half
    // its width. Where it is wider than they can serve, the slowest motions are braked less than they should.
    let widest = 1.0 + substep.dt_s * bitcast<f32>(atomicLoad(&errors[STIFFEST]));
    let least = max(widest / VISCOUS_RANGE, 1.0);
    let middle = 0.5 * (widest + least);
    let over = 2.0 * least / max(widest - least, 1e-6);
    let sigma = 1.0 + over;
    let shrink = 1.0 / (sigma + sqrt(over * (2.0 + over)));
    // 2 sigma T_k(sigma) / T_k+1(sigma), by T_k ~ shrink^-k + shrink^k.
    let k = f32(substep.job);
    let omega = select(2.0 * sigma * shrink * (1.0 + pow(shrink, 2.0 * k)) / (1.0 + pow(shrink, 2.0 * k + 2.0)), 1.0, substep.job == 0u);
    let v = present[i];
    let step = (wanted[i].xyz - v.xyz - braking(i, list, v)) / middle;
    let before = select(next[i].xyz, v.xyz, substep.job == 0u);
    next[i] = vec4<f32>(before + omega * (v.xyz + step - before), v.w);
}
