//! A block on a slope: V11.

use super::Check;
use super::bodies::{block, centre_m};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::types::{Plane, Settings, SolverError};
use glam::Vec3;

const GRAVITY_M_S2: f64 = 9.81;

/// How far a cube on a slope slides along it between two times. The slope is level ground under a
/// slanted gravity, which is there at once: the cube bounces on itself for a while.
fn slid_m(gpu: &Gpu, slope: f64, friction: f64, from_s: f64, to_s: f64) -> Result<f64, SolverError> {
    let particles = block(Vec3::ZERO, Vec3::splat(0.2), 0.025, 1e6, 0.3);
    let mut settings = Settings::new(0.05);
    settings.gravity_m_s2 = Vec3::new((GRAVITY_M_S2 * slope.sin()) as f32, 0.0, (-GRAVITY_M_S2 * slope.cos()) as f32);
    settings.ground = Some(Plane { height_m: 0.0, friction: friction as f32, restitution: 0.0 });
    let mut solver = Solver::new(gpu, settings, &particles)?;
    solver.advance(from_s, &Stop::default())?;
    let start = centre_m(&solver.states()?).x;
    solver.advance(to_s, &Stop::default())?;
    Ok(centre_m(&solver.states()?).x - start)
}

/// V11: it slides with g (sin - mu cos), and stays where tan <= mu.
pub(super) fn incline(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (slope, friction, seconds) = (30f64.to_radians(), 0.3, 0.5);
    let expected = 0.5 * GRAVITY_M_S2 * (slope.sin() - friction * slope.cos()) * seconds * seconds;
    let slides = Check::new("V11 elastic cube slides", "g (sin a - mu cos a) t^2 / 2", "Coulomb 1785: friction mu N", "m");
    let stays = Check::new("V11 elastic cube stays", "0 where tan a < mu by a degree", "Coulomb 1785: friction mu N", "m");
    let gentle = (0.3f64.atan().to_degrees() - 1.0).to_radians();
    Ok(vec![
        slides.compare(expected, slid_m(gpu, slope, friction, 0.0, seconds)?, 0.05),
        // It still shears to and fro by a fraction of a millimetre.
        stays.compare(0.0, slid_m(gpu, gentle, friction, seconds, 2.0 * seconds)?, 1e-3),
    ])
}
