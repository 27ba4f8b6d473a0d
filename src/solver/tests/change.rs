//! Matter that changes in a run.

use super::{block, centre_m, solver};
use crate::Stop;
use crate::solver::substance::Substance;
use crate::solver::validate::append;
use crate::solver::{Moduli, Plane, Settings, Solver, SolverError, Taut};
use glam::Vec3;

const SAND: Substance = Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 };

fn standing(height_m: f32, young_pa: f32, poisson: f32) -> Solver {
    let particles = block(Vec3::new(0.0, 0.0, -0.0125), Vec3::new(0.2, 0.2, height_m), 0.025, young_pa, poisson);
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.6, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    solver.prestress(&[0], &Stop::default(), &mut |_| {}).expect("a prestress");
    solver
}

fn height_m(solver: &Solver) -> f32 {
    solver.states().expect("states").iter().map(|s| s.position_m.z).fold(0.0, f32::max)
}

#[test]
fn a_block_that_turns_to_sand_falls_apart_and_resumes_to_the_same_bits() {
    let stop = Stop::default();
    let mut solver = standing(0.4, 5e5, 0.3);
    solver.advance(0.05, &stop).expect("an advance");
    let before = solver.states().expect("states");
    solver.change_material(0, None, Some(&SAND), Moduli::Kept).expect("a change");
    for (was, is) in before.iter().zip(&solver.states().expect("states")) {
        assert_eq!((was.position_m, was.velocity_m_s, was.mass_kg), (is.position_m, is.velocity_m_s, is.mass_kg));
        assert_eq!((is.substance(), is.object()), (1, 0));
    }
    let kept = solver.checkpoint().expect("a checkpoint");
    solver.advance(0.6, &stop).expect("an advance");
    assert!(height_m(&solver) < 0.3, "it stands {} m high", height_m(&solver));
    // A solver of the same start knows nothing of the change but from the checkpoint.
    let mut other = standing(0.4, 5e5, 0.3);
    other.restore(&kept).expect("a restore");
    other.advance(0.6, &stop).expect("an advance");
    assert!(solver.checkpoint().expect("a checkpoint") == other.checkpoint().expect("a checkpoint"));
    // And back before the change, the table has no sand.
    let mut fresh = standing(0.4, 5e5, 0.3);
    let start = fresh.checkpoint().expect("a checkpoint");
    solver.restore(&start).expect("a restore");
    solver.advance(0.05, &stop).expect("an advance");
    fresh.advance(0.05, &stop).expect("an advance");
    assert!(solver.checkpoint().expect("a checkpoint") == fresh.checkpoint().expect("a checkpoint"));
}

#[test]
fn a_part_may_turn_and_the_rest_stays() {
    let mut solver = standing(0.2, 2e5, 0.3);
    let upper: Vec<u32> = solver.states().expect("states").iter().filter(|s| s.position_m.z > 0.1).map(|s| s.index).collect();
    solver.change_material(0, Some(&upper), Some(&SAND), Moduli::Young { young_pa: 3e5, poisson: 0.2 }).expect("a change");
    for s in solver.states().expect("states") {
        assert_eq!(s.substance(), usize::from(upper.contains(&s.index)));
        assert_eq!(s.mu_pa, if upper.contains(&s.index) { 3e5 / 2.4 } else { 2e5 / 2.6 });
    }
    solver.advance(0.04, &Stop::default()).expect("an advance");
    let refused = |result| assert!(matches!(result, Err(SolverError::Input { .. })));
    refused(solver.change_material(0, Some(&[9_999_999]), None, Moduli::Kept));
    refused(solver.change_material(0, None, None, Moduli::Scaled(-1.0)));
    refused(solver.change_material(0, None, None, Moduli::Young { young_pa: 1e5, poisson: 0.5 }));
    refused(solver.change_material(0, None, Some(&Substance::Sand { friction_angle_deg: 95.0, cohesion_pa: 0.0 }), Moduli::Kept));
}

