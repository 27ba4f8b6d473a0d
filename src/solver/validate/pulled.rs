//! A bar that a weight pulls at: what yields, and how fast what flows lengthens.

use super::bodies::{append, block};
use super::strained::Strained;
use super::{Check, Plot};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::Substance;
use crate::solver::types::{ObjectForce, Particles, PinRegion, Settings, SolverError};
use crate::spec::{ColliderShape, ElasticModel, PlaneShape};
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
    /// Mean stretch across, between them.
    across: f64,
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
            across: self.between.iter().map(|&i| f64::from(states[i].f().y_axis.y)).sum::<f64>() / self.between.len() as f64,
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
            mean.across += now.across / f64::from(samples);
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
    let yields = Check::new("V16 von Mises bar in tension", "Y = F l / A0 - H alpha", "von Mises 1913, uniaxial; linear hardening", "Pa");
    let holds = Check::new("V16 below its yield stress", "no plastic strain", "von Mises 1913, uniaxial", "1");
    // By its length alone, without what the solver remembers of its slip.
    let tau = traction_pa * after.stretch;
    let longer = tau / f64::from(young_pa) + (tau - f64::from(yield_pa)) / f64::from(hardening_pa);
    let length = Check::new("V16 length under a load beyond", "ln l = tau / E + (tau - Y) / H, tau = F l / A0", "Hencky 1928; linear hardening", "1");
    let mut checks = vec![
        holds.compare(0.0, below.most_history, 1e-6),
        yields.compare(f64::from(yield_pa), measured, 0.03),
        length.compare(longer, after.stretch.ln(), 0.03),
    ];
    checks.extend(softening(gpu)?);
    Ok(checks)
}

/// What softens as it is stretched by steps at constant volume: its stress over its strain has a peak.
fn softening(gpu: &Gpu) -> Result<[Check; 2], SolverError> {
    let (young_pa, poisson, yield_pa, hardening_pa) = (1e6f32, 0.3f32, 1e4f32, -2e5f32);
    let mut block = Strained::new(gpu, Substance::Plastic { yield_stress_pa: yield_pa, hardening_pa }, young_pa, poisson)?;
    let (three_mu, yields, hardens) = (1.5 * f64::from(young_pa / (1.0 + poisson)), f64::from(yield_pa), f64::from(hardening_pa));
    // Four steps to where it yields, and twelve beyond.
    let (steps, step) = (16, 0.25 * yields / three_mu);
    let strain = |k: usize| step * (k + 1) as f64;
    let slip = |strain: f64| ((three_mu * strain - yields) / (three_mu + hardens)).max(0.0);
    let stress = |strain: f64| (three_mu * strain).min(yields + hardens * slip(strain));
    let by = Vec3::new(step.exp() as f32, (-0.5 * step).exp() as f32, (-0.5 * step).exp() as f32);
    // Of a stress without pressure two thirds of what von Mises counts are along the axis.
    let measured = (0..steps).map(|_| Ok(1.5 * block.stretch(by)?.tau_pa)).collect::<Result<Vec<f64>, SolverError>>()?;
    let plot = Plot {
        caption: "Stress of matter that softens, stretched at constant volume".to_owned(),
        x: "logarithmic strain",
        y: "stress, kPa",
        expected: (0..steps).map(|k| [strain(k), 1e-3 * stress(strain(k))]).collect(),
        measured: measured.iter().enumerate().map(|(k, m)| [strain(k), 1e-3 * m]).collect(),
    };
    let source = "von Mises 1913; linear softening, radial return";
    let peak = Check::new("V16 softening, peak stress", "Y", source, "Pa").compare(yields, measured.iter().copied().fold(f64::NAN, f64::max), 0.01);
    let end = Check::new("V16 softening, stress at four times the yield strain", "Y + H (3 mu e - Y) / (3 mu + H)", source, "Pa");
    Ok([peak, end.compare(stress(strain(steps - 1)), measured[steps - 1], 0.01).with_plot(plot)])
}

