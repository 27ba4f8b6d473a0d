//! Liquids that come to rest: V19 in a tank, V21 and V22 as drops.

use super::Check;
use super::bodies::{keep, pool, walls};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::state::ParticleState;
use crate::solver::substance::{Substance, liquid_bulk_pa};
use crate::solver::types::{Particles, Plane, Settings, SolverError};
use glam::Vec3;

const DENSITY_KG_M3: f32 = 1000.0;
const GRAVITY_M_S2: f32 = 9.81;

fn liquid(viscosity_pa_s: f32, surface_tension_n_m: f32) -> Substance {
    Substance::Liquid { viscosity_pa_s, surface_tension_n_m }
}

/// p = K (1 / J - 1), none where it is stretched.
fn pressure_pa(s: &ParticleState) -> f64 {
    f64::from(s.lambda_pa) * (1.0 / f64::from(s.f().determinant()) - 1.0).max(0.0)
}

fn mean(states: &[ParticleState], of: impl Fn(&ParticleState) -> f64) -> f64 {
    states.iter().map(of).sum::<f64>() / states.len() as f64
}

/// A tank with a floor.
fn tank(cell_m: f32, size_m: Vec3) -> Settings {
    let mut settings = Settings::new(cell_m);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    settings.colliders = walls(Vec3::ZERO, size_m);
    settings
}

/// V19: a pool that is let go at rest, ten cells deep; means over its second half second.
pub(super) fn hydrostatic(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (cell_m, depth_m) = (0.04, 0.4);
    let size_m = Vec3::new(0.32, 0.24, depth_m);
    let bulk_pa = liquid_bulk_pa(depth_m, 0.0, GRAVITY_M_S2, DENSITY_KG_M3);
    let particles = pool(Vec3::ZERO, size_m, 0.5 * cell_m, DENSITY_KG_M3, bulk_pa, liquid(1e-3, 0.0));
    let mut solver = Solver::new(gpu, tank(cell_m, size_m), &particles)?;
    let samples = 40;
    let (g, h) = (f64::from(GRAVITY_M_S2), f64::from(depth_m));
    let (mut pressure, mut height, mut stirring) = (0.0, 0.0, 0.0);
    for k in 0..samples {
        solver.advance(0.5 + 0.5 * f64::from(k + 1) / f64::from(samples), &Stop::default())?;
        let states = solver.states()?;
        let surface_m = 2.0 * mean(&states, |s| f64::from(s.position_m.z));
        // Least squares of p over rho g (H - z).
        let weight = |s: &ParticleState| f64::from(DENSITY_KG_M3) * g * (surface_m - f64::from(s.position_m.z));
        pressure += mean(&states, |s| weight(s) * pressure_pa(s)) / mean(&states, |s| weight(s).powi(2)) / f64::from(samples);
        height += surface_m / f64::from(samples);
        stirring += mean(&states, |s| f64::from(s.velocity_m_s.length_squared()) * 0.5) / f64::from(samples);
    }
    // Under its own weight each height z of the column sinks by rho g (H z - z^2 / 2) / K, on average H^2 / 3.
    let sunk = f64::from(DENSITY_KG_M3) * g * h * h / (3.0 * f64::from(bulk_pa));
    let source = "Stevin 1586, Pascal 1663";
    Ok(vec![
        Check::new("V19 pressure under water", "p = rho g (H - z)", source, "of the formula").compare(1.0, pressure, 0.02),
        Check::new("V19 volume at rest", "H - 2 rho g H^2 / (3 K), by the mean height", source, "m").compare(h - 2.0 * sunk, height, 0.02),
        Check::new("V19 stillness", "v^2 / 2 over g H, 0", source, "").compare(0.0, stirring / (g * h), 1e-3),
    ])
}

/// V19: half a tank's length of water falls, sloshes and comes to rest: is there as much of it?
pub(super) fn sloshing(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let cell_m = 0.02;
    let (length_m, depth_m) = (0.4, 0.2);
    let room = Vec3::new(length_m, 0.08, depth_m);
    let bulk_pa = liquid_bulk_pa(depth_m, 0.0, GRAVITY_M_S2, DENSITY_KG_M3);
    let column = pool(Vec3::ZERO, Vec3::new(0.5 * length_m, room.y, depth_m), 0.5 * cell_m, DENSITY_KG_M3, bulk_pa, liquid(0.5, 0.0));
    let mut solver = Solver::new(gpu, tank(cell_m, room), &column)?;
    let (settled_s, samples) = (3.5, 10);
    let mut height = 0.0;
    for k in 0..samples {
        solver.advance(settled_s + 0.05 * f64::from(k), &Stop::default())?;
        height += 2.0 * mean(&solver.states()?, |s| f64::from(s.position_m.z)) / f64::from(samples);
    }
    let check = Check::new("V19 sloshing, volume after it", "half the column's height, by the mean height", "Euler 1757: div v = 0", "m");
    Ok(vec![check.compare(0.5 * f64::from(depth_m), height, 0.02)])
}

