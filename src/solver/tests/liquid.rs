//! What liquids need beside their law, on the device against twins, and how they behave as wholes.

use super::solver;
use super::twins::{CELL_M, DT_S, SUBSTEP, Stored, gpu, node_count, run, scene_of, sort};
use crate::Stop;
use crate::solver::state::ParticleState;
use crate::solver::substance::{Substance, liquid_bulk_pa};
use crate::solver::twin::liquid::{Fields, wall};
use crate::solver::twin::{self, Surroundings};
use crate::solver::validate::{block, joined, pool};
use crate::solver::{Plane, Settings, Solver, obstacles};
use glam::{DVec3, IVec3, Vec3};

const SPAN_S: f32 = 2e-3;

/// Lattice coordinates, z first, of all nodes of the blocks that the sort lists.
fn active_nodes(solver: &Solver, states: &[ParticleState]) -> Vec<[i32; 3]> {
    let [across, along, _] = solver.params.blocks;
    let of_block = |block: u32| {
        let corner = IVec3::new((block % across) as i32, (block / across % along) as i32, (block / across / along) as i32) * 4;
        (0..64).map(move |k| corner + IVec3::new(k & 3, k >> 2 & 3, k >> 4))
    };
    let origin = IVec3::from(solver.params.origin);
    twin::sort::sort(states, &solver.params)
        .active
        .into_iter()
        .flat_map(of_block)
        .map(|c| (c + origin).into())
        .map(|[x, y, z]: [i32; 3]| [z, y, x])
        .collect()
}

#[test]
fn density_tension_and_walls_follow_the_twins() {
    let thin = Substance::Liquid { viscosity_pa_s: 0.3, surface_tension_n_m: 4.0 };
    let thick = Substance::Liquid { viscosity_pa_s: 400.0, surface_tension_n_m: 1.0 };
    let paste = Substance::Viscoplastic { yield_stress_pa: 2e3, viscosity_pa_s: 400.0 };
    follows_the_twins([thin.clone(), thick]);
    follows_the_twins([thin, paste]);
}

