//! What no substep resolves: it is softened or held back, costs a bounded number of substeps, and a run goes on from any
//! checkpoint as if it had not been interrupted.

use super::{block, solver};
use crate::Stop;
use crate::solver::validate::joined;
use crate::solver::{Advance, Collider, Particles, Placement, Plane, Settings, Solver, SolverError, Substance, Taut};
use crate::spec::{ColliderShape, ElasticModel, PlaneShape, SphereShape};
use glam::{Mat3, Quat, Vec3};

fn grounded(cell_m: f32, substeps_most: u32) -> Settings {
    Settings { ground: Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 }), substeps_most, ..Settings::new(cell_m) }
}

/// A block of 4 x 4 x 4 cells that stands at a place, in cells.
fn of(substance: Substance, at_cells: Vec3, cell_m: f32, young_pa: f32) -> Particles {
    let mut particles = block(at_cells * cell_m, Vec3::splat(4.0 * cell_m), 0.5 * cell_m, young_pa, 0.2);
    particles.substances = vec![substance];
    particles
}

fn thrown(velocity_m_s: Vec3, spin_rad_s: Vec3) -> Placement {
    Placement { rotation: Quat::IDENTITY, centre_m: Vec3::ZERO, offset_m: Vec3::ZERO, velocity_m_s, spin_rad_s }
}

fn frames(solver: &mut Solver, count: u32) -> Advance {
    let to_s = solver.time_s() + f64::from(count) * solver.settings.frame_s;
    solver.advance(to_s, &Stop::default()).expect("an advance")
}

const SNOW: Substance = Substance::Snow { theta_c: 0.025, theta_s: 0.0075, hardening: 13.0 };
const DROP: Substance = Substance::Liquid { viscosity_pa_s: 0.1, surface_tension_n_m: 900.0 };
const SMOOTHED: Substance = Substance::SphLiquid { viscosity_pa_s: 0.1, surface_tension_n_m: 900.0 };
const STONE: Substance = Substance::Rigid { friction: 0.3, restitution: 0.2 };

#[test]
fn snow_that_would_pack_beyond_what_is_carried_stiffens_as_far_as_that_and_says_so() {
    let cell_m = 0.1;
    let particles = of(SNOW, Vec3::new(0.0, 0.0, 0.5), cell_m, 1.5e10);
    let mut solver = solver(grounded(cell_m, 100), &particles);
    solver.place(0, &thrown(Vec3::new(0.0, 0.0, -100.0), Vec3::ZERO)).expect("a placement");
    let report = frames(&mut solver, 3);
    let said: Vec<Taut> = report.softened.iter().map(|s| s.what).collect();
    assert!(said.contains(&Taut::Stiffness) && said.contains(&Taut::Hardening), "{report:?}");
    assert!(report.substeps <= 3 * 200 && report.retries <= 3, "{report:?}");
    let states = solver.states().expect("states");
    assert!(states.iter().all(|s| s.position_m.is_finite() && s.position_m.z >= 0.0));
    // It did pack.
    assert!(states.iter().any(|s| s.history < 0.9), "nothing packed");
}

#[test]
fn nothing_moves_faster_than_a_frame_follows_whatever_it_is_made_of() {
    for substance in [Substance::default(), DROP, SMOOTHED, STONE] {
        let cell_m = 1e-4;
        let particles = of(substance.clone(), Vec3::new(0.0, 0.0, 60.0), cell_m, 1e4);
        let mut solver = solver(grounded(cell_m, 60), &particles);
        solver.place(0, &thrown(Vec3::new(200.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1000.0))).expect("a placement");
        let report = frames(&mut solver, 1);
        // Three cells in a thousandth of a second.
        let most_m_s = solver.params.speed_most;
        assert!((most_m_s - 0.4 * 60.0 * cell_m / 0.02).abs() < 1e-3 * most_m_s);
        assert!(report.held_m_s == most_m_s && report.substeps <= 3 * 60, "{substance:?}: {report:?}");
        let states = solver.states().expect("states");
        let fastest = states.iter().map(|s| s.velocity_m_s.length()).fold(0.0, f32::max);
        assert!(fastest <= 1.3 * most_m_s && fastest > 0.3 * most_m_s, "{substance:?}: {fastest} of {most_m_s} m/s");
    }
}

