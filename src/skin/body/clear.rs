//! What can be seen through: thin liquids are clear, thick ones are not.

use crate::solver::{Flow, Substance};

/// Viscosity up to which a liquid is clear, and from which it hides what is behind it, Pa s: oils lie between.
const VISCOSITY_PA_S: [f32; 2] = [0.03, 3.0];

/// 0 to 1, of a liquid.
pub(super) fn clearness(substance: &Substance) -> Option<f32> {
    let (Substance::Liquid { viscosity_pa_s, .. } | Substance::SphLiquid { viscosity_pa_s, .. }) = substance else {
        return None;
    };
    let [clear, thick] = VISCOSITY_PA_S;
    Some(((thick / viscosity_pa_s.max(f32::MIN_POSITIVE)).ln() / (thick / clear).ln()).clamp(0.0, 1.0))
}

/// Whether it comes apart in grains.
pub(super) fn is_grains(substance: &Substance) -> bool {
    substance.flow() == Some(Flow::Grains)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_is_clear_and_honey_is_not() {
        let of = |viscosity_pa_s| clearness(&Substance::Liquid { viscosity_pa_s, surface_tension_n_m: 0.07 }).unwrap();
        assert!(of(0.0) == 1.0 && of(0.001) == 1.0 && of(10.0) == 0.0 && (of(0.3) - 0.5).abs() < 1e-6);
        assert!(clearness(&Substance::Rigid { friction: 0.5, restitution: 0.5 }).is_none());
    }
}
