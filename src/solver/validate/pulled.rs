//! A bar that a weight pulls at: what yields, and how fast what flows lengthens.

use super::Check;
use super::bodies::{append, block};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::Substance;
use crate::solver::types::{ObjectForce, Particles, PinRegion, Settings, SolverError};
use crate::spec::{ColliderShape, PlaneShape};
use glam::Vec3;

const CELL_M: f32 = 0.05;
const SPACING_M: f32 = 0.025;
/// Length between the clamp and the weight, and edge of the square section.
const LENGTH_M: f32 = 0.8;
const EDGE_M: f32 = 0.1;
/// Where the length is measured, clear of both ends.
const MARKS_M: [f32; 2] = [0.2, 0.6];
/// Density of the weight: light, so that the bar follows the load.
const WEIGHT_KG_M3: f32 = 2000.0;
/// Steps that the load rises in.
const STEPS: u32 = 80;

/// A bar along x, held behind x = 0, with a weight of twice its density at its end.
struct Bar {
    solver: Solver,
    /// Particles at each mark, and between them.
    at: [Vec<usize>; 2],
    between: Vec<usize>,
    apart_m: f64,
}

/// The bar's state at one time, means over its section.
#[derive(Clone, Copy, Debug, Default)]
struct Reading {
    /// Length between the marks over that at rest.
    stretch: f64,
    /// Mean and largest history between them.
    history: f64,
    most_history: f64,
}

/// When a share of the load is reached, as a share of the ramp: it begins and ends gently, by a cosine.
fn share_of_ramp(load: f64) -> f64 {
    (1.0 - 2.0 * load).acos() / std::f64::consts::PI
}

impl Bar {
    /// The weight pulls with `traction_pa` times the section, reached after `ramp_s`.
    fn new(gpu: &Gpu, substance: Substance, young_pa: f32, poisson: f32, traction_pa: f64, ramp_s: f64) -> Result<Bar, SolverError> {
        let held_m = 2.0 * CELL_M;
        let low = Vec3::new(0.5 * CELL_M - held_m, -0.5 * EDGE_M, -0.5 * EDGE_M);
        let mut particles = block(low, Vec3::new(LENGTH_M + held_m, EDGE_M, EDGE_M), SPACING_M, young_pa, poisson);
        let first = 0.5 * CELL_M;
        let mark = |x: f32| (0..particles.len()).filter(|&i| (particles.position_m[i].x - first - x).abs() < 0.6 * SPACING_M).collect::<Vec<_>>();
        let at = MARKS_M.map(mark);
        let inside = |x: f32| (first + MARKS_M[0]..first + MARKS_M[1]).contains(&x);
        let between = (0..particles.len()).filter(|&i| inside(particles.position_m[i].x)).collect();
        let weight = block(Vec3::new(first + LENGTH_M, -0.5 * EDGE_M, -0.5 * EDGE_M), Vec3::splat(EDGE_M), SPACING_M, young_pa, poisson);
        let weight = Particles { density_kg_m3: vec![WEIGHT_KG_M3; weight.len()], ..weight };
        particles.substances = vec![substance];
        append(&mut particles, weight, Substance::default());
        let mut settings = Settings { gravity_m_s2: Vec3::ZERO, glued: true, ..Settings::new(CELL_M) };
        let clamp = PlaneShape { point_m: [f64::from(first), 0.0, 0.0], normal: [1.0, 0.0, 0.0] };
        let room = Vec3::splat(1.0);
        settings.pins = vec![PinRegion {
            object: 0,
            shape: ColliderShape::Plane(clamp),
            low_m: -room,
            high_m: room,
            from_s: 0.0,
            to_s: f64::INFINITY,
            path: Vec::new(),
        }];
        let mass_kg = f64::from(WEIGHT_KG_M3) * f64::from(EDGE_M).powi(3);
        let full = traction_pa * f64::from(EDGE_M).powi(2) / mass_kg;
        settings.forces = (0..STEPS)
            .map(|k| ObjectForce {
                object: 1,
                from_s: ramp_s * share_of_ramp((f64::from(k) + 0.5) / f64::from(STEPS)),
                to_s: f64::INFINITY,
                acceleration_m_s2: Vec3::X * (full / f64::from(STEPS)) as f32,
            })
            .collect();
        let mut bar = Bar { solver: Solver::new(gpu, settings, &particles)?, at, between, apart_m: 0.0 };
        bar.apart_m = bar.apart()?;
        Ok(bar)
    }

    fn apart(&self) -> Result<f64, SolverError> {
        let states = self.solver.states()?;
        let mean = |at: &[usize]| at.iter().map(|&i| f64::from(states[i].position_m.x)).sum::<f64>() / at.len() as f64;
        Ok(mean(&self.at[1]) - mean(&self.at[0]))
    }