#[test]
fn a_thousand_times_as_much_surface_tension_as_mercury_is_slackened_beside_the_grid_too() {
    let cell_m = 1e-3;
    let mut solver = solver(grounded(cell_m, 100), &of(SMOOTHED, Vec3::ZERO, cell_m, 1e4));
    let report = frames(&mut solver, 1);
    let told = report.softened.iter().find(|s| s.what == Taut::SurfaceTension).expect("a slackened tension");
    assert!(told.value < 1.0 && report.substeps <= 250, "{report:?}");
}

/// Also where a run was softened, and had learnt to take smaller substeps.
#[test]
fn a_softened_run_goes_on_from_its_checkpoint_to_the_same_bits() {
    let cell_m = 0.05;
    let two = joined(of(DROP, Vec3::new(0.0, 0.0, 0.5), cell_m, 1e5), of(SNOW, Vec3::new(1.0, 0.5, 5.5), cell_m, 1.5e10));
    let settings = grounded(cell_m, 50);
    let mut whole = solver(settings.clone(), &two);
    frames(&mut whole, 1);
    whole.soften(0, "a test").expect("softened");
    whole.set_wary(bytemuck::cast([1u32, 2, 3, 0, 0, 0]));
    frames(&mut whole, 1);
    let kept = whole.checkpoint().expect("a checkpoint");
    let mut resumed = solver(settings, &two);
    resumed.restore(&kept).expect("restored");
    assert_eq!(resumed.wary, whole.wary);
    assert_ne!(resumed.wary, Default::default());
    let (a, b) = (frames(&mut whole, 8), frames(&mut resumed, 8));
    assert_eq!((a.substeps, a.softened.len()), (b.substeps, b.softened.len()));
    assert!(whole.checkpoint().expect("a checkpoint") == resumed.checkpoint().expect("a checkpoint"));
    // What was learnt is forgotten after some frames without trouble.
    assert_eq!(whole.wary.halvings, 0);
}

#[test]
fn softening_leaves_a_quarter_of_everything_that_pulls() {
    let cell_m = 0.05;
    let mut solver =
        solver(grounded(cell_m, 4000), &of(Substance::Liquid { viscosity_pa_s: 0.1, surface_tension_n_m: 4.0 }, Vec3::ZERO, cell_m, 1e5));
    let before = solver.states().expect("states")[0].lambda_pa;
    solver.soften(1, "a test").expect("softened");
    let told = frames(&mut solver, 1).softened;
    assert_eq!(told.iter().map(|s| (s.what, s.factor)).collect::<Vec<_>>(), [(Taut::Stiffness, 0.25), (Taut::SurfaceTension, 0.25)]);
    assert_eq!(solver.states().expect("states")[0].lambda_pa, 0.25 * before);
    assert_eq!(solver.laws.substances[0], Substance::Liquid { viscosity_pa_s: 0.1, surface_tension_n_m: 1.0 });
}

/// A ceiling below the ground leaves no room at all: the ground is what is not passed.
#[test]
fn where_surfaces_leave_no_room_the_ground_has_the_last_word() {
    for substance in [Substance::default(), SMOOTHED] {
        let cell_m = 0.05;
        let ceiling = PlaneShape { point_m: [0.0, 0.0, -0.1], normal: [0.2, 0.0, -1.0] };
        let colliders = vec![Collider { shape: ColliderShape::Plane(ceiling), friction: 0.3, restitution: 0.0 }];
        let mut solver = solver(Settings { colliders, ..grounded(cell_m, 100) }, &of(substance, Vec3::new(0.0, 0.0, 1.0), cell_m, 1e5));
        frames(&mut solver, 3);
        let lowest = solver.states().expect("states").iter().map(|s| s.position_m.z).fold(f32::INFINITY, f32::min);
        // Matter may stand as deep in its support as it was captured, half a cell at most.
        assert!(lowest >= -0.51 * cell_m, "{lowest}");
    }
}

#[test]
fn what_is_too_far_away_for_its_cells_is_refused_in_words() {
    let cell_m = 1e-4;
    let mut solver = solver(grounded(cell_m, 100), &of(Substance::default(), Vec3::new(0.0, 4e8, 0.0), cell_m, 1e5));
    let error = solver.advance(0.02, &Stop::default()).expect_err("too far");
    assert!(matches!(error, SolverError::TooFar { .. }) && error.to_string().contains("place it nearer"), "{error}");
}

