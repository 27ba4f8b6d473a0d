//! Liquids of smoothed particles: each pass against its twin, and what a run keeps.

use super::solver;
use super::twins::Noise;
use crate::Stop;
use crate::gpu::{Gpu, Recording};
use crate::solver::advance::Substep;
use crate::solver::constants::{SPH_RELAX, SPH_SLOTS};
use crate::solver::core::Solver;
use crate::solver::obstacles;
use crate::solver::state::ParticleState;
use crate::solver::twin::{self, Surroundings};
use crate::solver::validate::{block, joined};
use crate::solver::{Collider, Moduli, Particles, Placement, Plane, Settings, Substance};
use crate::spec::{BoxShape, ColliderShape, ElasticModel, PlaneShape};
use glam::{DVec3, Quat, Vec3};

const D_M: f32 = 0.025;
const CELL_M: f32 = 2.0 * D_M;
const DT_S: f32 = 2e-3;

fn gpu() -> Gpu {
    Gpu::shared_for_tests().expect("a device")
}

fn liquid(low: Vec3, size: Vec3, viscosity_pa_s: f32, surface_tension_n_m: f32) -> Particles {
    let substances = vec![Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m }];
    Particles { substances, ..block(low, size, D_M, 1e5, 0.3) }
}

/// With a body of another object and substance, half as dense as it says.
fn with(a: Particles, mut b: Particles, substance: Substance) -> Particles {
    b.density_kg_m3.iter_mut().for_each(|rho| *rho *= 0.5);
    joined(a, Particles { substances: vec![substance], ..b })
}

fn wall(point: Vec3, normal: Vec3) -> Collider {
    let plane = PlaneShape { point_m: point.as_dvec3().into(), normal: normal.as_dvec3().into() };
    Collider { shape: ColliderShape::Plane(plane), friction: 0.0, restitution: 0.0 }
}

fn momentum(states: &[ParticleState]) -> DVec3 {
    states.iter().map(|s| s.velocity_m_s.as_dvec3() * f64::from(s.mass_kg)).sum()
}

#[test]
fn closed_forms_of_walls_are_the_integrals_of_the_kernel() {
    let whole: f64 =
        (0..2000).map(|k| (f64::from(k) + 0.5) / 2000.0).map(|q| 4.0 * std::f64::consts::PI * q * q * twin::sph::weight(q) / 2000.0).sum();
    assert!((whole - 1.0).abs() < 1e-5, "{whole}");
    assert!((twin::sph::plane(0.0) - 1.4).abs() < 1e-5);
    // A row of a cubic lattice half a spacing from a wall misses 0.150 of its density behind it.
    let row: f64 = (-3..=3)
        .flat_map(|a| (-3..=3).map(move |b| f64::from(a * a + b * b)))
        .map(|d| twin::sph::weight((0.25 * (d + 1.0)).sqrt().min(1.0)) / 8.0)
        .sum();
    assert!((twin::sph::wall_density(0.25) / row - 1.0).abs() < 0.01, "{row}");
}

#[test]
fn the_pull_of_solids_has_the_tension_of_fowlers_integral() {
    let parts = 2000;
    let at = (0..parts).map(|k| (f64::from(k) + 0.5) / f64::from(parts));
    let tension: f64 = at.map(|q| std::f64::consts::PI / 8.0 * q.powi(4) * twin::sph::pull(q) / f64::from(parts)).sum();
    assert!((tension - 1.0).abs() < 1e-5, "{tension}");
}

