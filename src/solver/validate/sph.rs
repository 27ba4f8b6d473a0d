//! Liquids of smoothed particles: V18 to V20 and V23.

use super::bodies::block;
use super::{Check, Plot};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use crate::solver::types::{Collider, Particles, Plane, Settings, SolverError};
use crate::spec::{ColliderShape, PlaneShape};
use glam::{EulerRot, Quat, Vec3};

const D_M: f32 = 0.01;
const GRAVITY_M_S2: f64 = 9.81;

/// A box of liquid of 1000 kg/m^3, so many particles along each axis.
fn liquid(low_m: Vec3, counts: [u32; 3], viscosity_pa_s: f32, surface_tension_n_m: f32) -> Particles {
    let size = Vec3::from(counts.map(|c| c as f32)) * D_M;
    let substances = vec![Substance::SphLiquid { viscosity_pa_s, surface_tension_n_m }];
    Particles { substances, ..block(low_m, size, D_M, 1.0, 0.0) }
}

/// A wall through a point; one of friction 0 lets a liquid slip, any other holds it.
fn wall(point_m: Vec3, normal: Vec3, friction: f32) -> Collider {
    let plane = PlaneShape { point_m: point_m.as_dvec3().into(), normal: normal.as_dvec3().into() };
    Collider { shape: ColliderShape::Plane(plane), friction, restitution: 0.0 }
}

/// Walls at both ends of an axis.
fn between(low: f32, high: f32, axis: Vec3, friction: f32) -> [Collider; 2] {
    [wall(axis * low, axis, friction), wall(axis * high, -axis, friction)]
}

fn slippery_ground(settings: &mut Settings) {
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.0, restitution: 0.0 });
}

/// Front of a collapsing column of width a and height 2a: (t sqrt(2 g / a), front / a), their second set.
const MARTIN_MOYCE: [[f64; 2]; 5] = [[0.832, 1.217], [1.219, 1.474], [1.997, 2.292], [2.547, 2.995], [3.345, 4.134]];

/// V18: the front of a collapsing column of water on a dry floor.
pub(super) fn dam_break(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    const ACROSS: u32 = 16;
    const THICK: u32 = 4;
    let a = ACROSS as f32 * D_M;
    let particles = liquid(Vec3::ZERO, [ACROSS, THICK, 2 * ACROSS], 1e-3, 0.0);
    let mut settings = Settings::new(2.0 * D_M);
    slippery_ground(&mut settings);
    settings.colliders = between(0.0, THICK as f32 * D_M, Vec3::Y, 0.0).into();
    settings.colliders.push(wall(Vec3::ZERO, Vec3::X, 0.0));
    let mut solver = Solver::new(gpu, settings, &particles)?;
    let mut measured = vec![[0.0, 1.0]];
    for k in 1..=17 {
        // The last is that of the experiment.
        let time = 3.345 / 17.0 * f64::from(k);
        solver.advance(time / (2.0 * GRAVITY_M_S2 / f64::from(a)).sqrt(), &Stop::default())?;
        let mut x: Vec<f32> = solver.states()?.iter().map(|s| s.position_m.x).collect();
        x.sort_unstable_by(f32::total_cmp);
        // As far as the water is two spacings deep, over the length of a kernel: on this slippery floor a row
        // of particles slides ahead, which a floor that is wetted holds back.
        let layer = 4 * THICK as usize;
        let front = (layer..x.len()).rev().find(|&k| x[k] - x[k - layer] < 2.0 * D_M).map_or(0.0, |k| x[k] + 0.5 * D_M);
        measured.push([time, f64::from(front / a)]);
    }
    let source = "Martin and Moyce 1952, as digitised in PySPH";
    // The experiment's dam goes in a time of its own: one start of the clock for all five points.
    let apart = |late: f64| MARTIN_MOYCE.iter().map(|p| (along(&measured, p[0] - late) / p[1] - 1.0).powi(2)).sum::<f64>();
    let late = (0..500).map(|k| 1e-3 * f64::from(k)).min_by(|a, b| apart(*a).total_cmp(&apart(*b))).unwrap_or(f64::NAN);
    let clock =
        Check::new("V18 SPH dam break, how late the clock starts", "0, to 0.3 (a / (2 g))^(1/2), by least squares", source, "(a / (2 g))^(1/2)");
    let mut checks = vec![clock.compare(0.0, late, 0.3)];
    let names = [
        "V18 SPH dam break, T = 0.832",
        "V18 SPH dam break, T = 1.219",
        "V18 SPH dam break, T = 1.997",
        "V18 SPH dam break, T = 2.547",
        "V18 SPH dam break, T = 3.345",
    ];
    for (name, [time, front]) in names.into_iter().zip(MARTIN_MOYCE) {
        let check = Check::new(name, "front / a at T = t (2 g / a)^(1/2) by that clock, measured", source, "");
        checks.push(check.compare(front, along(&measured, time - late), 0.05));
    }
    let plot = Plot {
        caption: "Front of a column of water, twice as high as wide, that collapses on a dry floor".to_owned(),
        x: "t sqrt(2 g / a)",
        y: "front / a",
        expected: MARTIN_MOYCE.to_vec(),
        measured: measured.clone(),
    };
    let end = Check::new("V18 SPH front of a dam break", "front / a at t sqrt(2 g / a) = 3.345 from the start, measured", source, "");
    let (time, front) = (MARTIN_MOYCE[4][0], MARTIN_MOYCE[4][1]);
    checks.push(end.compare(front, along(&measured, time), 0.1).with_plot(plot));
    Ok(checks)
}

