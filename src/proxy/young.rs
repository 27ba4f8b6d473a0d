//! `young_pa = "auto"`: soft enough to be seen moving, stiff enough that the captured thing stands.
//!
//! A column of volume V and height h stands under its own weight while V h^2 <= 7.84 E I / (rho g),
//! which for a round one of radius r is h^3 <= 7.84 E r^2 / (4 rho g) (Greenhill 1881). A stem that reaches
//! out sideways as far bends at its tip by V h^2 rho g / (6 E I), and twists out of its plane at some 1.3 times
//! Greenhill's bound (Prandtl 1899): what it takes for one, with the safety factor, does for the other, and
//! lets it bend by a third of a radian. Every cut across the way from the base leaves parts that hang on it
//! ([`sections`]); each part gives its sections' bound, and the object gets [`SAFETY`] times the largest bound
//! of its major parts. Slender details that need more, a thin shoot, a tendril or the stems of a bouquet, get it
//! for themselves.

use super::grid::Grid;
use super::sections::{Cut, Sections};
use crate::scene::Gaussians;

/// Standard gravity, whatever the spec's is: the object stood on Earth when it was captured.
const CAPTURE_GRAVITY_M_S2: f64 = 9.81;
/// How far above the bound: the thing still stands after one "softer".
const SAFETY: f64 = 4.0;
/// Softest and stiffest automatic value of a whole object, Pa.
const RANGE_PA: (f64, f64) = (5e4, 8e5);
/// Stiffest local value, Pa: beyond it a few thin stems would set everyone's time step.
const LOCAL_MOST_PA: f64 = 2e6;
/// Share of the solid from which a part is a major one.
const MAJOR_SHARE: f64 = 0.02;
/// What needs more than this over its weight is a thread: [`LOCAL_MOST_PA`] at the density of water.
const THREAD_M: f64 = LOCAL_MOST_PA / (1000.0 * CAPTURE_GRAVITY_M_S2);
/// And more than this over its reach too, whatever the scale of the scene: a square stem nine times as long as
/// thick.
const THREAD_SLENDERNESS: f64 = 500.0;
/// Share of what it takes to stand firmly with which a place bears what it carries and sways at a touch: twice the bound.
pub const BEARING: f64 = 2.0 / SAFETY;
/// A local value within this factor of the object's is not worth a difference.
const NOTABLE: f64 = 1.05;

/// How stiff an object has to be to stand, over its weight: E = density * g * this, metres. It follows
/// from the Gaussians alone, not from a solver's cell or a quality.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stance {
    /// Of its major parts.
    pub whole_m: f64,
    /// Where each Gaussian is.
    pub local_m: Vec<f32>,
    /// The most of what that is on the way from the base to where each Gaussian is. A column that is everywhere just as stiff as what it
    /// carries there asks for buckles under an eighth of Greenhill's load: stems are as stiff at their tips as at their feet.
    pub from_base_m: Vec<f32>,
}

/// The automatic stiffness of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct YoungAuto {
    /// Of the whole object, Pa.
    pub value_pa: f64,
    /// Of each Gaussian: `value_pa`, or more where a slender part needs it.
    pub local: Vec<f32>,
    /// What it takes to stand firmly at each Gaussian's place and between that and the base, Pa, whatever the rest is.
    pub needs_pa: Vec<f32>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// What the user may like to know.
    pub notes: Vec<String>,
}

/// Measures the solid that an object's Gaussians make.
pub(super) fn stance(gaussians: &Gaussians, grid: &Grid, sections: &Sections) -> Stance {
    let total_m3 = sections.volume_m3();
    let mut whole_m = 0.0f64;
    let mut of_section = vec![0.0f64; sections.count()];
    let cuts = sections.cuts();
    for cut in &cuts {
        let column = column_m(cut);
        if cut.volume_m3 >= MAJOR_SHARE * total_m3 {
            whole_m = whole_m.max(column);
        }
        for &section in &cut.sections {
            of_section[section as usize] = column;
        }
    }
    let mut from_base = of_section.clone();
    for &section in cuts.iter().rev().flat_map(|cut| &cut.sections) {
        for &beyond in sections.beyond(section) {
            from_base[beyond as usize] = from_base[beyond as usize].max(from_base[section as usize]);
        }
    }
    let section: Vec<Option<u32>> = gaussians.mean.iter().map(|&p| sections.at(grid, p)).collect();
    let at = |of_section: &[f64]| section.iter().map(|s| s.map_or(0.0, |s| of_section[s as usize] as f32)).collect();
    Stance { whole_m, local_m: at(&of_section), from_base_m: at(&from_base) }
}

