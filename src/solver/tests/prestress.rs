//! As captured, so at rest.

use super::solver;
use crate::Stop;
use crate::gpu::Gpu;
use crate::proxy::{self, ProxyRequest, tests::pot_with_a_tendril};
use crate::solver::substance::{Activation, Substance};
use crate::solver::validate::{append, block, joined, keep, stems, swings_m};
use crate::solver::{Particles, PinRegion, Plane, Settings, Solver};
use crate::spec::{ColliderShape, ElasticModel, PlaneShape, ProxyKind};
use glam::Vec3;

#[test]
fn a_captured_thing_with_slender_stems_stays_as_it_stands() {
    let particles = stems(2e6);
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.15, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    let stop = Stop::default();
    let report = solver.prestress(&[0], &stop, &mut |_| {}).expect("a prestress");
    assert!(report.converged && report.residual < 0.03, "{report:?}");
    solver.advance(0.2, &stop).expect("an advance");
    let states = solver.states().expect("states");
    let moved = states.iter().zip(&particles.position_m).map(|(s, p)| s.position_m.distance(*p)).fold(0.0, f32::max);
    // Free of stress, its stems would have come down by centimetres.
    assert!(moved < 0.001, "it moved by {moved} m");
}

#[test]
fn a_captured_pot_with_a_stem_and_a_tendril_stays_as_it_stands() {
    let (gaussians, _) = pot_with_a_tendril();
    let request = ProxyRequest { gaussians: &gaussians, ground_m: 0.0, cell_m: 0.02, kind: ProxyKind::Voxel, stands: true, seed: 1 };
    let solid = proxy::build(&request).expect("a solid");
    let young = proxy::young_auto(&solid.stance, 1000.0).local;
    let n = solid.position_m.len();
    let mut particles = block(Vec3::ZERO, Vec3::splat(0.1), 0.1, 1e5, 0.3);
    particles.velocity_m_s = vec![Vec3::ZERO; n];
    particles.density_kg_m3 = vec![1000.0; n];
    particles.young_pa = proxy::nearest(&gaussians, &solid.position_m).iter().map(|&g| young[g as usize]).collect();
    particles.poisson = vec![0.3; n];
    particles.substance = vec![0; n];
    particles.object = vec![0; n];
    (particles.position_m, particles.volume_m3) = (solid.position_m, solid.volume_m3);
    let mut settings = Settings::new(request.cell_m);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    let stop = Stop::default();
    solver.prestress(&[0], &stop, &mut |_| {}).expect("a prestress");
    solver.advance(0.3, &stop).expect("an advance");
    let states = solver.states().expect("states");
    let moved = states.iter().zip(&particles.position_m).map(|(s, p)| s.position_m.distance(*p)).fold(0.0, f32::max);
    // One per cent of its height.
    assert!(moved < 0.0028, "it moved by {moved} m");
}

#[test]
fn supports_that_would_have_to_pull_are_let_go_of() {
    // A plank on three feet that hangs over at both ends. With spans l and overhangs a the foot in the middle bears
    // q (5 l / 4 - 3 a^2 / (2 l)), here -0.9 q: it would have to be held down by two thirds of the weight.
    let foot = |x: f32| [0.45, 0.7, 0.95].iter().any(|middle| (x - middle).abs() < 0.05);
    let inside = |p: Vec3| p.z > 0.2 || foot(p.x);
    let particles = keep(&block(Vec3::ZERO, Vec3::new(1.4, 0.2, 0.3), 0.025, 3e6, 0.3), inside);
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.15, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    let stop = Stop::default();
    let report = solver.prestress(&[0], &stop, &mut |_| {}).expect("a prestress");
    assert!(report.converged && report.residual < 0.1, "{report:?}");
    solver.advance(0.2, &stop).expect("an advance");
    let states = solver.states().expect("states");
    let moved = states.iter().zip(&particles.position_m).map(|(s, p)| s.position_m.distance(*p)).fold(0.0, f32::max);
    // Let go of only when it starts, the plank would bend up there by 9 mm.
    assert!(moved < 0.001, "it moved by {moved} m");
}

#[test]
fn what_hangs_in_the_air_is_taken_as_free_of_stress() {
    let particles = block(Vec3::new(0.0, 0.0, 0.3), Vec3::splat(0.1), 0.025, 1e5, 0.3);
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.15, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    let before = solver.checkpoint().expect("a checkpoint");
    let report = solver.prestress(&[0], &Stop::default(), &mut |_| {}).expect("a prestress");
    assert!(matches!(report.hanging[..], [(0, gap_m)] if (gap_m - 0.3125).abs() < 0.01), "{report:?}");
    assert!(before == solver.checkpoint().expect("a checkpoint"));
}