/// A jittered liquid in the corner of two walls and the ground, beside a lighter elastic block, all
/// moving, and the solver ready to record passes.
fn scene(viscosity_pa_s: f32) -> (Solver, Vec<ParticleState>) {
    let mut noise = Noise(5);
    let fluid = liquid(Vec3::ZERO, Vec3::new(0.125, 0.1, 0.125), viscosity_pa_s, 2.0);
    let solid = block(Vec3::new(0.125, 0.0, 0.0), Vec3::new(0.075, 0.1, 0.1), D_M, 1e5, 0.3);
    let mut particles = with(fluid, solid, Substance::Elastic(ElasticModel::Corotated));
    for (x, v) in particles.position_m.iter_mut().zip(&mut particles.velocity_m_s) {
        *x += noise.vec() * (0.2 * D_M);
        *v = Vec3::new(0.3, -0.1, -0.4) + noise.vec() * 0.5;
    }
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: -0.004, friction: 0.4, restitution: 0.0 });
    let post = BoxShape { centre_m: [-0.055, 0.1, 0.1], size_m: [0.1, 0.6, 0.6] };
    settings.colliders =
        vec![Collider { shape: ColliderShape::Box(post), friction: 0.3, restitution: 0.0 }, wall(Vec3::new(0.0, -0.007, 0.0), Vec3::Y)];
    settings.forces = vec![crate::solver::ObjectForce { object: 1, from_s: 0.0, to_s: 1.0, acceleration_m_s2: Vec3::new(3.0, -2.0, 1.0) }];
    let mut solver = solver(settings, &particles);
    let seen = solver.look().expect("a look");
    solver.fit_window(seen.low, seen.high, 4).expect("a window");
    solver.set_surroundings();
    solver.start_segment();
    // Every third has just become liquid, and has not noted yet how dense it is.
    let allowed = |i: usize| if i.is_multiple_of(3) { -1.0 } else { 0.01 * (i % 5) as f32 };
    let kept: Vec<[f32; 4]> = (0..particles.len()).map(|i| [300.0 + 300.0 * noise.vec().x, allowed(i), -0.1 * (i % 4) as f32, 0.0]).collect();
    gpu().upload(&solver.kept.last().expect("pressures").live, &kept);
    let states = solver.states().expect("states");
    (solver, states)
}

fn close(what: &str, got: Vec3, want: DVec3, tolerance: f64) {
    assert!((got.as_dvec3() - want).length() <= tolerance, "{what}: {got} on the device, {want} by the twin");
}

fn read(buffer: &wgpu::Buffer, n: usize) -> Vec<[f32; 4]> {
    gpu().read(buffer, n).expect("values")
}

fn vectors(values: &[[f32; 4]]) -> Vec<DVec3> {
    values.iter().map(|v| Vec3::from_slice(v).as_dvec3()).collect()
}