fn follows_the_twins(substances: [Substance; 2]) {
    let (mut solver, mut states) = scene_of(substances);
    let colliders = obstacles::colliders(&solver.settings);
    let pins = [obstacles::pin(&solver.settings.pins[0], &solver.grips[0].pose, 0, CELL_M, 0.0)];
    let substances = solver.laws.substances.clone();
    let around = Surroundings { params: solver.params, colliders: &colliders, pins: &pins, accelerations: &[Vec3::ZERO; 2], substances: &substances };
    let fields = Fields::new(&states, &around, &active_nodes(&solver, &states));
    sort(&mut solver);
    let bound = solver.bind_both().expect("bound");
    let b = &bound[solver.current];
    let liquid = b.liquid.as_ref().expect("liquids");
    run(|r| solver.record_liquid(liquid, &b.active_groups, SPAN_S, r));

    let grid = solver.grid.clone().expect("a grid");
    let on_grid = grid.liquid.clone().expect("fields");
    let (stored, nodes) = (Stored::of(&solver), node_count(&solver));
    let share: Vec<[f32; 4]> = gpu().read(&on_grid.share, nodes).expect("share");
    let pull: Vec<[f32; 4]> = gpu().read(&on_grid.pull, nodes).expect("pull");
    let film: Vec<[f32; 2]> = gpu().read(&on_grid.film, nodes).expect("film");
    let left: Vec<[i32; 3]> = gpu().read(&on_grid.fill, nodes).expect("fill");
    assert!(left.iter().all(|f| *f == [0; 3]), "the fill is left for the next time");
    let strongest = fields.pool.keys().map(|&n| fields.pull(n).length()).fold(0.0, f64::max);
    let (mut compared, mut walls, mut astray) = (0, 0, 0);
    for (&node, poured) in fields.pool.iter().filter(|(_, p)| p.volume > 0.01) {
        let [full, tension, viscosity, _] = share[stored.node(&node, 0)].map(f64::from);
        match fields.full(node) {
            Some(want) => assert!((full - want).abs() < 2e-3 * want.max(0.1), "{node:?}: {full} full, {want} by the twin"),
            None => assert!(full < 0.0, "{node:?}"),
        }
        walls += usize::from(full < 0.0 || full > 1.05 * poured.volume);
        // Rounded to shares of the most tense one's, and of the most viscous one's.
        let off = (tension - poured.tension_m3_s2).abs();
        assert!(off < 1e-2 * poured.tension_m3_s2.max(1e-3), "{node:?}: {tension} and {}", poured.tension_m3_s2);
        assert!(
            (viscosity - poured.viscosity_m2_s).abs() < 1e-4 * 0.4 / poured.volume.min(1.0),
            "{node:?}: {viscosity} and {}",
            poured.viscosity_m2_s
        );
        let (got, want) = (DVec3::from(Vec3::from_slice(&pull[stored.node(&node, 0)])), fields.pull(node));
        compared += 1;
        // Where the surface begins a hair decides.
        astray += usize::from((got - want).length() > 5e-3 * strongest);
    }
    assert!(compared > 200 && walls > 50 && astray * 100 <= compared, "{astray} of {compared} astray, {walls} behind walls");
    assert!(strongest > 1.0);

    let (mut deep, mut thin) = (0, 0);
    for &node in fields.pool.keys() {
        let want = fields.film_m(node);
        let got = film[stored.node(&node, 0)].map(f64::from);
        deep += usize::from(want[0] > want[1]);
        thin += usize::from(want[1] > 0.0);
        let apart = got.iter().zip(want).map(|(g, w)| (g - w).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-3 * want[0].max(f64::from(CELL_M)), "film at {node:?}: {got:?} m, {want:?} by the twin");
    }
    assert!(deep > 50 && thin > 20, "{deep} nodes in deep liquid, {thin} in films");

    let mut moved = 0;
    for (got, s) in
        solver.states().expect("states").iter().zip(&states).filter(|(_, s)| s.f().determinant() > 0.3 && substances[s.substance()].is_liquid())
    {
        let (got, want) = (f64::from(got.f().determinant()), fields.density(s, f64::from(SPAN_S)));
        assert!((got - want).abs() < 1e-4, "J of particle {}: {got}, {want} by the twin", s.index);
        moved += usize::from((want - f64::from(s.f().determinant())).abs() > 1e-4);
    }
    assert!(moved > 100);

    // The grid's pass, from the same momenta.
    states = solver.states().expect("states");
    let (passes, groups) = (solver.passes.clone(), solver.particle_groups());
    run(|r| r.dispatch_with(&passes.stress, &b.stress, &SUBSTEP, groups));
    twin::stress(&mut states, &around, DT_S);
    run(|r| solver.record_p2g(b, &SUBSTEP, r));
    let mut want = twin::p2g(&states, &around);
    run(|r| r.indirect_with(&passes.grid, &b.grid, &SUBSTEP, &grid.active_groups, 0));
    for (node, value) in want.iter_mut() {
        let [x, y, z, viscosity] = pull[stored.node(node, 0)];
        (value.pull_m_s2, value.viscosity_m2_s, value.film_m) = (Vec3::new(x, y, z), viscosity, film[stored.node(node, 0)]);
    }
    twin::grid(&mut want, 0, &around, DT_S, SUBSTEP.since_s);
    let velocity: Vec<[f32; 4]> = gpu().read(&grid.velocity, nodes).expect("velocity");
    let heaviest = want.values().map(|n| n.mass).fold(0.0, f64::max);
    let strongest = want.values().map(|n| n.momentum.length()).fold(0.0, f64::max);
    let heavy = |v: &twin::Node| v.mass > 1e-2 * heaviest;
    for (node, value) in want.iter().filter(|(_, v)| heavy(v)) {
        let got = velocity[stored.node(node, 0)];
        let apart = (Vec3::from_slice(&got) - value.velocity).length();
        assert!(apart < 1e-4 * (strongest / value.mass) as f32, "{node:?}: {got:?} and {}", value.velocity);
        assert!((got[3] - value.held).abs() < 1e-4, "{node:?} is held by {} and {}", got[3], value.held);
    }

    // Walls, from the device's own velocities.
    for (node, value) in want.iter_mut() {
        let got = velocity[stored.node(node, 0)];
        (value.velocity, value.held) = (Vec3::from_slice(&got), got[3]);
    }
    run(|r| solver.record_walls(liquid, &b.active_groups, r));
    let after: Vec<[f32; 4]> = gpu().read(&grid.velocity, nodes).expect("velocity");
    let mut stuck = 0;
    for (node, value) in &want {
        let got = Vec3::from_slice(&after[stored.node(node, 0)]);
        let expected = if value.held > 0.0 { wall(&want, *node, &around) } else { value.velocity };
        stuck += usize::from(got != value.velocity);
        assert!((got - expected).length() < 1e-4 * value.velocity.length().max(1.0), "{node:?}: {got} and {expected}");
    }
    assert!(stuck > 20, "only {stuck} nodes stick");
}