/// Straight between the points of a curve.
fn along(curve: &[[f64; 2]], x: f64) -> f64 {
    let k = curve.partition_point(|p| p[0] < x).clamp(1, curve.len() - 1);
    let ([x0, y0], [x1, y1]) = (curve[k - 1], curve[k]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}

/// Slope of a line through points, by least squares.
fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = (points.iter().map(|p| p[0]).sum::<f64>() / n, points.iter().map(|p| p[1]).sum::<f64>() / n);
    points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>() / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>()
}

/// V_j r |W'| of the cubic spline of a cell's support, for particles of a spacing's volume.
fn carried(q: f64) -> f64 {
    q * if q < 0.5 { 12.0 * q - 18.0 * q * q } else { 6.0 * (1.0 - q).powi(2) } / std::f64::consts::PI
}

/// What the forces between particles carry upwards, for each: sum of z F_z / (2 V). A solver's own pressures
/// differ from it by how far its particles are from an even distribution.
fn carried_pa(states: &[ParticleState], pressures: &[f32]) -> Vec<f64> {
    let of = |(i, p): (usize, &f32)| {
        let pairs = states.iter().zip(pressures).filter_map(|(s, other)| {
            let apart = (s.position_m - states[i].position_m).as_dvec3() / f64::from(2.0 * D_M);
            let q = apart.length();
            (q > 0.0 && q < 1.0).then(|| 0.5 * f64::from(p + other) * carried(q) * (apart.z / q).powi(2))
        });
        pairs.sum()
    };
    pressures.iter().enumerate().map(of).collect()
}

/// V19: a pool at rest, its pressure over depth, its volume and what motion is left.
pub(super) fn hydrostatic(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let counts = [8, 8, 16];
    let particles = liquid(Vec3::ZERO, counts, 1e-3, 0.0);
    let mut settings = Settings::new(2.0 * D_M);
    slippery_ground(&mut settings);
    let [x, y, height] = counts.map(|c| c as f32 * D_M);
    settings.colliders = [between(0.0, x, Vec3::X, 0.0), between(0.0, y, Vec3::Y, 0.0)].concat();
    let mut solver = Solver::new(gpu, settings, &particles)?;
    solver.advance(1.0, &Stop::default())?;
    let (mut points, mut middle, mut energy, samples) = (Vec::new(), 0.0, 0.0, 50);
    for k in 1..=samples {
        solver.advance(1.0 + 0.02 * f64::from(k), &Stop::default())?;
        let states = solver.states()?;
        let pressures = carried_pa(&states, &solver.liquid_pressures_pa()?);
        // Within the pool: two rows off the ground and below the surface.
        let inside = states.iter().zip(&pressures).filter(|(s, _)| {
            s.position_m.z > 2.0 * D_M
                && s.position_m.z < height - 3.0 * D_M
                && [(s.position_m.x, x), (s.position_m.y, y)].iter().all(|&(at, width)| at > 2.0 * D_M && at < width - 2.0 * D_M)
        });
        points.extend(inside.map(|(s, p)| [f64::from(s.position_m.z), *p]));
        let share = 1.0 / (states.len() as f64 * f64::from(samples));
        middle += states.iter().map(|s| f64::from(s.position_m.z)).sum::<f64>() * share;
        energy += states.iter().map(|s| f64::from(s.velocity_m_s.length_squared())).sum::<f64>() * share;
    }
    let weight = Check::new("V19 SPH pressure over depth", "dp/dz = -rho g", "Stevin 1586, Pascal 1663", "Pa/m");
    let volume = Check::new("V19 SPH volume at rest", "mean height of the particles, as filled", "Euler 1757: div v = 0", "m");
    let rest = Check::new("V19 SPH motion at rest", "v rms / sqrt(g H) goes to 0", "Stevin 1586: forces balance", "");
    Ok(vec![
        weight.compare(-1000.0 * GRAVITY_M_S2, slope(&points), 0.02),
        volume.compare(0.5 * f64::from(height), middle, 0.02),
        rest.compare(0.0, energy.sqrt() / (GRAVITY_M_S2 * f64::from(height)).sqrt(), 0.03),
    ])
}

