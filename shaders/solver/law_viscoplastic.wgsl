// Bingham: below the yield stress a solid, above it flows with a viscosity: in simple shear
// tau = Y / sqrt(3) + eta rate. Implicit in the step, so that no viscosity limits it; the form is that
// of Yue et al. 2015 for a flow index of 1, with the stiffness of logarithmic strain.
//
// values: yield stress in tension, Pa; viscosity, Pa s.
fn viscoplastic(s: Substance, stretches: vec3<f32>, history: f32, mu: f32, lambda: f32, flow: Flow) -> Kept {
    let h = hencky(stretches);
    let size = 2.0 * mu * deviation(h.strain);
    let excess = size - SQRT_2_3 * s.values[0];
    if (!(excess > 0.0)) {
        return slipped(h, 1.0, history, mu, lambda);
    }
    // Backward Euler of d size / dt = -mu excess / eta.
    let relaxed = mu * flow.dt_s;
    let share = relaxed / max(relaxed + s.values[1], 1e-30);
    return slipped(h, 1.0 - excess * share / size, history, mu, lambda);
}
