//! Friction, restitution, colliders, forces, pins, and what is refused.

use super::{block, centre_m, solver};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::grip::Pose;
use crate::solver::obstacles::{self, distance_m};
use crate::solver::validate::joined;
use crate::solver::{Collider, ObjectForce, Particles, PinRegion, Placement, Plane, Settings, Solver, SolverError};
use crate::spec::{BoxShape, ColliderShape, PlaneShape, SphereShape};
use glam::{Quat, Vec3};

const CELL_M: f32 = 0.05;

fn velocity_m_s(solver: &Solver) -> Vec3 {
    let states = solver.states().expect("states");
    let mass: f32 = states.iter().map(|s| s.mass_kg).sum();
    states.iter().map(|s| s.velocity_m_s * s.mass_kg).sum::<Vec3>() / mass
}

fn on_ground(friction: f32, restitution: f32) -> Settings {
    let ground = Plane { height_m: 0.0, friction, restitution };
    Settings { ground: Some(ground), ..Settings::new(CELL_M) }
}

fn moving(velocity_m_s: Vec3, offset_m: Vec3) -> Placement {
    Placement { rotation: Quat::IDENTITY, centre_m: Vec3::ZERO, offset_m, velocity_m_s, spin_rad_s: Vec3::ZERO }
}

#[test]
fn what_is_placed_inside_a_collider_starts_in_front_of_it_in_one_piece() {
    let particles = block(Vec3::ZERO, Vec3::new(0.3, 0.3, 0.1), 0.025, 2e5, 0.3);
    let sphere = ColliderShape::Sphere(SphereShape { centre_m: [0.0, 0.0, -30.0], radius_m: 20.0 });
    let colliders = vec![Collider { shape: sphere, friction: 0.3, restitution: 0.0 }];
    let mut solver = solver(Settings { colliders, ..on_ground(0.3, 0.0) }, &particles);
    // In the ground and in the sphere under it.
    let out = solver.place(0, &moving(Vec3::ZERO, Vec3::new(0.2, 0.0, -15.0))).expect("a placement");
    let states = solver.states().expect("states");
    let lowest_m = states.iter().map(|s| s.position_m.z).fold(f32::INFINITY, f32::min);
    assert!(lowest_m.abs() < 1e-3, "{lowest_m}");
    assert!((out.z - 15.0).abs() < 0.1, "{out}");
    let apart = states.iter().zip(&particles.position_m).map(|(s, p)| (s.position_m - p - states[0].position_m + particles.position_m[0]).length());
    assert!(apart.fold(0.0, f32::max) < 1e-4, "in one piece");
    // A foot in the ground is pushed out by contact, as it runs.
    assert_eq!(solver.place(0, &moving(Vec3::ZERO, Vec3::new(0.0, 0.0, -0.03))).expect("a placement"), Vec3::ZERO);
}

#[test]
fn what_starts_deep_in_surfaces_comes_out_little_by_little() {
    // A wall that leaves no room for a hundred metres, and the ground: whichever had the last word would throw the block
    // out of its cells.
    let particles = block(Vec3::new(0.0, 0.0, -0.1), Vec3::new(0.2, 0.2, 0.2), 0.025, 2e5, 0.3);
    let wall = ColliderShape::Plane(PlaneShape { point_m: [100.0, 0.0, 0.0], normal: [1.0, 0.0, -1.0] });
    let colliders = vec![Collider { shape: wall, friction: 0.3, restitution: 0.0 }];
    let mut solver = solver(Settings { colliders, ..on_ground(0.3, 0.0) }, &particles);
    let report = solver.advance(0.02, &Stop::default()).expect("an advance");
    assert_eq!((report.retries, report.softened.len()), (0, 0), "{report:?}");
    let most_m = super::super::constants::PUSH_SHARE * solver.params.slack as f32 * CELL_M * report.substeps as f32;
    for (s, p) in solver.states().expect("states").iter().zip(&particles.position_m) {
        let way = s.position_m - *p;
        // It may stay half a cell inside: so far a captured thing may stand in its support.
        assert!(s.position_m.z > p.z.min(-0.5 * CELL_M) - 1e-3 && way.x > 0.0 && way.length() < 2.0 * most_m, "from {p} by {way}, at most {most_m}");
        assert!(s.velocity_m_s.length() < 1.0, "at {}", s.velocity_m_s);
    }
}

