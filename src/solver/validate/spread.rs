//! The two numbers of a liquid that anyone sees: what is thick or has much surface tension holds together, what is thin or
//! has little spreads. A block is let go on the ground; how wide is it after a second?

use super::Check;
use super::bodies::pool;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::{Substance, liquid_bulk_pa};
use crate::solver::types::{Plane, Settings, SolverError};
use glam::Vec3;

const CELL_M: f32 = 0.0125;
const SPACING_M: f32 = 0.5 * CELL_M;
const COUNTS: Vec3 = Vec3::new(16.0, 16.0, 5.0);
const DENSITY_KG_M3: f32 = 1000.0;
const GRAVITY_M_S2: f64 = 9.81;
const TIME_S: f64 = 1.0;
/// Cosine of the angle at which liquids meet what is solid.
const CONTACT: f64 = 0.5;

type Make = fn(f32, f32) -> Substance;

fn on_grid(viscosity_pa_s: f32, surface_tension_n_m: f32) -> Substance {
    Substance::Liquid { viscosity_pa_s, surface_tension_n_m }
}

fn smoothed(viscosity_pa_s: f32, surface_tension_n_m: f32) -> Substance {
    Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m }
}

fn volume_m3() -> f64 {
    f64::from((COUNTS * SPACING_M).element_product())
}

/// Mean square of the distance from the middle, metres^2.
fn spread_m2(gpu: &Gpu, substance: Substance) -> Result<f64, SolverError> {
    let size_m = COUNTS * SPACING_M;
    let bulk_pa = liquid_bulk_pa(size_m.z, 0.0, GRAVITY_M_S2 as f32, DENSITY_KG_M3);
    let block = pool(Vec3::ZERO, size_m, SPACING_M, DENSITY_KG_M3, bulk_pa, substance);
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    let mut solver = Solver::new(gpu, settings, &block)?;
    solver.advance(TIME_S, &Stop::default())?;
    let states = solver.states()?;
    let n = states.len() as f64;
    let middle = states.iter().map(|s| s.position_m.truncate().as_dvec2()).sum::<glam::DVec2>() / n;
    Ok(states.iter().map(|s| (s.position_m.truncate().as_dvec2() - middle).length_squared()).sum::<f64>() / n)
}

/// Radius of a heap that viscosity holds back: 0.894 (rho g V^3 t / (3 mu))^(1/8).
fn huppert_m(viscosity_pa_s: f64) -> f64 {
    0.894 * (f64::from(DENSITY_KG_M3) * GRAVITY_M_S2 * volume_m3().powi(3) * TIME_S / (3.0 * viscosity_pa_s)).powf(0.125)
}

/// Radius of a puddle that its tension holds together, as thick as 2 sin(angle / 2) capillary lengths.
fn puddle_m(surface_tension_n_m: f64) -> f64 {
    let capillary_m = (surface_tension_n_m / (f64::from(DENSITY_KG_M3) * GRAVITY_M_S2)).sqrt();
    (volume_m3() / (std::f64::consts::PI * (2.0 * (1.0 - CONTACT)).sqrt() * capillary_m)).sqrt()
}

fn all(gpu: &Gpu, make: Make, names: [&'static str; 4]) -> Result<Vec<Check>, SolverError> {
    // Of Huppert's heap, h = (1 - r^2 / R^2)^(1/3), R^2 is 7/3 of the mean square, of a disc 2.
    let heap = |viscosity, tension| -> Result<f64, SolverError> { Ok((7.0 / 3.0 * spread_m2(gpu, make(viscosity, tension))?).sqrt()) };
    let [thick, thin, loose, tight] = names;
    let viscous = |name| Check::new(name, "0.894 (rho g V^3 t / (3 mu))^(1/8)", "Huppert 1982", "m");
    let tense = Check::new(tight, "sqrt(V / (pi h)), h = 2 sin(angle / 2) sqrt(sigma / (rho g))", "puddles: de Gennes et al. 2004", "m");
    Ok(vec![
        viscous(thick).compare(huppert_m(100.0), heap(100.0, 0.0)?, 0.1),
        viscous(thin).compare(huppert_m(10.0), heap(10.0, 0.0)?, 0.1),
        viscous(loose).compare(huppert_m(2.0), heap(2.0, 0.02)?, 0.15),
        tense.compare(puddle_m(8.0), (2.0 * spread_m2(gpu, make(2.0, 8.0))?).sqrt(), 0.15),
    ])
}

/// Of a liquid on the grid.
pub(super) fn grid(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let names = ["spread at 100 Pa s", "spread at 10 Pa s", "spread at 0.02 N/m, 2 Pa s", "spread at 8 N/m, 2 Pa s"];
    all(gpu, on_grid, names)
}

/// Of one of smoothed particles.
pub(super) fn sph(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let names = ["spread SPH at 100 Pa s", "spread SPH at 10 Pa s", "spread SPH at 0.02 N/m, 2 Pa s", "spread SPH at 8 N/m, 2 Pa s"];
    all(gpu, smoothed, names)
}
