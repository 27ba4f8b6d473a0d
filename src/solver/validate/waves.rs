//! Bodies that swing: V6 and V8.

use super::bodies::block;
use super::{Check, Plot};
use crate::Stop;
use crate::gpu::Gpu;
use crate::solver::core::Solver;
use crate::solver::types::{Settings, SolverError};
use glam::Vec3;

const SPACING_M: f32 = 0.025;

/// Frequency of a sampled swing about a mean: the one whose cosine and sine take most of it away,
/// sought between half and twice a guess.
pub(super) fn frequency_hz(samples: &[[f64; 2]], guess_hz: f64) -> f64 {
    let mean = samples.iter().map(|s| s[1]).sum::<f64>() / samples.len() as f64;
    // What is left of the samples once the best a + b cos + c sin of one frequency is taken away.
    let left = |hz: f64| {
        let rows: Vec<([f64; 3], f64)> = samples
            .iter()
            .map(|&[t, y]| {
                let (s, c) = (std::f64::consts::TAU * hz * t).sin_cos();
                ([1.0, c, s], y - mean)
            })
            .collect();
        let fit = least_squares(&rows);
        rows.iter().map(|(row, y)| (y - row.iter().zip(fit).map(|(r, f)| r * f).sum::<f64>()).powi(2)).sum::<f64>()
    };
    let ratio = 4f64.powf(1.0 / 400.0);
    let coarse = (0..=400).map(|k| 0.5 * guess_hz * ratio.powi(k)).min_by(|a, b| left(*a).total_cmp(&left(*b))).unwrap_or(guess_hz);
    let (mut low, mut high) = (coarse / ratio, coarse * ratio);
    for _ in 0..40 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if left(a) < left(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// Normal equations of three unknowns, by Cramer's rule.
fn least_squares(rows: &[([f64; 3], f64)]) -> [f64; 3] {
    let column = |j: usize| glam::DVec3::from_array(std::array::from_fn(|i| rows.iter().map(|(r, _)| r[i] * r[j]).sum()));
    let matrix = glam::DMat3::from_cols(column(0), column(1), column(2));
    let right = glam::DVec3::from_array(std::array::from_fn(|i| rows.iter().map(|(r, y)| r[i] * y).sum()));
    (matrix.inverse() * right).to_array()
}

/// V8: a free bar whose ends go to and fro against each other, v = v0 cos(pi x / L) along it. With
/// nu = 0 nothing moves sideways and the wave is that of a bar.
pub(super) fn bar(gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
    let (length_m, young_pa, density) = (1.0f64, 1e6f64, 1000.0f64);
    let mut particles = block(Vec3::ZERO, Vec3::new(length_m as f32, 0.1, 0.1), SPACING_M, young_pa as f32, 0.0);
    let shape: Vec<f64> = particles.position_m.iter().map(|p| (std::f64::consts::PI * f64::from(p.x) / length_m).cos()).collect();
    particles.velocity_m_s = shape.iter().map(|s| Vec3::X * (0.2 * s) as f32).collect();
    let settings = Settings { gravity_m_s2: Vec3::ZERO, ..Settings::new(0.05) };
    let mut solver = Solver::new(gpu, settings, &particles)?;
    let expected_hz = (young_pa / density).sqrt() / (2.0 * length_m);
    let mut samples = Vec::new();
    for k in 0..=48 {
        let time_s = 1.5 / expected_hz * f64::from(k) / 48.0;
        solver.advance(time_s, &Stop::default())?;
        let states = solver.states()?;
        let swing: f64 = states.iter().zip(&shape).map(|(s, shape)| f64::from(s.velocity_m_s.x) * shape).sum();
        samples.push([time_s, 2.0 * swing / shape.len() as f64]);
    }
    let measured_hz = frequency_hz(&samples, expected_hz);
    let plot = Plot {
        caption: "A free bar after a blow along it: how fast its ends part, as the line of the formula says and as the solver has it".to_owned(),
        x: "time, s",
        y: "speed of the ends, m/s",
        expected: (0..=200)
            .map(|k| 1.5 / expected_hz * f64::from(k) / 200.0)
            .map(|t| [t, 0.2 * (std::f64::consts::TAU * expected_hz * t).cos()])
            .collect(),
        measured: samples,
    };
    let check = Check::new("V8 wave in a bar", "sqrt(E / rho) / (2 L)", "Rayleigh 1877, ch. VII, free ends; nu = 0", "Hz");
    Ok(vec![check.compare(expected_hz, measured_hz, 0.03).with_plot(plot)])
}

#[cfg(test)]
mod tests {
    use super::frequency_hz;

    #[test]
    fn a_swing_about_a_mean_has_its_frequency_found() {
        let samples: Vec<_> = (0..60).map(|k| f64::from(k) * 0.01).map(|t| [t, 3.0 - 0.2 * (std::f64::consts::TAU * 2.7 * t + 0.4).cos()]).collect();
        assert!((frequency_hz(&samples, 3.3) - 2.7).abs() < 1e-3);
    }
}