#[test]
fn friction_slows_a_sliding_block_by_mu_g() {
    let particles = block(Vec3::new(0.0, 0.0, -0.005), Vec3::new(0.3, 0.3, 0.1), 0.025, 2e5, 0.3);
    let mut solver = solver(on_ground(0.3, 0.0), &particles);
    let stop = Stop::default();
    solver.prestress(&[0], &stop, &mut |_| {}).expect("a prestress");
    solver.place(0, &moving(Vec3::X, Vec3::ZERO)).expect("a placement");
    solver.advance(0.2, &stop).expect("an advance");
    let v = velocity_m_s(&solver);
    let expected = 1.0 - 0.3 * 9.81 * 0.2;
    assert!((v.x - expected).abs() < 0.05 * (1.0 - expected), "{v}, expected {expected}");
    assert!(v.y.abs() < 0.01 && v.z.abs() < 0.02, "{v}");
    solver.advance(0.5, &stop).expect("an advance");
    let still = velocity_m_s(&solver);
    assert!(still.x.abs() < 0.02, "it came to rest, {still}");
}

#[test]
fn restitution_gives_speed_back() {
    let come_back = |restitution: f32| {
        let particles = block(Vec3::new(0.0, 0.0, 0.02), Vec3::splat(0.1), 0.025, 2e6, 0.2);
        let mut solver = solver(on_ground(0.0, restitution), &particles);
        solver.set_velocity(0, Vec3::new(0.0, 0.0, -1.0));
        let mut fastest = 0f32;
        for frame in 1..=6 {
            solver.advance(f64::from(frame) * 0.02, &Stop::default()).expect("an advance");
            fastest = fastest.max(velocity_m_s(&solver).z);
        }
        fastest
    };
    let (dull, lively) = (come_back(0.0), come_back(0.9));
    assert!(lively > dull && lively > 0.6 && lively <= 1.0, "{dull} {lively}");
}

#[test]
fn nothing_enters_a_box_or_a_sphere() {
    let mut settings = on_ground(0.3, 0.0);
    let table = BoxShape { centre_m: [0.1, 0.1, 0.2], size_m: [0.3, 0.5, 0.04] };
    let ball = SphereShape { centre_m: [0.3, 0.1, 0.25], radius_m: 0.1 };
    settings.colliders = vec![
        Collider { shape: ColliderShape::Box(table), friction: 0.3, restitution: 0.0 },
        Collider { shape: ColliderShape::Sphere(ball), friction: 0.3, restitution: 0.0 },
    ];
    let particles = block(Vec3::new(0.07, 0.03, 0.4), Vec3::splat(0.15), 0.025, 2e4, 0.3);
    let colliders = obstacles::colliders(&settings);
    let mut solver = solver(settings, &particles);
    solver.set_velocity(0, Vec3::new(0.5, 0.0, -2.0));
    let mut deepest = f32::INFINITY;
    for frame in 1..=40 {
        solver.advance(f64::from(frame) * 0.02, &Stop::default()).expect("an advance");
        let states = solver.states().expect("states");
        deepest = states.iter().map(|s| distance_m(&colliders, s.position_m)).fold(deepest, f32::min);
    }
    assert!(deepest > -0.002, "a particle is {deepest} m inside");
    assert!(centre_m(&solver).z > 0.1, "it went through the table to {}", centre_m(&solver));
}