#[test]
fn one_substep_pass_by_pass() {
    let (mut solver, states) = scene(0.5);
    let n = states.len();
    let groups = solver.particle_groups();
    let bound = solver.bind_both().expect("bound");
    let run = |build: &dyn Fn(&mut Recording)| {
        let mut recording = Recording::default();
        build(&mut recording);
        gpu().submit(&recording);
    };
    run(&|r| solver.record_sort(&bound[solver.current], r));
    solver.current = 1 - solver.current;
    let matter: Vec<[f32; 4]> = gpu().read(&solver.buffers[solver.current].matter, 4 * n).expect("matter");
    let order: Vec<usize> = (0..n).map(|i| matter[3 * n + i][0].to_bits() as usize).collect();
    let pressures = || -> Vec<[f32; 4]> { gpu().read(&solver.kept.last().expect("pressures").live, n).expect("pressures") };
    let kept = pressures();
    let sorted: Vec<ParticleState> = order.iter().map(|&i| states[i]).collect();
    let colliders = obstacles::colliders(&solver.settings);
    let accelerations = [Vec3::ZERO, Vec3::new(3.0, -2.0, 1.0)];
    let substances = solver.laws.substances.clone();
    let around = Surroundings { params: solver.params, colliders: &colliders, pins: &[], accelerations: &accelerations, substances: &substances };
    let (cell, dt) = (f64::from(CELL_M), f64::from(DT_S));
    let sph = solver.sph().expect("a liquid");
    let b = bound[solver.current].sph.as_ref().expect("bound");
    let p = &sph.passes;
    let substep = |job: u32| Substep { dt_s: DT_S, dt_next_s: DT_S, index: 0, job, since_s: 0.0, lag: 0 };

    // Lists and sums.
    run(&|r| {
        r.dispatch(&p.sph_place, &b.place, groups);
        r.dispatch(&p.sph_near, &b.near, groups);
        r.dispatch(&p.sph_skin, &b.skin, groups);
    });
    let allowed: Vec<Option<f64>> = order.iter().map(|&i| Some(f64::from(kept[i][1])).filter(|&a| a >= 0.0)).collect();
    let mut want = twin::sph::near(&sorted, &allowed, &around);
    let near: Vec<u32> = gpu().read(&sph.near, n).expect("lists");
    let (density, walls) = {
        let both = read(&sph.density, 2 * n);
        (both[..n].to_vec(), both[n..].to_vec())
    };
    let answer: Vec<f32> = gpu().read(&sph.answer, n).expect("answers");
    let concerned: Vec<usize> = (0..n).filter(|&i| want[i].liquid || !want[i].neighbours.is_empty()).collect();
    assert!(concerned.len() > n / 2 && concerned.iter().filter(|&&i| !want[i].liquid).count() > 20);
    for i in 0..n {
        let solids = want[i].neighbours.iter().filter(|&&j| !want[j].liquid).count();
        let listed = [near[i] & 0xfff, near[i] >> 12 & 0xfff, near[i] >> 31];
        assert_eq!(listed, [(want[i].neighbours.len() - solids) as u32, solids as u32, u32::from(want[i].liquid)], "lists of {i}");
        if want[i].liquid {
            close("gradient", Vec3::from_slice(&density[i]), want[i].gradient, 2e-4);
            close("walls", Vec3::from_slice(&walls[i]), want[i].wall, 2e-4);
            assert!((f64::from(walls[i][3]) - want[i].hidden).abs() < 1e-4, "{} {}", walls[i][3], want[i].hidden);
            assert!((f64::from(density[i][3]) - want[i].seen()).abs() < 1e-5, "{} {}", density[i][3], want[i].seen());
            assert!((f64::from(answer[i]) / want[i].answer - 1.0).abs() < 1e-3, "{} {}", answer[i], want[i].answer);
        }
    }
    run(&|r| r.dispatch(&p.sph_begin, &b.begin, groups));
    want.iter_mut().for_each(twin::sph::Particle::begin);
    let (density, nature) = (read(&sph.density, n), read(&sph.nature, n));
    assert!((0..n).filter(|&i| allowed[i].is_none() && want[i].liquid && want[i].density > 1.0).count() > 5);
    for i in (0..n).filter(|&i| want[i].liquid) {
        assert!((f64::from(density[i][3]) - want[i].seen()).abs() < 1e-5, "{} {}", density[i][3], want[i].seen());
        assert!((Some(f64::from(nature[i][3])) == allowed[i]) || (f64::from(nature[i][3]) - want[i].allowed.unwrap()).abs() < 1e-5);
    }
    let pulls: Vec<[f32; 2]> = gpu().read(&sph.skin, n).expect("pulls");
    let skin = twin::sph::skin(&want, cell);
    assert!(skin.iter().filter(|s| s[1] > 0.5).count() > 20);
    for i in (0..n).filter(|&i| want[i].liquid) {
        assert!((0..2).all(|k| (f64::from(pulls[i][k]) - skin[i][k]).abs() < 2e-3 * (1.0 + skin[i][k])), "{:?} {:?}", pulls[i], skin[i]);
    }
    let errors: Vec<u32> = gpu().read(&sph.errors, SPH_SLOTS as usize).expect("errors");
    let stiffest = want.iter().map(|p| p.viscous).fold(0.0, f64::max);
    assert!((f64::from(f32::from_bits(errors[SPH_SLOTS as usize - 1])) / stiffest - 1.0).abs() < 1e-3);

    // Forces, with viscosity and without, and the first half of a round with the pressures from before.
    let start: Vec<f64> = order.iter().zip(&want).map(|(&i, p)| if p.liquid { f64::from(kept[i][0]) } else { 0.0 }).collect();
    let pushed = twin::sph::pushed(&want, &start, cell, dt);
    for job in [0, 1] {
        run(&|r| r.dispatch_with(&p.sph_forces, &b.forces, &substep(job), groups));
        let forced = twin::sph::forces(&want, &around, dt, job == 0);
        let (got, after) = (read(&sph.predicted, n), read(&sph.corrected, n));
        for &i in &concerned {
            let tolerance = 2e-3 * (forced[i] - want[i].v).length() + 1e-4;
            close("forces", Vec3::from_slice(&got[i]), forced[i], tolerance);
            close("half a round", Vec3::from_slice(&after[i]), forced[i] + pushed[i], tolerance);
        }
    }
    let (free, wanted) = (vectors(&read(&sph.predicted, n)), vectors(&read(&sph.corrected, n)));
    let before: Vec<[f32; 4]> = (0..n).map(|i| [(i % 7) as f32 - 3.0, (i % 5) as f32, -1.0, 0.0]).collect();
    let braking = &solver.kept[solver.kept.len() - 2].live;
    gpu().upload(braking, &before);
    run(&|r| r.dispatch_with(&p.sph_foresee, &b.foresee, &substep(0), groups));
    let got = read(&sph.slowed, n);
    for &i in &concerned {
        close("foreseen", Vec3::from_slice(&got[i]), wanted[i] + Vec3::from_slice(&before[order[i]]).as_dvec3() * dt, 1e-6);
    }
    run(&|r| {
        for round in 0..40 {
            r.dispatch_with(&p.sph_implicit, &b.implicit[(round % 2) as usize], &substep(round), groups);
        }
    });
    let (got, slowed) = (read(&sph.slowed, n), twin::sph::implicit(&want, &wanted, &around, dt));
    for &i in &concerned {
        close("implicit viscosity", Vec3::from_slice(&got[i]), slowed[i], 1e-3);
    }
    run(&|r| r.dispatch_with(&p.sph_settle, &b.settle, &substep(0), groups));
    let (got, after) = (read(&sph.predicted, n), read(braking, n));
    for &i in &concerned {
        close("settled", Vec3::from_slice(&got[i]), free[i] + slowed[i] - wanted[i], 1e-3);
        close("braking", Vec3::from_slice(&after[order[i]]), (slowed[i] - wanted[i]) / dt, 0.5);
    }

    // What is left of a round, all of the next one, which lets another run, and the end of the substep.
    let base = vectors(&got);
    let check_pressures = |start: &[f64], corrected: &[DVec3]| -> Vec<f64> {
        let got: Vec<f32> = gpu().read(&sph.pressure, n).expect("pressures");
        for i in (0..n).filter(|&i| want[i].liquid) {
            let full = f64::from(SPH_RELAX) * twin::sph::error(&want, i, corrected, cell, dt) * want[i].answer * (cell / dt).powi(2);
            let next = (start[i] + full).max(0.0);
            assert!((f64::from(got[i]) - next).abs() < 0.3 + 2e-3 * next.abs(), "pressure of {i}: {} {next}", got[i]);
        }
        got.iter().map(|&p| f64::from(p)).collect()
    };
    run(&|r| r.dispatch_with(&p.sph_correct, &b.correct, &substep(0), groups));
    let corrected: Vec<DVec3> = base.iter().zip(&pushed).map(|(v, dv)| *v + *dv).collect();
    let first = check_pressures(&start, &corrected);
    run(&|r| r.dispatch_with(&p.sph_press, &b.press[1], &substep(1), groups));
    let corrected: Vec<DVec3> = base.iter().zip(twin::sph::pushed(&want, &first, cell, dt)).map(|(v, dv)| *v + dv).collect();
    let got = read(&sph.corrected, n);
    for &i in &concerned {
        close("corrected", Vec3::from_slice(&got[i]), corrected[i], 1e-4);
    }
    let turns: Vec<[u32; 4]> = gpu().read(&sph.turns[0], SPH_SLOTS as usize).expect("counts");
    assert_eq!(turns.iter().map(|t| t[0]).collect::<Vec<_>>()[..4], [0, 0, groups[0], 0], "who runs in even rounds");
    run(&|r| r.dispatch_with(&p.sph_advance, &b.advance, &substep(0), groups));
    let pushed = twin::sph::pushed(&want, &first, cell, dt);
    let (after, left) = (solver.states().expect("states"), pressures());
    for i in 0..n {
        let (me, s) = (&want[i], &after[order[i]]);
        let mut v = base[i] + pushed[i];
        if !me.liquid {
            v -= (Vec3::from(around.params.gravity_m_s2) + accelerations[1]).as_dvec3() * dt;
            let untouched = me.neighbours.is_empty();
            close("solid", s.velocity_m_s, if untouched { sorted[i].velocity_m_s.as_dvec3() } else { v }, 2e-4);
            assert_eq!(s.position_m, sorted[i].position_m);
            continue;
        }
        let [pressure_pa, allowed, rate, _] = left[order[i]].map(f64::from);
        let [eased, easing] = twin::sph::eased(me.allowed.unwrap(), f64::from(kept[order[i]][2]), cell, dt);
        assert!(pressure_pa == first[i], "{pressure_pa} {}", first[i]);
        assert!((allowed - eased).abs() < 1e-5 && (rate - easing).abs() < 1e-4, "{allowed} {eased} {rate} {easing}");
        v = twin::sph::braked(me, v, &around, dt);
        let mut x = me.x + v * dt;
        for c in &colliders {
            let touch = c.touch(x.as_vec3());
            let behind = f64::from(s.rest_m.min(0.0) - touch.distance_m);
            if behind > 0.0 {
                let normal = c.normal(touch.face, x.as_vec3()).as_dvec3();
                x += normal * behind.min((me.x - x).dot(normal).max(0.0) + twin::sph::out_of_walls(cell, dt) * behind);
                v -= normal * v.dot(normal).min(0.0);
            }
        }
        close("position", s.position_m, x, 1e-6);
        close("velocity", s.velocity_m_s, v, 2e-4);
    }
}

