//! Bound on the work of a run that makes no progress: how often a frame may be retried, and how many segments in a row may be
//! given up.
//!
//! Every remedy of `retry.rs` is bounded within one segment. A segment may be as short as one substep, though, and time passes
//! over one that is given up (`mend.rs`), so without a bound of its own a run could retry for ever. The counts are part of
//! `Wary`, hence of every checkpoint, and no clock is read: a run ends at the same retry on every machine.

use super::core::Solver;
use super::retry::Tries;
use super::types::SolverError;

/// Failed tries of one frame. All remedies of one segment together are 24 tries (room 3, fixed point 5, higher speed 2, halvings
/// 3, softenings 6, rest 1, and some for room that the device lacks), so about ten segments of a frame may each need all of
/// them. Chosen: below 24 one hard impact would end a run; a frame of 256 retries takes seconds on two CPU cores.
pub(super) const FRAME_RETRIES_MOST: u32 = 256;
/// Segments in a row that are given up, with no substep held between them. Chosen: matter that was brought to rest without strain
/// either moves on at the next segment or never; one segment alone would end runs that one bad overlap stops for an instant.
pub(super) const GIVEN_UP_MOST: u32 = 8;

impl Solver {
    /// Counts a failed try; an error where the frame has had all of its retries.
    pub(super) fn count_retry(&mut self, tries: &Tries) -> Result<(), SolverError> {
        self.wary.retries += 1;
        if self.wary.retries > FRAME_RETRIES_MOST { Err(self.no_progress(tries)) } else { Ok(()) }
    }

    /// Counts a segment that no remedy saved; an error where too many of them follow each other.
    pub(super) fn count_given_up(&mut self, tries: &Tries) -> Result<(), SolverError> {
        self.wary.given_up += 1;
        if self.wary.given_up >= GIVEN_UP_MOST { Err(self.no_progress(tries)) } else { Ok(()) }
    }

    fn no_progress(&self, tries: &Tries) -> SolverError {
        SolverError::NoProgress { time_s: self.time_s, retries: self.wary.retries, given_up: self.wary.given_up, reason: tries.reason.clone() }
    }
}
