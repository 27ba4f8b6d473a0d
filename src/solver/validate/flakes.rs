//! V17: snow that is pressed and pulled by known amounts.

use super::strained::Strained;
use super::{Check, Plot};
use crate::gpu::Gpu;
use crate::solver::substance::Substance;
use crate::solver::types::SolverError;
use glam::Vec3;

const THETA_C: f32 = 2.5e-2;
const THETA_S: f32 = 7.5e-3;
const HARDENING: f32 = 10.0;
const YOUNG_PA: f32 = 1.4e5;
const POISSON: f32 = 0.2;
const SOURCE: &str = "Stomakhin et al. 2013, eq. 2";

fn snow(gpu: &Gpu, hardening: f32) -> Result<Strained, SolverError> {
    Strained::new(gpu, Substance::Snow { theta_c: THETA_C, theta_s: THETA_S, hardening }, YOUNG_PA, POISSON)
}

/// Stretched along x at once: its packing, and how much stiffer that makes it.
fn at_once(gpu: &Gpu, stretch: f32) -> Result<(f64, f64), SolverError> {
    let by = Vec3::new(stretch, 1.0, 1.0);
    let (packed, soft) = (snow(gpu, HARDENING)?.stretch(by)?, snow(gpu, 0.0)?.stretch(by)?);
    Ok((packed.history, packed.tau_pa / soft.tau_pa))
}

/// The same law along one axis in plain numbers: packing and stress after each of many equal steps.
fn in_steps(step: f64, steps: usize) -> Vec<(f64, f64)> {
    let (mut elastic, mut packing) = (1.0f64, 1.0f64);
    let (young, nu) = (f64::from(YOUNG_PA), f64::from(POISSON));
    let stiffness = young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let one = |_| {
        let pressed = elastic * step;
        elastic = pressed.max(1.0 - f64::from(THETA_C));
        packing *= pressed / elastic;
        (packing, (f64::from(HARDENING) * (1.0 - packing)).exp() * stiffness * elastic * (elastic - 1.0))
    };
    (0..steps).map(one).collect()
}

pub(super) fn packs(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    let rows = [
        (["V17 snow, packing", "V17 snow, stiffening"], "Jp = 0.9 / (1 - theta_c)", 0.9, 1.0 - THETA_C),
        (["V17 snow, loosening", "V17 snow, softening"], "Jp = 1.05 / (1 + theta_s)", 1.05, 1.0 + THETA_S),
    ];
    for (names, formula, stretch, kept) in rows {
        let (packing, stiffer) = at_once(gpu, stretch)?;
        let expected = f64::from(stretch) / f64::from(kept);
        checks.push(Check::new(names[0], formula, SOURCE, "1").compare(expected, packing, 1e-4));
        let stiffening = (f64::from(HARDENING) * (1.0 - expected)).exp();
        checks.push(Check::new(names[1], "exp(xi (1 - Jp))", SOURCE, "1").compare(stiffening, stiffer, 1e-3));
    }
    checks.extend(column(gpu)?);
    Ok(checks)
}

/// A column between walls that is pressed to two thirds of its height.
fn column(gpu: &Gpu) -> Result<[Check; 2], SolverError> {
    let (step, steps) = (0.99f32, 40);
    let expected = in_steps(step.into(), steps);
    let mut column = snow(gpu, HARDENING)?;
    let measured = (0..steps).map(|_| column.stretch(Vec3::new(step, 1.0, 1.0))).collect::<Result<Vec<_>, _>>()?;
    let (last, (packing, tau_pa)) = (measured[steps - 1], expected[steps - 1]);
    let height = |k: usize| f64::from(step).powi(k as i32 + 1);
    let plot = Plot {
        caption: "Stress of snow that is pressed between walls, over what is left of its height".to_owned(),
        x: "height over that at first",
        y: "Kirchhoff stress, kPa",
        expected: expected.iter().enumerate().map(|(k, e)| [height(k), -1e-3 * e.1]).collect(),
        measured: measured.iter().enumerate().map(|(k, m)| [height(k), -1e-3 * m.tau_pa]).collect(),
    };
    let formula = "exp(xi (1 - Jp)) (lambda + 2 mu) s (s - 1), Jp by steps";
    Ok([
        Check::new("V17 pressed column of snow, packing", "Jp, by steps of s = max(0.99 s, 1 - theta_c)", SOURCE, "1").compare(
            packing,
            last.history,
            1e-3,
        ),
        Check::new("V17 pressed column of snow, stress", formula, SOURCE, "Pa").compare(tau_pa, last.tau_pa, 0.01).with_plot(plot),
    ])
}
