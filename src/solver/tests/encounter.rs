//! Objects that meet: apart from each other, with friction, and nothing lost.

use super::solver;
use crate::Stop;
use crate::gpu::{Gpu, Recording};
use crate::solver::advance::Plan;
use crate::solver::encounter::Layers;
use crate::solver::obstacles;
use crate::solver::state::ParticleState;
use crate::solver::twin::{self, Surroundings};
use crate::solver::validate::{block, joined, rigid_body};
use crate::solver::{Particles, PinRegion, Plane, Settings, Solver, Substance};
use crate::spec::{ColliderShape, PlaneShape};
use glam::{DVec3, Vec3};

const CELL_M: f32 = 0.05;
const SPACING_M: f32 = 0.025;

fn moving(mut body: Particles, velocity_m_s: Vec3) -> Particles {
    body.velocity_m_s.fill(velocity_m_s);
    body
}

fn weightless() -> Settings {
    Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }
}

fn of(states: &[ParticleState], object: u32) -> impl Iterator<Item = &ParticleState> {
    states.iter().filter(move |s| s.object() == object)
}

fn mean(states: &[ParticleState], object: u32, value: impl Fn(&ParticleState) -> Vec3) -> DVec3 {
    let mass: f64 = of(states, object).map(|s| f64::from(s.mass_kg)).sum();
    of(states, object).map(|s| value(s).as_dvec3() * f64::from(s.mass_kg)).sum::<DVec3>() / mass
}

fn place(states: &[ParticleState], object: u32) -> DVec3 {
    mean(states, object, |s| s.position_m)
}

fn velocity(states: &[ParticleState], object: u32) -> DVec3 {
    mean(states, object, |s| s.velocity_m_s)
}

fn momentum(states: &[ParticleState]) -> DVec3 {
    states.iter().map(|s| s.velocity_m_s.as_dvec3() * f64::from(s.mass_kg)).sum()
}

fn go(solver: &mut Solver, to_s: f64) -> Vec<ParticleState> {
    solver.advance(to_s, &Stop::default()).expect("an advance");
    solver.states().expect("states")
}

#[test]
fn surfaces_are_found_from_mass_and_its_gradient() {
    // N: the share of a quadratic spline beyond s.
    let beyond = |s: f64| match s.abs() {
        a if a >= 1.5 => (0.0, 1.0),
        a if a >= 0.5 => ((1.5 - a).powi(3) / 6.0, 1.0 - (1.5 - a).powi(3) / 6.0),
        a => (0.5 - 0.75 * a + a.powi(3) / 3.0, 0.5 + 0.75 * a - a.powi(3) / 3.0),
    };
    let share = |s: f64| if s >= 0.0 { beyond(s).0 } else { beyond(s).1 };
    let relative = |s: f64| (share(s - 1.0) - share(s + 1.0)) / 2.0 / share(s);
    for k in -20..=20 {
        let s = f64::from(k) * 0.05;
        let found = twin::encounter::ahead(relative(s));
        assert!((found - s).abs() < 0.1, "a surface at {s} is found at {found}");
        // Two that touch there.
        let gap = found + twin::encounter::ahead(relative(-s));
        assert!(gap.abs() < 0.09, "touching at {s}, a gap of {gap}");
    }
}