#[test]
fn a_force_lasts_as_long_as_it_says() {
    let mut settings = Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) };
    // Begins and ends inside frames.
    settings.forces = vec![ObjectForce { object: 0, from_s: 0.013, to_s: 0.051, acceleration_m_s2: Vec3::new(4.0, 0.0, 0.0) }];
    let mut solver = solver(settings, &block(Vec3::ZERO, Vec3::splat(0.1), 0.025, 1e5, 0.3));
    solver.advance(0.012, &Stop::default()).expect("an advance");
    assert!(velocity_m_s(&solver).length() < 1e-6);
    solver.advance(0.1, &Stop::default()).expect("an advance");
    let v = velocity_m_s(&solver);
    assert!((v - Vec3::X * (4.0 * 0.038)).length() < 1e-4, "{v}");
}

#[test]
fn a_pin_holds_and_lets_go() {
    let particles = block(Vec3::ZERO, Vec3::new(0.1, 0.1, 0.2), 0.025, 2e6, 0.3);
    let mut settings = Settings::new(CELL_M);
    let top = PlaneShape { point_m: [0.0, 0.0, 0.1], normal: [0.0, 0.0, -1.0] };
    settings.pins = vec![PinRegion {
        object: 0,
        shape: ColliderShape::Plane(top),
        low_m: Vec3::ZERO,
        high_m: Vec3::new(0.1, 0.1, 0.2),
        from_s: 0.0,
        to_s: 0.1,
        path: vec![],
    }];
    let mut solver = solver(settings, &particles);
    let start = centre_m(&solver).z;
    solver.advance(0.1, &Stop::default()).expect("an advance");
    let held = centre_m(&solver).z;
    assert!((held - start).abs() < 0.002, "held, it sank by {}", start - held);
    solver.advance(0.2, &Stop::default()).expect("an advance");
    let fallen = held - centre_m(&solver).z;
    assert!((fallen - 0.5 * 9.81 * 0.01).abs() < 0.005, "let go, it fell {fallen}");
}

#[test]
fn a_pin_goes_with_its_object_to_where_that_starts() {
    let size_m = Vec3::new(0.1, 0.1, 0.2);
    let particles = block(Vec3::ZERO, size_m, 0.025, 2e6, 0.3);
    // The upper half, as captured.
    let top = PlaneShape { point_m: [0.0, 0.0, 0.1], normal: [0.0, 0.0, -1.0] };
    let shape = ColliderShape::Plane(top);
    let pin = PinRegion { object: 0, shape, low_m: Vec3::ZERO, high_m: size_m, from_s: 0.0, to_s: 1.0, path: vec![] };
    let new = || solver(Settings { pins: vec![pin.clone()], ..Settings::new(CELL_M) }, &particles);
    let mut first = new();
    // Lies on its side, a metre away from where it was captured.
    let placement = Placement { rotation: Quat::from_rotation_x(std::f32::consts::FRAC_PI_2), ..moving(Vec3::ZERO, Vec3::new(0.3, -0.2, 1.0)) };
    first.place(0, &placement).expect("a placement");
    let start = first.states().expect("states");
    first.advance(0.05, &Stop::default()).expect("an advance");
    let checkpoint = first.checkpoint().expect("a checkpoint");
    first.advance(0.1, &Stop::default()).expect("an advance");
    let moved_m = start.iter().zip(first.states().expect("states")).map(|(a, b)| (a.position_m - b.position_m).length());
    let held_m = moved_m.zip(&particles.position_m).filter(|(_, captured)| captured.z > 0.1).map(|(m, _)| m).fold(0.0, f32::max);
    assert!(held_m < 1e-3, "the half that is held moved by {held_m}");
    // A run from a checkpoint was never placed.
    let mut second = new();
    second.restore(&checkpoint).expect("a state");
    second.advance(0.1, &Stop::default()).expect("an advance");
    assert!(first.checkpoint().expect("a checkpoint") == second.checkpoint().expect("a checkpoint"), "other bits");
}