#[test]
fn a_stone_in_a_liquid_beside_the_grid_stands_as_captured_without_a_search() {
    let cell_m = 0.05;
    let mut both = joined(of(SMOOTHED, Vec3::ZERO, cell_m, 1e5), of(STONE, Vec3::new(4.0, 0.0, 0.0), cell_m, 1e5));
    both.object.fill(0);
    let mut solver = solver(grounded(cell_m, 100), &both);
    let report = solver.prestress(&[0], &Stop::default(), &mut |_| ()).expect("a prestress");
    assert_eq!(report.iterations, 0);
    frames(&mut solver, 1);
}

/// A ball in the middle of a body that does not let it go: matter keeps clear of it, but for what was captured inside, and
/// nothing flies off.
#[test]
fn a_collider_inside_an_object_is_kept_clear_and_bursts_nothing() {
    let calm = Substance::SphLiquid { viscosity_pa_s: 1.0, surface_tension_n_m: 0.0 };
    for substance in [Substance::default(), Substance::Liquid { viscosity_pa_s: 1.0, surface_tension_n_m: 0.0 }, calm, STONE] {
        let cell_m = 0.05;
        let ball = SphereShape { centre_m: [0.1, 0.1, 0.1], radius_m: 0.04 };
        let colliders = vec![Collider { shape: ColliderShape::Sphere(ball), friction: 0.3, restitution: 0.0 }];
        let settings = Settings { colliders, gravity_m_s2: Vec3::ZERO, ..grounded(cell_m, 200) };
        let mut solver = solver(settings, &of(substance.clone(), Vec3::ZERO, cell_m, 1e5));
        frames(&mut solver, 3);
        let states = solver.states().expect("states");
        let fastest = states.iter().map(|s| s.velocity_m_s.length()).fold(0.0, f32::max);
        assert!(states.iter().all(|s| s.position_m.is_finite()) && fastest < 5.0, "{substance:?}: {fastest} m/s");
        let nearest = states.iter().map(|s| (s.position_m - Vec3::splat(0.1)).length()).fold(f32::INFINITY, f32::min);
        assert!(substance == STONE || nearest >= 0.04 - 0.51 * cell_m, "{substance:?}: {nearest} m");
    }
}

/// Of a millimetre, where little is followed: what a body is pushed with at once is no more than the rest of it may have.
#[test]
fn a_body_is_pushed_into_soft_matter_no_faster_than_is_followed() {
    let cell_m = 1e-4;
    let both = joined(of(Substance::default(), Vec3::ZERO, cell_m, 50.0), of(STONE, Vec3::new(0.0, 0.0, 4.0), cell_m, 1e5));
    let mut solver = solver(Settings { frame_s: 1e-3, substeps_most: 20, gravity_m_s2: Vec3::ZERO, ..Settings::new(cell_m) }, &both);
    solver.kick(1, Vec3::new(0.0, 0.0, -200.0));
    let report = frames(&mut solver, 1);
    assert!(report.mended.is_empty() && report.retries <= 1, "{report:?}");
}

#[test]
fn what_is_no_number_is_made_one_from_what_is_around_it_and_that_is_said() {
    let cell_m = 0.05;
    let mut solver = solver(grounded(cell_m, 100), &of(Substance::default(), Vec3::new(0.0, 0.0, 2.0), cell_m, 1e5));
    solver.edit(|s| if s.index == 100 { s.velocity_m_s = Vec3::splat(f32::NAN) } else { s.velocity_m_s.x = 0.5 }).expect("an edit");
    let report = frames(&mut solver, 1);
    assert!(report.mended.contains_key(&0), "{report:?}");
    let states = solver.states().expect("states");
    assert!(states.iter().all(|s| s.position_m.is_finite() && s.f().is_finite() && (s.velocity_m_s.x - 0.5).abs() < 0.05));
}

#[test]
fn where_nothing_helps_things_stop_and_time_goes_on() {
    let cell_m = 0.05;
    let mut solver = solver(grounded(cell_m, 100), &joined(of(Substance::default(), Vec3::Z, cell_m, 1e5), of(STONE, 6.0 * Vec3::X, cell_m, 1e5)));
    solver.kick(0, Vec3::X);
    solver.kick(1, Vec3::X);
    let (mut tries, mut report) = (Default::default(), Advance::default());
    assert!(solver.give_way(1, &mut tries, &mut report).expect("a try"));
    assert!(solver.states().expect("states").iter().all(|s| (s.velocity_m_s - Vec3::X).length() < 1e-5));
    assert!(!solver.give_way(1, &mut tries, &mut report).expect("no more"));
    let states = solver.states().expect("states");
    assert!(states.iter().all(|s| if s.object() == 0 { s.velocity_m_s == Vec3::ZERO } else { s.velocity_m_s == Vec3::X }));
    assert_eq!(report.mended[&0], 2 * states.iter().filter(|s| s.object() == 0).count() as u64);
}