/// A sphere of liquid about the origin, weightless, stretched along z at equal volume.
fn drop(radius_m: f32, spacing_m: f32, stretch: f32, bulk_pa: f32, substance: Substance) -> Particles {
    let edge_m = 2.2 * radius_m;
    // Off the lattice's nodes, as any drop is.
    let low_m = Vec3::splat(-0.5 * edge_m) + Vec3::new(0.26, 0.14, 0.0) * spacing_m;
    let all = pool(low_m, Vec3::splat(edge_m), spacing_m, DENSITY_KG_M3, bulk_pa, substance);
    let mut round = keep(&all, |x| x.length() < radius_m);
    let wide = stretch.sqrt().recip();
    round.position_m.iter_mut().for_each(|x| *x *= Vec3::new(wide, wide, stretch));
    round
}

fn weightless(cell_m: f32) -> Settings {
    Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(cell_m) }
}

/// V22: pressure in a drop of five cells' radius, viscous enough to stop breathing.
pub(super) fn laplace(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (cell_m, radius_m, tension_n_m) = (0.01, 0.05, 1.0);
    let particles = drop(radius_m, 0.5 * cell_m, 1.0, 1000.0 * tension_n_m / radius_m, liquid(0.5, tension_n_m));
    let volume: f64 = particles.volume_m3.iter().map(|&v| f64::from(v)).sum();
    let radius = (3.0 * volume / (4.0 * std::f64::consts::PI)).cbrt();
    let mut solver = Solver::new(gpu, weightless(cell_m), &particles)?;
    let samples = 25;
    let mut pressure = 0.0;
    for k in 0..samples {
        solver.advance(0.5 + 0.02 * f64::from(k), &Stop::default())?;
        let inner: Vec<_> = solver.states()?.into_iter().filter(|s| s.position_m.length() < 0.4 * radius_m).collect();
        pressure += mean(&inner, pressure_pa) / f64::from(samples);
    }
    let check = Check::new("V22 pressure in a drop", "2 sigma / R", "Young 1805, Laplace 1806", "Pa");
    Ok(vec![check.compare(2.0 * f64::from(tension_n_m) / radius, pressure, 0.1)])
}

/// V21: a drop of eight cells' radius that was stretched by a sixteenth swings about the sphere.
pub(super) fn swinging(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (cell_m, radius_m, tension_n_m) = (0.01f32, 0.08f32, 1.0f32);
    let particles = drop(radius_m, 0.5 * cell_m, 1.06, 400.0 * tension_n_m / radius_m, liquid(0.0, tension_n_m));
    let mut solver = Solver::new(gpu, weightless(cell_m), &particles)?;
    let omega = (8.0 * f64::from(tension_n_m) / (f64::from(DENSITY_KG_M3) * f64::from(radius_m).powi(3))).sqrt();
    let mut crossings: Vec<f64> = Vec::new();
    let mut earlier: Option<(f64, f64)> = None;
    for k in 1.. {
        let time_s = 0.02 * f64::from(k);
        if crossings.len() == 2 || time_s > 2.0 * std::f64::consts::TAU / omega {
            break;
        }
        solver.advance(time_s, &Stop::default())?;
        let states = solver.states()?;
        let second = |axis: usize| {
            let middle = mean(&states, |s| f64::from(s.position_m[axis]));
            mean(&states, |s| (f64::from(s.position_m[axis]) - middle).powi(2))
        };
        let longer = second(2) / (second(0) * second(1)).sqrt() - 1.0;
        if let Some((before_s, before)) = earlier.filter(|(_, before)| before * longer < 0.0) {
            crossings.push(before_s + (time_s - before_s) * before / (before - longer));
        }
        earlier = Some((time_s, longer));
    }
    let measured = if let [first, second] = crossings[..] { std::f64::consts::PI / (second - first) } else { f64::NAN };
    let check = Check::new("V21 swinging drop", "omega^2 = 8 sigma / (rho R^3)", "Rayleigh 1879, mode 2", "1/s");
    Ok(vec![check.compare(omega, measured, 0.1)])
}