#[test]
fn what_is_dropped_bends_as_it_did() {
    // No formula holds for bent stems that swing so far: a change of this is one of how things bend.
    let swing_m = swings_m(&Gpu::shared_for_tests().expect("a device")).expect("a run");
    assert!((swing_m / 0.0551 - 1.0).abs() < 0.1, "its heads swing by {swing_m} m");
}

#[test]
fn what_can_stand_stands_whatever_its_law() {
    let laws = [
        Substance::Muscle { model: ElasticModel::Corotated, fibre: Vec3::Z, activation: Activation::Curve(Vec::new()) },
        Substance::Plastic { yield_stress_pa: 2e4, hardening_pa: 0.0 },
        Substance::Viscoplastic { yield_stress_pa: 2e4, viscosity_pa_s: 10.0 },
    ];
    for law in laws {
        let mut particles = block(Vec3::new(0.0, 0.0, -0.0125), Vec3::new(0.2, 0.2, 0.3), 0.025, 1e5, 0.3);
        particles.substances = vec![law.clone()];
        let mut settings = Settings::new(0.05);
        settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
        let mut solver = solver(settings, &particles);
        let stop = Stop::default();
        let report = solver.prestress(&[0], &stop, &mut |_| {}).expect("a prestress");
        assert!(report.residual < 0.03, "{law:?}: {report:?}");
        solver.advance(0.1, &stop).expect("an advance");
        let states = solver.states().expect("states");
        let moved = states.iter().zip(&particles.position_m).map(|(s, p)| s.position_m.distance(*p)).fold(0.0, f32::max);
        // Free of stress, its top would have come down by 4 mm, and swung to 8.
        assert!(moved < 0.0005, "{law:?}: it moved by {moved} m");
    }
}

/// The farthest that any particle of an object is from where it was captured.
fn moved_m(solver: &Solver, particles: &Particles, object: u32) -> f32 {
    let states = solver.states().expect("states");
    let moved = states.iter().zip(&particles.position_m).filter(|(s, _)| s.object() == object).map(|(s, p)| s.position_m.distance(*p));
    moved.fold(0.0, f32::max)
}

#[test]
fn what_a_pin_holds_hangs_as_captured_beside_what_stands_and_what_nothing_holds() {
    let size_m = Vec3::new(0.2, 0.2, 0.4);
    let low_m = Vec3::new(0.5, 0.0, 0.5);
    let stands = block(Vec3::new(0.0, 0.0, -0.0125), size_m, 0.025, 1e5, 0.3);
    let hangs = block(low_m, size_m, 0.025, 1e5, 0.3);
    let falls = block(Vec3::new(1.0, 0.0, 0.5), size_m, 0.025, 1e5, 0.3);
    let particles = joined(joined(stands, hangs), falls);
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    let top = ColliderShape::Plane(PlaneShape { point_m: [0.0, 0.0, 0.85], normal: [0.0, 0.0, -1.0] });
    settings.pins = vec![PinRegion { object: 1, shape: top, low_m, high_m: low_m + size_m, from_s: 0.0, to_s: 1.0, path: vec![] }];
    let mut solver = solver(settings, &particles);
    let report = solver.prestress(&[0, 1, 2], &Stop::default(), &mut |_| {}).expect("a prestress");
    assert!(matches!(report.hanging[..], [(2, _)]), "{report:?}");
    assert!(report.converged && report.residual < 0.03, "{report:?}");
    solver.advance(0.1, &Stop::default()).expect("an advance");
    // Free of stress, what hangs would swing down by up to rho g h^2 / E: 12 mm below the pin.
    let [stood, hung, fell] = [0, 1, 2].map(|object| moved_m(&solver, &particles, object));
    assert!(stood < 0.001 && hung < 0.001 && fell > 0.04, "moved by {stood}, {hung} and {fell} m");
}

#[test]
fn what_stands_on_another_thing_is_carried() {
    let mut particles = block(Vec3::new(0.0, 0.0, -0.0125), Vec3::splat(0.2), 0.025, 1e5, 0.3);
    append(&mut particles, block(Vec3::new(0.0, 0.0, 0.1875), Vec3::new(0.2, 0.2, 0.4), 0.025, 1e5, 0.3), Substance::default());
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    let report = solver.prestress(&[0, 1], &Stop::default(), &mut |_| {}).expect("a prestress");
    assert!(report.hanging.is_empty() && report.residual < 0.1, "{report:?}");
}
