//! V17: snow that is packed by a known amount.

use super::Check;
use super::bodies::block;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::Substance;
use crate::solver::types::{Settings, SolverError};
use glam::{Mat3, Vec3};

const THETA_C: f32 = 2.5e-2;
const PRESSED: f32 = 0.9;
const HARDENING: f32 = 10.0;

/// A free block whose F is pressed to 0.9 along x: its packing after one short substep, and the
/// speed that its corner gains.
fn pressed(gpu: &Gpu, hardening: f32) -> Result<(f64, f64), SolverError> {
    let mut particles = block(Vec3::ZERO, Vec3::splat(0.1), 0.025, 1.4e5, 0.2);
    particles.substances = vec![Substance::Snow { theta_c: THETA_C, theta_s: 7.5e-3, hardening }];
    let mut solver = Solver::new(gpu, Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(0.05) }, &particles)?;
    solver.edit(|s| s.set_f(Mat3::from_diagonal(Vec3::new(PRESSED, 1.0, 1.0))))?;
    solver.advance(1e-5, &Stop::default())?;
    let state = solver.states()?[0];
    Ok((f64::from(state.history), f64::from(state.velocity_m_s.length())))
}

pub(super) fn packs(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (packing, speed_m_s) = pressed(gpu, HARDENING)?;
    let (_, soft_m_s) = pressed(gpu, 0.0)?;
    let expected = f64::from(PRESSED) / f64::from(1.0 - THETA_C);
    let stiffer = (f64::from(HARDENING) * (1.0 - expected)).exp();
    let source = "Stomakhin et al. 2013";
    Ok(vec![
        Check::new("V17 snow, packing", "Jp = 0.9 / (1 - theta_c)", source, "1").compare(expected, packing, 1e-4),
        Check::new("V17 snow, stiffening", "exp(xi (1 - Jp))", source, "1").compare(stiffer, speed_m_s / soft_m_s, 1e-3),
    ])
}