/// A box filled by a lattice that is turned against its walls: layers along them would slide more easily
/// than a liquid.
fn turned(counts: [u32; 3], viscosity_pa_s: f32) -> Particles {
    let size = Vec3::from(counts.map(|c| c as f32)) * D_M;
    let reach = size.length();
    let side = (2.0 * reach / D_M) as u32;
    let whole = liquid(Vec3::splat(-reach), [side; 3], viscosity_pa_s, 0.0);
    let turn = Quat::from_euler(EulerRot::XYZ, 0.5, 0.7, 0.3);
    let inside = |x: &Vec3| (*x - 0.25 * D_M).cmpge(Vec3::ZERO).all() && (*x + 0.25 * D_M).cmple(size).all();
    let position_m: Vec<Vec3> = whole.position_m.iter().map(|x| turn * *x).filter(inside).collect();
    let n = position_m.len();
    Particles {
        position_m,
        velocity_m_s: vec![Vec3::ZERO; n],
        volume_m3: vec![D_M.powi(3); n],
        density_kg_m3: vec![1000.0; n],
        young_pa: vec![1.0; n],
        poisson: vec![0.0; n],
        substance: vec![0; n],
        object: vec![0; n],
        ..whole
    }
}

/// Velocity in a channel a while after a fall began: g / (2 nu) x (W - x) less what of it is still to come.
fn falling_m_s(x: f64, w: f64, nu: f64, time_s: f64) -> f64 {
    use std::f64::consts::PI;
    let mode = |n: f64| (n * PI * x / w).sin() * (-(n * PI / w).powi(2) * nu * time_s).exp() / n.powi(3);
    let to_come: f64 = (0..60).map(|k| mode(f64::from(2 * k + 1))).sum();
    GRAVITY_M_S2 / nu * (0.5 * x * (w - x) - 4.0 * w * w / PI.powi(3) * to_come)
}

/// When its profile stands: the slowest part of the start dies with exp(-pi^2 nu t / W^2), and a ninetieth is left.
fn settled_s(w: f64, nu: f64) -> f64 {
    (4.5 * w * w / (std::f64::consts::PI.powi(2) * nu)).max(0.06)
}

/// Velocity of a thick liquid that falls between two walls which hold it, so many spacings apart, after a time that its width
/// and kinematic viscosity give: as expected, and as measured.
pub(super) fn channel(gpu: &Gpu, across: u32, viscosity_pa_s: f32, time_s: impl Fn(f64, f64) -> f64) -> Result<[Vec<[f64; 2]>; 2], SolverError> {
    let counts = [across, 4, 24];
    let particles = turned(counts, viscosity_pa_s);
    let width = across as f32 * D_M;
    let mut settings = Settings::new(2.0 * D_M);
    let slab = between(0.0, counts[1] as f32 * D_M, Vec3::Y, 0.0);
    settings.colliders = [between(0.0, width, Vec3::X, 1.0), slab].concat();
    let mut solver = Solver::new(gpu, settings, &particles)?;
    let (w, nu) = (f64::from(width), f64::from(viscosity_pa_s) / 1000.0);
    let time_s = time_s(w, nu);
    solver.advance(time_s, &Stop::default())?;
    let states = solver.states()?;
    let middle = states.iter().map(|s| s.position_m.z).sum::<f32>() / states.len() as f32;
    let (mut measured, mut expected) = (Vec::new(), Vec::new());
    for k in 0..across {
        let strip: Vec<_> = states
            .iter()
            .filter(|s| (s.position_m.z - middle).abs() < 4.0 * D_M && (s.position_m.x / D_M) as u32 == k)
            .map(|s| [f64::from(s.position_m.x), -f64::from(s.velocity_m_s.z)])
            .collect();
        if strip.is_empty() {
            continue;
        }
        let n = strip.len() as f64;
        let x = strip.iter().map(|p| p[0]).sum::<f64>() / n;
        measured.push([x, strip.iter().map(|p| p[1]).sum::<f64>() / n]);
        expected.push([x, falling_m_s(x, w, nu, time_s)]);
    }
    Ok([expected, measured])
}

pub(super) fn mean_of(curve: &[[f64; 2]]) -> f64 {
    curve.iter().map(|p| p[1]).sum::<f64>() / curve.len() as f64
}

