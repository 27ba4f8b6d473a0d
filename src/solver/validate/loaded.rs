//! Bodies under their own weight: V5 and V7.

use super::bodies::{block, mean_of};
use super::waves::frequency_hz;
use super::{Check, Plot};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::types::{Particles, PinRegion, Settings, SolverError};
use crate::spec::{ColliderShape, PlaneShape};
use glam::Vec3;

const CELL_M: f32 = 0.05;
const SPACING_M: f32 = 0.025;
const DENSITY_KG_M3: f64 = 1000.0;
const GRAVITY_M_S2: f64 = 9.81;

/// Where the clamps end: between two nodes, the farther of which is the last that they hold.
const CLAMP_M: f32 = 0.5 * CELL_M;

/// Holds the body behind a plane at `CLAMP_M` along a normal.
fn clamp(particles: &Particles, normal: Vec3) -> PinRegion {
    let (low_m, high_m) = particles.position_m.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let plane = PlaneShape { point_m: (normal * CLAMP_M).as_dvec3().into(), normal: normal.as_dvec3().into() };
    PinRegion { object: 0, shape: ColliderShape::Plane(plane), low_m, high_m, from_s: 0.0, to_s: f64::INFINITY, path: Vec::new() }
}

/// Mean of a displacement over `span_s`, in `samples` steps. A load put on at once makes a body swing
/// about where it would hang: its mean over whole periods is the static one.
fn mean_over(
    solver: &mut Solver,
    span_s: f64,
    samples: u32,
    mut of: impl FnMut(&Solver) -> Result<Vec<f64>, SolverError>,
) -> Result<Vec<f64>, SolverError> {
    let mut sums: Vec<f64> = Vec::new();
    for k in 1..=samples {
        solver.advance(span_s * f64::from(k) / f64::from(samples), &Stop::default())?;
        let values = of(solver)?;
        sums.resize(values.len(), 0.0);
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / f64::from(samples));
    }
    Ok(sums)
}

/// Where the beam bends from: the grid keeps it straight up to half a cell before the first node that moves,
/// and upright up to the last that does not.
const ROOT_M: f32 = 0.75 * CELL_M;

/// Length, height and width of the cantilever, and its modulus.
const BEAM: (f64, f64, f64, f64) = (1.1875, 0.2, 0.05, 3e7);

/// Deflection of a cantilever under its weight at one place.
struct BeamPoint {
    /// From the root.
    x_m: f64,
    /// By the solver, downwards.
    measured_m: f64,
    /// By Timoshenko's beam.
    expected_m: f64,
}

/// Timoshenko: w q/(24 E I) (6 L^2 - 4 L x + x^2) x^2 for bending, and q / (k G A) (L x - x^2/2) for
/// shear with k = 5/6.
fn timoshenko_m(x: f64, poisson: f64) -> f64 {
    let (l, h, b, e) = BEAM;
    let (area, inertia, shear) = (h * b, b * h.powi(3) / 12.0, 0.5 * e / (1.0 + poisson));
    let q = DENSITY_KG_M3 * GRAVITY_M_S2 * area;
    q * x * x * (6.0 * l * l - 4.0 * l * x + x * x) / (24.0 * e * inertia) + q * (l * x - 0.5 * x * x) / (5.0 / 6.0 * shear * area)
}

/// The cantilever in its clamp, straight, at rest, under gravity from now on.
fn cantilever_start(gpu: &Gpu, poisson: f32) -> Result<(Solver, Particles), SolverError> {
    let (l, h, b, e) = BEAM;
    // The clamp holds two more cells of the beam.
    let held_m = 2.0 * CELL_M;
    let low = Vec3::new(CLAMP_M - held_m, -0.5 * b as f32, -0.5 * h as f32);
    let size = Vec3::new(l as f32 + ROOT_M - low.x, b as f32, h as f32);
    let particles = block(low, size, SPACING_M, e as f32, poisson);
    let mut settings = Settings::new(CELL_M);
    settings.pins.push(clamp(&particles, Vec3::X));
    Ok((Solver::new(gpu, settings, &particles)?, particles))
}

/// First mode of an Euler-Bernoulli cantilever, (1.8751^2 / 2 pi) sqrt(E I / rho A) / L^2.
fn first_mode_hz() -> f64 {
    let (l, h, _, e) = BEAM;
    1.8751f64.powi(2) / std::f64::consts::TAU * (e * h * h / 12.0 / DENSITY_KG_M3).sqrt() / (l * l)
}