    fn read(&self) -> Result<Reading, SolverError> {
        let states = self.solver.states()?;
        let histories = || self.between.iter().map(|&i| f64::from(states[i].history));
        Ok(Reading {
            stretch: self.apart()? / self.apart_m,
            history: histories().sum::<f64>() / self.between.len() as f64,
            most_history: histories().fold(0.0, f64::max),
        })
    }

    /// Mean of what is read over a span of time, from the present one.
    fn mean_over(&mut self, from_s: f64, to_s: f64) -> Result<Reading, SolverError> {
        let samples = 24;
        let mut mean = Reading::default();
        for k in 1..=samples {
            self.solver.advance(from_s + (to_s - from_s) * f64::from(k) / f64::from(samples), &Stop::default())?;
            let now = self.read()?;
            mean.stretch += now.stretch / f64::from(samples);
            mean.history += now.history / f64::from(samples);
            mean.most_history = mean.most_history.max(now.most_history);
        }
        Ok(mean)
    }
}

/// V16: the stress at which a bar in tension yields, from the plastic strain beyond it: with linear
/// hardening the Kirchhoff stress F l / A0 is Y + H alpha.
pub(super) fn tension(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (young_pa, yield_pa, hardening_pa, traction_pa, ramp_s) = (1e7f32, 1e5f32, 5e6f32, 1.5e5, 1.0);
    let substance = Substance::Plastic { yield_stress_pa: yield_pa, hardening_pa };
    let mut bar = Bar::new(gpu, substance, young_pa, 0.3, traction_pa, ramp_s)?;
    // At nine tenths of the yield stress nothing has yielded.
    bar.solver.advance(ramp_s * share_of_ramp(0.9 * f64::from(yield_pa) / traction_pa), &Stop::default())?;
    let below = bar.read()?;
    bar.solver.advance(ramp_s, &Stop::default())?;
    let after = bar.mean_over(ramp_s, ramp_s + 0.15)?;
    let measured = traction_pa * after.stretch - f64::from(hardening_pa) * after.history;
    let yields = Check::new("V16 von Mises bar in tension", "Y = F l / A0 - H alpha", "uniaxial yield stress, linear hardening", "Pa");
    let holds = Check::new("V16 below its yield stress", "no plastic strain", "uniaxial yield stress", "1");
    Ok(vec![holds.compare(0.0, below.most_history, 1e-6), yields.compare(f64::from(yield_pa), measured, 0.03)])
}

/// How fast a bar of a Bingham solid lengthens, and that it does not below its yield stress.
pub(super) fn bingham(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (young_pa, yield_pa, viscosity_pa_s, ramp_s) = (1e6f32, 2e4f32, 1e5f32, 0.4);
    let substance = Substance::Viscoplastic { yield_stress_pa: yield_pa, viscosity_pa_s };
    let (from_s, to_s) = (0.6, 1.2);
    // Above: the strain's rise over a span against the integral of (tau - Y) / (3 eta), tau = F l / A0.
    let traction_pa = 5e4;
    let mut bar = Bar::new(gpu, substance.clone(), young_pa, 0.3, traction_pa, ramp_s)?;
    bar.solver.advance(from_s, &Stop::default())?;
    let (start, mut expected, samples) = (bar.read()?, 0.0, 30);
    let mut before = start;
    for k in 1..=samples {
        bar.solver.advance(from_s + (to_s - from_s) * f64::from(k) / f64::from(samples), &Stop::default())?;
        let now = bar.read()?;
        let tau = traction_pa * 0.5 * (before.stretch + now.stretch);
        // What the stress gains meanwhile is elastic.
        let elastic = traction_pa * (now.stretch - before.stretch) / f64::from(young_pa);
        let rate = (tau - f64::from(yield_pa)) / (3.0 * f64::from(viscosity_pa_s));
        expected += rate * (to_s - from_s) / f64::from(samples) + elastic;
        before = now;
    }
    let flows = Check::new("Bingham bar in tension", "(tau - Y) / (3 eta), over 0.6 s", "Bingham solid, Trouton's ratio 3", "1");
    let flows = flows.compare(expected, (before.stretch / start.stretch).ln(), 0.05);
    // Below: Hooke's strain and no more, however long it hangs.
    let traction_pa = 1.5e4;
    let mut bar = Bar::new(gpu, substance, young_pa, 0.3, traction_pa, ramp_s)?;
    bar.solver.advance(from_s, &Stop::default())?;
    let hangs = bar.mean_over(from_s, to_s)?;
    let holds = Check::new("Bingham bar below its yield stress", "ln l = F l / (A0 E)", "Hooke, logarithmic strain", "1");
    Ok(vec![flows, holds.compare(traction_pa * hangs.stretch / f64::from(young_pa), hangs.stretch.ln(), 0.03)])
}