#[test]
fn nothing_outside_changes_momentum_in_free_flight() {
    let fluid = liquid(Vec3::ZERO, Vec3::splat(0.15), 0.5, 1.0);
    let solid = block(Vec3::new(0.15, 0.0, 0.0), Vec3::splat(0.1), D_M, 5e4, 0.3);
    let mut particles = with(fluid, solid, Substance::Elastic(ElasticModel::Corotated));
    for (v, x) in particles.velocity_m_s.iter_mut().zip(&particles.position_m) {
        *v = Vec3::new(2.0, 0.05, 0.0) - (*x - Vec3::splat(0.1)) * 2.0;
    }
    let settings = Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) };
    let mut solver = solver(settings, &particles);
    let before = momentum(&solver.states().expect("states"));
    let mass: f64 = solver.states().expect("states").iter().map(|s| f64::from(s.mass_kg)).sum();
    solver.advance(0.1, &Stop::default()).expect("an advance");
    let states = solver.states().expect("states");
    let given: DVec3 = states.iter().filter(|s| s.object() == 1).map(|s| s.velocity_m_s.as_dvec3() * f64::from(s.mass_kg)).sum();
    assert!((given.x - 2.0 * mass * 0.128).abs() > 1e-3 * mass, "the two touched");
    let lost = (momentum(&states) - before).length() / mass;
    assert!(lost < 1e-5, "{lost} m/s");
}