#[test]
fn layers_meet_as_their_twins_do() {
    let bodies = [
        moving(block(Vec3::ZERO, Vec3::splat(0.15), SPACING_M, 2e5, 0.3), Vec3::new(1.0, 0.3, 0.0)),
        moving(block(Vec3::new(0.14, 0.03, 0.02), Vec3::splat(0.15), SPACING_M, 2e5, 0.3), Vec3::new(-2.0, 0.0, 0.5)),
        moving(block(Vec3::new(0.07, 0.14, 0.05), Vec3::splat(0.15), SPACING_M, 5e4, 0.2), Vec3::new(0.0, -2.0, 0.0)),
    ];
    let mut settings = Settings { frictions: vec![0.1, 0.5], ..Settings::new(CELL_M) };
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.4, restitution: 0.0 });
    let top = PlaneShape { point_m: [0.0, 0.0, 0.12], normal: [0.0, 0.0, -1.0] };
    let (low_m, high_m) = (Vec3::ZERO, Vec3::splat(0.15));
    settings.pins = vec![PinRegion { object: 0, shape: ColliderShape::Plane(top), low_m, high_m, from_s: 0.0, to_s: 1.0, path: Vec::new() }];
    let mut solver = solver(settings, &bodies.into_iter().reduce(joined).expect("three"));
    let seen = solver.look().expect("a look");
    solver.fit_window(seen.low, seen.high, 4).expect("a window");
    solver.set_surroundings();
    solver.start_segment();
    let states = solver.states().expect("states");
    let (colliders, pins) =
        (obstacles::colliders(&solver.settings), [obstacles::pin(&solver.settings.pins[0], &solver.grips[0].pose, 0, CELL_M, 0.0)]);
    let substances = solver.laws.substances.clone();
    let around = Surroundings { params: solver.params, colliders: &colliders, pins: &pins, accelerations: &[Vec3::ZERO; 3], substances: &substances };
    let dt_s = 4e-4;
    let plan = Plan { dt_s, last_dt_s: dt_s, substeps: 1, sort_every: 1, pour_every: 1, viscous_rounds: 0 };
    let bound = solver.bind_both().expect("bound");
    let gpu = Gpu::shared_for_tests().expect("a device");
    let mut recording = Recording::default();
    solver.record_substep(&plan, 0, &bound, &mut recording);
    gpu.submit(&recording);

    let mut stressed = states.clone();
    twin::stress(&mut stressed, &around, dt_s);
    let mut layers: Vec<twin::Grid> = (0..3).map(|o| twin::p2g(&of(&stressed, o).copied().collect::<Vec<_>>(), &around)).collect();
    (0..).zip(&mut layers).for_each(|(layer, grid)| twin::grid(grid, layer, &around, dt_s, 0.0));
    let apart = layers.clone();
    let dealt = Layers::deal(&solver.settings, &states, &solver.laws.substances);
    let surfaces = dealt.surfaces(&solver.settings, &states, &solver.laws.substances, 3);
    assert_eq!(surfaces.iter().map(|s| s[0]).collect::<Vec<_>>(), [0.1, 0.5, 0.3]);
    twin::encounter::encounter(&mut layers, &surfaces, &around, dt_s);
    let met = layers.iter().flatten().zip(apart.iter().flatten()).filter(|(a, b)| (a.1.velocity - b.1.velocity).length() > 1e-3).count();
    assert!(met > 15, "only {met} nodes met");

    let stored = super::twins::Stored::of(&solver);
    let grid = solver.grid.clone().expect("a grid");
    let velocity: Vec<[f32; 4]> = gpu.read(&grid.velocity, super::twins::node_count(&solver)).expect("velocity");
    let heaviest = layers.iter().flatten().map(|n| n.1.mass).fold(0.0, f64::max);
    for (layer, want) in layers.iter().enumerate() {
        for (node, value) in want.iter().filter(|(_, v)| v.mass > 1e-2 * heaviest) {
            let got = velocity[stored.node(node, layer as u32)];
            assert!((Vec3::from_slice(&got) - value.velocity).length() < 2e-3, "layer {layer}, node {node:?}: {got:?} and {}", value.velocity);
        }
    }
    for object in 0..3 {
        let mut want: Vec<ParticleState> = of(&stressed, object).copied().collect();
        twin::g2p(&mut want, &layers[object as usize], &around, dt_s, 0.0);
        let after = solver.states().expect("states");
        for (got, want) in of(&after, object).zip(&want) {
            assert!((got.velocity_m_s - want.velocity_m_s).length() < 2e-3, "{} and {}", got.velocity_m_s, want.velocity_m_s);
        }
    }
}

/// Seven stones of a particle each, aside.
fn pebbles() -> Particles {
    let pebble = |k: u32| rigid_body(block(Vec3::new(0.05 * k as f32, 0.0, 0.3), Vec3::splat(SPACING_M), SPACING_M, 1e5, 0.3), 0.3, 0.0);
    (1..7).map(pebble).fold(pebble(0), joined)
}

