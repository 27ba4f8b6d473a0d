//! Bodies that nothing touches: V1 to V4.

use super::Check;
use super::bodies::{self, block, centre_m, set_moving};
use super::rigid::momenta;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use crate::solver::types::{Particles, Placement, Settings, SolverError};
use crate::spec::ElasticModel;
use glam::{DVec3, Mat3, Quat, Vec3};

const CELL_M: f32 = 0.05;
const SPACING_M: f32 = 0.025;

fn weightless() -> Settings {
    Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(CELL_M) }
}

/// What falls and flies: the name of a row for each of V1 and V2, and its law.
const KINDS: [(&str, &str, Substance); 5] = [
    ("V1 free fall", "V2 momentum", Substance::Elastic(ElasticModel::Corotated)),
    ("V1 free fall, rigid", "V2 momentum, rigid", Substance::Rigid { friction: 0.3, restitution: 0.0 }),
    ("V1 free fall, sand", "V2 momentum, sand", Substance::Sand { friction_angle_deg: 30.0, cohesion_pa: 0.0 }),
    ("V1 free fall, liquid", "V2 momentum, liquid", Substance::Liquid { viscosity_pa_s: 0.1, surface_tension_n_m: 0.0 }),
    ("V1 free fall, SPH liquid", "V2 momentum, SPH liquid", Substance::SphLiquid { viscosity_pa_s: 0.1, surface_tension_n_m: 0.0 }),
];

fn cube(low_m: Vec3, young_pa: f32, substance: &Substance) -> Particles {
    Particles { substances: vec![substance.clone()], ..block(low_m, Vec3::splat(0.15), SPACING_M, young_pa, 0.3) }
}

/// V1: free fall for 0.2 s; the worst particle counts.
pub(super) fn fall(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    KINDS.iter().map(|(name, _, substance)| falls(gpu, name, substance)).collect()
}

fn falls(gpu: &Gpu, name: &'static str, substance: &Substance) -> Result<Check, SolverError> {
    let particles = cube(Vec3::new(0.1, 0.1, 1.0), 1e5, substance);
    let mut solver = Solver::new(gpu, Settings::new(CELL_M), &particles)?;
    // Symplectic Euler falls by the sum of h g t = g (t^2 + sum of h^2) / 2; with equal h, g t (t + h) / 2.
    let mut squares = 0.0;
    for frame in 1..=10 {
        let report = solver.advance(f64::from(frame) * 0.02, &Stop::default())?;
        squares += report.substeps as f64 * report.dt_max_s.powi(2);
    }
    // Bodies follow the parabola itself.
    let rigid = substance.rigid().is_some();
    let expected = 0.5 * 9.81 * (0.2f64.powi(2) + if rigid { 0.0 } else { squares });
    let worst = solver
        .states()?
        .iter()
        .zip(&particles.position_m)
        .map(|(s, p)| f64::from(p.z - s.position_m.z))
        .fold(expected, |worst, fallen| if (fallen - expected).abs() > (worst - expected).abs() { fallen } else { worst });
    let [formula, source] = match rigid {
        true => ["g t^2 / 2", "Galilei 1638"],
        false => ["g (t^2 + sum h^2) / 2", "Galilei 1638; the sum of symplectic Euler, exact"],
    };
    Ok(Check::new(name, formula, source, "m").compare(expected, worst, 1e-4))
}

/// Momentum along y before and after a span of a block that moves at a velocity and breathes.
fn momentum_of(gpu: &Gpu, substance: &Substance, velocity: Vec3, squeeze: f32, seconds: f64) -> Result<(f64, f64), SolverError> {
    let mut particles = cube(Vec3::ZERO, 5e4, substance);
    for (v, x) in particles.velocity_m_s.iter_mut().zip(&particles.position_m) {
        // Breathes about its middle, so that stress is handed about all the while.
        *v = velocity + (*x - Vec3::splat(0.075)) * squeeze;
    }
    let mut solver = Solver::new(gpu, weightless(), &particles)?;
    let before = momenta(&solver)?.0;
    solver.advance(seconds, &Stop::default())?;
    Ok((before.y, momenta(&solver)?.0.y))
}