/// Chooses the stiffness of an object of this density; the spec's gravity is not asked.
pub fn young_auto(stance: &Stance, density_kg_m3: f64) -> YoungAuto {
    let weight_n_m3 = density_kg_m3 * CAPTURE_GRAVITY_M_S2;
    let needed_pa = weight_n_m3 * stance.whole_m;
    let value_pa = needed_pa.clamp(RANGE_PA.0, RANGE_PA.1);
    let needs: Vec<f64> = stance.local_m.iter().map(|&m| weight_n_m3 * f64::from(m)).collect();
    let local = needs.iter().map(|&need| if need > NOTABLE * value_pa { need.min(LOCAL_MOST_PA) as f32 } else { value_pa as f32 }).collect();
    let needs_pa = stance.from_base_m.iter().map(|&m| (weight_n_m3 * f64::from(m)).min(LOCAL_MOST_PA) as f32).collect();
    YoungAuto { value_pa, local, needs_pa, warnings: warnings(value_pa, needed_pa), notes: notes(value_pa, &needs) }
}

/// Lets go of threads that no stiffness that is chosen makes stand: they would droop or curl up, however
/// little they weigh. What they are part of does not: it is what it is. How many there are.
pub(super) fn let_go_of_threads(sections: &mut Sections) -> usize {
    let most_m3 = MAJOR_SHARE * sections.volume_m3();
    let cuts = sections.cuts();
    let too_slender = |cut: &&Cut| {
        let column_m = column_m(cut);
        cut.volume_m3 < most_m3 && column_m > THREAD_M && column_m > THREAD_SLENDERNESS * cut.reach_m
    };
    // From the base on: what hangs on one that is let go goes with it.
    let mut threads = 0;
    for cut in cuts.iter().rev().filter(too_slender) {
        if !cut.sections.iter().all(|&id| sections.is_out(id)) {
            sections.leave_out(cut);
            threads += 1;
        }
    }
    threads
}

/// Greenhill's bound of what a cut carries, with the safety factor, over its weight.
fn column_m(cut: &Cut) -> f64 {
    SAFETY * cut.volume_m3 * cut.reach_m.powi(2) / (7.84 * cut.moment_m4)
}

fn warnings(value_pa: f64, needed_pa: f64) -> Vec<String> {
    let short = needed_pa > value_pa;
    let text = || {
        format!(
            "it is so slender that it may sway and sag once it moves: to stand with room to spare it would need a stiffness of {}, and {} is the \
             most that is chosen unasked; \"stiffness {}\" gives it more",
            pascals(needed_pa),
            pascals(value_pa),
            pascals(needed_pa)
        )
    };
    short.then(text).into_iter().collect()
}

fn notes(value_pa: f64, needs: &[f64]) -> Vec<String> {
    let stiffened = needs.iter().filter(|&&need| need > NOTABLE * value_pa).count();
    let most = needs.iter().copied().fold(0.0, f64::max).min(LOCAL_MOST_PA);
    let share = 100.0 * stiffened as f64 / needs.len().max(1) as f64;
    let text = || {
        format!(
            "its automatic stiffness is {}, and up to {} in slender parts that need it to stand ({share:.1} % of the Gaussians)",
            pascals(value_pa),
            pascals(most)
        )
    };
    (stiffened > 0).then(text).into_iter().collect()
}

/// "694 kPa"
pub fn pascals(value: f64) -> String {
    if value >= 1e6 { format!("{:.1} MPa", value / 1e6) } else { format!("{:.0} kPa", value / 1e3) }
}
