//! Liquids that flow: V18, a dam that breaks, and V20, between walls.

use super::Check;
use super::bodies::{pool, walls};
use super::repeat::differing;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::state::ParticleState;
use crate::solver::substance::{Substance, liquid_bulk_pa};
use crate::solver::types::{Collider, ObjectForce, Plane, Settings, SolverError};
use glam::Vec3;

const DENSITY_KG_M3: f32 = 1000.0;
const GRAVITY_M_S2: f32 = 9.81;

/// Front of a collapsing column of width a and height 2 a on a dry floor: T = t sqrt(2 g / a) and
/// Z = front / a. Martin and Moyce 1952, figure 3, a = 1.125 inches.
const NARROW: [(f64, f64); 5] = [(0.849, 1.245), (1.212, 1.443), (1.602, 1.884), (2.283, 2.689), (2.950, 3.728)];
/// The same, a = 2.25 inches.
const WIDE: [(f64, f64); 5] = [(0.832, 1.217), (1.219, 1.474), (1.997, 2.292), (2.547, 2.995), (3.345, 4.134)];
/// Koshizuka and Oka 1996, the same shape.
const LATER: [(f64, f64); 9] =
    [(0.0, 1.0), (0.381, 1.111), (0.769, 1.252), (1.153, 1.505), (1.537, 1.892), (1.935, 2.241), (2.323, 2.615), (2.719, 3.003), (3.096, 3.624)];

/// Straight between the points of a curve.
fn between(curve: &[(f64, f64)], t: f64) -> f64 {
    let k = curve.partition_point(|p| p.0 < t).clamp(1, curve.len() - 1);
    let ((t0, z0), (t1, z1)) = (curve[k - 1], curve[k]);
    z0 + (z1 - z0) * (t - t0) / (t1 - t0)
}

/// V18: the front at three times, against the mean of three experiments.
pub(super) fn dam_break(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (cell_m, width_m) = (0.0125f32, 0.1f32);
    let depth_m = 4.0 * cell_m;
    let bulk_pa = liquid_bulk_pa(2.0 * width_m, 0.0, GRAVITY_M_S2, DENSITY_KG_M3);
    let water = Substance::Liquid { viscosity_pa_s: 1e-3, surface_tension_n_m: 0.0 };
    let column = pool(Vec3::ZERO, Vec3::new(width_m, depth_m, 2.0 * width_m), 0.5 * cell_m, DENSITY_KG_M3, bulk_pa, water);
    let mut settings = Settings::new(cell_m);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.5, restitution: 0.0 });
    settings.colliders = walls(Vec3::ZERO, Vec3::new(10.0 * width_m, depth_m, 0.0));
    let mut solver = Solver::new(gpu, settings, &column)?;
    let mut checks = Vec::new();
    let names = ["V18 dam break, T = 1.5", "V18 dam break, T = 2", "V18 dam break, T = 2.5"];
    for (name, t) in names.into_iter().zip([1.5, 2.0, 2.5]) {
        solver.advance(t * (f64::from(width_m) / (2.0 * f64::from(GRAVITY_M_S2))).sqrt(), &Stop::default())?;
        // The front of the sheet, half a spacing beyond its particles; a few of them fly ahead.
        let mut ahead: Vec<f32> = solver.states()?.iter().map(|s| s.position_m.x).collect();
        ahead.sort_by(f32::total_cmp);
        let front_m = ahead[ahead.len() - 1 - ahead.len() / 200] + 0.25 * cell_m;
        let expected = (between(&NARROW, t) + between(&WIDE, t) + between(&LATER, t)) / 3.0;
        let check = Check::new(name, "front / width", "Martin and Moyce 1952; Koshizuka and Oka 1996", "");
        checks.push(check.compare(expected, f64::from(front_m / width_m), 0.1));
    }
    Ok(checks)
}

/// Between two walls, in cells.
const GAP_CELLS: f32 = 10.0;
const CELL_M: f32 = 0.01;

/// Liquid between two walls across y, driven along z; the speeds (y / gap, u) in the middle third of
/// its length after `time_s`. `driven` is the share of the gap, about its middle, that is.
fn between_walls(gpu: &Gpu, viscosity_pa_s: f32, drive_m_s2: f32, driven: f32, shift_m: f32, time_s: f64) -> Result<Vec<(f64, f64)>, SolverError> {
    let gap_m = GAP_CELLS * CELL_M;
    let low_m = Vec3::new(0.0, shift_m, 0.0);
    // Long, so that its open ends hardly count: they add pressure over 1 / length.
    let size_m = Vec3::new(CELL_M, gap_m, 6.0 * gap_m);
    let thick = Substance::Liquid { viscosity_pa_s, surface_tension_n_m: 0.0 };
    let mut slab = pool(low_m, size_m, 0.5 * CELL_M, DENSITY_KG_M3, 1e5, thick);
    let middle = |y: f32| ((y - shift_m) / gap_m - 0.5).abs() <= 0.5 * driven;
    for (object, x) in slab.object.iter_mut().zip(&slab.position_m) {
        *object = u32::from(middle(x.y));
    }
    let mut settings = Settings { glued: true, ..Settings::new(CELL_M) };
    // All of it by its weight; a part of it by a force.
    settings.gravity_m_s2 = if driven < 1.0 { Vec3::ZERO } else { Vec3::Z * drive_m_s2 };
    let forces = vec![ObjectForce { object: 1, from_s: 0.0, to_s: f64::INFINITY, acceleration_m_s2: Vec3::Z * drive_m_s2 }];
    settings.forces = if driven < 1.0 { forces } else { Vec::new() };
    let along_y = walls(low_m, low_m + size_m);
    settings.colliders = along_y.into_iter().skip(2).map(|c| Collider { friction: 0.7, ..c }).collect();
    let mut solver = Solver::new(gpu, settings, &slab)?;
    solver.advance(time_s, &Stop::default())?;
    let states = solver.states()?;
    let top = states.iter().map(|s| s.position_m.z).fold(f32::MIN, f32::max);
    let bottom = states.iter().map(|s| s.position_m.z).fold(f32::MAX, f32::min);
    let inside = |s: &&ParticleState| ((s.position_m.z - bottom) / (top - bottom) - 0.5).abs() < 1.0 / 6.0;
    Ok(states.iter().filter(inside).map(|s| (f64::from((s.position_m.y - shift_m) / gap_m), f64::from(s.velocity_m_s.z))).collect())
}

