//! Matter that turns into something else, or gives way.

use super::core::Solver;
use super::laws::{Rows, from_rows, rows};
use super::state::ParticleState;
use super::stored::stored_pa;
use super::substance::Substance;
use super::types::SolverError;
use crate::spec::limits;
use glam::{DMat3, Mat3};

/// Nothing is weakened below this modulus.
const SOFTEST_PA: f32 = limits::YOUNG_PA.0 as f32;
/// Newton steps to the rotation of F, which squares its distance from it each time.
const ROTATION_STEPS: u32 = 24;
/// Share by which the energy of what changes may seem to rise, and strain that is rounding.
const ENERGY_SLACK: f32 = 1e-3;
/// Halvings of the share of its strain that is left.
const ENERGY_HALVINGS: u32 = 20;

/// Moduli after a change of material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moduli {
    /// Those that it had.
    Kept,
    /// Those that it had, times a factor over 0: weakened, or hardened. What is as soft as anything may be gets no softer.
    Scaled(f32),
    /// Young's modulus, Pa, and Poisson's ratio.
    Young {
        /// Over 0.
        young_pa: f32,
        /// Over -1 and under 0.5.
        poisson: f32,
    },
    /// Lame's two, Pa; mu may be 0 where the law has no shear.
    Lame {
        /// Shear modulus.
        mu_pa: f32,
        /// With which lambda + 2 mu is over 0.
        lambda_pa: f32,
    },
}

impl Moduli {
    /// (mu, lambda) from those before.
    fn of(self, mu_pa: f32, lambda_pa: f32) -> (f32, f32) {
        match self {
            Moduli::Kept => (mu_pa, lambda_pa),
            Moduli::Scaled(factor) => {
                let factor = factor.max((SOFTEST_PA / (lambda_pa + 2.0 * mu_pa)).min(1.0) * factor.signum());
                (mu_pa * factor, lambda_pa * factor)
            }
            Moduli::Young { young_pa: e, poisson: nu } => (e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))),
            Moduli::Lame { mu_pa, lambda_pa } => (mu_pa, lambda_pa),
        }
    }
}

impl Solver {
    /// Makes an object, or `only` some particles of it by their index, of another substance and with
    /// other moduli, at the present time. Mass, places, velocities and what is seen stay; what F the new
    /// law goes on with is for [`Substance`] to say. No substance: that which it has.
    pub fn change_material(&mut self, object: u32, only: Option<&[u32]>, substance: Option<&Substance>, moduli: Moduli) -> Result<(), SolverError> {
        self.change(object, only, substance, moduli, Shape::Kept)
    }

    /// The same, and the shape that it has now is the one that it returns to: no stress is left in it.
    pub fn freeze(&mut self, object: u32, only: Option<&[u32]>, substance: Option<&Substance>, moduli: Moduli) -> Result<(), SolverError> {
        self.change(object, only, substance, moduli, Shape::Present)
    }