/// V2: momentum, also along an axis on which the block creeps while it races along another.
pub(super) fn momentum(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let check = |name, (before, after)| Check::new(name, "m v, unchanged", "Newton 1687, law 1", "kg m/s").compare(before, after, 1e-3);
    let mut checks = Vec::new();
    for (k, (_, name, substance)) in KINDS.iter().enumerate() {
        // What is elastic breathes for a second; what flows is squeezed, and flies apart.
        let (squeeze, seconds) = if k == 0 { (1.0, 1.0) } else { (-1.0, 0.3) };
        checks.push(check(*name, momentum_of(gpu, substance, Vec3::Y, squeeze, seconds)?));
    }
    let creeping = momentum_of(gpu, &KINDS[0].2, Vec3::new(2.0, 0.05, 0.0), 1.0, 1.0)?;
    checks.push(check("V2 momentum, 0.05 m/s beside 2 m/s", creeping));
    Ok(checks)
}

/// Kinetic energy with what APIC keeps in the affine part of a turning body: a quarter of the cell squared times
/// the square of the axial vector of mass C over four times the mass.
fn turning_energy_j(states: &[ParticleState]) -> f64 {
    let quarter = 0.25 * f64::from(CELL_M).powi(2);
    let of = |s: &ParticleState| {
        let (a, mass) = (s.affine.map(f64::from), f64::from(s.mass_kg));
        let axial = DVec3::new(a[7] - a[5], a[2] - a[6], a[3] - a[1]);
        0.5 * mass * s.velocity_m_s.as_dvec3().length_squared() + 0.25 * quarter * axial.length_squared() / mass
    };
    states.iter().map(of).sum()
}

/// V3: what a spinning cube keeps over a second: angular momentum, energy, and its shape.
pub(super) fn angular_momentum(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (edge_m, young_pa, spin_rad_s) = (0.2f32, 1e5f32, 6.0f32);
    let particles = block(Vec3::ZERO, Vec3::splat(edge_m), SPACING_M, young_pa, 0.3);
    let mut solver = Solver::new(gpu, weightless(), &particles)?;
    let spin = Placement {
        rotation: Quat::IDENTITY,
        centre_m: Vec3::splat(0.1),
        offset_m: Vec3::ZERO,
        velocity_m_s: Vec3::ZERO,
        spin_rad_s: Vec3::new(0.0, 0.0, spin_rad_s),
    };
    solver.place(0, &spin)?;
    let of = |solver: &Solver| -> Result<_, SolverError> {
        let states = solver.states()?;
        let stretched = states.iter().map(|s| (s.f().transpose() * s.f() - Mat3::IDENTITY).to_cols_array());
        let widest = stretched.flatten().map(f32::abs).fold(0.0, f32::max);
        Ok((bodies::angular_momentum(&states, centre_m(&states), CELL_M).z, turning_energy_j(&states), f64::from(widest)))
    };
    let before = of(&solver)?;
    solver.advance(1.0, &Stop::default())?;
    let after = of(&solver)?;
    let turns = Check::new("V3 angular momentum", "sum m r x v + m cell^2/4 axial(C), unchanged", "Jiang et al. 2015, section 5.3.2", "kg m^2/s");
    let energy = Check::new("V3 energy", "1/2 sum m v^2 + m cell^2/4 w^2: share lost in 1 s, 0", "Jiang et al. 2015, section 5.3.2", "1");
    // Spun up at once, a bar of half the cube's diagonal would stretch by twice rho w^2 R^2 / (2 E).
    let radius_2 = 0.5 * f64::from(edge_m).powi(2);
    let stretch = 2.0 * 1000.0 * f64::from(spin_rad_s).powi(2) * radius_2 / f64::from(young_pa);
    let source = "Hooke's law integrated: E u' = rho w^2 (R^2 - r^2) / 2, twice that at once";
    let shape = Check::new("V3 a turning cube keeps its shape", "max |F^T F - I|: 0, to 2 rho w^2 R^2 / E", source, "1");
    Ok(vec![turns.compare(before.0, after.0, 1e-3), energy.compare(0.0, 1.0 - after.1 / before.1, 0.02), shape.compare(0.0, after.2, stretch)])
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
    let check = Check::new("V4 spinning rod", "rho w^2 L^3 / (3 E)", "Hooke's law integrated: E u' = rho w^2 (L^2 - x^2) / 2", "m");
    Ok(vec![check.compare(expected, sum / f64::from(samples), 0.1)])
}

