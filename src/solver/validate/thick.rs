//! Thick liquids that are pulled long, and that lie loosely: both keep the volume that they have. Pastes that run down a wall.

use super::Check;
use super::bodies::{block, pool, walls};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::state::ParticleState;
use crate::solver::substance::{Substance, liquid_bulk_pa};
use crate::solver::types::{PinRegion, Plane, Settings, SolverError};
use crate::spec::{ColliderShape, PlaneShape};
use glam::Vec3;

const CELL_M: f32 = 0.02;
const GRAVITY_M_S2: f32 = 9.81;

fn liquid(viscosity_pa_s: f32) -> Substance {
    Substance::Liquid { viscosity_pa_s, surface_tension_n_m: 0.0 }
}

/// A thread that hangs from its upper end. Each part of it carries what hangs below by 3 mu times its rate of stretch, so that
/// with k = rho g t / (3 mu) it is 1 / (1 - k z) as long as it was, z the length that hung below it at first, and as thin.
pub(super) fn thread(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (long_m, wide_m, density_kg_m3, viscosity_pa_s, time_s) = (16.0 * CELL_M, 4.0 * CELL_M, 1000.0, 2000.0, 1.0);
    let held_m = 2.0 * CELL_M;
    let (low_m, size_m) = (Vec3::ZERO, Vec3::new(wide_m, wide_m, long_m + held_m));
    let bulk_pa = liquid_bulk_pa(long_m, 0.0, GRAVITY_M_S2, density_kg_m3);
    let particles = pool(low_m, size_m, 0.5 * CELL_M, density_kg_m3, bulk_pa, liquid(viscosity_pa_s));
    let above = PlaneShape { point_m: [0.0, 0.0, f64::from(long_m - 0.5 * CELL_M)], normal: [0.0, 0.0, -1.0] };
    let shape = ColliderShape::Plane(above);
    let mut settings = Settings::new(CELL_M);
    settings.pins = vec![PinRegion { object: 0, shape, low_m, high_m: size_m, from_s: 0.0, to_s: f64::INFINITY, path: Vec::new() }];
    let mut solver = Solver::new(gpu, settings, &particles)?;
    let start = solver.states()?;
    solver.advance(time_s, &Stop::default())?;
    let states = solver.states()?;
    // Two layers, and what lies between them.
    let (low, high) = (0.25 * long_m, 0.75 * long_m);
    let within = |from_m: f32, to_m: f32| start.iter().zip(&states).filter(move |(s, _)| s.position_m.z > from_m && s.position_m.z < to_m);
    let mean = |from_m: f32, to_m: f32, of: &dyn Fn(Vec3) -> f32| {
        let (sum, count) = within(from_m, to_m).fold((0.0, 0.0), |(sum, count), (_, s)| (sum + f64::from(of(s.position_m)), count + 1.0));
        sum / count
    };
    let height = |at_m: f32| mean(at_m - 0.6 * CELL_M, at_m + 0.6 * CELL_M, &|x| x.z);
    let area = |x: Vec3| (x.truncate() - 0.5 * wide_m).length_squared();
    let area_at_first = f64::from(wide_m * wide_m) / 6.0 * (1.0 - 1.0 / 64.0);
    let k = f64::from(density_kg_m3 * GRAVITY_M_S2) * time_s / (3.0 * f64::from(viscosity_pa_s));
    let [low_k, high_k] = [low, high].map(|z| 1.0 - k * f64::from(z));
    let long = Check::new("thread grows long", "ln((1 - k z1) / (1 - k z2)) / k, k = rho g t / (3 mu)", "Trouton 1906", "m");
    let thin = Check::new("thread grows thin", "1 - k z of its cross-section, the mean between z1 and z2", "Trouton 1906", "1");
    Ok(vec![
        long.compare((low_k / high_k).ln() / k, height(high) - height(low), 0.05),
        thin.compare(0.5 * (low_k + high_k), mean(low, high, &area) / area_at_first, 0.05),
    ])
}

