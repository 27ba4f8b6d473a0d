// Where all substances are elastic: the passes without the other laws.

fn respond(s: Substance, trial: mat3x3<f32>, history: f32, mu: f32, lambda: f32, flow: Flow) -> Answer {
    return Answer(trial, history, kirchhoff(trial, mu, lambda, s.model == 1u));
}

fn resting_stress(s: Substance, f: mat3x3<f32>, mu: f32, lambda: f32) -> mat3x3<f32> {
    return kirchhoff(f, mu, lambda, s.model == 1u);
}

// Nothing pulls of itself.
fn activation(row: u32, time: u32) -> f32 {
    return 0.0;
}

// Nothing is remembered but F.
fn remember(i: u32, s: Substance, answer: Answer, flow: Flow) {}