/// First frequency of bending of a free bar of length `l`, height `h` (ASTM E1876, eq. 1 and 2).
fn bar_frequency_hz(l: f64, h: f64, young_pa: f64, density_kg_m3: f64, nu: f64) -> f64 {
    let t2 = (h / l).powi(2);
    let shear = 8.34 * (1.0 + 0.2023 * nu + 2.173 * nu * nu) * t2 * t2 / (1.0 + 6.338 * (1.0 + 0.1408 * nu + 1.536 * nu * nu) * t2);
    let correction = 1.0 + 6.585 * (1.0 + 0.0752 * nu + 0.8109 * nu * nu) * t2 - 0.868 * t2 * t2 - shear;
    (young_pa * h * h / (0.9465 * density_kg_m3 * l.powi(4) * correction)).sqrt()
}

/// First frequency of a bar that was set bending by a push in the shape of its first mode, from when it
/// is straight again.
fn bending_bar_hz(gpu: &Gpu, l: f32, h: f32, young_pa: f32, poisson: f32) -> Result<f64, SolverError> {
    let mut particles = block(Vec3::new(0.0, 0.0, -0.5 * h), Vec3::new(l, 2.0 * CELL_M, h), SPACING_M, young_pa, poisson);
    // cosh + cos - 0.9825 (sinh + sin) of 4.730 x / l.
    let shape = |x: f32| {
        let k = 4.730_041 * f64::from(x / l);
        k.cosh() + k.cos() - 0.982_502 * (k.sinh() + k.sin())
    };
    let mode: Vec<f64> = particles.position_m.iter().map(|p| shape(p.x)).collect();
    for (v, m) in particles.velocity_m_s.iter_mut().zip(&mode) {
        *v = Vec3::Z * (0.05 * m) as f32;
    }
    let mut solver = Solver::new(gpu, weightless(), &particles)?;
    let bent = |solver: &Solver| -> Result<f64, SolverError> {
        let states = solver.states()?;
        let moved = states.iter().zip(&particles.position_m).zip(&mode).map(|((s, p), m)| f64::from(s.position_m.z - p.z) * m);
        Ok(moved.sum())
    };
    let expected_s = 1.0 / bar_frequency_hz(l.into(), h.into(), young_pa.into(), 1000.0, poisson.into());
    let (samples, mut before) = (64, (0.0, 0.0));
    for k in 1..=samples {
        let t = 0.8 * expected_s * f64::from(k) / f64::from(samples);
        solver.advance(t, &Stop::default())?;
        let now = bent(&solver)?;
        if k > 4 && now <= 0.0 {
            let (t0, b0): (f64, f64) = before;
            return Ok(0.5 / (t0 + (t - t0) * b0 / (b0 - now)));
        }
        before = (t, now);
    }
    Ok(f64::NAN)
}

/// How fast free bars bend to and fro, up to nearly incompressible.
pub(super) fn bending_bar(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let of = |name, poisson: f32| {
        let (l, h, young_pa) = (1.2f32, 0.2f32, 3e7f32);
        let expected = bar_frequency_hz(l.into(), h.into(), young_pa.into(), 1000.0, poisson.into());
        let check = Check::new(name, "sqrt(E h^2 / (0.9465 rho L^4 T1))", "ASTM E1876, eq. 1 and 2, free bar", "Hz");
        Ok::<Check, SolverError>(check.compare(expected, bending_bar_hz(gpu, l, h, young_pa, poisson)?, 0.05))
    };
    Ok(vec![of("bending bar, nu = 0", 0.0)?, of("bending bar, nu = 0.3", 0.3)?, of("bending bar, nu = 0.49", 0.49)?])
}