/// V20: thick liquids in channels.
pub(super) fn poiseuille(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let [expected, measured] = channel(gpu, 16, 50.0, settled_s)?;
    let apart = measured.iter().zip(&expected).map(|(m, e)| (m[1] - e[1]).powi(2)).sum::<f64>() / measured.len() as f64;
    let top = expected.iter().map(|p| p[1]).fold(0.0, f64::max);
    let source = "Poiseuille 1840, between planes: nu u'' = -g";
    let mean = Check::new("V20 SPH Poiseuille, mean velocity", "g W^2 / (12 nu)", source, "m/s");
    let shape = Check::new("V20 SPH Poiseuille, profile", "rms distance from g x (W - x) / (2 nu), of its top", source, "");
    let plot = Plot {
        caption: "Velocity across a channel of 16 spacings in which a thick liquid falls".to_owned(),
        x: "x, m",
        y: "velocity, m/s",
        expected: expected.clone(),
        measured: measured.clone(),
    };
    let mut checks = vec![mean.compare(mean_of(&expected), mean_of(&measured), 0.05), shape.compare(0.0, apart.sqrt() / top, 0.08).with_plot(plot)];
    let others = [
        ("V20 SPH Poiseuille, 10 spacings, mean velocity", 10, 50.0),
        ("V20 SPH Poiseuille, 24 spacings, mean velocity", 24, 200.0),
        ("V20 SPH Poiseuille, 1e3 Pa s, mean velocity", 16, 1e3),
        ("V20 SPH Poiseuille, 1e6 Pa s, mean velocity", 16, 1e6),
    ];
    for (name, across, viscosity_pa_s) in others {
        let [expected, measured] = channel(gpu, across, viscosity_pa_s, settled_s)?;
        let check = Check::new(name, "g W^2 / (12 nu)", source, "m/s");
        checks.push(check.compare(mean_of(&expected), mean_of(&measured), 0.05));
    }
    Ok(checks)
}

/// V23: how deep a cube of half the liquid's density floats.
pub(super) fn buoyancy(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    const POOL: [u32; 3] = [14, 14, 12];
    const CUBE: f32 = 6.0 * D_M;
    let [x, y, _] = POOL.map(|c| c as f32 * D_M);
    let low = Vec3::new(4.0, 4.0, 9.0) * D_M;
    let cube = block(low, Vec3::splat(CUBE), D_M, 2e4, 0.3);
    let pool = liquid(Vec3::ZERO, POOL, 1e-3, 0.0);
    let beside = |p: &Vec3| !(p.cmpgt(low).all() && p.cmplt(low + CUBE).all());
    let mut position_m: Vec<Vec3> = pool.position_m.into_iter().filter(beside).collect();
    let liquids = position_m.len();
    position_m.extend(&cube.position_m);
    let n = position_m.len();
    let of = |liquid: f32, solid: f32| (0..n).map(|i| if i < liquids { liquid } else { solid }).collect::<Vec<f32>>();
    let particles = Particles {
        position_m,
        velocity_m_s: vec![Vec3::ZERO; n],
        volume_m3: vec![D_M.powi(3); n],
        density_kg_m3: of(1000.0, 500.0),
        young_pa: of(1.0, 2e4),
        poisson: of(0.0, 0.3),
        substance: (0..n).map(|i| u16::from(i >= liquids)).collect(),
        object: (0..n).map(|i| u32::from(i >= liquids)).collect(),
        substances: vec![pool.substances[0].clone(), Substance::default()],
    };
    let mut settings = Settings::new(2.0 * D_M);
    slippery_ground(&mut settings);
    settings.colliders = [between(0.0, x, Vec3::X, 0.0), between(0.0, y, Vec3::Y, 0.0)].concat();
    let mut solver = Solver::new(gpu, settings, &particles)?;
    let (mut under, samples) = (0.0, 20);
    for k in 1..=40 {
        solver.advance(0.03 * f64::from(k), &Stop::default())?;
        let states = solver.states()?;
        let middle = states[liquids..].iter().map(|s| s.position_m.z).sum::<f32>() / (n - liquids) as f32;
        let bottom = middle - 0.5 * CUBE;
        // Where the surface stands: the mean height of a flat pool that the cube reaches into.
        let mean = states[..liquids].iter().map(|s| s.position_m.z).sum::<f32>() / liquids as f32;
        let narrow = CUBE * CUBE / (x * y - CUBE * CUBE);
        let level = mean + (mean * mean + narrow * bottom * (2.0 * mean - bottom)).sqrt();
        under += if k > 40 - samples { f64::from((level - bottom) / CUBE) / f64::from(samples) } else { 0.0 };
    }
    let check =
        Check::new("V23 SPH floating cube", "submerged share = density over the liquid's", "Archimedes, On Floating Bodies, book 1, prop. 5", "");
    Ok(vec![check.compare(0.5, under, 0.05)])
}
