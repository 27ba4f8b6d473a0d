//! Events that wait for an impact: the first time that their object meets something that it did not touch before.
//!
//! Found by the run itself, from where things are: before each frame, and within one at each of a few moments at which
//! they would touch if all went on as it does. What is found is part of the state, so that a run that goes on from a
//! checkpoint knows it.

use super::event::TimedEvent;
use crate::solver::Sight;
use serde::{Deserialize, Serialize};

/// Moments of a frame at which an impact may be found.
pub(super) const LOOKS: u32 = 16;
/// Gap below which things touch, in cells.
const TOUCHING: f32 = 0.1;
/// Gap above which what touched has parted, in cells.
const PARTED: f32 = 0.5;

/// An event that waits.
#[derive(Clone, Debug)]
pub(super) struct Waiting {
    pub event: TimedEvent,
    pub state: State,
}

/// How far it has come.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    /// The things that its object has been clear of.
    parted: Vec<bool>,
    /// When it happened.
    pub fired_s: Option<f64>,
}

impl Waiting {
    pub fn new(event: TimedEvent) -> Waiting {
        Waiting { event, state: State::default() }
    }

    /// Looks at where things are; whether its object touches something that it was clear of.
    pub fn meets(&mut self, sight: &Sight) -> bool {
        let gaps = sight.gaps(self.event.object, 0.0, |_| true);
        self.state.parted.resize(gaps.len(), false);
        let met = gaps.iter().zip(&self.state.parted).any(|(gap, parted)| *parted && *gap < TOUCHING);
        self.state.parted.iter_mut().zip(&gaps).for_each(|(parted, gap)| *parted |= *gap > PARTED);
        met
    }

    /// Which of some times from now on it has to look at next.
    pub fn soonest(&self, sight: &Sight, times_s: &[f32]) -> Option<usize> {
        sight.soonest(self.event.object, times_s, TOUCHING, &self.state.parted)
    }
}