    fn change(&mut self, object: u32, only: Option<&[u32]>, substance: Option<&Substance>, moduli: Moduli, shape: Shape) -> Result<(), SolverError> {
        let row = substance.map(|s| self.row_for(s)).transpose()?;
        let mut picked = vec![only.is_none(); self.params.count as usize];
        for &index in only.into_iter().flatten() {
            let Some(picked) = picked.get_mut(index as usize) else {
                return Err(SolverError::Input { what: format!("particle {index}"), expected: format!("an index under {}", self.params.count) });
            };
            *picked = true;
        }
        let mut states = self.states()?;
        let mut unstressed: Vec<Rows> = self.gpu.read(&self.unstressed, states.len())?;
        let mut shown = self.shown()?;
        let (mut bodies_change, mut poured) = (false, Vec::new());
        for (i, state) in states.iter_mut().enumerate().filter(|(i, s)| picked[*i] && s.object() == object && !s.has_left()) {
            let softer = state.lambda_pa + 2.0 * state.mu_pa;
            let stored = stored_pa(&self.laws.substances[state.substance()], state);
            (state.mu_pa, state.lambda_pa) = moduli.of(state.mu_pa, state.lambda_pa);
            let modulus = state.lambda_pa + 2.0 * state.mu_pa;
            let carried = self.laws.substances[state.substance()].carries_by_stretch();
            let stiff = match substance {
                Some(after) => after.rigid().is_none(),
                None => !state.is_rigid(),
            };
            if stiff && !(state.mu_pa >= 0.0 && modulus > 0.0 && modulus.is_finite()) {
                return Err(SolverError::Input {
                    what: format!("{moduli:?}"),
                    expected: "finite moduli over 0, nu over -1 and under 0.5".to_owned(),
                });
            }
            if row.is_some() || shape == Shape::Present {
                let row = row.unwrap_or(state.substance() as u16);
                let before = &self.laws.substances[state.substance()];
                let after = &self.laws.substances[usize::from(row)];
                turn(state, before, after, shape, &mut unstressed[i], shown.get_mut(i));
                if after.is_sph() && !before.is_sph() {
                    poured.push(i);
                }
                bodies_change |= (state.is_rigid() || after.rigid().is_some()) && state.substance() != usize::from(row);
                state.set_substance(row, after.rigid().is_some());
                if after.is_sph() || after.rigid().is_some() {
                    // It has pressure, or no stress at all, in place of moduli, and no part in the grid.
                    (state.mu_pa, state.lambda_pa, state.affine) = (0.0, 0.0, [0.0; 9]);
                }
            }
            let law = &self.laws.substances[state.substance()];
            if carried && law.carries_by_stretch() && softer > 0.0 && softer < modulus {
                ease(state, softer / modulus, law.shown_stretch().is_none(), &mut unstressed[i]);
            }
            hold_energy(state, law, stored, &mut unstressed[i]);
            state.history = law.history_with(state.f(), state.history);
        }
        if bodies_change {
            self.reassemble(&mut states, &mut unstressed)?;
        }
        self.gpu.upload(&self.unstressed, &unstressed);
        self.set_shown(&shown);
        self.pour(&poured)?;
        self.set_layers(&states)?;
        self.replace(states);
        Ok(())
    }

    /// The row of a substance, added to the table where there is none.
    fn row_for(&mut self, substance: &Substance) -> Result<u16, SolverError> {
        let mut table = self.laws.substances.clone();
        let row = table.iter().position(|s| s == substance).unwrap_or(table.len());
        if row == table.len() {
            table.push(substance.clone());
            self.set_substances(&table)?;
        }
        u16::try_from(row).map_err(|_| SolverError::Input { what: format!("{row} substances"), expected: "at most 65536".to_owned() })
    }
}

/// Which shape matter that changes returns to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    /// What it did, as far as its new law remembers.
    Kept,
    /// The one that it has.
    Present,
}

/// Turns a particle's matter, so that its shape as others see it stays.
fn turn(state: &mut ParticleState, before: &Substance, after: &Substance, shape: Shape, unstressed: &mut Rows, shown: Option<&mut Rows>) {
    let f = state.f();
    let seen = match (&shown, before.shown_stretch()) {
        (Some(shown), Some(_)) => from_rows(shown),
        _ => f * from_rows(unstressed),
    };
    let (next, history) = match shape {
        Shape::Kept => after.taken_over(before, f, state.history),
        Shape::Present => (Mat3::IDENTITY, after.first_history()),
    };
    state.history = history;
    state.set_f(next);
    match (after.shown_stretch(), shown) {
        (Some(_), Some(shown)) => *shown = rows(seen),
        _ if before.shown_stretch().is_some() || next != f => *unstressed = rows((next.as_dmat3().inverse() * seen.as_dmat3()).as_mat3()),
        // F0 is still that of the same F.
        _ => {}
    }
}

/// Matter that becomes stiffer keeps the stress that it carries, not its strain: nobody did the work of straining it so far.
/// V - I, V the left stretch, falls as the modulus rises.
fn ease(state: &mut ParticleState, share: f32, seen_by_f: bool, unstressed: &mut Rows) {
    let f = state.f().as_dmat3();
    // What is inside out or flat carries nothing that is worth keeping.
    let mut next = DMat3::IDENTITY;
    if f.determinant() > 1e-6 {
        let mut turn = f;
        for _ in 0..ROTATION_STEPS {
            turn = (turn + turn.inverse().transpose()) * 0.5;
        }
        let share = f64::from(share);
        next = (f * turn.transpose() * share + DMat3::IDENTITY * (1.0 - share)) * turn;
    }
    if seen_by_f {
        *unstressed = rows((next.inverse() * f * from_rows(unstressed).as_dmat3()).as_mat3());
    }
    state.set_f(next.as_mat3());
}

