//! Matter that becomes a body on the way, and bodies that become soft.

use super::{CELL_M, Settings, advance, bodies_of, floating, incline, solver, velocity};
use crate::gpu::{Gpu, Recording};
use crate::solver::validate::{block, joined, rigid_body as rigid};
use crate::solver::{Moduli, Particles, Solver, Substance};
use glam::{DVec3, Quat, Vec3};

const STONE: Substance = Substance::Rigid { friction: 0.5, restitution: 0.0 };
const SAND: Substance = Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 };

/// Momentum, and angular momentum of the particles' places about the origin.
fn momenta(solver: &Solver) -> (DVec3, DVec3) {
    let states = solver.states().expect("states");
    let p = |s: &crate::solver::state::ParticleState| s.velocity_m_s.as_dvec3() * f64::from(s.mass_kg);
    (states.iter().map(p).sum(), states.iter().map(|s| s.position_m.as_dvec3().cross(p(s))).sum())
}

/// What skinning sees: places and G of all particles.
fn seen(solver: &Solver) -> Vec<[u32; 8]> {
    let mut recording = Recording::default();
    solver.record_frame(&mut recording);
    solver.gpu.submit(&recording);
    solver.gpu.read(solver.motion(), solver.particle_count() as usize).expect("motion")
}

fn same_but_for_rounding(a: &[[u32; 8]], b: &[[u32; 8]]) {
    for (a, b) in a.iter().zip(b) {
        assert_eq!(a[..3], b[..3]);
        let halves = |m: &[u32; 8]| m[3..].iter().flat_map(|w| [*w as u16, (*w >> 16) as u16]).map(half::f16::from_bits).collect::<Vec<_>>();
        for (a, b) in halves(a).iter().zip(halves(b)) {
            assert!((a.to_f32() - b.to_f32()).abs() < 2e-3, "{a} {b}");
        }
    }
}

fn spinning_block() -> Particles {
    let mut particles = block(Vec3::splat(-0.075), Vec3::new(0.15, 0.1, 0.2), 0.025, 1e5, 0.3);
    for (v, p) in particles.velocity_m_s.iter_mut().zip(&particles.position_m) {
        *v = Vec3::new(1.0, -2.0, 6.0).cross(*p) + Vec3::X;
    }
    particles
}

#[test]
fn soft_matter_turns_to_stone_as_it_moves_and_looks_and_back() {
    let mut first = solver(floating(), &spinning_block());
    advance(&mut first, 0.06);
    let (before, shape) = (momenta(&first), seen(&first));
    first.change_material(0, None, Some(&STONE), Moduli::Young { young_pa: 1e5, poisson: 0.0 }).expect("a change");
    same_but_for_rounding(&seen(&first), &shape);
    let kept = first.checkpoint().expect("a checkpoint");
    advance(&mut first, 0.0604);
    let after = momenta(&first);
    assert!((after.0 - before.0).length() < 1e-5 * before.0.length(), "{} {}", before.0, after.0);
    assert!((after.1 - before.1).length() < 1e-2 * before.1.length(), "{} {}", before.1, after.1);
    advance(&mut first, 0.2);
    // It keeps the shape that it had, turned.
    let body = bodies_of(&first)[0];
    assert!(Quat::from_array(body.turn).angle_between(Quat::IDENTITY) > 0.5);
    assert!(first.states().expect("states").iter().all(|s| (s.f().determinant() - 1.0).abs() < 1e-5));
    // Another solver knows of the change from the checkpoint alone.
    let mut second = solver(floating(), &spinning_block());
    second.restore(&kept).expect("a restore");
    advance(&mut second, 0.0604);
    advance(&mut second, 0.2);
    let end = first.checkpoint().expect("a checkpoint");
    assert!(end == second.checkpoint().expect("a checkpoint"), "a resumed run differs");
    // Soft again: as fast, of the same shape.
    let (before, shape) = (momenta(&first), seen(&first));
    first.change_material(0, None, Some(&Substance::default()), Moduli::Young { young_pa: 1e5, poisson: 0.3 }).expect("a change");
    same_but_for_rounding(&seen(&first), &shape);
    advance(&mut first, 0.3);
    let after = momenta(&first);
    assert!((after.0 - before.0).length() < 1e-3 * before.0.length(), "{} {}", before.0, after.0);
    assert!((after.1 - before.1).length() < 2e-2 * before.1.length(), "{} {}", before.1, after.1);
    // And back to the start, where there is no body.
    let mut fresh = solver(floating(), &spinning_block());
    first.restore(&fresh.checkpoint().expect("a checkpoint")).expect("a restore");
    advance(&mut first, 0.02);
    advance(&mut fresh, 0.02);
    assert!(first.checkpoint().expect("a checkpoint") == fresh.checkpoint().expect("a checkpoint"));
}