#[test]
fn a_checkpoint_is_of_the_pins_that_have_begun_whatever_others_there_are() {
    let size_m = Vec3::splat(0.1);
    let particles = joined(block(Vec3::ZERO, size_m, 0.025, 2e6, 0.3), block(Vec3::new(0.5, 0.0, 0.0), size_m, 0.025, 2e6, 0.3));
    let all = |object: u32| ColliderShape::Box(BoxShape { centre_m: [0.05 + 0.5 * f64::from(object), 0.05, 0.05], size_m: [0.2; 3] });
    let pin = |object: u32, from_s: f64| {
        let low_m = Vec3::X * 0.5 * object as f32;
        PinRegion { object, shape: all(object), low_m, high_m: low_m + size_m, from_s, to_s: 1.0, path: vec![] }
    };
    let new = |pins: &[PinRegion]| {
        let mut solver = solver(Settings { pins: pins.to_vec(), ..Settings::new(CELL_M) }, &particles);
        solver.set_velocity(0, Vec3::X);
        solver.set_velocity(1, Vec3::Y);
        solver
    };
    let stop = Stop::default();
    let mut first = new(&[pin(0, 0.02), pin(1, 0.02)]);
    first.advance(0.04, &stop).expect("an advance");
    let checkpoint = first.checkpoint().expect("a checkpoint");
    first.advance(0.08, &stop).expect("an advance");
    // Another version lists them otherwise, and has one more that begins later.
    let mut second = new(&[pin(1, 0.02), pin(1, 0.06), pin(0, 0.02)]);
    second.restore(&checkpoint).expect("a state");
    assert_eq!([second.grips[2].pose, second.grips[0].pose], [first.grips[0].pose, first.grips[1].pose]);
    assert!(second.grips[1].pose == Pose::CAPTURED && second.grips[0].pose != second.grips[2].pose);
    second.settings.pins.remove(1);
    second.grips.remove(1);
    second.advance(0.08, &stop).expect("an advance");
    assert!(first.states().expect("states") == second.states().expect("states"), "other bits");
}

#[test]
fn a_pin_that_begins_late_holds_its_own_object_where_that_has_come_to() {
    let size_m = Vec3::splat(0.1);
    let flies = block(Vec3::ZERO, size_m, 0.025, 2e6, 0.3);
    // Another falls through where the first one was captured.
    let falls = block(Vec3::new(0.0, 0.0, 0.15), size_m, 0.025, 2e6, 0.3);
    let all = BoxShape { centre_m: [0.05; 3], size_m: [0.2; 3] };
    let pin = PinRegion { object: 0, shape: ColliderShape::Box(all), low_m: Vec3::ZERO, high_m: size_m, from_s: 0.05, to_s: 1.0, path: vec![] };
    let mut solver = solver(Settings { pins: vec![pin], ..Settings::new(CELL_M) }, &joined(flies, falls));
    solver.set_velocity(0, Vec3::new(8.0, 0.0, 0.0));
    let centre = |solver: &Solver, object: u32| {
        let states = solver.states().expect("states");
        let of: Vec<Vec3> = states.iter().filter(|s| s.object() == object).map(|s| s.position_m).collect();
        of.iter().sum::<Vec3>() / of.len() as f32
    };
    solver.advance(0.05, &Stop::default()).expect("an advance");
    let [held, falling] = [0, 1].map(|object| centre(&solver, object));
    assert!((held.x - 0.45).abs() < 0.01, "it flew to {held}");
    solver.advance(0.15, &Stop::default()).expect("an advance");
    assert!((centre(&solver, 0) - held).length() < 2e-3, "held at {held}, it came to {}", centre(&solver, 0));
    let fallen_m = falling.z - centre(&solver, 1).z;
    let expected_m = 0.5 * 9.81 * (0.15f32.powi(2) - 0.05f32.powi(2));
    assert!((fallen_m - expected_m).abs() < 0.003, "the other fell by {fallen_m}, not {expected_m}");
}