/// Root of the mean square of velocities, but for one that all have.
fn stirred_m_s(states: &[ParticleState], common_m_s: Vec3) -> f32 {
    (states.iter().map(|s| (s.velocity_m_s - common_m_s).length_squared()).sum::<f32>() / states.len() as f32).sqrt()
}

#[test]
fn what_is_too_dense_from_the_start_is_not_thrown_apart() {
    // As bodies are filled: a lattice whose particles were shifted; and one that is squeezed as well.
    for squeezed in [1.0, 0.9] {
        for gravity_m_s2 in [0.0, -9.81] {
            let mut noise = Noise(11);
            let mut particles = liquid(Vec3::ZERO, Vec3::splat(0.2), 1e-3, 0.07);
            particles.position_m.iter_mut().for_each(|x| *x = (*x + noise.vec() * (0.4 * D_M)) * squeezed);
            let gravity_m_s2 = Vec3::new(0.0, 0.0, gravity_m_s2);
            let mut solver = solver(Settings { gravity_m_s2, ..Settings::new(CELL_M) }, &particles);
            for k in 1..=10 {
                let time_s = 0.01 * k as f32;
                solver.advance(f64::from(time_s), &Stop::default()).expect("an advance");
                let stirred = stirred_m_s(&solver.states().expect("states"), gravity_m_s2 * time_s);
                assert!(stirred < 0.05, "{stirred} m/s after {time_s} s, squeezed to {squeezed}");
            }
        }
    }
}