/// Depth of a liquid that was let go with gaps all through it, 1.6 times as large as it is.
fn settled_m(gpu: &Gpu, viscosity_pa_s: f32, density_kg_m3: f32, time_s: f64) -> Result<[f64; 2], SolverError> {
    let (spacing_m, looser) = (0.5 * CELL_M, 1.6f32);
    let apart_m = spacing_m * looser.cbrt();
    let size_m = Vec3::new(10.0, 10.0, 14.0) * apart_m;
    let bulk_pa = liquid_bulk_pa(size_m.z, 0.0, GRAVITY_M_S2, density_kg_m3);
    let mut loose = pool(Vec3::ZERO, size_m, apart_m, density_kg_m3, bulk_pa, liquid(viscosity_pa_s));
    loose.volume_m3.fill(spacing_m.powi(3));
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    settings.colliders = walls(Vec3::ZERO, size_m);
    let mut solver = Solver::new(gpu, settings, &loose)?;
    solver.advance(time_s, &Stop::default())?;
    let states = solver.states()?;
    let depth_m = 2.0 * states.iter().map(|s| f64::from(s.position_m.z)).sum::<f64>() / states.len() as f64;
    Ok([f64::from(size_m.z / looser), depth_m])
}

/// Honey and lava with gaps close up under their own weight.
pub(super) fn loose(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let check = |name| Check::new(name, "V / A", "a liquid has no gaps: what holds them open is air, which escapes", "m");
    let ([honey, honey_m], [lava, lava_m]) = (settled_m(gpu, 10.0, 1420.0, 1.0)?, settled_m(gpu, 150.0, 2600.0, 1.0)?);
    Ok(vec![check("loose honey closes up").compare(honey, honey_m, 0.04), check("loose lava closes up").compare(lava, lava_m, 0.04)])
}

/// A deep layer of paste on a slope: it sticks to the wall, shears where the stress is over its yield stress, and the rest
/// rides on that as a plug.
pub(super) fn paste(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (yield_pa, viscosity_pa_s, young_pa, drive_m_s2, density_kg_m3) = (350.0, 100.0, 2e5, 4.9, 1000.0f64);
    let size_m = Vec3::new(48.0, 2.0, 8.0) * CELL_M;
    let mut layer = block(Vec3::ZERO, size_m, 0.5 * CELL_M, young_pa, 0.4);
    layer.substances = vec![Substance::Viscoplastic { yield_stress_pa: yield_pa, viscosity_pa_s }];
    let mut settings = Settings::new(CELL_M);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    settings.colliders = walls(Vec3::ZERO, size_m).into_iter().skip(2).collect();
    settings.gravity_m_s2 = Vec3::new(drive_m_s2, 0.0, -8.5);
    let mut solver = Solver::new(gpu, settings, &layer)?;
    solver.advance(0.35, &Stop::default())?;
    let middle = |x: Vec3| (x.x / size_m.x - 0.5).abs() < 0.1;
    let states = solver.states()?;
    let speed = |from: f32, to: f32| {
        let of = |s: &&ParticleState| middle(layer.position_m[s.index as usize]) && (from..to).contains(&(s.position_m.z / size_m.z));
        let speeds: Vec<f64> = states.iter().filter(of).map(|s| f64::from(s.velocity_m_s.x)).collect();
        speeds.iter().sum::<f64>() / speeds.len() as f64
    };
    let (deep_m, weight) = (f64::from(size_m.z), density_kg_m3 * f64::from(drive_m_s2));
    // Sheared up to this height.
    let sheared_m = deep_m - f64::from(yield_pa) / 3f64.sqrt() / weight;
    let plug_m_s = 0.5 * weight / f64::from(viscosity_pa_s) * sheared_m * sheared_m;
    let rides = Check::new("paste runs down a slope", "rho g sin a (h - tau / (rho g sin a))^2 / (2 eta), its plug", "Bingham 1922", "m/s");
    let shears = Check::new("paste sticks to a wall", "1 - (1 - z / hs)^2 of that at z = h / 8, hs the height that shears", "Bingham 1922", "1");
    let lowest = 1.0 - (1.0 - deep_m / 8.0 / sheared_m).powi(2);
    Ok(vec![rides.compare(plug_m_s, speed(0.75, 0.95), 0.1), shears.compare(lowest, speed(1.0 / 16.0, 3.0 / 16.0) / speed(0.75, 0.95), 0.15)])
}
