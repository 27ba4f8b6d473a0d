// A field: what accelerates a particle, by where it is, how fast, and when.

// What an expression knows of a particle.
struct Here {
    x: vec3<f32>,
    v: vec3<f32>,
    x0: vec3<f32>,
    time_s: f32,
    mass_kg: f32,
    seed: f32,
}

// An acceleration and its derivatives, columns by the three components.
struct Pull {
    a: vec3<f32>,
    by_x: mat3x3<f32>,
    by_v: mat3x3<f32>,
}

fn no_pull() -> Pull {
    let zero = vec3<f32>(0.0);
    return Pull(zero, mat3x3<f32>(zero, zero, zero), mat3x3<f32>(zero, zero, zero));
}

// From its three components, each of which carries its gradients.
fn pull_of(x: Dual, y: Dual, z: Dual) -> Pull {
    return Pull(
        vec3<f32>(x.value, y.value, z.value),
        transpose(mat3x3<f32>(x.by_x, y.by_x, z.by_x)),
        transpose(mat3x3<f32>(x.by_v, y.by_v, z.by_v)),
    );
}

fn largest_entry(m: mat3x3<f32>) -> f32 {
    let most = max(max(abs(m[0]), abs(m[1])), abs(m[2]));
    return max(max(most.x, most.y), most.z);
}

// What a pull adds to the velocity over dt: dt (I + 2/3 Z + 1/6 Z^2)^-1 (I + 1/6 Z) a with
// Z = -dt (da/dv + dt da/dx), from the (1, 2) Pade approximant of exp(-Z) (Ehle 1969: stable for any Z
// that does not grow, and gone at once where it is stiff). It follows a linear drag to third order, and takes
// no energy from a spring: in the step of v and x one after the other the stiffness k becomes
// k (1 + z / 6) / (1 + 2/3 z + 1/6 z^2), z = k dt^2, which keeps dt^2 k below 1.1 where 4 is the bound, of which
// the material takes up to two.
// Stiffer than FIELD_STIFFEST a step it is weakened as a whole.
fn velocity_change(p: Pull, dt: f32) -> vec3<f32> {
    let raw = -dt * (p.by_v + dt * p.by_x);
    let share = min(1.0, FIELD_STIFFEST / max(largest_entry(raw), 1e-20));
    let z = raw * share;
    let a = p.a * share;
    let unit = mat3x3<f32>(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), vec3<f32>(0.0, 0.0, 1.0));
    let m = unit + (2.0 / 3.0) * z + (1.0 / 6.0) * (z * z);
    let wanted = dt * (a + (1.0 / 6.0) * (z * a));
    // Cramer's rule.
    let c0 = cross(m[1], m[2]);
    let d = dot(m[0], c0);
    if (!(d > 1e-3)) {
        return dt * a;
    }
    return vec3<f32>(dot(c0, wanted), dot(cross(m[2], m[0]), wanted), dot(cross(m[0], m[1]), wanted)) / d;
}

// The velocity after it. A field brings nothing beyond FIELD_SPEED, nor what substeps follow, and a change that is no number is none.
fn driven(v: vec3<f32>, change: vec3<f32>) -> vec3<f32> {
    let next = v + change;
    if (!finite3(next)) {
        return v;
    }
    let most = max(length(v), min(FIELD_SPEED, params.speed_most));
    return next * min(1.0, most / max(length(next), 1e-20));
}
