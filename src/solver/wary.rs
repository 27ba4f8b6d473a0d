//! What trouble teaches a run: for some frames after a segment failed, those that follow start where it ended up.
//!
//! It is part of the state, so that a run that goes on from a checkpoint does as one that was never interrupted.

use super::constants::{FIXED_BITS, FIXED_BITS_RETREAT};
use super::core::Solver;
use bytemuck::{Pod, Zeroable};

/// Substeps are halved this often at most.
pub(super) const HALVINGS: u32 = 3;
/// Bits of the fixed point that are given up at most: a node may then hold a thousand times as much.
const BITS_MOST: u32 = 5 * FIXED_BITS_RETREAT;
/// Frames without trouble after which a lesson is forgotten.
const CALM_FRAMES: u32 = 8;

/// What was learnt. All zeros where there never was trouble, or none for long.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Wary {
    /// Substeps are so often half as long as the Courant number asks.
    pub halvings: u32,
    /// Bits of the fixed point given up.
    pub bits: u32,
    /// Whole frames since the last trouble.
    calm: u32,
    /// Whether there was trouble in the present frame.
    troubled: u32,
    /// Failed tries of the present frame, see `retry_budget.rs`.
    pub retries: u32,
    /// Segments given up since one held, see `retry_budget.rs`.
    pub given_up: u32,
}

impl Wary {
    /// A segment failed.
    pub fn trouble(&mut self) {
        self.troubled = 1;
    }

    /// Gives up some bits of the fixed point; false where none are left to give.
    pub fn widen(&mut self) -> bool {
        let may = self.bits < BITS_MOST;
        self.bits += if may { FIXED_BITS_RETREAT } else { 0 };
        may
    }

    /// A frame ended.
    pub fn frame_ends(&mut self) {
        self.calm = if self.troubled != 0 || (self.halvings, self.bits) == (0, 0) { 0 } else { self.calm + 1 };
        (self.troubled, self.retries) = (0, 0);
        if self.calm == CALM_FRAMES {
            *self = Wary { halvings: self.halvings.saturating_sub(1), bits: self.bits.saturating_sub(FIXED_BITS_RETREAT), calm: 0, ..*self };
        }
    }
}

/// Fixed-point units of a kilogram where the heaviest particle has so much mass; a finite number whatever the mass is.
pub(super) fn mass_units(heaviest_kg: f32, bits: u32) -> f32 {
    let exponent = ((FIXED_BITS - bits) as i32).saturating_sub(heaviest_kg.log2().ceil() as i32);
    2f32.powi(exponent.clamp(f32::MIN_EXP, f32::MAX_EXP - 1))
}

impl Solver {
    /// Takes a lesson to heart.
    pub(super) fn set_wary(&mut self, wary: Wary) {
        self.wary = wary;
        self.params.momentum_bits = FIXED_BITS - wary.bits;
        self.params.mass_units = mass_units(self.heaviest_kg, wary.bits);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lessons_last_some_frames_and_leave_nothing() {
        let mut wary = Wary::default();
        wary.frame_ends();
        assert_eq!(wary, Wary::default());
        wary.trouble();
        wary.halvings = 1;
        assert!(wary.widen());
        for _ in 0..CALM_FRAMES {
            wary.frame_ends();
            assert_eq!((wary.halvings, wary.bits), (1, FIXED_BITS_RETREAT));
        }
        wary.frame_ends();
        assert_eq!(wary, Wary::default());
        assert_eq!((0..10).filter(|_| wary.widen()).count() as u32, BITS_MOST / FIXED_BITS_RETREAT);
    }
}
