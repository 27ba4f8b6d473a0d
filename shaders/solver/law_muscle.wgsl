// Muscle: elastic, and a fibre m that pulls along itself: tau = tau_elastic + E a (F m)(F m)^T with the
// activation a.
//
// values: m.
fn muscle(s: Substance, trial: mat3x3<f32>, history: f32, mu: f32, lambda: f32, flow: Flow) -> Answer {
    let fibre = trial * vec3<f32>(s.values[0], s.values[1], s.values[2]);
    let pull = young(mu, lambda) * flow.activation;
    let pulled = mat3x3<f32>(fibre * (pull * fibre.x), fibre * (pull * fibre.y), fibre * (pull * fibre.z));
    return Answer(trial, history, kirchhoff(trial, mu, lambda, s.model == 1u) + pulled);
}
