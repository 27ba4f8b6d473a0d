//! What flies apart farther than the grid can hold is left behind: it weighs nothing any more, is not seen, and asks for no
//! grid. The rest goes on as if it had never been.

use super::core::Solver;
use super::grid::Window;
use super::laws::Rows;
use super::rigid;
use super::state::ParticleState;
use super::types::{Advance, Left, SolverError};
use glam::{IVec3, Vec3};

/// Share of what a window can hold that is kept around the middle, so that the next to leave is a while off.
const KEPT_SHARE: f32 = 0.75;
/// Share of the blocks that fit which those who stay take, where it is not their distance that asks for too many.
const FILLED_SHARE: f64 = 0.5;

impl Solver {
    /// Leaves behind who is too far from where most of the mass is, where a grid with such a margin has no room. Whether
    /// anyone was; what is too large from the start is for its author to mend.
    pub(super) fn leave_behind(&mut self, error: &SolverError, margin: i32, report: &mut Advance) -> Result<bool, SolverError> {
        let SolverError::TooWide { nodes, allowed, .. } = error else { return Ok(false) };
        if self.time_s <= 0.0 {
            return Ok(false);
        }
        let mut states = self.states()?;
        let away_m = self.away_m(&states);
        let mut reach_m = KEPT_SHARE * self.window_reach(margin) as f32 * self.settings.cell_m;
        if away_m.iter().all(|away| *away <= reach_m) {
            // All would fit a window, of which there are too many blocks: as many as fit stay, those nearest.
            let mut sorted = away_m.clone();
            sorted.sort_by(f32::total_cmp);
            let stay = (FILLED_SHARE * *allowed as f64 / *nodes as f64 * sorted.len() as f64) as usize;
            reach_m = sorted.get(stay).copied().unwrap_or(0.0);
        }
        let mut leaves = 0;
        for (state, away_m) in states.iter_mut().zip(away_m).filter(|(_, away)| *away > reach_m) {
            let left = report.left.entry(state.object()).or_default();
            *left = Left { particles: left.particles + 1, away_m: left.away_m.max(away_m) };
            (leaves, *state) = (leaves + 1, state.left());
        }
        tracing::debug!(time_s = self.time_s, leaves, reach_m, "left behind");
        if leaves == 0 {
            return Ok(false);
        }
        if self.rigid.is_some() {
            let mut unstressed: Vec<Rows> = self.gpu.read(&self.unstressed, states.len())?;
            self.reassemble(&mut states, &mut unstressed)?;
            self.gpu.upload(&self.unstressed, &unstressed);
        }
        self.set_layers(&states)?;
        self.replace(states);
        Ok(true)
    }

    /// How many cells from its middle, along each axis, a window reaches that has room around it.
    fn window_reach(&self, margin: i32) -> i32 {
        let most = self.spread_most() / u64::from(self.params.layers);
        let fits = |reach: i32| Window::around(IVec3::splat(-reach), IVec3::splat(reach), margin).block_count() <= most;
        let (mut low, mut high) = (0, 1 << 16);
        while high - low > 1 {
            let middle = (low + high) / 2;
            if fits(middle) { low = middle } else { high = middle }
        }
        low
    }

    /// How far each particle is from the one that is nearest to the median of the mass, along the axis where that is most; a
    /// body goes by its centre, and whatever has left already is not away.
    fn away_m(&self, states: &[ParticleState]) -> Vec<f32> {
        let median = Vec3::from_array([0, 1, 2].map(|axis| median(states, axis)));
        let off = |x: Vec3| (x - median).abs().max_element();
        let here = |s: &&ParticleState| !s.has_left() && s.position_m.is_finite();
        let middle = states.iter().filter(here).map(|s| s.position_m).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(median);
        let away = |x: Vec3| (x - middle).abs().max_element();
        let mut away_m: Vec<f32> = states.iter().map(|s| if here(&s) { away(s.position_m) } else { 0.0 }).collect();
        for members in self.rigid.iter().flat_map(rigid::Rigid::members) {
            let centre = members.iter().map(|&i| states[i].position_m.as_dvec3()).sum::<glam::DVec3>() / members.len() as f64;
            let whole = away(centre.as_vec3());
            members.into_iter().for_each(|i| away_m[i] = away_m[i].max(whole));
        }
        away_m
    }
}

/// The place along an axis below which half the mass lies.
fn median(states: &[ParticleState], axis: usize) -> f32 {
    let here = states.iter().filter(|s| !s.has_left() && s.position_m.is_finite());
    let mut places: Vec<(f32, f64)> = here.map(|s| (s.position_m[axis], f64::from(s.mass_kg))).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * places.iter().map(|(_, kg)| kg).sum::<f64>();
    let mut below = 0.0;
    let at = places.iter().find(|(_, kg)| {
        below += kg;
        below >= half
    });
    at.map_or(0.0, |(x, _)| *x)
}
