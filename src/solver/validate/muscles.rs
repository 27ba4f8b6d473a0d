//! A free muscle under activation.

use super::Check;
use super::bodies::block;
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::substance::{Activation, Substance};
use crate::solver::types::{Settings, SolverError};
use crate::spec::ElasticModel;
use glam::Vec3;

const YOUNG_PA: f64 = 1e5;
const POISSON: f64 = 0.3;
const ACTIVATION: f64 = 0.5;

/// Stretches along and across the fibres at which a neo-Hookean muscle bears no stress:
/// mu (l1^2 - 1) + lambda ln J + E a l1^2 = 0 and mu (l2^2 - 1) + lambda ln J = 0, from which
/// l1 / l2 = sqrt(mu / (mu + E a)); l2 by halving.
fn free_stretches() -> (f64, f64) {
    let mu = YOUNG_PA / (2.0 * (1.0 + POISSON));
    let lambda = YOUNG_PA * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let ratio = (mu / (mu + YOUNG_PA * ACTIVATION)).sqrt();
    let stress = |across: f64| mu * (across * across - 1.0) + lambda * (ratio * across.powi(3)).ln();
    let (mut low, mut high) = (0.5, 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if stress(middle) < 0.0 { low = middle } else { high = middle }
    }
    (ratio * low, low)
}

/// Shortening of a free block whose fibres run along x; slowly activated, so that it hardly swings.
pub(super) fn shortens(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let mut particles = block(Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.4, 0.1, 0.1), 0.025, YOUNG_PA as f32, POISSON as f32);
    let activation = Activation::Curve(vec![(0.0, 0.0), (0.5, ACTIVATION)]);
    particles.substances = vec![Substance::Muscle { model: ElasticModel::NeoHookean, fibre: Vec3::X, activation }];
    let settings = Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(0.05) };
    let mut solver = Solver::new(gpu, settings, &particles)?;
    solver.advance(0.5, &Stop::default())?;
    // Over two periods 2 L / c of its free oscillation.
    let samples = 20;
    let (mut along, mut across) = (0.0, 0.0);
    for k in 1..=samples {
        solver.advance(0.5 + 0.16 * f64::from(k) / f64::from(samples), &Stop::default())?;
        let states = solver.states()?;
        let mean = |axis: usize| states.iter().map(|s| f64::from(s.f().col(axis)[axis])).sum::<f64>() / states.len() as f64;
        along += mean(0) / f64::from(samples);
        across += mean(2) / f64::from(samples);
    }
    let (l1, l2) = free_stretches();
    let source = "Bonet and Wood 2008, neo-Hookean, and E a = 0.5 E along the fibres: no stress";
    Ok(vec![
        Check::new("muscle, length", "l1 = l2 sqrt(mu / (mu + E a))", source, "1").compare(l1, along, 0.02),
        Check::new("muscle, width", "mu (l2^2 - 1) + lambda ln(l1 l2^2) = 0", source, "1").compare(l2, across, 0.02),
    ])
}