/// Takes from the strain of what has just changed until it stores no more than before: laws differ where strains are large,
/// and other moduli store other energies.
fn hold_energy(state: &mut ParticleState, law: &Substance, before_pa: f64, unstressed: &mut Rows) {
    let most_pa = before_pa * (1.0 + f64::from(ENERGY_SLACK)) + f64::from(ENERGY_SLACK * ENERGY_SLACK * (state.mu_pa + state.lambda_pa.abs()));
    let eased = |share: f32| {
        let (mut eased, mut unstressed) = (*state, *unstressed);
        ease(&mut eased, share, law.shown_stretch().is_none(), &mut unstressed);
        (eased, unstressed)
    };
    if stored_pa(law, state) <= most_pa {
        return;
    }
    let (mut least, mut most) = (0.0, 1.0);
    for _ in 0..ENERGY_HALVINGS {
        let middle = 0.5 * (least + most);
        if stored_pa(law, &eased(middle).0) <= most_pa { least = middle } else { most = middle }
    }
    (*state, *unstressed) = eased(least);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_crushed_and_turns_into_something_else_stores_no_more_than_before() {
        let crushed = Mat3::from_rotation_x(0.6) * Mat3::from_cols_array(&[2.5, 0.1, 0.0, 0.0, 1.8, 0.3, 0.0, 0.0, 0.004]);
        let laws = crate::solver::tests::laws::all_laws();
        for (before, after) in laws.iter().flat_map(|a| laws.iter().map(move |b| (a, b))) {
            let mut state = ParticleState { mu_pa: 1e3, lambda_pa: 2e3, history: before.first_history(), ..Default::default() };
            state.set_f(crushed);
            let stored = stored_pa(before, &state);
            let (mut unstressed, mut shown) = (rows(Mat3::IDENTITY), rows(Mat3::IDENTITY));
            turn(&mut state, before, after, Shape::Kept, &mut unstressed, Some(&mut shown));
            (state.mu_pa, state.lambda_pa) = (1e3, 5e4);
            let turned = state.f() * from_rows(&unstressed);
            hold_energy(&mut state, after, stored, &mut unstressed);
            assert!(stored_pa(after, &state) <= 1.002 * stored + 0.1, "{before:?} to {after:?}: {stored} became {}", stored_pa(after, &state));
            if after.shown_stretch().is_none() {
                let (seen, was) = (state.f() * from_rows(&unstressed), turned);
                assert!(seen.abs_diff_eq(was, 1e-3), "{before:?} to {after:?}: {was} is seen as {seen}");
            }
        }
    }

    #[test]
    fn what_is_seen_stays_whatever_it_turns_into() {
        let f = Mat3::from_rotation_z(0.4) * Mat3::from_cols_array(&[1.1, 0.02, 0.0, 0.1, 0.93, 0.05, 0.0, 0.0, 1.02]);
        let first = Mat3::from_cols_array(&[0.99, 0.01, 0.0, 0.0, 1.02, 0.0, 0.0, 0.0, 0.98]);
        let [elastic, _, muscle, plastic, _, viscoplastic, sand, _, snow] = crate::solver::tests::laws::all_laws().try_into().expect("nine");
        let laws = [elastic, muscle, plastic, viscoplastic, sand, snow];
        for before in &laws {
            for after in &laws {
                let mut state = ParticleState { history: before.first_history(), ..Default::default() };
                state.set_f(f);
                let (mut unstressed, mut shown) = (rows(first), rows(Mat3::from_rotation_x(0.1) * 0.9));
                let seen = if before.shown_stretch().is_some() { from_rows(&shown) } else { f * first };
                turn(&mut state, before, after, Shape::Kept, &mut unstressed, Some(&mut shown));
                let now = if after.shown_stretch().is_some() { from_rows(&shown) } else { state.f() * from_rows(&unstressed) };
                assert!(now.abs_diff_eq(seen, 1e-5), "{before:?} to {after:?}: {seen} became {now}");
                // Nor does matter appear: volume with what sand and snow remember of it.
                let volume = match after {
                    Substance::Sand { .. } => state.f().determinant() * state.history.exp(),
                    _ => state.f().determinant(),
                };
                assert!((volume / f.determinant() - 1.0).abs() < 1e-4, "{before:?} to {after:?}");
                turn(&mut state, after, before, Shape::Present, &mut unstressed, Some(&mut shown));
                let now = if before.shown_stretch().is_some() { from_rows(&shown) } else { state.f() * from_rows(&unstressed) };
                assert!(now.abs_diff_eq(seen, 1e-5) && state.f() == Mat3::IDENTITY, "{before:?} frozen: {seen} became {now}");
            }
        }
    }
}
