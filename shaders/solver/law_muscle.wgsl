// Muscle: elastic, and a fibre m that pulls along itself: tau = tau_elastic + E a (F m)(F m)^T with the
// activation a. What it adds to the elastic stress.
//
// values: m.
fn muscle(s: Substance, f: mat3x3<f32>, mu: f32, lambda: f32, activation: f32) -> mat3x3<f32> {
    let fibre = f * vec3<f32>(s.values[0], s.values[1], s.values[2]);
    let pull = young(mu, lambda) * activation;
    return mat3x3<f32>(fibre * (pull * fibre.x), fibre * (pull * fibre.y), fibre * (pull * fibre.z));
}
