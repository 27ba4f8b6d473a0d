// Solids whose stress is linear in the logarithm of stretch: tau = U (2 mu e + lambda tr e) U^T with
// e = ln S of F = U S V^T. A return along e is then one along the stress.

struct Hencky {
    axes: Svd,
    // e.
    strain: vec3<f32>,
    // Whether F is inside out or stretched beyond what the law follows; it is cut to that.
    beyond: bool,
}

fn ln_each(s: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(ln_near_one(s.x), ln_near_one(s.y), ln_near_one(s.z));
}

fn hencky(f: mat3x3<f32>) -> Hencky {
    let axes = svd(f);
    let s = clamp(axes.s, vec3<f32>(STRETCH_LEAST), vec3<f32>(STRETCH_MOST));
    return Hencky(axes, ln_each(s), any(s != axes.s));
}

fn hencky_stress(h: Hencky, strain: vec3<f32>, mu: f32, lambda: f32) -> mat3x3<f32> {
    let pressure = lambda * (strain.x + strain.y + strain.z);
    return compose(h.axes.u, 2.0 * mu * strain + vec3<f32>(pressure), h.axes.u);
}

// F with another strain along the same axes. As a change, so that little of it rounds little.
fn strained(h: Hencky, strain: vec3<f32>) -> mat3x3<f32> {
    let s = clamp(h.axes.s, vec3<f32>(STRETCH_LEAST), vec3<f32>(STRETCH_MOST));
    return compose(h.axes.u, s * exp(strain - h.strain), h.axes.v);
}

// What stays of a trial F whose deviatoric strain is scaled by `keep`.
fn slipped(trial: mat3x3<f32>, h: Hencky, keep: f32, history: f32, mu: f32, lambda: f32) -> Answer {
    let mean = vec3<f32>((h.strain.x + h.strain.y + h.strain.z) / 3.0);
    let strain = mean + (h.strain - mean) * keep;
    let tau = hencky_stress(h, strain, mu, lambda);
    if (keep == 1.0 && !h.beyond) {
        return Answer(trial, history, tau);
    }
    return Answer(strained(h, strain), history, tau);
}

fn deviation(strain: vec3<f32>) -> f32 {
    return length(strain - vec3<f32>((strain.x + strain.y + strain.z) / 3.0));
}
