// The law of each kind of substance. Each heavy part is written once, for a pass that is long runs long: one search for
// the singular values, one for the rotation.

// From a trial F, that of the substep taken as elastic, to what the law lets stand of it.
fn respond(s: Substance, trial: mat3x3<f32>, history: f32, mu: f32, lambda: f32, flow: Flow) -> Answer {
    if (s.kind == PLASTIC || s.kind == VISCOPLASTIC || s.kind == SAND || s.kind == SNOW) {
        let axes = svd(trial);
        let kept = along_axes(s, axes.s, history, mu, lambda, flow);
        let tau = compose(axes.u, kept.tau, axes.u);
        if (kept.changed) {
            return Answer(compose(axes.u, kept.stretch, axes.v), kept.history, tau);
        }
        return Answer(trial, kept.history, tau);
    }
    var rotation = trial;
    if (s.kind == LIQUID || s.model == 0u) {
        rotation = polar(trial);
    }
    if (s.kind == LIQUID) {
        return liquid(s, trial, rotation, history, lambda, flow);
    }
    var tau = kirchhoff_turned(trial, rotation, mu, lambda, s.model == 1u);
    if (s.kind == MUSCLE) {
        tau += muscle(s, trial, mu, lambda, flow.activation);
    }
    return Answer(trial, history, tau);
}

// Of what yields, given the stretches along its axes.
fn along_axes(s: Substance, stretches: vec3<f32>, history: f32, mu: f32, lambda: f32, flow: Flow) -> Kept {
    switch (s.kind) {
        case PLASTIC: { return plastic(s, stretches, history, mu, lambda); }
        case VISCOPLASTIC: { return viscoplastic(s, stretches, history, mu, lambda, flow); }
        case SAND: { return sand(s, stretches, history, mu, lambda); }
        default: { return snow(s, stretches, history, mu, lambda); }
    }
}

// Stress of what stands still and does not yield, for the prestress.
fn resting_stress(s: Substance, f: mat3x3<f32>, mu: f32, lambda: f32) -> mat3x3<f32> {
    if (s.kind == PLASTIC || s.kind == VISCOPLASTIC) {
        let axes = svd(f);
        return compose(axes.u, hencky_stress(hencky(axes.s).strain, mu, lambda), axes.u);
    }
    return kirchhoff(f, mu, lambda, s.model == 1u);
}