/// Deflection along a cantilever of four cells' height, from clamp to tip.
fn cantilever_curve(gpu: &Gpu, poisson: f32) -> Result<Vec<BeamPoint>, SolverError> {
    let (mut solver, particles) = cantilever_start(gpu, poisson)?;
    let l = BEAM.0 as f32;
    // Slowed by shear by a per cent: second order here.
    let frequency_hz = first_mode_hz();
    let columns: Vec<f32> = (0..).map(|k| CLAMP_M + (k as f32 + 0.5) * SPACING_M - ROOT_M).take_while(|&x| x < l).collect();
    let of_column = |x: f32| (0..particles.len()).filter(|&i| (particles.position_m[i].x - ROOT_M - x).abs() < 0.1 * SPACING_M).collect::<Vec<_>>();
    let picked: Vec<_> = columns.iter().map(|&x| of_column(x)).collect();
    let measured = mean_over(&mut solver, 1.0 / frequency_hz, 40, |solver| {
        let states = solver.states()?;
        let fallen = |i: &usize| f64::from(particles.position_m[*i].z - states[*i].position_m.z);
        Ok(picked.iter().map(|column| column.iter().map(fallen).sum::<f64>() / column.len() as f64).collect())
    })?;
    let point = |(&x, &measured_m): (&f32, &f64)| BeamPoint { x_m: f64::from(x), measured_m, expected_m: timoshenko_m(f64::from(x), poisson.into()) };
    Ok(columns.iter().zip(&measured).map(point).collect())
}

/// V5: a cantilever, up to nearly incompressible.
pub(super) fn cantilever(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    for (name, poisson) in [("V5 cantilever tip", 0.0), ("V5 tip, nu = 0.3", 0.3), ("V5 tip, nu = 0.45", 0.45), ("V5 tip, nu = 0.49", 0.49)] {
        let curve = cantilever_curve(gpu, poisson)?;
        let Some(tip) = curve.last() else { continue };
        let check =
            Check::new(name, "q L^4 / (8 E I) + q L^2 / (2 k G A)", "Timoshenko 1921, k = 5/6", "m").compare(tip.expected_m, tip.measured_m, 0.05);
        checks.push(if poisson == 0.0 { check.with_plot(deflection(&curve)) } else { check });
        if poisson == 0.0 {
            let farthest = curve.iter().map(|p| (p.measured_m - p.expected_m).abs()).fold(0.0, f64::max) / tip.expected_m;
            let along = Check::new("V5 cantilever, whole length", "farthest from the line, as a share of the tip's", "Timoshenko 1921, k = 5/6", "");
            checks.push(along.compare(0.0, farthest, 0.05));
        }
    }
    Ok(checks)
}

/// The curve beside Timoshenko's.
fn deflection(curve: &[BeamPoint]) -> Plot {
    Plot {
        caption:
            "Deflection of a cantilever under its own weight: the line is Timoshenko's, the dots the solver's, with four cells across the height"
                .to_owned(),
        x: "distance from the clamp, m",
        y: "deflection, mm",
        expected: curve.iter().map(|p| [p.x_m, 1e3 * p.expected_m]).collect(),
        measured: curve.iter().map(|p| [p.x_m, 1e3 * p.measured_m]).collect(),
    }
}

/// V6: how fast the tip swings once gravity is there.
pub(super) fn swing(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (mut solver, particles) = cantilever_start(gpu, 0.0)?;
    let tip: Vec<usize> = (0..particles.len()).filter(|&i| particles.position_m[i].x - ROOT_M > BEAM.0 as f32 - SPACING_M).collect();
    let expected_hz = first_mode_hz();
    let mut samples = Vec::new();
    for k in 0..=48 {
        let time_s = 1.5 / expected_hz * f64::from(k) / 48.0;
        solver.advance(time_s, &Stop::default())?;
        samples.push([time_s, 1e3 * mean_of(&solver, &tip, |s| f64::from(s.position_m.z))?]);
    }
    let measured_hz = frequency_hz(&samples, expected_hz);
    let check = Check::new(
        "V6 cantilever's first mode",
        "(1.8751^2 / 2 pi) sqrt(E I / (rho A)) / L^2",
        "Rayleigh 1877, ch. VIII, clamped and free; L / h = 6",
        "Hz",
    );
    Ok(vec![check.compare(expected_hz, measured_hz, 0.05)])
}

