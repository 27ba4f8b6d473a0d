//! Free motion, order, contact and resumption on small bodies.

use super::{block, centre_m, solver};
use crate::Stop;
use crate::gpu::{Gpu, Recording};
use crate::solver::grid::Window;
use crate::solver::{Placement, Plane, Settings, Solver};
use glam::{Quat, Vec3};

#[test]
fn falls_as_a_stone_does() {
    let particles = block(Vec3::new(0.1, 0.1, 1.0), Vec3::splat(0.2), 0.025, 1e5, 0.3);
    let mut solver = solver(Settings::new(0.05), &particles);
    let mut squares = 0.0;
    for frame in 1..=10 {
        let report = solver.advance(f64::from(frame) * 0.02, &Stop::default()).expect("an advance");
        assert_eq!((report.retries, report.dt_min_s), (0, report.dt_max_s));
        squares += report.substeps as f64 * report.dt_max_s.powi(2);
    }
    // Symplectic Euler: sum of h_i g t_i = g (t^2 + sum of h_i^2) / 2.
    let expected = 0.5 * 9.81 * (0.2f64.powi(2) + squares);
    for (s, p) in solver.states().expect("states").iter().zip(&particles.position_m) {
        let fallen = f64::from(p.z - s.position_m.z);
        assert!((fallen / expected - 1.0).abs() < 1e-4, "{fallen} {expected}");
    }
}

#[test]
fn two_runs_and_a_resumed_one_end_in_the_same_bits() {
    let mut particles = block(Vec3::new(0.0, 0.0, 0.06), Vec3::splat(0.2), 0.025, 5e4, 0.3);
    particles.velocity_m_s.fill(Vec3::new(0.7, 0.1, -2.0));
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let stop = Stop::default();
    let mut first = solver(settings.clone(), &particles);
    first.advance(0.06, &stop).expect("an advance");
    let kept = first.checkpoint().expect("a checkpoint");
    first.kick(0, Vec3::Y);
    first.advance(0.1, &stop).expect("an advance");

    let mut second = solver(settings.clone(), &particles);
    for frame in 1..=3 {
        second.advance(f64::from(frame) / 50.0, &stop).expect("an advance");
    }
    assert!(kept == second.checkpoint().expect("a checkpoint"), "frame by frame differs from one call");

    let mut third = solver(settings, &particles);
    third.restore(&kept).expect("a restore");
    third.kick(0, Vec3::Y);
    third.advance(0.1, &stop).expect("an advance");
    assert!(first.checkpoint().expect("a checkpoint") == third.checkpoint().expect("a checkpoint"), "a resumed run differs");
}

#[test]
fn a_cut_changes_nothing_before_itself() {
    let particles = block(Vec3::new(0.0, 0.0, 1.0), Vec3::splat(0.1), 0.025, 5e4, 0.3);
    let stop = Stop::default();
    let mut whole = solver(Settings::new(0.05), &particles);
    let mut cut = solver(Settings::new(0.05), &particles);
    let dt = whole.advance(0.02, &stop).expect("an advance").dt_max_s;
    whole.advance(0.02 + 3.0 * dt, &stop).expect("an advance");
    cut.advance(0.02, &stop).expect("an advance");
    cut.advance(0.02 + 3.0 * dt, &stop).expect("an advance");
    assert!(whole.checkpoint().expect("a checkpoint") == cut.checkpoint().expect("a checkpoint"));
    let late = cut.advance(0.0305, &stop).expect("an advance");
    assert!(late.dt_min_s < late.dt_max_s, "the cut took a part of a substep: {late:?}");
    assert!((cut.time_s() - 0.0305).abs() < 1e-12);
}