#[test]
fn what_starts_inside_a_wall_comes_out_without_throwing_the_rest_apart() {
    let particles = liquid(Vec3::ZERO, Vec3::splat(0.2), 1e-3, 0.0);
    let colliders = vec![wall(Vec3::ZERO, Vec3::X)];
    for step_s in [1e-4, 1e-3] {
        let mut solver = solver(Settings { gravity_m_s2: Vec3::ZERO, colliders: colliders.clone(), ..Settings::new(CELL_M) }, &particles);
        // Two layers are behind it.
        let (offset_m, still) = (Vec3::new(-0.04, 0.0, 0.0), Vec3::ZERO);
        let placement = Placement { rotation: Quat::IDENTITY, centre_m: Vec3::ZERO, offset_m, velocity_m_s: still, spin_rad_s: still };
        solver.place(0, &placement).expect("a placement");
        for k in 1..=10 {
            solver.advance(step_s * f64::from(k), &Stop::default()).expect("an advance");
            let stirred = stirred_m_s(&solver.states().expect("states"), still);
            assert!(stirred < 0.2, "{stirred} m/s after {k} substeps of {step_s} s");
        }
        solver.advance(0.5, &Stop::default()).expect("an advance");
        let deepest = solver.states().expect("states").iter().map(|s| s.position_m.x).fold(0.0, f32::min);
        assert!(deepest > -0.002, "still {deepest} m inside");
    }
}

#[test]
fn a_squeezed_solid_that_melts_is_not_thrown_apart() {
    let particles = liquid(Vec3::ZERO, Vec3::splat(0.2), 1e-3, 0.0);
    let mut solver = solver(Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }, &particles);
    solver.advance(0.01, &Stop::default()).expect("an advance");
    // What it was as a liquid before is forgotten.
    solver.change_material(0, None, Some(&Substance::default()), Moduli::Young { young_pa: 1e5, poisson: 0.3 }).expect("a solid");
    solver.edit(|s| s.position_m *= 0.9).expect("a squeeze");
    solver.change_material(0, None, Some(&particles.substances[0]), Moduli::Kept).expect("a liquid");
    for k in 2..=10 {
        solver.advance(0.01 * f64::from(k), &Stop::default()).expect("an advance");
        let stirred = stirred_m_s(&solver.states().expect("states"), Vec3::ZERO);
        assert!(stirred < 0.05, "{stirred} m/s");
    }
}

#[test]
fn lists_are_whole_wherever_a_liquid_is() {
    for corner in [Vec3::ZERO, Vec3::new(-400.0, 90.0, 1000.0)] {
        let mut noise = Noise(9);
        let mut particles = liquid(corner, Vec3::splat(0.15), 0.01, 0.0);
        particles.position_m.iter_mut().for_each(|x| *x += noise.vec() * (0.4 * D_M));
        let mut solver = solver(Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }, &particles);
        let before: Vec<Vec3> = solver.states().expect("states").iter().map(|s| s.position_m).collect();
        solver.advance(1e-6, &Stop::default()).expect("an advance");
        let near: Vec<u32> = gpu().read(&solver.sph().expect("a liquid").near, particles.len()).expect("lists");
        let per_m = 1.0 / CELL_M;
        let around = |x: &Vec3| before.iter().filter(|&y| ((*x - *y) * per_m).length_squared() < 1.0).count() - 1;
        let mut want: Vec<usize> = before.iter().map(around).collect();
        let mut got: Vec<usize> = near.iter().map(|n| (n & 0xfff) as usize).collect();
        want.sort_unstable();
        got.sort_unstable();
        assert_eq!(got, want, "from {corner}");
    }
}

#[test]
fn a_deep_column_that_lands_flat_does_not_fly_apart() {
    // Walls hold it on four sides: all of it has to stop at once. Its layers are those of a lattice.
    let size = Vec3::new(4.0, 4.0, 100.0) * D_M;
    let mut particles = liquid(Vec3::new(0.0, 0.0, 0.8 * D_M), size, 1e-3, 0.0728);
    let fall_m_s = 5.4;
    particles.velocity_m_s.fill(Vec3::new(0.0, 0.0, -fall_m_s));
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    settings.colliders = vec![wall(Vec3::ZERO, Vec3::X), wall(size, -Vec3::X), wall(Vec3::ZERO, Vec3::Y), wall(size, -Vec3::Y)];
    let mut solver = solver(settings, &particles);
    let report = solver.advance(0.06, &Stop::default()).expect("an advance");
    assert_eq!(report.retries, 0);
    let energy: f64 = solver.states().expect("states").iter().map(|s| f64::from(s.velocity_m_s.length_squared())).sum();
    let share = energy / (particles.len() as f64 * f64::from(fall_m_s * fall_m_s));
    assert!(share < 0.9, "{share} of its energy is left");
}