/// How much of the expected profile there is, by least squares, and the root mean square of the rest
/// as a share of the profile's largest.
fn fit(measured: &[(f64, f64)], expected: impl Fn(f64) -> f64) -> (f64, f64) {
    let dot = |of: &dyn Fn(&(f64, f64)) -> f64| measured.iter().map(of).sum::<f64>();
    let share = dot(&|&(y, u)| u * expected(y)) / dot(&|&(y, _)| expected(y).powi(2));
    let most = measured.iter().map(|&(y, _)| expected(y)).fold(0.0, f64::max);
    let rest = (dot(&|&(y, u)| (u - share * expected(y)).powi(2)) / measured.len() as f64).sqrt();
    (share, rest / most)
}

/// V20: Poiseuille's parabola and Couette's straight lines, with viscosities that an explicit step of
/// the same length would bear and a hundred times more.
pub(super) fn viscous(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let gap = f64::from(GAP_CELLS * CELL_M);
    let (rho, g) = (f64::from(DENSITY_KG_M3), f64::from(GRAVITY_M_S2));
    let mut checks = Vec::new();
    let mut compare = |names: [&'static str; 2], formula, source, (share, rest)| {
        checks.push(Check::new(names[0], formula, source, "of the formula").compare(1.0, share, 0.05));
        checks.push(Check::new(names[1], "root mean square off the profile", source, "of its largest").compare(0.0, rest, 0.05));
    };
    let poiseuille = |eta: f64| move |y: f64| rho * g / (2.0 * eta) * gap * gap * y * (1.0 - y);
    let formula = "u = rho g y (W - y) / (2 eta)";
    let thin = between_walls(gpu, 120.0, GRAVITY_M_S2, 1.0, 0.0, 0.06)?;
    compare(
        ["V20 Poiseuille, 120 Pa s", "V20 Poiseuille, 120 Pa s, shape"],
        formula,
        "Poiseuille 1840, between planes",
        fit(&thin, poiseuille(120.0)),
    );
    let thick = between_walls(gpu, 1.2e4, GRAVITY_M_S2, 1.0, 0.0, 1.0)?;
    compare(
        ["V20 Poiseuille, 12000 Pa s", "V20 Poiseuille, 12000 Pa s, shape"],
        formula,
        "Poiseuille 1840, between planes",
        fit(&thick, poiseuille(1.2e4)),
    );
    // A driven core of a fifth of the gap drags the rest by its two sides.
    let core = 0.2;
    let tent = |y: f64| rho * g * gap * core / 2.0 * (0.5 - (y - 0.5).abs()) * gap / 120.0;
    let mut sheared = between_walls(gpu, 120.0, GRAVITY_M_S2, core as f32, 0.0, 0.06)?;
    sheared.retain(|(y, _)| (y - 0.5).abs() > 0.5 * core);
    compare(["V20 Couette, 120 Pa s", "V20 Couette, 120 Pa s, shape"], "u = tau y / eta", "Couette 1890", fit(&sheared, tent));
    Ok(checks)
}

/// V26 with liquids: the same bits again, and from a checkpoint.
pub(super) fn same_bits(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let honey = Substance::Liquid { viscosity_pa_s: 10.0, surface_tension_n_m: 0.5 };
    let mut drop = pool(Vec3::new(0.0, 0.0, 0.06), Vec3::splat(0.2), 0.025, DENSITY_KG_M3, 1e5, honey);
    drop.velocity_m_s.fill(Vec3::new(0.7, 0.1, -2.0));
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.3, restitution: 0.0 });
    let stop = Stop::default();
    let start = || Solver::new(gpu, settings.clone(), &drop);
    let (mut first, mut second, mut third) = (start()?, start()?, start()?);
    first.advance(0.06, &stop)?;
    third.restore(&first.checkpoint()?)?;
    second.advance(0.06, &stop)?;
    let mut ends = Vec::new();
    for solver in [&mut first, &mut second, &mut third] {
        solver.advance(0.12, &stop)?;
        ends.push(solver.checkpoint()?);
    }
    let again = Check::new("V26 liquid, a second run", "bytes that differ", "integer sums, fixed order", "bytes");
    let resumed = Check::new("V26 liquid, from a checkpoint", "bytes that differ", "integer sums, fixed order", "bytes");
    Ok(vec![again.compare(0.0, differing(&ends[0], &ends[1]), 0.0), resumed.compare(0.0, differing(&ends[0], &ends[2]), 0.0)])
}
