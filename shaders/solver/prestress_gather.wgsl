// Prestress, on particles: from displacements of the grid to forces. Positions stay.
//
// With positions held, balance is linear in the Kirchhoff stress, and of an isotropic solid that
// stress depends on the left stretch alone, now and whatever happens later. So the stress is sought
// as a linear solid would carry it, A = -(4 / cell^2) volume (2 mu eps + lambda tr eps I); to take it
// over (job ADOPT) F becomes the symmetric stretch whose true stress it is.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> velocity: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> control: Control;
@group(0) @binding(5) var<storage, read> substances: array<Substance>;
var<immediate> substep: Substep;

// What a linear solid answers to a strain.
fn linear_stress(strain: mat3x3<f32>, mu: f32, lambda: f32) -> mat3x3<f32> {
    var tau = (2.0 * mu) * strain;
    let pressure = lambda * (strain[0].x + strain[1].y + strain[2].z);
    tau[0].x += pressure;
    tau[1].y += pressure;
    tau[2].z += pressure;
    return tau;
}

// The strain by which a linear solid answers to a stress.
fn linear_strain(tau: mat3x3<f32>, mu: f32, lambda: f32) -> mat3x3<f32> {
    var strain = tau * (0.5 / mu);
    let trace = (tau[0].x + tau[1].y + tau[2].z) * (0.5 * lambda / (mu * (3.0 * lambda + 2.0 * mu)));
    strain[0].x -= trace;
    strain[1].y -= trace;
    strain[2].z -= trace;
    return strain;
}

fn widest(m: mat3x3<f32>) -> f32 {
    let column = max(max(abs(m[0]), abs(m[1])), abs(m[2]));
    return max(max(column.x, column.y), column.z);
}

// Stretch that carries a stress, from one that carries nearly that: the linear compliance, repeated.
// No solid carries any pressure: where it is more than this one bears, the stretch stops at a bound,
// with what it bears there.
fn carry(start: mat3x3<f32>, wanted: mat3x3<f32>, mu: f32, lambda: f32, s: Substance) -> mat3x3<f32> {
    let unit = mat3x3<f32>(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.0, 0.0, 1.0));
    var f = start;
    for (var k = 0u; k < CARRY_STEPS; k++) {
        let strain = f - unit + CARRY_SHARE * linear_strain(wanted - resting_stress(s, f, mu, lambda), mu, lambda);
        f = unit + strain * min(1.0, CARRY_MOST / max(widest(strain), CARRY_MOST));
    }
    return f;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(subgroup_invocation_id) lane: u32) {
    let n = params.count;
    let i = min(id.x, n - 1u);
    let position = kinematics[i];
    let x = position.xyz;
    let base = base_node(x);
    let gradient = gather(stencil(x, base, vec3<u32>(base - params.origin))).gradient * (4.0 * params.per_m);
    // Objects that take no part have no pseudo mass.
    let takes_part = position.w > 0.0;
    let mu = matter[i].w;
    let lambda = matter[n + i].w;
    let weight = select(0.0, 4.0 * params.per_m * params.per_m * matter[2u * n + i].w, takes_part);
    let adopt = steer(substep.job, params.count) == ADOPT;
    var tau = linear_stress(0.5 * (gradient + transpose(gradient)), mu, lambda);
    if (adopt && takes_part) {
        let s = substances[row_of(bitcast<u32>(matter[3u * n + i].y))];
        let old = read_deformation(i);
        let f = carry(old, resting_stress(s, old, mu, lambda) + tau, mu, lambda, s);
        tau = resting_stress(s, f, mu, lambda);
        if (id.x < n) {
            let rows = transpose(f);
            matter[i] = vec4<f32>(rows[0], mu);
            matter[n + i] = vec4<f32>(rows[1], lambda);
            matter[2u * n + i] = vec4<f32>(rows[2], matter[2u * n + i].w);
        }
    }
    let affine = -weight * tau;
    // Weight, as the velocity that the pseudo mass gains from it in one round; only against the true stress.
    let v = select(vec3<f32>(0.0), params.gravity_m_s2 * matter[3u * n + i].w, adopt && takes_part);
    if (id.x < n) {
        write_motion(i, v, affine);
    }
    // A lane beyond the last particle saw that one while another wrote it, and counts for nothing.
    let most = subgroupMax(select(0u, bitcast<u32>(momentum_measure(position.w, v, affine)), id.x < n));
    if (lane == 0u) {
        atomicMax(&control.momentum[(substep.index + 1u) & 3u], most);
    }
}
