//! As captured, so at rest.

use super::{block, solver};
use crate::Stop;
use crate::solver::{Particles, Plane, Settings};
use glam::Vec3;

/// A pot on the ground that carries two stems which bend outwards, the synthetic kin of a vase of
/// flowers: about 1 m tall, stems one to two cells thick.
pub fn stems(spacing_m: f32, young_pa: f32) -> Particles {
    let inside = |p: Vec3| {
        let pot = p.z < 0.25 && Vec3::new(p.x, p.y, 0.0).length() < 0.16;
        let stem = |side: f32| {
            let t = (p.z - 0.2) / 0.6;
            let axis = Vec3::new(side * (0.06 + 0.2 * t.max(0.0).powi(2)), 0.02 * side, p.z);
            (0.0..1.0).contains(&t) && (p - axis).length() < 0.05
        };
        let head = |side: f32| (p - Vec3::new(side * 0.26, 0.02 * side, 0.8)).length() < 0.07;
        pot || stem(1.0) || stem(-1.0) || head(1.0) || head(-1.0)
    };
    let mut all = block(Vec3::new(-0.4, -0.2, 0.0), Vec3::new(0.8, 0.4, 0.9), spacing_m, young_pa, 0.3);
    let keep: Vec<usize> = (0..all.len()).filter(|&i| inside(all.position_m[i])).collect();
    all.position_m = keep.iter().map(|&i| all.position_m[i]).collect();
    let n = keep.len();
    all.velocity_m_s.truncate(n);
    all.volume_m3.truncate(n);
    all.density_kg_m3.truncate(n);
    all.young_pa.truncate(n);
    all.poisson.truncate(n);
    all.model.truncate(n);
    all.object.truncate(n);
    all
}

#[test]
fn a_captured_thing_with_slender_stems_stays_as_it_stands() {
    let particles = stems(0.025, 2e6);
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
fn what_hangs_in_the_air_is_taken_as_free_of_stress() {
    let particles = block(Vec3::new(0.0, 0.0, 0.3), Vec3::splat(0.1), 0.025, 1e5, 0.3);
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.15, restitution: 0.0 });
    let mut solver = solver(settings, &particles);
    let before = solver.checkpoint().expect("a checkpoint");
    let report = solver.prestress(&[0], &Stop::default(), &mut |_| {}).expect("a prestress");
    assert_eq!(report.warnings.len(), 1);
    assert!(before == solver.checkpoint().expect("a checkpoint"));
}