#[test]
fn only_what_is_on_the_grid_has_a_layer() {
    let (viscosity_pa_s, surface_tension_n_m) = (1e-3, 0.07);
    let cube = || block(Vec3::ZERO, Vec3::splat(0.1), SPACING_M, 1e5, 0.3);
    let of = |substance: Substance| Particles { substances: vec![substance], ..cube() };
    let drop = of(Substance::Liquid { viscosity_pa_s, surface_tension_n_m });
    let beside = of(Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m });
    let all = [cube(), pebbles(), cube(), beside, drop].into_iter().reduce(joined).expect("some");
    let solver = solver(weightless(), &all);
    let layer = |object: usize| solver.params.layer_of[object / 8] >> (4 * (object % 8)) & 15;
    assert_eq!((solver.params.layers, layer(0), layer(8), layer(10)), (3, 0, 1, 2));
    assert_eq!(solver.params.wet_layers, 0b100);
    // More than there are layers share them in turn; one needs no other.
    let many = solver_of(&(0..10).map(|_| cube()).reduce(joined).expect("ten"));
    assert_eq!((many.params.layers, many.params.layer_of[0], many.params.layer_of[1]), (8, 0x7654_3210, 0x10));
    assert_eq!(solver_of(&joined(pebbles(), cube())).params.layers, 1);
}

fn solver_of(particles: &Particles) -> Solver {
    solver(weightless(), particles)
}

#[test]
fn cubes_that_collide_part_again_and_keep_their_momentum() {
    let low = moving(block(Vec3::ZERO, Vec3::splat(0.15), SPACING_M, 1e5, 0.3), Vec3::new(1.0, 0.0, 0.0));
    let high = moving(block(Vec3::new(0.2, 0.013, 0.021), Vec3::splat(0.15), SPACING_M, 1e5, 0.3), Vec3::new(-1.0, 0.0, 0.0));
    // With stones between them in the list, the other is the ninth object.
    let mut solver = solver(weightless(), &joined(joined(low, pebbles()), high));
    let one_kg_m_s = f64::from(0.15f32.powi(3) * 1000.0);
    let (mut nearest_m, mut parted_m) = (f64::INFINITY, 0.0);
    for frame in 1..=10 {
        let states = go(&mut solver, f64::from(frame) * 0.02);
        assert!(momentum(&states).length() < 1e-3 * one_kg_m_s, "{}", momentum(&states));
        let apart_m = (place(&states, 8) - place(&states, 0)).x;
        nearest_m = nearest_m.min(apart_m);
        parted_m = apart_m;
    }
    // They touch, cell or no cell between them, and are squeezed a little.
    assert!(nearest_m < 0.15 + 0.01 && nearest_m > 0.10, "came as near as {nearest_m}");
    let states = solver.states().expect("states");
    let apart_m_s = (velocity(&states, 8) - velocity(&states, 0)).x;
    assert!(apart_m_s > 0.5 && parted_m > nearest_m + 0.02, "part at {apart_m_s} m/s, {parted_m} m apart");
    // A glued pair would have pulled itself to rest.
    for s in states.iter().filter(|s| !s.is_rigid()) {
        assert!(s.f().determinant() > 0.5 && s.f().determinant() < 1.5, "torn: {}", s.f());
    }
}

