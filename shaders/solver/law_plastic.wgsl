// Von Mises with linear hardening (Simo and Hughes 1998, box 3.2, in logarithmic strain): yields where
// ||dev tau|| = sqrt(2/3) Y, so that Y is the stress of a bar in tension.
//
// values: yield stress, hardening, Pa. History: equivalent plastic strain.
fn plastic(s: Substance, stretches: vec3<f32>, history: f32, mu: f32, lambda: f32) -> Kept {
    let h = hencky(stretches);
    let size = deviation(h.strain);
    let least = YIELD_FLOOR * s.values[0];
    let present = max(s.values[0] + s.values[1] * history, least);
    let excess = 2.0 * mu * size - SQRT_2_3 * present;
    if (!(excess > 0.0)) {
        return slipped(h, 1.0, history, mu, lambda);
    }
    // Softening steeper than the shear stiffness has no answer that follows on; it is kept just flatter.
    var slip = excess / max(2.0 * mu + 2.0 / 3.0 * s.values[1], 0.4 * mu);
    if (s.values[0] + s.values[1] * (history + SQRT_2_3 * slip) < least) {
        slip = size - SQRT_2_3 * least / (2.0 * mu);
    }
    return slipped(h, 1.0 - min(slip / size, 1.0), history + SQRT_2_3 * slip, mu, lambda);
}
