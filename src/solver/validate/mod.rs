//! The solver against formulas: each case runs a small scene on the device and compares a number.

mod bodies;
mod captured;
mod coupling;
mod driven;
mod films;
mod flakes;
mod forced;
mod free;
mod grains;
mod liquid_flow;
mod liquid_rest;
mod loaded;
mod muscles;
mod pulled;
mod repeat;
mod rigid;
mod sliding;
mod sph;
mod sph_drops;
mod sph_held;
mod spread;
mod strained;
mod thick;
mod waves;

#[cfg(test)]
pub(super) use bodies::{append, ball, block, joined, keep, pool, rigid as rigid_body};
#[cfg(test)]
pub(super) use captured::{stems, swings_m};
#[cfg(test)]
pub(super) use rigid::momenta;

use super::types::SolverError;
use crate::gpu::Gpu;
use serde::Serialize;

/// A measured curve beside the expected one, for a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What is shown, in a sentence.
    pub caption: String,
    /// What the horizontal axis counts, with its unit.
    pub x: &'static str,
    /// What the vertical axis counts, with its unit.
    pub y: &'static str,
    /// The formula, or the published data.
    pub expected: Vec<[f64; 2]>,
    /// The solver.
    pub measured: Vec<[f64; 2]>,
}

/// One comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// Short and stable: `V5 cantilever tip`.
    pub name: &'static str,
    /// What is expected, as a formula.
    pub formula: &'static str,
    /// Where the formula comes from.
    pub source: &'static str,
    /// Its value.
    pub expected: f64,
    /// What the solver gave.
    pub measured: f64,
    /// How far apart they may be, as a share of `expected`, or in `unit` where that is 0.
    pub tolerance: f64,
    /// Of both values.
    pub unit: &'static str,
    /// Whether they agree.
    pub held: bool,
    /// The whole course, where one number is only its end.
    #[serde(skip)]
    pub plot: Option<Plot>,
}

impl Check {
    /// Nothing measured yet.
    pub fn new(name: &'static str, formula: &'static str, source: &'static str, unit: &'static str) -> Check {
        Check { name, formula, source, expected: 0.0, measured: f64::NAN, tolerance: 0.0, unit, held: false, plot: None }
    }

    /// Compares; a number that is none never holds.
    pub fn compare(self, expected: f64, measured: f64, tolerance: f64) -> Check {
        let scale = if expected == 0.0 { 1.0 } else { expected.abs() };
        Check { expected, measured, tolerance, held: (measured - expected).abs() <= tolerance * scale, ..self }
    }

    /// Adds the course that the number is taken from.
    fn with_plot(self, plot: Plot) -> Check {
        Check { plot: Some(plot), ..self }
    }
}

/// What runs a case on a device.
pub type Run = fn(&Gpu) -> Result<Vec<Check>, SolverError>;

/// A case: its name, and what runs it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Names of its checks begin with this.
    pub name: &'static str,
    /// Seconds on a software adapter; minutes where false.
    pub quick: bool,
    run: Run,
}

impl Case {
    /// See the fields.
    pub const fn new(name: &'static str, quick: bool, run: Run) -> Case {
        Case { name, quick, run }
    }

    /// Runs it.
    pub fn run(&self, gpu: &Gpu) -> Result<Vec<Check>, SolverError> {
        (self.run)(gpu)
    }

    /// What is wrong with how its checks are put: each has a formula, a source and a name of its own, which
    /// begins with that of this case and of no other that it could be taken for.
    pub fn flaw(&self, checks: &[Check]) -> Option<String> {
        let begins = |check: &Check, case: &Case| check.name.starts_with(case.name);
        let fault = |check: &Check| {
            let owner = CASES.iter().filter(|case| begins(check, case)).max_by_key(|case| case.name.len());
            let what = if owner.is_none_or(|owner| owner.name != self.name) {
                "does not begin with the name of its case"
            } else if checks.iter().filter(|other| other.name == check.name).count() > 1 {
                "is not the only one of its name"
            } else if check.formula.is_empty() || check.source.is_empty() {
                "has no formula or no source"
            } else {
                return None;
            };
            Some(format!("{} {what}", check.name))
        };
        if checks.is_empty() { Some(format!("{} checks nothing", self.name)) } else { checks.iter().find_map(fault) }
    }
}

