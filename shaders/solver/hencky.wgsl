// What a law of stretches along fixed axes lets stand.
struct Kept {
    // The stretches, and whether any changed.
    stretch: vec3<f32>,
    changed: bool,
    history: f32,
    // Principal Kirchhoff stresses.
    tau: vec3<f32>,
}

// Solids whose stress is linear in the logarithm of stretch: tau = U (2 mu e + lambda tr e) U^T with
// e = ln S of F = U S V^T. A return along e is then one along the stress.

struct Hencky {
    // e.
    strain: vec3<f32>,
    // Stretches, cut to what the law follows, and whether that changed any: F is inside out or beyond.
    stretch: vec3<f32>,
    beyond: bool,
}

fn ln_each(s: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(ln_near_one(s.x), ln_near_one(s.y), ln_near_one(s.z));
}

fn hencky(stretches: vec3<f32>) -> Hencky {
    let s = clamp(stretches, vec3<f32>(STRETCH_LEAST), vec3<f32>(STRETCH_MOST));
    return Hencky(ln_each(s), s, any(s != stretches));
}

fn hencky_stress(strain: vec3<f32>, mu: f32, lambda: f32) -> vec3<f32> {
    let pressure = lambda * (strain.x + strain.y + strain.z);
    return 2.0 * mu * strain + vec3<f32>(pressure);
}

// What stays with another strain along the same axes. As a change, so that little of it rounds little.
fn strained(h: Hencky, strain: vec3<f32>, history: f32, mu: f32, lambda: f32) -> Kept {
    return Kept(h.stretch * exp(strain - h.strain), true, history, hencky_stress(strain, mu, lambda));
}

// What stays where the deviatoric strain is scaled by `keep`.
fn slipped(h: Hencky, keep: f32, history: f32, mu: f32, lambda: f32) -> Kept {
    if (keep == 1.0) {
        return Kept(h.stretch, h.beyond, history, hencky_stress(h.strain, mu, lambda));
    }
    let mean = vec3<f32>((h.strain.x + h.strain.y + h.strain.z) / 3.0);
    return strained(h, mean + (h.strain - mean) * keep, history, mu, lambda);
}

fn deviation(strain: vec3<f32>) -> f32 {
    return length(strain - vec3<f32>((strain.x + strain.y + strain.z) / 3.0));
}