#[test]
fn a_checkpoint_tells_what_a_body_is_made_of() {
    // A block thrown along the ground loses its grip before anything moved: its places are those of the start.
    let thrown = || {
        let mut particles = rigid(block(Vec3::ZERO, Vec3::splat(0.1), 0.025, 1e5, 0.3), 0.9, 0.0);
        particles.velocity_m_s.fill(Vec3::X);
        solver(incline(0.0, 0.9), &particles)
    };
    let mut whole = thrown();
    whole.change_material(0, None, Some(&Substance::Rigid { friction: 0.05, restitution: 0.0 }), Moduli::Kept).expect("a change");
    advance(&mut whole, 0.06);
    let kept = whole.checkpoint().expect("a checkpoint");
    advance(&mut whole, 0.12);
    let mut resumed = thrown();
    resumed.restore(&kept).expect("a restore");
    advance(&mut resumed, 0.12);
    assert!(whole.checkpoint().expect("a checkpoint") == resumed.checkpoint().expect("a checkpoint"));
    assert!(velocity(&bodies_of(&whole)[0]).x > 0.5, "it slides on");
}

#[test]
fn one_of_two_stones_turns_to_sand_and_the_other_stands() {
    let lower = rigid(block(Vec3::ZERO, Vec3::splat(0.2), 0.025, 1e5, 0.3), 0.5, 0.0);
    let upper = rigid(block(Vec3::new(0.3, 0.0, 0.0), Vec3::splat(0.2), 0.025, 1e5, 0.3), 0.5, 0.0);
    let mut solver = solver(incline(0.0, 0.5), &joined(lower, upper));
    advance(&mut solver, 0.04);
    assert_eq!((solver.params.layers, solver.soft), (1, false));
    solver.change_material(0, None, Some(&SAND), Moduli::Young { young_pa: 2e5, poisson: 0.3 }).expect("a change");
    assert_eq!((bodies_of(&solver).len(), solver.soft), (1, true));
    advance(&mut solver, 0.5);
    let states = solver.states().expect("states");
    let top = |object: u32| states.iter().filter(|s| s.object() == object).map(|s| s.position_m.z).fold(0.0, f32::max);
    assert!(top(0) < 0.15, "the sand is {} m high", top(0));
    assert!((top(1) - 0.1875).abs() < 2e-3 && velocity(&bodies_of(&solver)[0]).length() < 0.02, "the stone is {} m high", top(1));
}

#[test]
fn too_many_bodies_are_refused() {
    let grain = |k: u32| rigid(block(Vec3::new((k % 12) as f32, (k / 12) as f32, 0.0) * 0.3, Vec3::splat(0.025), 0.025, 1e5, 0.3), 0.3, 0.0);
    let all = (1..129).map(grain).fold(grain(0), joined);
    let gpu = Gpu::shared_for_tests().expect("a device");
    let refused = Solver::new(&gpu, Settings::new(CELL_M), &all).expect_err("too many").to_string();
    assert!(refused.contains("129 rigid bodies") && refused.contains("128"), "{refused}");
}