/// Every case, in order.
pub const CASES: &[Case] = &[
    Case { name: "V1", quick: true, run: free::fall },
    Case { name: "V2", quick: true, run: free::momentum },
    Case { name: "V3", quick: true, run: free::angular_momentum },
    Case { name: "V4", quick: true, run: free::spinning_rod },
    Case { name: "V5", quick: false, run: loaded::cantilever },
    Case { name: "V6", quick: false, run: loaded::swing },
    Case { name: "bending bar", quick: true, run: free::bending_bar },
    Case { name: "V7", quick: true, run: loaded::column },
    Case { name: "V8", quick: true, run: waves::bar },
    Case { name: "V9", quick: true, run: rigid::bounce },
    Case { name: "V10", quick: true, run: rigid::incline },
    Case { name: "V11", quick: true, run: sliding::incline },
    Case { name: "V12", quick: true, run: rigid::cradle },
    Case { name: "V13", quick: true, run: grains::incline },
    Case { name: "V13 heap", quick: false, run: grains::repose },
    Case { name: "V13 cohesion", quick: true, run: grains::cohesion },
    Case { name: "V14", quick: false, run: grains::slab },
    Case { name: "V15", quick: false, run: grains::cylinder },
    Case { name: "V16", quick: true, run: pulled::tension },
    Case { name: "large strain", quick: true, run: pulled::large_strain },
    Case { name: "Bingham", quick: true, run: pulled::bingham },
    Case { name: "V17", quick: true, run: flakes::packs },
    Case { name: "muscle", quick: true, run: muscles::shortens },
    Case { name: "V18", quick: true, run: liquid_flow::dam_break },
    Case { name: "film", quick: true, run: films::brake },
    Case { name: "V19", quick: true, run: liquid_rest::hydrostatic },
    Case { name: "V19 sloshing", quick: false, run: liquid_rest::sloshing },
    Case { name: "V20", quick: true, run: liquid_flow::viscous },
    Case { name: "V21", quick: false, run: liquid_rest::swinging },
    Case { name: "V22", quick: true, run: liquid_rest::laplace },
    Case { name: "V26 liquid", quick: true, run: liquid_flow::same_bits },
    Case { name: "V18 SPH", quick: true, run: sph::dam_break },
    Case { name: "V19 SPH", quick: true, run: sph::hydrostatic },
    Case { name: "V20 SPH", quick: true, run: sph::poiseuille },
    Case { name: "V20 SPH held out", quick: true, run: sph_held::viscous },
    Case { name: "V21 SPH", quick: false, run: sph_drops::swinging },
    Case { name: "V22 SPH", quick: true, run: sph_drops::laplace },
    Case { name: "thread", quick: true, run: thick::thread },
    Case { name: "loose", quick: true, run: thick::loose },
    Case { name: "paste", quick: true, run: thick::paste },
    Case { name: "spread", quick: false, run: spread::grid },
    Case { name: "spread SPH", quick: false, run: spread::sph },
    Case { name: "V23", quick: false, run: coupling::floating },
    Case { name: "V23 SPH", quick: false, run: sph::buoyancy },
    Case { name: "V26", quick: true, run: repeat::same_bits },
    Case { name: "drag", quick: true, run: driven::drag },
    Case { name: "spring", quick: true, run: driven::spring },
    Case { name: "swirl", quick: true, run: driven::vortex },
    Case { name: "attractor", quick: true, run: forced::orbit },
    Case { name: "explosion", quick: true, run: forced::blast },
    Case { name: "motor", quick: true, run: forced::motor },
    Case { name: "pin", quick: true, run: forced::pin },
    Case { name: "impact", quick: true, run: forced::impact },
    Case { name: "friction", quick: true, run: forced::friction },
    Case { name: "fields", quick: true, run: driven::same_bits },
    Case { name: "V24", quick: true, run: rigid::into_jelly },
    Case { name: "V24 pairs", quick: true, run: coupling::pairs },
    Case { name: "thin plate", quick: true, run: coupling::plate },
    Case { name: "V25", quick: true, run: rigid::joint },
    Case { name: "stack", quick: false, run: rigid::stack },
    Case { name: "left alone", quick: false, run: captured::left_alone },
    Case { name: "dropped", quick: false, run: captured::dropped },
];
