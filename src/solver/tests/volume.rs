//! Solids near incompressibility: the passes against their twin, and what they do to a block.

use super::solver;
use super::twins::{CELL_M, run, scene_of, sort};
use crate::Stop;
use crate::solver::substance::Substance::Elastic;
use crate::solver::twin::{self, Surroundings};
use crate::solver::validate::block;
use crate::solver::{Moduli, Plane, Settings, Solver, obstacles};
use crate::spec::ElasticModel::{Corotated, NeoHookean};
use glam::Vec3;

#[test]
fn gains_are_evened_as_by_the_twin() {
    let (mut solver, mut states) = scene_of([Elastic(Corotated), Elastic(NeoHookean)]);
    // The first object is nearly incompressible.
    for s in states.iter_mut().filter(|s| s.object() == 0) {
        s.lambda_pa = 20.0 * s.mu_pa;
        s.history = s.f().determinant().max(0.05).ln() + 0.5 * (s.history - 0.05);
    }
    solver.replace(states.clone());
    let seen = solver.look().expect("a look");
    solver.fit_window(seen.low, seen.high, 4).expect("a window");
    solver.start_segment();
    let colliders = obstacles::colliders(&solver.settings);
    let substances = solver.laws.substances.clone();
    let around = Surroundings { params: solver.params, colliders: &colliders, pins: &[], accelerations: &[Vec3::ZERO; 2], substances: &substances };
    let want = twin::volume::evened(&states, &around);
    sort(&mut solver);
    let bound = solver.bind_both().expect("bound");
    run(|r| solver.record_volume(bound[solver.current].volume.as_ref().expect("passes"), r));
    let mut changed = 0;
    for ((got, want), before) in solver.states().expect("states").iter().zip(&want).zip(&states) {
        assert!(got.f().abs_diff_eq(*want, 1e-5), "particle {}: {} on the device, {want} by the twin", got.index, got.f());
        let moved = !want.abs_diff_eq(before.f(), 1e-4);
        changed += usize::from(moved);
        assert!(!moved || before.object() == 0);
        assert!(!moved || (got.history - got.f().determinant().ln()).abs() < 1e-4);
    }
    assert!(changed > 200, "{changed} particles changed");
}

/// A block that falls on the ground.
fn dropped(poisson: f32) -> Solver {
    let particles = block(Vec3::new(0.0, 0.0, 0.01), Vec3::splat(0.2), 0.025, 1e5, poisson);
    let ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    let mut solver = solver(Settings { ground, ..Settings::new(CELL_M) }, &particles);
    solver.set_velocity(0, Vec3::new(0.0, 0.0, -1.0));
    solver
}

/// How unlike the volumes of particles of one cell are, and of all, as shares of rest.
fn spread(solver: &Solver) -> (f32, f32) {
    let states = solver.states().expect("states");
    let mut cells = std::collections::BTreeMap::<[i32; 3], Vec<f32>>::new();
    for s in &states {
        cells.entry((s.position_m / CELL_M).floor().as_ivec3().to_array()).or_default().push(s.f().determinant());
    }
    let width = |all: &[f32]| all.iter().copied().fold(0.0, f32::max) - all.iter().copied().fold(9.0, f32::min);
    let all: Vec<f32> = states.iter().map(|s| s.f().determinant()).collect();
    (cells.values().map(|c| width(c)).sum::<f32>() / cells.len() as f32, width(&all))
}

#[test]
fn what_is_soft_against_volume_has_no_such_passes() {
    let mut solver = dropped(0.4);
    solver.advance(0.02, &Stop::default()).expect("an advance");
    assert!(solver.volume.is_none() && solver.grid.as_ref().is_some_and(|g| g.gains.is_none()));
    // It becomes stiffer on the way, and softer again.
    solver.change_material(0, None, None, Moduli::Young { young_pa: 1e5, poisson: 0.48 }).expect("a change");
    solver.advance(0.04, &Stop::default()).expect("an advance");
    assert!(solver.volume.is_some() && solver.grid.as_ref().is_some_and(|g| g.gains.is_some()));
    solver.change_material(0, None, None, Moduli::Young { young_pa: 1e5, poisson: 0.3 }).expect("a change");
    solver.advance(0.05, &Stop::default()).expect("an advance");
    assert!(solver.volume.is_none());
}

#[test]
fn cells_share_their_volume_and_resume_to_the_same_bits() {
    let mut whole = dropped(0.49);
    whole.advance(0.04, &Stop::default()).expect("an advance");
    let kept = whole.checkpoint().expect("a checkpoint");
    whole.advance(0.08, &Stop::default()).expect("an advance");
    let (within, all) = spread(&whole);
    assert!(all > 1e-3 && within < 0.5 * all, "{within} within cells, {all} in all");
    let mut resumed = dropped(0.49);
    resumed.restore(&kept).expect("a restore");
    resumed.advance(0.08, &Stop::default()).expect("an advance");
    assert_eq!(whole.states().expect("states"), resumed.states().expect("states"));
}
