//! The last resort: what neither shorter substeps nor softer matter resolves loses its strain, and moves as what is around it
//! does. Where that happens again and again without a substep between, the run ends (`retry_budget.rs`).

use super::constants::{J_LEAST, J_MOST};
use super::core::Solver;
use super::retry::Tries;
use super::state::ParticleState;
use super::substance::Substance;
use super::types::{Advance, SolverError};
use glam::{DVec3, IVec3, Mat3, Vec3};
use std::collections::{BTreeMap, HashMap};

impl Solver {
    /// Takes the strain of what no law follows, of what a segment came to, and goes on from there.
    pub(super) fn mend(&mut self, every_law: bool, report: &mut Advance) -> Result<(), SolverError> {
        let laws = self.laws.substances.clone();
        let broken = |s: &ParticleState| {
            let volume = s.f().determinant();
            if every_law { !(J_LEAST..=J_MOST).contains(&volume) } else { laws[s.substance()].must_not_invert() && volume <= 0.0 }
        };
        let mut mended = BTreeMap::new();
        self.edit(|s| {
            if !s.is_rigid() && broken(s) {
                unstrain(s, &laws);
                *mended.entry(s.object()).or_default() += 1;
            }
        })?;
        note(report, mended);
        Ok(())
    }

    /// What is left where a segment fails whatever is done: first the suspect objects, or all where none stands out, lose
    /// their strain and all speed that their neighbours have not, and it is tried once more; then they stop, and time passes.
    /// Whether to try.
    pub(super) fn give_way(&mut self, suspects: u32, tries: &mut Tries, report: &mut Advance) -> Result<bool, SolverError> {
        let suspect = |object: u32| suspects == 0 || suspects >> (object & 31) & 1 != 0;
        let mut states = self.states()?;
        let mut mended = BTreeMap::new();
        states.iter().filter(|s| suspect(s.object())).for_each(|s| *mended.entry(s.object()).or_default() += 1);
        if tries.calmed {
            (0..self.object_count).filter(|object| suspect(*object)).for_each(|object| self.set_velocity(object, Vec3::ZERO));
        } else {
            calm(&mut states, suspect, &self.laws.substances, self.settings.cell_m);
            self.replace(states);
        }
        note(report, mended);
        Ok(!std::mem::replace(&mut tries.calmed, true))
    }
}

fn note(report: &mut Advance, mended: BTreeMap<u32, u64>) {
    mended.into_iter().for_each(|(object, particles)| *report.mended.entry(object).or_default() += particles);
}

/// Leaves a particle its rotation alone, as far as it has one.
fn unstrain(s: &mut ParticleState, laws: &[Substance]) {
    let law = &laws[s.substance()];
    let f = if law.is_liquid() || law.is_sph() { Mat3::IDENTITY } else { rotation(s.f()) };
    s.set_f(f);
    s.set_affine(Mat3::ZERO);
    s.history = if s.history.is_finite() { law.history_with(f, s.history) } else { law.first_history() };
}

/// A rotation near F, whatever F is: its first two columns at right angles.
fn rotation(f: Mat3) -> Mat3 {
    let x = f.x_axis.normalize_or_zero();
    let z = x.cross(f.y_axis).normalize_or_zero();
    let turn = Mat3::from_cols(x, z.cross(x), z);
    if turn.is_finite() && (turn.determinant() - 1.0).abs() < 1e-3 { turn } else { Mat3::IDENTITY }
}

/// Takes the strain of what a predicate picks, and gives it the mean velocity of its object's particles within a cell or two.
fn calm(states: &mut [ParticleState], picked: impl Fn(u32) -> bool, laws: &[Substance], cell_m: f32) {
    let mut centres: BTreeMap<u32, (f64, DVec3)> = BTreeMap::new();
    let mut cells: HashMap<(u32, IVec3), (f64, DVec3)> = HashMap::new();
    let cell = |s: &ParticleState| (s.position_m / cell_m).floor().as_ivec3();
    let add = |sum: &mut (f64, DVec3), kg: f32, v: Vec3| *sum = (sum.0 + f64::from(kg), sum.1 + v.as_dvec3() * f64::from(kg));
    let mean = |sum: (f64, DVec3)| if sum.0 > 0.0 { (sum.1 / sum.0).as_vec3() } else { Vec3::ZERO };
    for s in states.iter().filter(|s| s.position_m.is_finite()) {
        add(centres.entry(s.object()).or_default(), s.mass_kg, s.position_m);
        if s.velocity_m_s.is_finite() {
            add(cells.entry((s.object(), cell(s))).or_default(), s.mass_kg, s.velocity_m_s);
        }
    }
    for s in states.iter_mut().filter(|s| picked(s.object()) && !s.is_rigid()) {
        if !s.position_m.is_finite() {
            s.position_m = mean(centres.get(&s.object()).copied().unwrap_or_default());
        }
        let around = (0..27).map(|k| cell(s) + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
        let near = around.filter_map(|at| cells.get(&(s.object(), at)));
        s.velocity_m_s = mean(near.fold((0.0, DVec3::ZERO), |sum, one| (sum.0 + one.0, sum.1 + one.1)));
        unstrain(s, laws);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_f_is_a_rotation_is_left() {
        let turn = Mat3::from_rotation_y(0.7) * Mat3::from_rotation_z(0.4);
        assert!(rotation(turn).abs_diff_eq(turn, 1e-6));
        for f in [turn * Mat3::from_diagonal(Vec3::new(2.0, 0.1, -0.5)), Mat3::ZERO, Mat3::from_diagonal(Vec3::new(f32::NAN, 1.0, 1.0))] {
            let left = rotation(f);
            assert!((left.determinant() - 1.0).abs() < 1e-5 && (left * left.transpose()).abs_diff_eq(Mat3::IDENTITY, 1e-5), "{f}: {left}");
        }
    }
}
