//! V26: the same bits again.

use super::Check;
use super::bodies::block;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::types::{Plane, Settings, SolverError};
use glam::Vec3;

/// A block that hits the ground at a slant, twice, and once more from a checkpoint in the middle.
pub(super) fn same_bits(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let mut particles = block(Vec3::new(0.0, 0.0, 0.06), Vec3::splat(0.2), 0.025, 5e4, 0.3);
    particles.velocity_m_s.fill(Vec3::new(0.7, 0.1, -2.0));
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let stop = Stop::default();
    let start = || Solver::new(gpu, settings.clone(), &particles);
    let mut first = start()?;
    first.advance(0.06, &stop)?;
    let kept = first.checkpoint()?;
    first.kick(0, Vec3::Y);
    first.advance(0.1, &stop)?;
    let end = first.checkpoint()?;

    let mut second = start()?;
    second.advance(0.06, &stop)?;
    second.kick(0, Vec3::Y);
    second.advance(0.1, &stop)?;
    let mut third = start()?;
    third.restore(&kept)?;
    third.kick(0, Vec3::Y);
    third.advance(0.1, &stop)?;

    let differing = |other: &[u8]| end.iter().zip(other).filter(|(a, b)| a != b).count() as f64;
    let again = Check::new("V26 a second run", "bytes that differ", "integer sums, fixed order", "bytes");
    let resumed = Check::new("V26 from a checkpoint", "bytes that differ", "integer sums, fixed order", "bytes");
    Ok(vec![again.compare(0.0, differing(&second.checkpoint()?), 0.0), resumed.compare(0.0, differing(&third.checkpoint()?), 0.0)])
}