/// Stretches along and across a bar under a load on its first section: of those at which nothing pulls sideways, by
/// halving, the ones whose stress along it is F l1 / A0. `volume` says which J leaves no stress across at a stretch,
/// `difference` how much more stress there is along it than across.
fn loaded_stretches(traction_pa: f64, volume: impl Fn(f64) -> f64, difference: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    let along = |across: f64| volume(across) / (across * across);
    let (mut low, mut high) = (0.6, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if difference(along(middle), middle) > traction_pa * along(middle) { low = middle } else { high = middle }
    }
    (along(low), low)
}

/// How far bars of both elastic models stretch under a load of three tenths of their modulus.
pub(super) fn large_strain(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (young_pa, poisson, traction_pa, ramp_s) = (1e5f32, 0.3f32, 3e4, 1.5);
    let (e, nu) = (f64::from(young_pa), f64::from(poisson));
    let (mu, lambda) = (e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
    // mu (l2^2 - 1) + lambda ln J = 0; 2 mu (l2 - 1) l2 + lambda J (J - 1) = 0.
    let neo_hookean = loaded_stretches(traction_pa, |l2| (-mu * (l2 * l2 - 1.0) / lambda).exp(), |l1, l2| mu * (l1 * l1 - l2 * l2));
    let volume = |l2: f64| 0.5 * (1.0 + (1.0 - 8.0 * mu * (l2 - 1.0) * l2 / lambda).sqrt());
    let corotated = loaded_stretches(traction_pa, volume, |l1, l2| 2.0 * mu * ((l1 - 1.0) * l1 - (l2 - 1.0) * l2));
    let rows = [
        (
            ["large strain, neo-Hookean bar, longer by", "large strain, neo-Hookean bar, thinner by"],
            ["mu (l1^2 - 1) + lambda ln J = F l1 / A0", "mu (l2^2 - 1) + lambda ln J = 0"],
            "Bonet and Wood 2008, compressible neo-Hookean",
            ElasticModel::NeoHookean,
            neo_hookean,
        ),
        (
            ["large strain, corotated bar, longer by", "large strain, corotated bar, thinner by"],
            ["2 mu (l1 - 1) l1 + lambda J (J - 1) = F l1 / A0", "2 mu (l2 - 1) l2 + lambda J (J - 1) = 0"],
            "Stomakhin et al. 2012, fixed corotated",
            ElasticModel::Corotated,
            corotated,
        ),
    ];
    let mut checks = Vec::new();
    for (names, formulas, source, model, (l1, l2)) in rows {
        let mut bar = Bar::new(gpu, Substance::Elastic(model), young_pa, poisson, traction_pa, ramp_s)?;
        bar.solver.advance(ramp_s, &Stop::default())?;
        // Two swings of the weight on the bar.
        let hangs = bar.mean_over(ramp_s, ramp_s + 0.8)?;
        checks.push(Check::new(names[0], formulas[0], source, "1").compare(l1 - 1.0, hangs.stretch - 1.0, 0.05));
        checks.push(Check::new(names[1], formulas[1], source, "1").compare(1.0 - l2, 1.0 - hangs.across, 0.05));
    }
    Ok(checks)
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
    let flows = Check::new("Bingham bar in tension", "(tau - Y) / (3 eta), over 0.6 s", "Bingham 1922; Trouton 1906, ratio 3", "1");
    let flows = flows.compare(expected, (before.stretch / start.stretch).ln(), 0.05);
    // Below: Hooke's strain and no more, however long it hangs.
    let traction_pa = 1.5e4;
    let mut bar = Bar::new(gpu, substance, young_pa, 0.3, traction_pa, ramp_s)?;
    bar.solver.advance(from_s, &Stop::default())?;
    let hangs = bar.mean_over(from_s, to_s)?;
    let holds = Check::new("Bingham bar below its yield stress", "ln l = F l / (A0 E)", "Hencky 1928, logarithmic strain", "1");
    Ok(vec![flows, holds.compare(traction_pa * hangs.stretch / f64::from(young_pa), hangs.stretch.ln(), 0.03)])
}
