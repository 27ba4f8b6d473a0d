//! The energy that matter stores by its law, for changes from one law to another: nobody does work on it then.

use super::constants::{J_FLOOR, STRETCH_LEAST, STRETCH_MOST};
use super::state::ParticleState;
use super::substance::Substance;
use crate::spec::ElasticModel;
use glam::{DMat3, DVec3};

/// Energy per captured volume, Pa.
pub(super) fn stored_pa(law: &Substance, state: &ParticleState) -> f64 {
    let (mu, lambda) = (f64::from(state.mu_pa), f64::from(state.lambda_pa));
    let f = state.f().as_dmat3();
    let s = stretches(f);
    let quadratic = |strain: DVec3, volume: f64| mu * strain.length_squared() + 0.5 * lambda * volume * volume;
    match law {
        Substance::Elastic(model) | Substance::Frozen { model, .. } | Substance::Muscle { model, .. } => match model {
            ElasticModel::Corotated => quadratic(s - DVec3::ONE, s.element_product() - 1.0),
            ElasticModel::NeoHookean => {
                let log = s.element_product().max(f64::from(J_FLOOR)).ln();
                mu * (0.5 * (s.length_squared() - 3.0) - log) + 0.5 * lambda * log * log
            }
        },
        Substance::Plastic { .. } | Substance::Viscoplastic { .. } | Substance::Sand { .. } => {
            let loose = if matches!(law, Substance::Sand { .. }) { f64::from(state.history) } else { 0.0 };
            let cut = s.clamp(DVec3::splat(f64::from(STRETCH_LEAST)), DVec3::splat(f64::from(STRETCH_MOST)));
            let strain = DVec3::new(cut.x.ln(), cut.y.ln(), cut.z.ln()) + DVec3::splat(loose / 3.0);
            quadratic(strain, strain.element_sum())
        }
        Substance::Snow { theta_c, theta_s, hardening } => {
            let kept = s.clamp(DVec3::splat(1.0 - f64::from(*theta_c)), DVec3::splat(1.0 + f64::from(*theta_s)));
            let stiffening = f64::from(*hardening) * (1.0 - f64::from(state.history));
            quadratic(kept - DVec3::ONE, kept.element_product() - 1.0) * stiffening.exp()
        }
        Substance::Liquid { .. } => quadratic(DVec3::ZERO, (s.element_product() - 1.0).min(0.0)),
        Substance::SphLiquid { .. } | Substance::Rigid { .. } => 0.0,
    }
}

/// Principal stretches, the last of them negative where F is inside out: the roots of the characteristic polynomial of F^T F
/// in closed form (Smith 1961).
fn stretches(f: DMat3) -> DVec3 {
    let c = f.transpose() * f;
    let mean = (c.x_axis.x + c.y_axis.y + c.z_axis.z) / 3.0;
    let off = c - DMat3::from_diagonal(DVec3::splat(mean));
    let p = (off.to_cols_array().iter().map(|v| v * v).sum::<f64>() / 6.0).sqrt();
    if p <= 1e-12 * mean {
        return DVec3::splat(mean.max(0.0).sqrt()) * DVec3::new(1.0, 1.0, f.determinant().signum());
    }
    let angle = (0.5 * (off * (1.0 / p)).determinant()).clamp(-1.0, 1.0).acos() / 3.0;
    let third = std::f64::consts::TAU / 3.0;
    let root = |turn: f64| (mean + 2.0 * p * (angle + turn).cos()).max(0.0).sqrt();
    let (most, least) = (root(0.0), root(third));
    // What is left of the volume is exact where the least is all but none.
    let middle = root(-third);
    DVec3::new(most, middle, least.copysign(f.determinant()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat3;

    #[test]
    fn stretches_are_those_that_were_put_in() {
        for s in [DVec3::new(3.0, 1.0, 0.2), DVec3::ONE, DVec3::new(2.0, 2.0, 0.5), DVec3::new(1.5, 0.7, -0.3)] {
            let turns = (DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(2.0), DMat3::from_rotation_y(-1.1));
            let found = stretches(turns.0 * DMat3::from_diagonal(s) * turns.1);
            assert!(found.abs_diff_eq(s, 1e-6), "{s} came out as {found}");
        }
    }

    #[test]
    fn the_energy_of_a_small_strain_is_that_of_hooke_whatever_the_law() {
        let strain = DVec3::new(1e-3, -2e-3, 5e-4);
        let mut state = ParticleState { mu_pa: 3e4, lambda_pa: 7e4, ..Default::default() };
        state.set_f(Mat3::from_diagonal((DVec3::ONE + strain).as_vec3()));
        let hooke = 3e4 * strain.length_squared() + 3.5e4 * strain.element_sum().powi(2);
        let plastic = Substance::Plastic { yield_stress_pa: 1e9, hardening_pa: 0.0 };
        for law in [Substance::Elastic(ElasticModel::Corotated), Substance::Elastic(ElasticModel::NeoHookean), plastic] {
            let found = stored_pa(&law, &state);
            assert!((found / hooke - 1.0).abs() < 5e-3, "{law:?}: {found} of {hooke}");
        }
    }
}