#[test]
fn two_runs_and_a_resumed_one_end_in_the_same_bits() {
    let build = || {
        let mut particles = with(
            liquid(Vec3::new(0.0, 0.0, 0.01), Vec3::splat(0.125), 0.01, 0.07),
            block(Vec3::new(0.0, 0.0, 0.16), Vec3::splat(0.075), D_M, 5e4, 0.3),
            Substance::default(),
        );
        particles.velocity_m_s.fill(Vec3::new(0.4, 0.1, -1.0));
        let mut settings = Settings::new(CELL_M);
        settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
        solver(settings, &particles)
    };
    let stop = Stop::default();
    let mut first = build();
    first.advance(0.04, &stop).expect("an advance");
    let kept = first.checkpoint().expect("a checkpoint");
    first.kick(0, Vec3::Y);
    first.advance(0.08, &stop).expect("an advance");
    let mut second = build();
    second.advance(0.02, &stop).expect("an advance");
    second.advance(0.04, &stop).expect("an advance");
    assert!(kept == second.checkpoint().expect("a checkpoint"), "frame by frame differs from one call");
    let mut third = build();
    third.restore(&kept).expect("a restore");
    third.kick(0, Vec3::Y);
    third.advance(0.08, &stop).expect("an advance");
    assert!(first.checkpoint().expect("a checkpoint") == third.checkpoint().expect("a checkpoint"), "a resumed run differs");
}

#[test]
fn crowded_lists_grow_and_overlapping_bodies_part_without_flying_off() {
    let mut particles = liquid(Vec3::ZERO, Vec3::splat(0.1), 0.01, 0.0);
    for shift in [0.3, 0.6] {
        let other = liquid(Vec3::splat(shift * D_M), Vec3::splat(0.1), 0.01, 0.0);
        particles.position_m.extend(other.position_m);
        particles.velocity_m_s.extend(other.velocity_m_s);
        particles.volume_m3.extend(other.volume_m3);
        particles.density_kg_m3.extend(other.density_kg_m3);
        particles.young_pa.extend(other.young_pa);
        particles.poisson.extend(other.poisson);
        particles.substance.extend(other.substance);
        particles.object.extend(other.object);
    }
    let new = || solver(Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }, &particles);
    let (mut solver, mut resumed) = (new(), new());
    let report = solver.advance(0.02, &Stop::default()).expect("an advance");
    assert!(report.retries > 0, "lists of 64 are too short for three bodies in one place");
    // Lists as short as at the start: it finds them too short again, and nothing else changes.
    resumed.restore(&solver.checkpoint().expect("a checkpoint")).expect("a state");
    let (without, with) = (solver.advance(0.04, &Stop::default()).expect("an advance"), resumed.advance(0.04, &Stop::default()).expect("an advance"));
    assert!(without.retries == 0 && with.retries > 0, "{without:?}, {with:?}");
    assert!(solver.checkpoint().expect("a checkpoint") == resumed.checkpoint().expect("a checkpoint"), "other bits");
    solver.advance(1.5, &Stop::default()).expect("an advance");
    let states = solver.states().expect("states");
    let fastest = states.iter().map(|s| s.velocity_m_s.length()).fold(0.0, f32::max);
    assert!(fastest < 1.0, "{fastest} m/s");
    let sph = solver.sph().expect("a liquid");
    let (seen, allowed) = (read(&sph.density, states.len()), read(&sph.nature, states.len()));
    let mean = seen.iter().zip(&allowed).map(|(v, a)| v[3] + a[3]).sum::<f32>() / states.len() as f32;
    assert!(mean < 1.02, "still {mean} times as dense");
}
