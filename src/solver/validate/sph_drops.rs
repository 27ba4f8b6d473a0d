//! Drops of smoothed particles without weight: V21 and V22.

use super::bodies::{keep, pool};
use super::{Check, Plot};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use crate::solver::types::{Particles, Settings, SolverError};
use glam::{DVec3, Vec3};

const DENSITY_KG_M3: f32 = 1000.0;
const TENSION_N_M: f32 = 1.0;
const CELL_M: f32 = 0.01;

/// A sphere about the origin, stretched along z at equal volume.
#[derive(Clone, Copy, Debug)]
struct Drop {
    /// Its radius in cells.
    cells: f32,
    cell_m: f32,
    stretch: f32,
    viscosity_pa_s: f32,
    tension_n_m: f32,
}

impl Drop {
    /// Round, thin, as most of them are.
    fn new(cells: f32) -> Drop {
        Drop { cells, cell_m: CELL_M, stretch: 1.0, viscosity_pa_s: 0.0, tension_n_m: TENSION_N_M }
    }

    /// Its particles, and the radius that their volume has.
    fn particles(&self) -> (Particles, f64) {
        let (d, radius_m) = (0.5 * self.cell_m, self.cells * self.cell_m);
        let substance = Substance::SphLiquid { viscosity_pa_s: self.viscosity_pa_s, surface_tension_n_m: self.tension_n_m };
        // Off the middle of a cell, as any drop is.
        let low_m = Vec3::splat(-radius_m - 2.0 * d) + Vec3::new(0.26, 0.14, 0.37) * d;
        let mut all = keep(&pool(low_m, Vec3::splat(2.0 * radius_m + 4.0 * d), d, DENSITY_KG_M3, 1.0, substance), |x| x.length() < radius_m);
        let n = all.len();
        let wide = self.stretch.sqrt().recip();
        all.position_m.iter_mut().for_each(|x| *x *= Vec3::new(wide, wide, self.stretch));
        (all, (3.0 * n as f64 * f64::from(d).powi(3) / (4.0 * std::f64::consts::PI)).cbrt())
    }

    fn weightless(&self) -> Settings {
        Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(self.cell_m) }
    }
}

fn middle(states: &[ParticleState]) -> DVec3 {
    states.iter().map(|s| s.position_m.as_dvec3()).sum::<DVec3>() / states.len() as f64
}

/// Mean of what the pressures carry between particles that are so near to the middle: sum of r F / (6 V).
fn carried_pa(states: &[ParticleState], pressures: &[f32], within_m: f64) -> f64 {
    let centre = middle(states);
    let inside = (0..states.len()).filter(|&i| (states[i].position_m.as_dvec3() - centre).length() < within_m);
    let of = |i: usize| -> f64 {
        let pairs = states.iter().zip(pressures).filter_map(|(s, other)| {
            let q = f64::from((s.position_m - states[i].position_m).length() / CELL_M);
            // V r |W'| of the cubic spline.
            let steep = if q < 0.5 { 12.0 * q - 18.0 * q * q } else { 6.0 * (1.0 - q).powi(2) } / std::f64::consts::PI;
            (q > 0.0 && q < 1.0).then(|| 0.5 * f64::from(pressures[i] + other) * q * steep / 3.0)
        });
        pairs.sum()
    };
    let values: Vec<f64> = inside.map(of).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// V22: pressure in drops of two sizes, in cells, and that they stay round.
pub(super) fn laplace(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    let names = [
        ["V22 SPH pressure in a drop of 3.5 cells", "V22 SPH roundness of a drop of 3.5 cells"],
        ["V22 SPH pressure in a drop of 5 cells", "V22 SPH roundness of a drop of 5 cells"],
    ];
    for ([name, round], cells) in names.into_iter().zip([3.5, 5.0]) {
        let drop = Drop { viscosity_pa_s: 0.05, ..Drop::new(cells) };
        let (particles, radius_m) = drop.particles();
        let mut solver = Solver::new(gpu, drop.weightless(), &particles)?;
        let (mut pressure, samples) = (0.0, 10);
        for k in 0..samples {
            solver.advance(0.12 + 0.012 * f64::from(k), &Stop::default())?;
            let within_m = radius_m - 1.3 * f64::from(CELL_M);
            pressure += carried_pa(&solver.states()?, &solver.liquid_pressures_pa()?, within_m) / f64::from(samples);
        }
        checks.push(Check::new(name, "2 sigma / R", "Young 1805, Laplace 1806", "Pa").compare(
            2.0 * f64::from(TENSION_N_M) / radius_m,
            pressure,
            0.1,
        ));
        let states = solver.states()?;
        let farthest = states.iter().map(|s| (s.position_m.as_dvec3() - middle(&states)).length()).fold(0.0, f64::max);
        let round = Check::new(round, "farthest particle from the middle, of R", "Plateau 1873: least surface", "");
        checks.push(round.compare(1.0, farthest / radius_m, 0.12));
    }
    Ok(checks)
}

/// V21: a drop of four cells' radius that was stretched by a tenth swings about the sphere; and, from which no constant was set,
/// one of five smaller cells with a fifth of the tension. Of that one runs that begin alike but for their last bits swing by a tenth
/// apart, so that it is held to a sixth.
pub(super) fn swinging(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (small, big) = ("V21 SPH swinging drop", "V21 SPH swinging drop of 5 cells, 0.2 N/m");
    Ok(vec![
        swing(gpu, small, &Drop { stretch: 1.1, ..Drop::new(4.0) }, 0.1)?,
        swing(gpu, big, &Drop { cell_m: 0.006, tension_n_m: 0.2, stretch: 1.1, ..Drop::new(5.0) }, 1.0 / 6.0)?,
    ])
}

fn swing(gpu: &Gpu, name: &'static str, drop: &Drop, within: f64) -> Result<Check, SolverError> {
    let (particles, radius_m) = drop.particles();
    let mut solver = Solver::new(gpu, drop.weightless(), &particles)?;
    let omega = (8.0 * f64::from(drop.tension_n_m) / (f64::from(DENSITY_KG_M3) * radius_m.powi(3))).sqrt();
    let period_s = std::f64::consts::TAU / omega;
    let (mut measured, mut expected) = (Vec::new(), Vec::new());
    let mut first = 0.0;
    for k in 0..=30 {
        let time_s = 0.04 * f64::from(k) * period_s;
        solver.advance(time_s, &Stop::default())?;
        let states = solver.states()?;
        let centre = middle(&states);
        let second = |axis: usize| states.iter().map(|s| (f64::from(s.position_m[axis]) - centre[axis]).powi(2)).sum::<f64>();
        let longer = second(2) / (second(0) * second(1)).sqrt() - 1.0;
        first = if k == 0 { longer } else { first };
        measured.push([time_s, longer]);
        expected.push([time_s, first * (omega * time_s).cos()]);
    }
    let crossings: Vec<f64> =
        measured.windows(2).filter(|w| w[0][1] * w[1][1] < 0.0).map(|w| w[0][0] + (w[1][0] - w[0][0]) * w[0][1] / (w[0][1] - w[1][1])).collect();
    let swing = if let [a, b, ..] = crossings[..] { std::f64::consts::PI / (b - a) } else { f64::NAN };
    let plot = Plot {
        caption: "Second moment along a stretched drop of smoothed particles over that across, less 1".to_owned(),
        x: "t, s",
        y: "stretch",
        expected,
        measured,
    };
    let check = Check::new(name, "omega^2 = 8 sigma / (rho R^3)", "Rayleigh 1879, mode 2", "1/s");
    Ok(check.compare(omega, swing, within).with_plot(plot))
}
