//! Bodies that nothing touches: V1 to V4.

use super::Check;
use super::bodies::{self, block, centre_m, set_moving};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::types::{Placement, Settings, SolverError};
use glam::{Quat, Vec3};

const CELL_M: f32 = 0.05;
const SPACING_M: f32 = 0.025;

fn weightless() -> Settings {
    Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }
}

/// V1: free fall for 0.2 s; the worst particle counts.
pub(super) fn fall(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let particles = block(Vec3::new(0.1, 0.1, 1.0), Vec3::splat(0.15), SPACING_M, 1e5, 0.3);
    let mut solver = Solver::new(gpu, Settings::new(CELL_M), &particles)?;
    // Symplectic Euler falls by the sum of h g t = g (t^2 + sum of h^2) / 2; with equal h, g t (t + h) / 2.
    let mut squares = 0.0;
    for frame in 1..=10 {
        let report = solver.advance(f64::from(frame) * 0.02, &Stop::default())?;
        squares += report.substeps as f64 * report.dt_max_s.powi(2);
    }
    let expected = 0.5 * 9.81 * (0.2f64.powi(2) + squares);
    let worst = solver
        .states()?
        .iter()
        .zip(&particles.position_m)
        .map(|(s, p)| f64::from(p.z - s.position_m.z))
        .fold(expected, |worst, fallen| if (fallen - expected).abs() > (worst - expected).abs() { fallen } else { worst });
    let check = Check::new("V1 free fall", "g (t^2 + sum h^2) / 2", "symplectic Euler, exact", "m");
    Ok(vec![check.compare(expected, worst, 1e-4)])
}

/// Momentum along y before and after a second of a block that moves at a velocity and breathes.
fn momentum_of(gpu: &Gpu, velocity: Vec3, squeeze: f32) -> Result<(f64, f64), SolverError> {
    let mut particles = block(Vec3::ZERO, Vec3::splat(0.15), SPACING_M, 5e4, 0.3);
    for (v, x) in particles.velocity_m_s.iter_mut().zip(&particles.position_m) {
        // Breathes about its middle, so that stress is handed about all the while.
        *v = velocity + (*x - Vec3::splat(0.075)) * squeeze;
    }
    let mut solver = Solver::new(gpu, weightless(), &particles)?;
    let before = bodies::momentum(&solver.states()?);
    solver.advance(1.0, &Stop::default())?;
    let after = bodies::momentum(&solver.states()?);
    Ok((before.y, after.y))
}

/// V2: momentum over a second, also along an axis on which the block creeps while it races along another.
pub(super) fn momentum(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let check = |name, (before, after)| Check::new(name, "m v, unchanged", "Newton's first law", "kg m/s").compare(before, after, 1e-3);
    Ok(vec![
        check("V2 momentum, 1 m/s", momentum_of(gpu, Vec3::new(0.0, 1.0, 0.0), 1.0)?),
        check("V2 momentum, 0.05 m/s beside 2 m/s", momentum_of(gpu, Vec3::new(2.0, 0.05, 0.0), 1.0)?),
    ])
}

/// V3: angular momentum of a spinning cube over a second.
pub(super) fn angular_momentum(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let particles = block(Vec3::ZERO, Vec3::splat(0.2), SPACING_M, 1e5, 0.3);
    let mut solver = Solver::new(gpu, weightless(), &particles)?;
    let spin = Placement {
        rotation: Quat::IDENTITY,
        centre_m: Vec3::splat(0.1),
        offset_m: Vec3::ZERO,
        velocity_m_s: Vec3::ZERO,
        spin_rad_s: Vec3::new(0.0, 0.0, 6.0),
    };
    solver.place(0, &spin)?;
    let of = |solver: &Solver| -> Result<_, SolverError> {
        let states = solver.states()?;
        Ok(bodies::angular_momentum(&states, centre_m(&states), CELL_M).z)
    };
    let before = of(&solver)?;
    solver.advance(1.0, &Stop::default())?;
    let check = Check::new("V3 angular momentum", "sum m r x v + m cell^2/4 axial(C), unchanged", "Jiang et al. 2015", "kg m^2/s");
    Ok(vec![check.compare(before, of(&solver)?, 1e-3)])
}

/// V4: stretch of a slender rod that turns about its middle, averaged over its axial oscillation.
pub(super) fn spinning_rod(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (half_m, young_pa, spin_rad_s) = (0.4f32, 1e6f32, 10.0f32);
    let mut particles = block(Vec3::new(-half_m, -0.05, -0.05), Vec3::new(2.0 * half_m, 0.1, 0.1), SPACING_M, young_pa, 0.0);
    set_moving(&mut particles, Vec3::ZERO, Vec3::ZERO, Vec3::new(0.0, 0.0, spin_rad_s));
    let mut solver = Solver::new(gpu, weightless(), &particles)?;
    let ends: Vec<usize> = (0..particles.len()).filter(|&i| particles.position_m[i].x.abs() > half_m - SPACING_M).collect();
    let reach = |solver: &Solver| {
        // Of the middle of each end face, so that its width does not count.
        let states = solver.states()?;
        let end = |sign: f32| {
            let side: Vec<_> = ends.iter().filter(|&&i| particles.position_m[i].x * sign > 0.0).collect();
            side.iter().map(|&&i| states[i].position_m).sum::<Vec3>() / side.len() as f32
        };
        Ok::<f64, SolverError>(0.5 * f64::from(end(1.0).distance(end(-1.0))))
    };
    let rest = reach(&solver)?;
    // Four periods 4 L / c of the axial mode, sampled finely.
    let period_s = 4.0 * f64::from(half_m) / f64::from(young_pa / 1000.0).sqrt();
    let samples = 64;
    let mut sum = 0.0;
    for k in 1..=samples {
        solver.advance(4.0 * period_s * f64::from(k) / f64::from(samples), &Stop::default())?;
        sum += reach(&solver)? - rest;
    }
    let (l, e, w) = (f64::from(half_m), f64::from(young_pa), f64::from(spin_rad_s));
    let expected = 1000.0 * w * w * l.powi(3) / (3.0 * e);
    let check = Check::new("V4 spinning rod", "rho w^2 L^3 / (3 E)", "bar under its own centrifugal load", "m");
    Ok(vec![check.compare(expected, sum / f64::from(samples), 0.1)])
}