/// Runs a drop of some viscosity that falls on the ground; the share of its energy that is left at the
/// end, the shortest substep, and its states.
fn dropped(viscosity_pa_s: f32, bulk_pa: f32) -> (f64, f64, Vec<ParticleState>) {
    let substance = Substance::Liquid { viscosity_pa_s, surface_tension_n_m: 0.0 };
    let mut particles = pool(Vec3::new(0.0, 0.0, 0.02), Vec3::splat(0.16), 0.02, 1000.0, bulk_pa, substance);
    particles.velocity_m_s.fill(Vec3::new(0.0, 0.0, -2.0));
    let mut settings = Settings::new(0.04);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    let mut shortest_s = f64::INFINITY;
    for frame in 1..=10 {
        shortest_s = shortest_s.min(solver.advance(0.02 * f64::from(frame), &Stop::default()).expect("a run").dt_min_s);
    }
    let states = solver.states().expect("states");
    let energy: f64 = states.iter().map(|s| 0.5 * f64::from(s.velocity_m_s.length_squared()) + 9.81 * f64::from(s.position_m.z)).sum();
    (energy / particles.len() as f64 / (2.0 + 9.81 * 0.1), shortest_s, states)
}

#[test]
fn any_viscosity_runs_at_the_step_of_sound() {
    let bulk_pa = liquid_bulk_pa(0.2, 2.0, 9.81, 1000.0);
    let sound_m_s = f64::from(bulk_pa / 1000.0).sqrt();
    for viscosity_pa_s in [0.0, 1e-3, 10.0, 1e3, 1e4, 1e6] {
        let (energy, shortest_s, states) = dropped(viscosity_pa_s, bulk_pa);
        let courant = shortest_s * sound_m_s / 0.04;
        let width = (12.0
            * (states.iter().map(|s| s.position_m.x.powi(2)).sum::<f32>() / states.len() as f32
                - (states.iter().map(|s| s.position_m.x).sum::<f32>() / states.len() as f32).powi(2)))
        .sqrt();
        let lowest = states.iter().map(|s| s.position_m.z).fold(f32::MAX, f32::min);
        println!("{viscosity_pa_s} Pa s: energy {energy:.3}, Courant number {courant:.3}, width {width:.3} m, lowest {lowest:.4} m");
        assert!(energy < 1.0 && lowest >= -1e-4, "{viscosity_pa_s} Pa s gains energy or leaks: {energy}, {lowest} m");
        assert!(courant > 0.19, "{viscosity_pa_s} Pa s takes substeps of {shortest_s} s");
        let spread = match viscosity_pa_s {
            ..1.0 => 0.5..2.0,
            ..100.0 => 0.25..0.4,
            // Not more than the blow flattens it.
            _ => 0.15..0.23,
        };
        assert!(spread.contains(&width), "{viscosity_pa_s} Pa s spreads to {width} m");
    }
}

#[test]
fn a_liquids_surface_pulls_at_the_liquid_alone() {
    // A cube of jelly a cell beside a cube of liquid, so that they share nodes and do not touch.
    let liquid = Substance::Liquid { viscosity_pa_s: 0.1, surface_tension_n_m: 2.0 };
    let drop = pool(Vec3::ZERO, Vec3::splat(0.2), 0.025, 1000.0, 1e5, liquid);
    let jelly = block(Vec3::new(0.25, 0.0, 0.0), Vec3::splat(0.2), 0.025, 5e4, 0.3);
    let mut solver = solver(Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }, &joined(drop, jelly));
    solver.advance(0.001, &Stop::default()).expect("an advance");
    let states = solver.states().expect("states");
    let fastest = |object: u32| states.iter().filter(|s| s.object() == object).map(|s| s.velocity_m_s.length()).fold(0.0, f32::max);
    assert!(fastest(0) > 1e-4, "the liquid draws together, at {} m/s", fastest(0));
    assert_eq!(fastest(1), 0.0);
}
