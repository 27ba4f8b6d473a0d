// The law of each kind of substance.

// From a trial F, that of the substep taken as elastic, to what the law lets stand of it.
fn respond(s: Substance, trial: mat3x3<f32>, history: f32, mu: f32, lambda: f32, flow: Flow) -> Answer {
    switch (s.kind) {
        case PLASTIC: { return plastic(s, trial, history, mu, lambda); }
        case VISCOPLASTIC: { return viscoplastic(s, trial, history, mu, lambda, flow); }
        case SAND: { return sand(s, trial, history, mu, lambda); }
        case SNOW: { return snow(s, trial, history, mu, lambda); }
        case MUSCLE: { return muscle(s, trial, history, mu, lambda, flow); }
        case LIQUID: { return liquid(s, trial, history, lambda, flow); }
        default: { return Answer(trial, history, kirchhoff(trial, mu, lambda, s.model == 1u)); }
    }
}

// Stress of what stands still and does not yield, for the prestress.
fn resting_stress(s: Substance, f: mat3x3<f32>, mu: f32, lambda: f32) -> mat3x3<f32> {
    if (s.kind == PLASTIC || s.kind == VISCOPLASTIC) {
        let h = hencky(f);
        return hencky_stress(h, h.strain, mu, lambda);
    }
    return kirchhoff(f, mu, lambda, s.model == 1u);
}
