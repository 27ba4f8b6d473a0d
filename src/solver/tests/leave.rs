//! What flies farther apart than the grid holds.

use super::{block, solver};
use crate::Stop;
use crate::solver::state::ParticleState;
use crate::solver::validate::joined;
use crate::solver::{Moduli, Particles, Settings, Solver, SolverError, Substance};
use glam::Vec3;

const CELL_M: f32 = 0.05;
/// Farther along all three axes than any device's window.
const FAR_M: f32 = 4000.0 * CELL_M;
const SMOOTHED: Substance = Substance::SphLiquid { viscosity_pa_s: 0.01, surface_tension_n_m: 0.0 };
const STONE: Substance = Substance::Rigid { friction: 0.3, restitution: 0.0 };

fn of(substance: &Substance) -> Particles {
    Particles { substances: vec![substance.clone()], ..block(Vec3::ZERO, Vec3::splat(0.2), 0.025, 1e5, 0.3) }
}

fn settings() -> Settings {
    Settings { frame_s: 0.02, ..Settings::new(CELL_M) }
}

/// After a frame, with some of its particles thrown far away.
fn torn(particles: &Particles, thrown: impl Fn(&ParticleState) -> bool) -> Solver {
    let mut solver = solver(settings(), particles);
    solver.advance(0.02, &Stop::default()).expect("an advance");
    solver
        .edit(|s| {
            if thrown(s) {
                let out = if s.index % 2 == 0 { 1.0 } else { -1.0 };
                s.position_m += Vec3::splat(out * FAR_M);
                s.velocity_m_s += Vec3::splat(out);
            }
        })
        .expect("an edit");
    solver
}

fn gone(states: &[ParticleState]) -> Vec<u32> {
    states.iter().filter(|s| s.has_left()).map(|s| s.index).collect()
}

#[test]
fn debris_that_no_grid_holds_is_left_behind_and_the_rest_falls_on() {
    let stop = Stop::default();
    for substance in [Substance::default(), Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 }, SMOOTHED] {
        let particles = of(&substance);
        let mut solver = torn(&particles, |s| s.index < 3);
        let kept = solver.checkpoint().expect("a checkpoint");
        let report = solver.advance(0.06, &stop).expect("an advance");
        let left = report.left.get(&0).copied().unwrap_or_default();
        assert!(left.particles == 3 && (left.away_m / FAR_M - 1.0).abs() < 0.01, "{substance:?}: {report:?}");
        let states = solver.states().expect("states");
        assert_eq!(gone(&states), [0, 1, 2]);
        let drop_m_s = 0.06 * 9.81;
        for s in states.iter().filter(|s| !s.has_left()) {
            assert!((s.velocity_m_s.z + drop_m_s).abs() < 0.05 && s.position_m.is_finite(), "{substance:?}: {s:?}");
        }
        // From before and from after the same bits go on, though another window is made.
        let (mut before, mut after) = (torn(&particles, |_| false), torn(&particles, |_| false));
        before.restore(&kept).expect("a restore");
        before.advance(0.04, &stop).expect("an advance");
        after.restore(&before.checkpoint().expect("a checkpoint")).expect("a restore");
        let again = after.advance(0.06, &stop).expect("an advance");
        assert!(again.left.is_empty(), "told twice: {again:?}");
        assert!(after.checkpoint().expect("a checkpoint") == solver.checkpoint().expect("a checkpoint"), "{substance:?}: other bits");
        // What is left behind stays so, whatever the rest turns into, and nothing moves it.
        solver.kick(0, Vec3::X);
        solver.change_material(0, None, Some(&Substance::default()), Moduli::Young { young_pa: 2e5, poisson: 0.2 }).expect("a change");
        solver.advance(0.08, &stop).expect("an advance");
        let later = solver.states().expect("states");
        assert_eq!(gone(&later), [0, 1, 2]);
        assert!((0..3).all(|i| later[i].position_m == states[i].position_m));
    }
}

#[test]
fn a_body_that_flies_off_is_left_whole_and_the_other_stays() {
    let stop = Stop::default();
    let stones = joined(of(&STONE), Particles { position_m: of(&STONE).position_m.iter().map(|x| *x + Vec3::X).collect(), ..of(&STONE) });
    let particles =
        joined(stones, Particles { position_m: of(&STONE).position_m.iter().map(|x| *x + Vec3::Y).collect(), ..of(&Substance::default()) });
    let mut solver = solver(settings(), &particles);
    solver.advance(0.02, &stop).expect("an advance");
    // Bodies are made anew where their particles are.
    let mut states = solver.states().expect("states");
    let second = states.iter().filter(|s| s.object() == 1).count() as u64;
    states.iter_mut().filter(|s| s.object() == 1).for_each(|s| s.position_m += Vec3::splat(FAR_M));
    let mut unstressed = solver.gpu.read(&solver.unstressed, states.len()).expect("F0");
    solver.reassemble(&mut states, &mut unstressed).expect("bodies");
    solver.replace(states);
    let report = solver.advance(0.06, &stop).expect("an advance");
    assert!(report.left.len() == 1 && report.left[&1].particles == second, "{report:?}");
    assert_eq!(solver.motions().expect("bodies").len(), 1);
    let states = solver.states().expect("states");
    for s in states.iter().filter(|s| !s.has_left()) {
        assert!(s.object() != 1 && (s.velocity_m_s.z + 0.06 * 9.81).abs() < 0.05, "{s:?}");
    }
}

#[test]
fn what_is_too_wide_from_the_start_is_refused() {
    let mut particles = of(&Substance::default());
    particles.position_m[0] += Vec3::splat(FAR_M);
    let error = solver(settings(), &particles).advance(0.02, &Stop::default()).expect_err("too wide");
    assert!(matches!(error, SolverError::TooWide { .. }), "{error}");
}
