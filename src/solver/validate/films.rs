//! Sheets of liquid on a wall, thinner than a cell: what the wall's friction makes of their speed.

use super::Check;
use super::bodies::{pool, walls};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::{Substance, liquid_bulk_pa};
use crate::solver::types::{Plane, Settings, SolverError};
use glam::Vec3;

const CELL_M: f32 = 0.02;
const THICK_M: f32 = 0.1 * CELL_M;
const DENSITY_KG_M3: f32 = 1000.0;

/// Mean speed of the middle third of a sheet after a while on a wall along which `drive_m_s2` pulls it.
fn speed_m_s(gpu: &Gpu, viscosity_pa_s: f32, drive_m_s2: f32, start_m_s: f32, time_s: f64) -> Result<f64, SolverError> {
    let size_m = Vec3::new(30.0, 4.0, 0.5) * CELL_M;
    let spacing_m = 0.5 * CELL_M;
    let bulk_pa = liquid_bulk_pa(CELL_M, 3.0, 9.81, DENSITY_KG_M3);
    let mut sheet = pool(Vec3::ZERO, size_m, spacing_m, DENSITY_KG_M3, bulk_pa, Substance::Liquid { viscosity_pa_s, surface_tension_n_m: 0.0 });
    sheet.volume_m3.fill(spacing_m * spacing_m * THICK_M);
    sheet.velocity_m_s.fill(Vec3::X * start_m_s);
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    settings.colliders = walls(Vec3::ZERO, size_m).into_iter().skip(2).collect();
    settings.gravity_m_s2 = Vec3::new(drive_m_s2, 0.0, -8.5);
    let mut solver = Solver::new(gpu, settings, &sheet)?;
    let start: Vec<f32> = sheet.position_m.iter().map(|x| x.x).collect();
    solver.advance(time_s, &Stop::default())?;
    let states = solver.states()?;
    let middle = states.iter().zip(&start).filter(|(_, x)| (**x / size_m.x - 0.5).abs() < 1.0 / 6.0);
    let speeds: Vec<f64> = middle.map(|(s, _)| f64::from(s.velocity_m_s.x)).collect();
    Ok(speeds.iter().sum::<f64>() / speeds.len() as f64)
}

/// A sheet that is left to itself, one on a slope, and one so viscous that it creeps.
pub(super) fn brake(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    // What turbulence takes from a film on a rough wall: f / 8 of rho v^2, f = 0.03.
    let per_m = 0.03 / 8.0 / f64::from(THICK_M);
    let (start, seconds) = (3.0, 0.2);
    let slows = Check::new("film slows down", "v0 / (1 + f v0 t / (8 h)), f = 0.03", "Weisbach 1845, Darcy 1857: tau = f rho v^2 / 8", "m/s");
    let slows = slows.compare(start / (1.0 + per_m * start * seconds), speed_m_s(gpu, 1e-6, 0.0, start as f32, seconds)?, 0.05);
    let (drive, start, seconds) = (4.9f64, 1.0, 0.3);
    let terminal = (drive / per_m).sqrt();
    let reached = terminal * (drive * seconds / terminal + (start / terminal).atanh()).tanh();
    let runs = Check::new("film on a slope", "towards sqrt(8 g h sin a / f)", "Chezy 1769; Weisbach 1845, Darcy 1857", "m/s");
    let runs = runs.compare(reached, speed_m_s(gpu, 1e-6, drive as f32, start as f32, seconds)?, 0.05);
    let (thick, viscosity) = (f64::from(THICK_M), 0.1);
    let creeps = Check::new("film so viscous that it creeps", "rho g sin a h^2 / (3 mu)", "Nusselt 1916", "m/s");
    let nusselt = f64::from(DENSITY_KG_M3) * drive * thick * thick / (3.0 * viscosity);
    Ok(vec![slows, runs, creeps.compare(nusselt, speed_m_s(gpu, viscosity as f32, drive as f32, 0.0, 0.15)?, 0.05)])
}