#[test]
fn what_becomes_stiffer_neither_leaps_nor_looks_other() {
    let mut solver = standing(0.2, 2e3, 0.3);
    // It is far from where it would rest: squeezed to half its height, which a stiff block would leave at 14 m/s.
    solver
        .edit(|s| {
            s.position_m.z *= 0.5;
            s.set_f(glam::Mat3::from_diagonal(Vec3::new(1.0, 1.0, 0.5)) * s.f());
        })
        .expect("an edit");
    let seen = |solver: &Solver| {
        let (states, rows) = (solver.states().expect("states"), solver.gpu.read::<[[f32; 4]; 3]>(&solver.unstressed, solver.params.count as usize));
        let first = rows.expect("rows").iter().map(crate::solver::laws::from_rows).collect::<Vec<_>>();
        states.iter().zip(first).map(|(s, first)| s.f() * first).collect::<Vec<_>>()
    };
    let (before, top_m) = (seen(&solver), height_m(&solver));
    solver.change_material(0, None, Some(&Substance::default()), Moduli::Young { young_pa: 2e6, poisson: 0.3 }).expect("a change");
    assert!(before.iter().zip(seen(&solver)).all(|(a, b)| a.abs_diff_eq(b, 1e-5)), "another shape");
    let fastest = |solver: &Solver| solver.states().expect("states").iter().map(|s| s.velocity_m_s.length()).fold(0.0, f32::max);
    let mut most = 0.0f32;
    for k in 1..=10 {
        solver.advance(0.01 * f64::from(k), &Stop::default()).expect("an advance");
        most = most.max(fastest(&solver));
    }
    // What it carried, 1 kPa, is as much as a twentieth of a metre a second of sound stores.
    assert!(most < 0.2 && (height_m(&solver) / top_m - 1.0).abs() < 0.02, "{most} m/s, {} of {top_m} m", height_m(&solver));
    // However often it is weakened, it is matter.
    for _ in 0..40 {
        solver.change_material(0, None, None, Moduli::Scaled(1e-6)).expect("a change");
    }
    assert!(solver.states().expect("states").iter().all(|s| s.lambda_pa + 2.0 * s.mu_pa > 99.0));
}

#[test]
fn a_weakened_column_sinks_by_as_much_again() {
    // Under half its modulus the strain of its own weight is twice what it was: the top comes down by
    // rho g H^2 / (2 E), and with it the middle by half of that and a quarter less: H^2 / 3 over H^2 / 2.
    let (height_m, young_pa) = (0.4f32, 2e5f32);
    let mut solver = standing(height_m, young_pa, 0.0);
    let start = centre_m(&solver).z;
    solver.change_material(0, None, None, Moduli::Scaled(0.5)).expect("a change");
    let period_s = 4.0 * f64::from(height_m) / f64::from(0.5 * young_pa / 1000.0).sqrt();
    let (mut sunk, samples) = (0.0, 40);
    for k in 1..=samples {
        solver.advance(2.0 * period_s * f64::from(k) / f64::from(samples), &Stop::default()).expect("an advance");
        sunk += (start - centre_m(&solver).z) / samples as f32;
    }
    let expected = 1000.0 * 9.81 * height_m * height_m / (3.0 * young_pa);
    assert!((sunk / expected - 1.0).abs() < 0.1, "sunk by {sunk} m, expected {expected}");
}

#[test]
fn a_lid_on_hardening_is_told_once_from_when_it_is_there() {
    let snow = Substance::Snow { theta_c: 0.025, theta_s: 0.0075, hardening: 10.0 };
    let mut particles = block(Vec3::new(0.0, 0.0, 0.1), Vec3::splat(0.1), 0.025, 1.4e5, 0.2);
    particles.substances = vec![snow.clone()];
    append(&mut particles, block(Vec3::new(0.5, 0.0, 0.1), Vec3::splat(0.1), 0.025, 1e5, 0.3), Substance::default());
    let mut solver = solver(Settings { substeps_most: 40, ..Settings::new(0.05) }, &particles);
    let told = |to_s: f64, solver: &mut Solver| -> Vec<(u32, f64)> {
        let softened = solver.advance(to_s, &Stop::default()).expect("an advance").softened;
        softened.iter().filter(|s| s.what == Taut::Hardening).map(|s| (s.object, s.time_s)).collect()
    };
    assert_eq!(told(0.02, &mut solver), [(0, 0.0)]);
    solver.change_material(1, None, Some(&SAND), Moduli::Kept).expect("a change");
    assert_eq!(told(0.04, &mut solver), []);
    // What turns to snow then is news, and the snow from before is not.
    let other = Substance::Snow { theta_c: 0.02, theta_s: 0.0075, hardening: 10.0 };
    solver.change_material(1, None, Some(&other), Moduli::Young { young_pa: 1.4e5, poisson: 0.2 }).expect("a change");
    assert_eq!(told(0.06, &mut solver).len(), 1);
    assert!(solver.laws.stiffenings[0] < f32::MAX);
}
