//! How hard a muscle pulls over time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::limits;

/// Share of Young's modulus that fibres pull with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Activation {
    /// The same all the time.
    Steady(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// `[time_s, activation]` pairs; straight lines between them, constant before the first and after the last.
    Curve(#[schemars(length(min = 1, max = limits::ENTRIES))] Vec<[f64; 2]>),
    /// Swings to and fro.
    Wave(Wave),
}

/// An activation that swings between two values like a cosine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wave {
    /// Its least value, at the start of a period.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub least: f64,
    /// Its largest value, half a period later.
    #[serde(default = "one")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub most: f64,
    /// Length of a period.
    #[schemars(range(min = limits::PERIOD_S.0, max = limits::PERIOD_S.1))]
    pub period_s: f64,
    /// Share of a period that has passed at t = 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub phase: f64,
}

fn one() -> f64 {
    1.0
}

impl Activation {
    /// Its value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        let points = match self {
            Activation::Steady(value) => return *value,
            Activation::Wave(wave) => {
                let turn = (time_s / wave.period_s + wave.phase) * std::f64::consts::TAU;
                return wave.least + (wave.most - wave.least) * 0.5 * (1.0 - turn.cos());
            }
            Activation::Curve(points) => points,
        };
        let next = points.iter().position(|[t, _]| *t > time_s);
        match next {
            Some(0) => points[0][1],
            Some(after) => {
                let ([t0, a0], [t1, a1]) = (points[after - 1], points[after]);
                a0 + (a1 - a0) * (time_s - t0) / (t1 - t0)
            }
            None => points.last().map_or(0.0, |[_, value]| *value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_straight_between_its_points_and_a_wave_swings() {
        let curve = Activation::Curve(vec![[0.5, 0.0], [1.0, 1.0], [2.0, 0.5]]);
        for (time_s, value) in [(0.0, 0.0), (0.5, 0.0), (0.75, 0.5), (1.0, 1.0), (1.5, 0.75), (9.0, 0.5)] {
            assert_eq!(curve.at(time_s), value, "at {time_s}");
        }
        let wave = Activation::Wave(Wave { least: 0.2, most: 1.0, period_s: 2.0, phase: 0.5 });
        assert!((wave.at(0.0) - 1.0).abs() < 1e-12 && (wave.at(1.0) - 0.2).abs() < 1e-12 && (wave.at(0.5) - 0.6).abs() < 1e-12);
    }
}
