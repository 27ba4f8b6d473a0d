//! `volume_*.wgsl`: means over cells, by a map of them.

use super::Surroundings;
use crate::solver::constants::{EVEN_FROM, EVEN_MOST, J_FLOOR};
use crate::solver::state::ParticleState;
use glam::Mat3;
use std::collections::BTreeMap;

/// ln det F since what the particle remembers, where its cell counts it.
fn gained(s: &ParticleState, around: &Surroundings) -> Option<f64> {
    let j = f64::from(s.f().determinant());
    let stiff = s.mu_pa > 0.0 && s.lambda_pa > EVEN_FROM * s.mu_pa && around.substances[s.substance()].remembers_volume();
    let most = f64::from(EVEN_MOST);
    (stiff && !s.is_rigid() && j > f64::from(J_FLOOR)).then(|| (j.ln() - f64::from(s.history)).clamp(-most, most))
}

/// F of each particle after its gain became its cell's mean.
pub fn evened(states: &[ParticleState], around: &Surroundings) -> Vec<Mat3> {
    let cell = |s: &ParticleState| (s.object() % around.params.layers, (s.position_m * around.params.per_m).floor().as_ivec3().to_array());
    let mut cells: BTreeMap<_, (f64, f64)> = BTreeMap::new();
    for s in states {
        if let Some(gained) = gained(s, around) {
            let (volume, sum) = cells.entry(cell(s)).or_default();
            *volume += f64::from(s.volume_m3);
            *sum += f64::from(s.volume_m3) * gained;
        }
    }
    let of = |s: &ParticleState| {
        let more = gained(s, around).map_or(0.0, |gained| cells[&cell(s)].1 / cells[&cell(s)].0 - gained);
        (s.f().as_dmat3() * (more / 3.0).exp()).as_mat3()
    };
    states.iter().map(of).collect()
}
