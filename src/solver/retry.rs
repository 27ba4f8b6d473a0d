//! What is done about a segment that failed: more room, shorter substeps, softer matter, in the order of what they cost, and
//! in the end what [`super::mend`] does.

use super::advance::Plan;
use super::budget;
use super::core::Solver;
use super::types::SolverError;
use super::wary::HALVINGS;
use super::watch::Watch;

/// A material is softened this often in a segment, to a 4096th.
const SOFTENINGS: u32 = 6;
/// A segment's window gets so many times the room that it should need at most.
const ROOM_MOST: i32 = 8;

/// How often one segment was tried.
pub(super) struct Tries {
    /// The window's margin is so many times what it should need.
    pub room: i32,
    /// At most so many: less where the device has not that much.
    pub room_most: i32,
    softenings: u32,
    /// Whether what is suspect was calmed.
    pub calmed: bool,
    /// Failures that more room did not mend.
    pub trips: u32,
    /// Why the last try failed; empty before the first has.
    pub reason: String,
}

impl Default for Tries {
    fn default() -> Tries {
        Tries { room: 1, room_most: ROOM_MOST, softenings: 0, calmed: false, trips: 0, reason: String::new() }
    }
}

/// How a segment that failed is run again.
pub(super) enum WayOn {
    /// With more room for something, or substeps for a higher speed.
    Wider,
    /// In substeps half as long.
    Shorter,
    /// With softer matter.
    Softer,
    /// None of them helps.
    None,
}

impl Solver {
    /// Halves the substeps of what spreads farther than there is room for: shorter ones may not come to that. Whether they
    /// could be halved.
    pub(super) fn shorten(&mut self, error: &SolverError, tries: &mut Tries) -> bool {
        tracing::debug!(time_s = self.time_s, %error, "too much room");
        self.wary.trouble();
        tries.trips += 1;
        let may = self.wary.halvings < HALVINGS;
        self.wary.halvings += u32::from(may);
        may
    }

    /// Whether substeps half as long are worth their cost.
    fn may_halve(&self, plan: &Plan) -> bool {
        let affordable = self.wary.halvings == 0 || f64::from(plan.dt_s) >= budget::shortest_s(&self.settings);
        self.wary.halvings < HALVINGS && affordable
    }

    /// Whether nothing is wrong with a segment but shapes that nothing else puts right. Of what is merely inside out, which
    /// its law does not follow, softer matter would make no difference.
    pub(super) fn is_mendable(&self, now: &Watch, plan: &Plan, travel_m: f32, tries: &Tries) -> bool {
        let tried = tries.calmed || now.has_sound_volumes();
        let reshaped = Watch { inside_out: 0, j_low: 1.0, j_high: 1.0, ..*now };
        tried && !self.may_halve(plan) && reshaped.trip(plan.dt_s, plan.sort_every, self.settings.cell_m, travel_m).is_none()
    }

    /// What is done about a segment that failed. Room costs little; substeps half as long cost as many again, which
    /// is worth it while a frame's budget lasts; beyond that what cannot be resolved is softened, at the same cost.
    pub(super) fn way_on(&mut self, now: &Watch, plan: &Plan, faster: bool, tries: &mut Tries) -> Result<WayOn, SolverError> {
        // Wider sums are no matter of the time step, where nothing else is wrong.
        if now.overflow && self.wary.widen() {
            self.set_wary(self.wary);
            if f64::from(now.peak_speed_m_s * plan.dt_s) <= f64::from(self.settings.cell_m) {
                return Ok(WayOn::Wider);
            }
        }
        // Nor is it known yet whether substeps for the speed that things came to do.
        if faster && tries.trips <= 2 {
            return Ok(WayOn::Wider);
        }
        Ok(match () {
            _ if self.may_halve(plan) => WayOn::Shorter,
            _ if tries.softenings < SOFTENINGS => {
                tries.softenings += 1;
                WayOn::Softer
            }
            _ => WayOn::None,
        })
    }

    /// Softens the suspect objects, or all where none stands out.
    pub(super) fn soften(&mut self, suspects: u32, reason: &str) -> Result<(), SolverError> {
        let mut states = self.states()?;
        let suspect = |object: u32| suspects == 0 || suspects >> (object & 31) & 1 != 0;
        let mut substances = self.laws.substances.clone();
        self.softened.extend(budget::soften(&mut states, &mut substances, suspect, self.time_s, reason));
        self.set_substances(&substances)?;
        self.replace(states);
        Ok(())
    }
}
