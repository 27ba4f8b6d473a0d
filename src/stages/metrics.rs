//! What was measured of a run: the content of `metrics.json`.

use crate::solver::Left;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A run in numbers: SI units, z up, one entry of each array for each frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Metrics {
    /// Name of the version; empty where there is none.
    pub version: String,
    /// Hash of the canonical spec.
    pub spec: String,
    /// Frames a second.
    pub fps: u32,
    /// How many frames were simulated.
    pub frames: u32,
    /// Seconds of motion.
    pub duration_s: f64,
    /// What the solver did.
    pub solver: SolverMetrics,
    /// Values that were `"auto"`, by path.
    pub resolved: serde_json::Map<String, serde_json::Value>,
    /// Wall seconds of each stage, and of parts of it under `stage.part`; parts run side by side.
    pub seconds: BTreeMap<String, f64>,
    /// What the run took of memory.
    #[serde(default)]
    pub memory: MemoryMetrics,
    /// Simulated objects, by name.
    pub objects: BTreeMap<String, ObjectMetrics>,
    /// The spec's events, in its order, and when they happened.
    #[serde(default)]
    pub events: Vec<EventMetrics>,
    /// What was expected, and whether it held.
    pub expect: Vec<ExpectationResult>,
}

/// What the solver did.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct SolverMetrics {
    /// Name of the device.
    pub device: String,
    /// `draft` or `full`.
    pub quality: String,
    /// Edge of a grid cell.
    pub cell_m: f64,
    /// Smallest and largest substep.
    pub substep_s: SubstepRange,
    /// Substeps in all.
    pub substeps: u64,
    /// Particles in all.
    pub particles: u64,
    /// Most particles of any frame with a value that is not a number.
    pub nonfinite: u64,
    /// Frames that were rolled back and repeated with a smaller substep.
    pub retries: u32,
    /// What had to be softened, in words; empty where nothing was.
    pub softened: Vec<String>,
    /// How often each force gave no number, counted by particle and substep; it counted as zero there.
    pub undefined: BTreeMap<String, u64>,
    /// How often a force would have brought a particle beyond 200 m/s, where it was held.
    pub limited: u64,
    /// The speed at which something was held, the fastest that substeps follow; 0 where nothing was.
    #[serde(default)]
    pub held_m_s: f64,
    /// How often a particle of each object came to what neither shorter substeps nor softer matter resolve, and lost its strain or
    /// its speed there.
    #[serde(default)]
    pub mended: BTreeMap<String, u64>,
    /// What of each object flew farther from the rest than the grid holds and is no longer followed: it weighs nothing from then
    /// on, is not seen, and counts in no other number. Empty where all was followed.
    #[serde(default)]
    pub left: BTreeMap<String, LeftMetrics>,
    /// Wall seconds of the simulation.
    pub simulate_s: f64,
}

/// What of an object is no longer followed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct LeftMetrics {
    /// How many particles.
    pub particles: u64,
    /// How far from the rest the farthest of them was when it was left.
    pub away_m: f64,
}

impl LeftMetrics {
    /// With what left later.
    pub(super) fn add(&mut self, later: &LeftMetrics) {
        *self = LeftMetrics { particles: self.particles + later.particles, away_m: self.away_m.max(later.away_m) };
    }
}

impl From<Left> for LeftMetrics {
    fn from(left: Left) -> LeftMetrics {
        LeftMetrics { particles: left.particles, away_m: left.away_m.into() }
    }
}

/// Memory, bytes; 0 where it could not be told.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct MemoryMetrics {
    /// Most that was in use on the device while it simulated.
    pub device_bytes: u64,
    /// Most that was set aside there in blocks.
    pub device_reserved_bytes: u64,
    /// Most that the process had in main memory until the end of the run, what it shares with the device included.
    pub host_peak_bytes: u64,
}

/// Smallest and largest substep, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct SubstepRange {
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

/// One object in numbers. Definitions are in `docs/spec.md` and `phystalk schema metrics`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct ObjectMetrics {
    /// Particles of its solid.
    pub particles: u64,
    /// Gaussians that follow them.
    pub gaussians: u64,
    /// Mass.
    pub mass_kg: f64,
    /// Inner particles over all.
    pub fill_ratio: f64,
    /// Centre of mass.
    pub com_m: Vec<[f64; 3]>,
    /// First percentile of particle height.
    pub low_m: Vec<f64>,
    /// 99th percentile of particle height.
    pub high_m: Vec<f64>,
    /// Speed of the fastest particle.
    pub speed_m_s: Vec<f64>,
    /// Mean speed.
    pub mean_speed_m_s: Vec<f64>,
    /// Volume over the undeformed body's.
    pub volume_ratio: Vec<f64>,
    /// 99th percentile of the largest principal stretch since rest.
    pub stretch_max: Vec<f64>,
    /// Inertia^-1 times angular momentum.
    pub spin_rad_s: Vec<[f64; 3]>,
    /// Kinetic energy.
    pub kinetic_j: Vec<f64>,
    /// Root mean square horizontal distance from the centre of mass.
    pub spread_m: Vec<f64>,
    /// Lowest particle over what is below it.
    pub gap_m: Vec<f64>,
    /// Times at which it met what is below it.
    pub impacts_s: Vec<f64>,
}

/// One event of the spec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct EventMetrics {
    /// As the spec calls it.
    pub name: String,
    /// To which object.
    pub object: String,
    /// When it happened, for one that waits as the run found it; null where it did not.
    pub at_s: Option<f64>,
}

/// One expectation of the spec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct ExpectationResult {
    /// As written.
    pub text: String,
    /// What was measured.
    pub value: Option<f64>,
    /// Whether it held.
    pub held: bool,
}