/// A column that stands in its clamp, free sideways with nu = 0.
#[derive(Clone, Copy, Debug)]
struct Column {
    height_m: f64,
    /// Modulus below and above a height.
    young_pa: [f64; 2],
    changes_m: f64,
    /// Of its slowest swing up and down.
    period_s: f64,
}

impl Column {
    /// How much two heights come nearer: the integral of rho g (H - z) / E.
    fn shortens_m(&self, low: f64, high: f64) -> f64 {
        let weight = |z: f64| DENSITY_KG_M3 * GRAVITY_M_S2 * (self.height_m * z - 0.5 * z * z);
        let middle = self.changes_m.clamp(low, high);
        let [below, above] = self.young_pa;
        (weight(middle) - weight(low)) / below + (weight(high) - weight(middle)) / above
    }

    /// What is expected between two heights, and what the solver gives. The lower one is clear of the clamp, whose edge
    /// is as wide as a cell.
    fn shortens(&self, gpu: &Gpu) -> Result<(f64, f64), SolverError> {
        let held_m = 2.0 * CELL_M;
        let low_m = Vec3::new(-0.05, -0.05, CLAMP_M - held_m);
        let size = Vec3::new(0.1, 0.1, self.height_m as f32 + held_m);
        let mut particles = block(low_m, size, SPACING_M, 1.0, 0.0);
        let above = |z: f32| usize::from(f64::from(z - CLAMP_M) > self.changes_m);
        particles.young_pa = particles.position_m.iter().map(|p| self.young_pa[above(p.z)] as f32).collect();
        let mut settings = Settings::new(CELL_M);
        settings.pins.push(clamp(&particles, Vec3::Z));
        let mut solver = Solver::new(gpu, settings, &particles)?;
        let layer = |height: f64| {
            let z = CLAMP_M + height as f32;
            (0..particles.len()).filter(|&i| (particles.position_m[i].z - z).abs() < 0.1 * SPACING_M).collect::<Vec<_>>()
        };
        let half = 0.5 * f64::from(SPACING_M);
        let (low, high) = (4.0 * f64::from(SPACING_M) + half, self.height_m - half);
        let (bottom, top) = (layer(low), layer(high));
        let length = |solver: &Solver| {
            let z = |layer: &[usize]| mean_of(solver, layer, |s| f64::from(s.position_m.z));
            Ok::<f64, SolverError>(z(&top)? - z(&bottom)?)
        };
        let start = length(&solver)?;
        let shorter = mean_over(&mut solver, 2.0 * self.period_s, 48, |solver| Ok(vec![start - length(solver)?]))?;
        Ok((self.shortens_m(low, high), shorter[0]))
    }
}

/// V7: how columns under their own weight shorten: one, and one of two stiffnesses.
pub(super) fn column(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (height_m, young_pa) = (0.8, 5e5);
    let period_s = 4.0 * height_m / (young_pa / DENSITY_KG_M3).sqrt();
    let plain = Column { height_m, young_pa: [young_pa; 2], changes_m: 0.0, period_s };
    // Sound takes as long through either part, so that it swings with tan^2(w L / c) = the ratio of their impedances.
    // Where they join the grid knows their strains to a third of a cell: over 45 cells that is two per cent.
    let (stiff, soft) = (4e6f64, 1e6f64);
    let (transit_s, ratio) = (0.75 / (soft / DENSITY_KG_M3).sqrt(), (stiff / soft).sqrt());
    let period_s = std::f64::consts::TAU * transit_s / ratio.sqrt().atan();
    let joined = Column { height_m: 2.25, young_pa: [stiff, soft], changes_m: 1.5, period_s };
    let source = "Hooke's law integrated: E u' = rho g (H - z)";
    let rows = [
        ("V7 column under its weight", "rho g (H z - z^2 / 2) / E between two heights", plain),
        ("V7 column of two moduli in one body", "sum of sigma L / E, between two heights", joined),
    ];
    let check = |(name, formula, column): (_, _, Column)| {
        let (expected, measured) = column.shortens(gpu)?;
        Ok(Check::new(name, formula, source, "m").compare(expected, measured, 0.03))
    };
    rows.into_iter().map(check).collect()
}
