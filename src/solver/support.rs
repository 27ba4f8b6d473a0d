//! What carries what in a captured scene: surfaces and pins, and whatever these carry.

use super::constants::{REST_CELLS, REST_CELLS_MAX};
use super::core::Solver;
use super::obstacles::{self, distance_m};
use super::state::ParticleState;
use glam::{IVec3, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// Share of an object's height, from its lowest point, that counts as the base it stands on.
const BASE_SHARE: f32 = 0.03;

/// Which objects of a captured scene are carried.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Support {
    /// Those that something carries.
    pub carried: Vec<u32>,
    /// Those that nothing carries, and how high they hang over what is below them, metres.
    pub hanging: Vec<(u32, f32)>,
}

impl Solver {
    /// Which of some objects are carried: what is within a cell of a surface or held by a pin, and what is within a cell of
    /// matter that is carried and can stand.
    pub(super) fn support(&self, states: &[ParticleState], objects: &[u32]) -> Support {
        let colliders = obstacles::colliders(&self.settings);
        let mut gaps_m: BTreeMap<u32, f32> = objects.iter().map(|&object| (object, f32::INFINITY)).collect();
        for state in states {
            if let Some(gap_m) = gaps_m.get_mut(&state.object()) {
                *gap_m = gap_m.min(distance_m(&colliders, state.position_m));
            }
        }
        let stands = |object: &u32| gaps_m[object] <= self.rest_most_m() || self.is_pinned(*object);
        let (mut carried, mut open): (Vec<u32>, Vec<u32>) = objects.iter().partition(|object| stands(object));
        let beside = self.beside(states, &open);
        let lies_on = |object: &u32, carried: &[u32]| beside.get(object).is_some_and(|others| others.iter().any(|other| carried.contains(other)));
        loop {
            let (next, left): (Vec<u32>, Vec<u32>) = open.iter().partition(|object| lies_on(object, &carried));
            if next.is_empty() {
                break;
            }
            (carried, open) = ([carried, next].concat(), left);
        }
        Support { carried, hanging: open.iter().map(|object| (*object, gaps_m[object])).collect() }
    }

    /// Lets what stands within a cell of a surface stand on it exactly.
    pub(super) fn settle_offsets(&self, states: &mut [ParticleState], objects: &[u32]) {
        let (cell_m, colliders) = (self.settings.cell_m, obstacles::colliders(&self.settings));
        for &object in objects {
            let own = |s: &&ParticleState| s.object() == object;
            let lowest_m = states.iter().filter(own).map(|s| distance_m(&colliders, s.position_m)).fold(f32::INFINITY, f32::min);
            if lowest_m > self.rest_most_m() {
                continue;
            }
            let most_m = (REST_CELLS * cell_m).max(lowest_m + 0.01 * cell_m);
            // A captured base is never quite flat: all of it stands, not its lowest grain alone.
            let base_m = most_m.max((BASE_SHARE * height_m(states, object)).min(self.rest_most_m()));
            for state in states.iter_mut().filter(|s| s.object() == object) {
                let distance_m = distance_m(&colliders, state.position_m);
                state.rest_m = if distance_m <= base_m { distance_m } else { most_m }.max(-2.0 * REST_CELLS * cell_m);
            }
        }
    }

    /// What is no farther from what carries it than this stands on it.
    fn rest_most_m(&self) -> f32 {
        REST_CELLS_MAX * self.settings.cell_m
    }

    /// Whether a pin holds any of an object now.
    fn is_pinned(&self, object: u32) -> bool {
        let pins = self.settings.pins.iter().zip(&self.grips);
        pins.into_iter().any(|(pin, grip)| grip.holds_of(object) && self.in_force(pin.from_s, pin.to_s))
    }

    /// For each of some objects, the others with matter that can stand within a cell of its own.
    fn beside(&self, states: &[ParticleState], objects: &[u32]) -> BTreeMap<u32, BTreeSet<u32>> {
        if objects.is_empty() {
            return BTreeMap::new();
        }
        let reach_m = self.rest_most_m();
        let cell_of = |x: Vec3| (x / reach_m).floor().as_ivec3();
        let mut firm: BTreeMap<[i32; 3], Vec<&ParticleState>> = BTreeMap::new();
        for state in states.iter().filter(|s| self.laws.substances[s.substance()].can_stand()) {
            firm.entry(cell_of(state.position_m).to_array()).or_default().push(state);
        }
        let mut beside: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for state in states.iter().filter(|s| objects.contains(&s.object())) {
            let cell = cell_of(state.position_m);
            let around = (0..27).filter_map(|k| firm.get(&(cell + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)).to_array()));
            let near = around.flatten().filter(|other| other.object() != state.object() && other.position_m.distance(state.position_m) <= reach_m);
            beside.entry(state.object()).or_default().extend(near.map(|other| other.object()));
        }
        beside
    }
}

/// Extent of an object along z.
fn height_m(states: &[ParticleState], object: u32) -> f32 {
    let heights = states.iter().filter(|s| s.object() == object).map(|s| s.position_m.z);
    let (low, high) = heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    (high - low).max(0.0)
}