#[test]
fn nothing_passes_the_ground_and_a_body_comes_to_rest_on_it() {
    let mut particles = block(Vec3::new(0.01, 0.02, 0.1), Vec3::splat(0.2), 0.025, 5e4, 0.3);
    particles.velocity_m_s.fill(Vec3::new(0.0, 0.0, -1.0));
    let mut settings = Settings::new(0.05);
    // Ground anywhere between two nodes.
    settings.ground = Some(Plane { height_m: -0.013, friction: 0.3, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    let stop = Stop::default();
    let mut lowest = f32::INFINITY;
    for frame in 1..=75 {
        solver.advance(f64::from(frame) * 0.02, &stop).expect("an advance");
        lowest = solver.states().expect("states").iter().map(|s| s.position_m.z).fold(lowest, f32::min);
    }
    assert!(lowest >= -0.013 - 1e-6, "lowest {lowest}");
    let states = solver.states().expect("states");
    let bottom = states.iter().map(|s| s.position_m.z).fold(f32::INFINITY, f32::min);
    // A particle stands for half its spacing below it: resting ones are within a quarter cell of that.
    assert!(bottom < -0.013 + 0.0125 + 0.25 * 0.05, "it hovers at {bottom}");
    let energy: f32 = states.iter().map(|s| 0.5 * s.mass_kg * s.velocity_m_s.length_squared()).sum();
    let mass: f32 = states.iter().map(|s| s.mass_kg).sum();
    // It came at 1 m/s and may still tremble.
    assert!(energy < 0.01 * 0.5 * mass, "{energy} J are left");
}

#[test]
fn placed_particles_turn_move_and_spin_rigidly() {
    let particles = block(Vec3::ZERO, Vec3::splat(0.1), 0.025, 5e4, 0.3);
    let mut solver = solver(Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(0.05) }, &particles);
    let placement = Placement {
        rotation: Quat::from_rotation_z(std::f32::consts::FRAC_PI_2),
        centre_m: Vec3::splat(0.05),
        offset_m: Vec3::new(0.0, 0.0, 1.0),
        velocity_m_s: Vec3::X,
        spin_rad_s: Vec3::new(0.0, 0.0, 2.0),
    };
    solver.place(0, &placement).expect("a placement");
    let gpu = Gpu::shared_for_tests().expect("a device");
    let mut recording = Recording::default();
    solver.record_frame(&mut recording);
    gpu.submit(&recording);
    let motion: Vec<[u32; 8]> = gpu.read(solver.motion(), particles.len()).expect("motion");
    let velocity: Vec<[f32; 4]> = gpu.read(solver.velocity(), particles.len()).expect("velocity");
    for ((m, v), p) in motion.iter().zip(&velocity).zip(&particles.position_m) {
        let x = Vec3::new(f32::from_bits(m[0]), f32::from_bits(m[1]), f32::from_bits(m[2]));
        let arm = x - Vec3::new(0.05, 0.05, 1.05);
        assert!((arm - Vec3::new(0.05 - p.y, p.x - 0.05, p.z - 0.05)).length() < 1e-6);
        assert!((Vec3::from_slice(v) - (Vec3::X + Vec3::new(0.0, 0.0, 2.0).cross(arm))).length() < 1e-5);
        let half = |word: u32, high: bool| half::f16::from_bits((if high { word >> 16 } else { word & 0xffff }) as u16).to_f32();
        // G - I of a quarter turn about z.
        let g = [half(m[3], false), half(m[3], true), half(m[4], false), half(m[4], true), half(m[5], false)];
        assert_eq!(g, [-1.0, -1.0, 0.0, 1.0, -1.0]);
        assert!((v[3] - 1.0).abs() < 1e-5);
    }
    let before = centre_m(&solver);
    solver.advance(0.02, &Stop::default()).expect("an advance");
    assert!((centre_m(&solver) - before - Vec3::X * 0.02).length() < 1e-5);
}

#[test]
fn an_untouched_particle_is_exactly_undeformed() {
    let particles = block(Vec3::splat(0.3), Vec3::splat(0.1), 0.025, 5e4, 0.3);
    let solver = solver(Settings::new(0.05), &particles);
    let gpu = Gpu::shared_for_tests().expect("a device");
    let mut recording = Recording::default();
    solver.record_frame(&mut recording);
    gpu.submit(&recording);
    let motion: Vec<[u32; 8]> = gpu.read(solver.motion(), particles.len()).expect("motion");
    for (m, p) in motion.iter().zip(&particles.position_m) {
        assert_eq!(*m, [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), 0, 0, 0, 0, 0]);
    }
}

#[test]
fn a_raised_stop_ends_at_the_last_whole_frame() {
    let particles = block(Vec3::splat(0.3), Vec3::splat(0.1), 0.025, 5e4, 0.3);
    let mut solver: Solver = solver(Settings::new(0.05), &particles);
    let stop = Stop::default();
    stop.raise();
    let before = solver.checkpoint().expect("a checkpoint");
    let report = solver.advance(1.0, &stop).expect("an advance");
    assert!(report.stopped && report.substeps == 0);
    assert!(before == solver.checkpoint().expect("a checkpoint"));
}

#[test]
fn how_wide_the_window_was_changes_no_bit() {
    // A squeezed block jumps off the ground in a long frame, which its speed does not tell beforehand.
    let jumped = |margin: i32| {
        let ground = Some(Plane { height_m: 0.0, friction: 0.0, restitution: 0.0 });
        let settings = Settings { frame_s: 0.4, gravity_m_s2: Vec3::ZERO, ground, ..Settings::new(0.05) };
        let mut solver = solver(settings, &block(Vec3::ZERO, Vec3::splat(0.2), 0.025, 2e5, 0.3));
        solver.edit(|s| s.set_f(s.f() * 0.8)).expect("an edit");
        let seen = solver.look().expect("a look");
        let window = Window::around(seen.low, seen.high, margin);
        (solver.params.origin, solver.params.blocks, solver.window) = (window.origin.into(), window.blocks.into(), Some(window));
        solver.new_grid(4096, window.block_count() as usize).expect("a grid");
        let report = solver.advance(0.4, &Stop::default()).expect("an advance");
        let highest_m = solver.states().expect("states").iter().map(|s| s.position_m.z).fold(0.0, f32::max);
        assert!(highest_m > 0.7 && highest_m < 2.0, "it jumped {highest_m} m high");
        (report.retries, solver.checkpoint().expect("a checkpoint"))
    };
    let (narrow, wide) = (jumped(5), jumped(40));
    assert!(narrow.0 > wide.0, "it left the narrow one: {} retries, and {}", narrow.0, wide.0);
    assert!(narrow.1 == wide.1);
}