/// Under a logarithm of no volume it would push for ever, and nothing would turn it back.
#[test]
fn neo_hookean_matter_that_was_turned_inside_out_gains_no_energy() {
    let cell_m = 0.05;
    let substance = Substance::Elastic(ElasticModel::NeoHookean);
    let mut solver = solver(Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(cell_m) }, &of(substance, Vec3::ZERO, cell_m, 1e4));
    solver
        .edit(|s| {
            if s.index % 7 == 0 {
                s.set_f(Mat3::from_diagonal(Vec3::new(1.0, 1.0, -0.3)))
            }
        })
        .expect("an edit");
    let report = frames(&mut solver, 2);
    assert!(report.mended[&0] > 0 && report.softened.is_empty(), "{report:?}");
    let states = solver.states().expect("states");
    assert!(states.iter().all(|s| s.f().determinant() > 0.0));
    let kinetic_j: f32 = states.iter().map(|s| 0.5 * s.mass_kg * s.velocity_m_s.length_squared()).sum();
    // What each of them held as neo-Hookean matter that is flattened to 0.3 holds.
    let held_j: f32 =
        states.iter().filter(|s| s.index % 7 == 0).map(|s| s.volume_m3 * 0.5 * s.lambda_pa * 0.3f32.ln().powi(2) + s.volume_m3 * s.mu_pa).sum();
    assert!(kinetic_j < held_j, "{kinetic_j} J of {held_j} J");
}

/// Sizes that no spec reaches (`world::check_scale` refuses them) are the hardest inputs of the retries: numbers leave the range
/// of f32 either way.
#[test]
fn every_run_ends_within_a_bounded_number_of_retries_whatever_its_size() {
    use crate::solver::retry_budget::{FRAME_RETRIES_MOST, GIVEN_UP_MOST};
    for cell_m in [4e-14, 1e-11, 1e-9, 1e-7, 1e-3, 1.0, 1e4, 1e7, 1e9, 1e12] {
        for (size_cells, substance) in [(Vec3::splat(4.0), Substance::default()), (Vec3::new(4.0, 4.0, 0.5), STONE), (Vec3::splat(0.5), SMOOTHED)] {
            // A liquid falls by its cell in sqrt(cell / g): below, its frames take many substeps, and no retries.
            if substance == SMOOTHED && cell_m < 1e-3 {
                continue;
            }
            let mut particles = block(0.5 * cell_m * Vec3::Z, size_cells * cell_m, 0.5 * cell_m, 1e5, 0.2);
            particles.substances = vec![substance.clone()];
            let gpu = crate::gpu::Gpu::shared_for_tests().expect("a device");
            let Ok(mut solver) = Solver::new(&gpu, grounded(cell_m, 20), &particles) else { continue };
            for frame in 1..=2 {
                let to_s = f64::from(frame) * solver.settings.frame_s;
                match solver.advance(to_s, &Stop::default()) {
                    Ok(report) => assert!(report.retries <= FRAME_RETRIES_MOST, "{cell_m} {substance:?}: {report:?}"),
                    Err(error) => {
                        assert!(solver.wary.retries <= FRAME_RETRIES_MOST + 1 && solver.wary.given_up <= GIVEN_UP_MOST, "{cell_m}: {error}");
                        assert!(!error.to_string().contains("NaN"), "{error}");
                        break;
                    }
                }
            }
        }
    }
}

/// Room for a segment fails for ever where a pin drives matter out of any window: the run ends, at the same retry each time.
#[test]
fn a_run_without_progress_ends_with_an_error_that_names_its_last_failure() {
    let cell_m = 4e-14;
    let run = || {
        let mut solver = solver(grounded(cell_m, 100), &of(Substance::default(), Vec3::Z, cell_m, 1e5));
        let error = (1..=GIVEN_UP_FRAMES).find_map(|frame| solver.advance(f64::from(frame) * 0.02, &Stop::default()).err());
        (error.map(|e| e.to_string()), solver.wary)
    };
    let (error, wary) = run();
    let error = error.expect("a run that cannot go on");
    assert!(error.contains("no progress") && error.contains("scene.metres_per_unit"), "{error}");
    assert_eq!((Some(error), wary), run());
}

const GIVEN_UP_FRAMES: u32 = 20;