/// How far a block slides on another in 0.2 s, and how fast it is then, with gravity tilted by a tangent.
fn slide(tangent: f32, friction: f32) -> (f64, f64) {
    let lower = block(Vec3::ZERO, Vec3::new(0.4, 0.2, 0.1), SPACING_M, 1e6, 0.2);
    let upper = block(Vec3::new(0.1, 0.05, 0.1), Vec3::new(0.1, 0.1, 0.075), SPACING_M, 1e6, 0.2);
    let theta = tangent.atan();
    let mut settings = Settings { frictions: vec![2.0 * friction, 0.5 * friction], ..Settings::new(CELL_M) };
    settings.gravity_m_s2 = 9.81 * Vec3::new(theta.sin(), 0.0, -theta.cos());
    settings.ground = Some(Plane { height_m: 0.0, friction: 50.0, restitution: 0.0 });
    let mut solver = solver(settings, &joined(lower, upper));
    solver.prestress(&[0, 1], &Stop::default(), &mut |_| {}).expect("a prestress");
    let apart = |states: &[ParticleState]| place(states, 1) - place(states, 0);
    let start = apart(&solver.states().expect("states"));
    let states = go(&mut solver, 0.2);
    ((apart(&states) - start).x, (velocity(&states, 1) - velocity(&states, 0)).x)
}

#[test]
fn a_block_on_a_block_slides_where_the_slope_is_steeper_than_friction() {
    let (stays_m, _) = slide(0.25, 0.3);
    assert!(stays_m.abs() < 1e-3, "it slid by {stays_m} m");
    let (slides_m, speed_m_s) = slide(0.5, 0.3);
    let theta = 0.5f64.atan();
    let expected_m_s = 9.81 * (theta.sin() - 0.3 * theta.cos()) * 0.2;
    assert!((speed_m_s / expected_m_s - 1.0).abs() < 0.05, "{speed_m_s} m/s after {slides_m} m, expected {expected_m_s}");
}

#[test]
fn a_block_rests_on_another() {
    let lower = block(Vec3::ZERO, Vec3::new(0.2, 0.2, 0.15), SPACING_M, 1e5, 0.3);
    let upper = block(Vec3::new(0.038, 0.041, 0.15), Vec3::new(0.125, 0.125, 0.1), SPACING_M, 5e4, 0.3);
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.4, restitution: 0.0 });
    let mut solver = solver(settings, &joined(lower, upper));
    solver.prestress(&[0, 1], &Stop::default(), &mut |_| {}).expect("a prestress");
    let apart = |states: &[ParticleState]| (place(states, 1) - place(states, 0)).z;
    let start_m = apart(&solver.states().expect("states"));
    let mut sunk_m = Vec::new();
    for k in 1..=4 {
        sunk_m.push(start_m - apart(&go(&mut solver, 0.15 * f64::from(k))));
    }
    let states = solver.states().expect("states");
    assert!(sunk_m.iter().all(|s| s.abs() < 0.1 * f64::from(CELL_M)), "sank by {sunk_m:?}");
    assert!((sunk_m[3] - sunk_m[1]).abs() < 5e-4, "still sinking: {sunk_m:?}");
    assert!(velocity(&states, 1).length() < 0.02, "{}", velocity(&states, 1));
}

#[test]
fn what_is_thrown_at_a_held_plate_stays_before_it() {
    let plate = block(Vec3::ZERO, Vec3::new(0.3, 0.3, 0.1), SPACING_M, 2e5, 0.3);
    let ball = moving(block(Vec3::new(0.1, 0.11, 0.2), Vec3::splat(0.1), SPACING_M, 2e5, 0.3), Vec3::new(0.0, 0.0, -4.0));
    let mut settings = weightless();
    let below = PlaneShape { point_m: [0.0, 0.0, 0.04], normal: [0.0, 0.0, 1.0] };
    settings.pins = vec![PinRegion {
        object: 0,
        shape: ColliderShape::Plane(below),
        low_m: Vec3::ZERO,
        high_m: Vec3::new(0.3, 0.3, 0.1),
        from_s: 0.0,
        to_s: 9.0,
        path: Vec::new(),
    }];
    let mut solver = solver(settings, &joined(plate, ball));
    let mut lowest_m = f32::INFINITY;
    for frame in 1..=6 {
        let states = go(&mut solver, f64::from(frame) * 0.02);
        lowest_m = of(&states, 1).map(|s| s.position_m.z).fold(lowest_m, f32::min);
    }
    assert!(lowest_m > 0.05, "a particle came down to {lowest_m} m");
    assert!(velocity(&solver.states().expect("states"), 1).z > 0.5, "it bounced off");
}