#[test]
fn a_jelly_thrown_hard_at_the_ground_stays_finite() {
    let particles = block(Vec3::new(0.0, 0.0, 0.1), Vec3::splat(0.15), 0.025, 2e3, 0.3);
    let mut solver = solver(on_ground(0.3, 0.0), &particles);
    solver.set_velocity(0, Vec3::new(3.0, 0.0, -15.0));
    solver.advance(0.2, &Stop::default()).expect("an advance");
    for s in solver.states().expect("states") {
        assert!(s.position_m.is_finite() && s.velocity_m_s.is_finite() && s.f().is_finite());
        assert!(s.position_m.z >= -1e-6);
    }
}

#[test]
fn too_wide_a_world_is_an_error_that_says_so() {
    let mut particles = block(Vec3::ZERO, Vec3::splat(0.1), 0.025, 1e5, 0.3);
    particles.position_m[0] = Vec3::splat(900.0);
    let mut solver = solver(Settings::new(CELL_M), &particles);
    let error = solver.advance(0.1, &Stop::default()).expect_err("no device holds that");
    assert!(matches!(error, SolverError::TooWide { .. }), "{error}");
    assert!(error.to_string().contains("cells_across"), "{error}");
}

#[test]
fn memory_follows_matter_and_not_the_room_between() {
    let near = block(Vec3::ZERO, Vec3::splat(0.1), 0.025, 1e5, 0.3);
    let blocks = |particles: &Particles| {
        let mut solver = solver(Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }, particles);
        solver.advance(0.02, &Stop::default()).expect("a frame");
        (solver.seen.expect("a watch").blocks, solver.states().expect("states"))
    };
    let (few, _) = blocks(&near);
    // A crumb of it 20 m away: a million blocks lie between.
    let mut far = near.clone();
    far.position_m[0] = Vec3::splat(20.01);
    let (more, states) = blocks(&far);
    assert!(more <= few + 8, "{more} blocks, {few} without the crumb");
    assert_eq!(states[0].position_m, far.position_m[0]);
}

#[test]
fn a_grid_that_fills_up_in_a_segment_is_made_larger_and_nothing_else_changes() {
    let fall = |capacity: Option<usize>| {
        let mut particles = block(Vec3::new(0.0, 0.0, 0.02), Vec3::splat(0.2), 0.025, 1e5, 0.3);
        let outwards = |x: &Vec3| (*x - Vec3::new(0.1, 0.1, 0.12)) * 40.0;
        particles.velocity_m_s = particles.position_m.iter().map(outwards).collect();
        let mut solver = solver(Settings::new(CELL_M), &particles);
        if let Some(capacity) = capacity {
            let seen = solver.look().expect("a look");
            solver.fit_window(seen.low, seen.high, 40).expect("a window");
            solver.new_grid(capacity, 100_000).expect("a grid");
        }
        let report = solver.advance(0.06, &Stop::default()).expect("three frames");
        (solver.states().expect("states"), report.retries, solver.grid.as_ref().expect("a grid").capacity)
    };
    let (states, retries, _) = fall(None);
    let (same, as_many, grown) = fall(Some(3));
    assert_eq!(states, same);
    assert_eq!(retries, as_many);
    assert!(grown > 8);
}

#[test]
fn input_that_makes_no_sense_is_refused() {
    let gpu = Gpu::shared_for_tests().expect("a device");
    let good = block(Vec3::ZERO, Vec3::splat(0.1), 0.05, 1e5, 0.3);
    let refused = |particles: &Particles, settings: Settings| matches!(Solver::new(&gpu, settings, particles), Err(SolverError::Input { .. }));
    assert!(refused(&Particles::default(), Settings::new(CELL_M)));
    assert!(refused(&Particles { poisson: vec![0.5; good.len()], ..good.clone() }, Settings::new(CELL_M)));
    assert!(refused(&Particles { volume_m3: vec![0.0; good.len()], ..good.clone() }, Settings::new(CELL_M)));
    assert!(refused(&Particles { object: Vec::new(), ..good.clone() }, Settings::new(CELL_M)));
    assert!(refused(&good, Settings::new(0.0)));
    assert!(refused(&good, Settings { cfl: 0.9, ..Settings::new(CELL_M) }));
    assert!(!refused(&good, Settings::new(CELL_M)));
}
