// Drucker-Prager with cohesion (Klar et al. 2016): holds ||dev tau|| <= slope (p + p0) and cannot be
// pulled beyond p = -p0. What it has dilated beyond that is remembered, and taken back before it bears
// pressure again, so that loose sand does not gain volume.
//
// values: slope; p0, Pa. History: logarithm of the volume gained while loose.
fn sand(s: Substance, stretches: vec3<f32>, history: f32, mu: f32, lambda: f32) -> Kept {
    let h = hencky(stretches);
    let bulk = lambda + 2.0 / 3.0 * mu;
    let tip = s.values[1] / bulk;
    let strain = h.strain + vec3<f32>(history / 3.0);
    let volume = strain.x + strain.y + strain.z;
    if (volume >= tip) {
        let rest = vec3<f32>(tip / 3.0);
        return strained(h, rest, min(volume - tip, LOOSE_MOST), mu, lambda);
    }
    let mean = vec3<f32>(volume / 3.0);
    let size = 2.0 * mu * length(strain - mean);
    let held = s.values[0] * bulk * (tip - volume);
    if (size <= held) {
        if (history == 0.0) {
            return slipped(h, 1.0, 0.0, mu, lambda);
        }
        return strained(h, strain, 0.0, mu, lambda);
    }
    return strained(h, mean + (strain - mean) * (held / size), 0.0, mu, lambda);
}
