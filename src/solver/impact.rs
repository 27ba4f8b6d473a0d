//! Looking for impacts: what an object touches at a moment, and what it soon will as far as its speed tells.
//!
//! Looked at between segments, on the host, from where particles are, which comes back for it; a scene that waits for no
//! impact never is.

use super::core::Solver;
use super::obstacles::{self, ColliderRecord};
use super::state::Glance;
use super::types::SolverError;
use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Particles of two objects that touch are about so far from each other, in cells: either is a quarter of one inside
/// its surface, and contact on the grid begins as much before.
const TOUCHING_CELLS: f32 = 0.75;
/// Gaps between objects are measured up to this, in cells.
const NEAR_CELLS: f32 = 1.5;

/// Where everything is at one moment.
#[derive(Debug)]
pub struct Sight {
    cell_m: f32,
    /// The ground first, where there is one.
    colliders: Vec<ColliderRecord>,
    /// Particles of each object.
    bodies: Vec<Body>,
}

#[derive(Debug, Default)]
struct Body {
    /// Position, and distance from a support at which the particle stands on it.
    points: Vec<(Vec3, f32)>,
    velocity_m_s: Vec<Vec3>,
    speed_m_s: f32,
    /// Of free fall and of steady forces.
    acceleration_m_s2: Vec3,
}

impl Body {
    /// How far any particle gets.
    fn reach_m(&self, after_s: f32) -> f32 {
        (self.speed_m_s + 0.5 * self.acceleration_m_s2.length() * after_s) * after_s
    }

    /// Where its particles would be, if nothing stopped them.
    fn after(&self, after_s: f32) -> Vec<(Vec3, f32)> {
        let fall = 0.5 * after_s * after_s * self.acceleration_m_s2;
        self.points.par_iter().zip(&self.velocity_m_s).map(|((x, rest), v)| (*x + after_s * *v + fall, *rest)).collect()
    }
}

impl Solver {
    /// Everything as it is now.
    pub fn sight(&self) -> Result<Sight, SolverError> {
        let mut bodies: Vec<Body> = (0..self.object_count).map(|_| Body::default()).collect();
        for Glance { position_m, velocity_m_s, object, rest_m } in self.buffers[self.current].glance(&self.gpu, self.params.count as usize)? {
            if let Some(body) = bodies.get_mut(object as usize) {
                body.points.push((position_m, rest_m));
                body.velocity_m_s.push(velocity_m_s);
                body.speed_m_s = body.speed_m_s.max(velocity_m_s.length());
            }
        }
        for (object, body) in (0u32..).zip(&mut bodies) {
            let forces = self.settings.forces.iter().filter(|f| f.object == object && self.in_force(f.from_s, f.to_s));
            body.acceleration_m_s2 = self.settings.gravity_m_s2 + forces.map(|f| f.acceleration_m_s2).sum::<Vec3>();
        }
        Ok(Sight { cell_m: self.settings.cell_m, colliders: obstacles::colliders(&self.settings), bodies })
    }
}

impl Sight {
    /// How many things there are to touch: ground, colliders, objects, in this order.
    pub fn things(&self) -> usize {
        self.colliders.len() + self.bodies.len()
    }

    /// Gap between an object and each thing `after_s` from now, in cells; 0 where it stands on it. Infinite for what is
    /// far off, what is not asked for, and itself. Other objects are followed for as long.
    pub fn gaps(&self, object: u32, after_s: f32, asked: impl Fn(usize) -> bool) -> Vec<f32> {
        let Some(body) = self.bodies.get(object as usize).filter(|b| !b.points.is_empty()) else {
            return vec![f32::INFINITY; self.things()];
        };
        let mine = body.after(after_s);
        let to_collider = |c: &ColliderRecord| mine.par_iter().map(|(x, rest)| c.touch(*x).distance_m - rest).reduce(|| f32::INFINITY, f32::min);
        let to_body = |other: &Body| nearest_m(&mine, &other.after(after_s), NEAR_CELLS * self.cell_m);
        let count = self.colliders.len();
        (0..self.things())
            .map(|thing| match thing.checked_sub(count) {
                _ if !asked(thing) => f32::INFINITY,
                None => to_collider(&self.colliders[thing]) / self.cell_m,
                Some(other) if other == object as usize => f32::INFINITY,
                Some(other) => to_body(&self.bodies[other]) / self.cell_m - TOUCHING_CELLS,
            })
            .collect()
    }

    /// Which of `times_s` from now on, in ascending order, is the first at which an object is nearer to anything asked
    /// for than `gap`, in cells, if all goes on as it does.
    pub fn soonest(&self, object: u32, times_s: &[f32], gap: f32, asked: &[bool]) -> Option<usize> {
        let last_s = *times_s.last()?;
        let body = self.bodies.get(object as usize)?;
        let count = self.colliders.len();
        // Only what it can reach at all in that time.
        let now = self.gaps(object, 0.0, |thing| thing < count && asked[thing]);
        let near = |thing: usize| match thing.checked_sub(count) {
            _ if !asked[thing] => false,
            None => now[thing] * self.cell_m < body.reach_m(last_s) + gap * self.cell_m,
            Some(other) => {
                let other = &self.bodies[other];
                apart_m(&body.points, &other.points) < body.reach_m(last_s) + other.reach_m(last_s) + NEAR_CELLS * self.cell_m
            }
        };
        let near: Vec<bool> = (0..self.things()).map(near).collect();
        if !near.contains(&true) {
            return None;
        }
        times_s.iter().position(|&after_s| self.gaps(object, after_s, |thing| near[thing]).iter().any(|g| *g < gap))
    }
}

fn bounds(points: &[(Vec3, f32)]) -> (Vec3, Vec3) {
    points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (x, _)| (low.min(*x), high.max(*x)))
}

/// Distance of the boxes around two sets of points.
fn apart_m(a: &[(Vec3, f32)], b: &[(Vec3, f32)]) -> f32 {
    let (a, b) = (bounds(a), bounds(b));
    (b.0 - a.1).max(a.0 - b.1).max(Vec3::ZERO).length()
}

/// Distance of the nearest two points of two sets; infinite where it is over `most_m`.
fn nearest_m(a: &[(Vec3, f32)], b: &[(Vec3, f32)], most_m: f32) -> f32 {
    // Infinitely far where a set is empty.
    if apart_m(a, b) > most_m {
        return f32::INFINITY;
    }
    let (low, high) = bounds(a);
    let cell = |x: Vec3| ((x - low) / most_m).floor().as_ivec3();
    let room = Vec3::splat(most_m);
    let mut cells: HashMap<IVec3, Vec<Vec3>> = HashMap::new();
    for (x, _) in b.iter().filter(|(x, _)| x.cmpge(low - room).all() && x.cmple(high + room).all()) {
        cells.entry(cell(*x)).or_default().push(*x);
    }
    let near = |x: &Vec3| {
        let at = cell(*x);
        let around = (0..27).map(move |k| at + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
        around.filter_map(|c| cells.get(&c)).flatten().map(|y| x.distance(*y)).fold(f32::INFINITY, f32::min)
    };
    let least_m = a.par_iter().map(|(x, _)| near(x)).reduce(|| f32::INFINITY, f32::min);
    if least_m <= most_m { least_m } else { f32::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_points_are_those_of_all_pairs() {
        let set = |seed: u32, shift: f32| -> Vec<(Vec3, f32)> {
            let value = |i: u32| ((i.wrapping_mul(2_654_435_761) ^ seed.wrapping_mul(40_503)) % 1000) as f32 * 1e-3;
            (0..60).map(|i| (Vec3::new(value(3 * i) + shift, value(3 * i + 1), value(3 * i + 2)), 0.0)).collect()
        };
        for (seed, shift) in [(1, 0.0), (2, 0.9), (3, 1.1), (4, -1.05), (5, 3.0)] {
            let (a, b) = (set(seed, 0.0), set(seed + 100, shift));
            let all = a.iter().flat_map(|(x, _)| b.iter().map(move |(y, _)| x.distance(*y))).fold(f32::INFINITY, f32::min);
            let expected = if all <= 0.3 { all } else { f32::INFINITY };
            assert_eq!(nearest_m(&a, &b, 0.3), expected, "seed {seed}");
        }
        assert_eq!(nearest_m(&[], &set(1, 0.0), 0.3), f32::INFINITY);
    }
}
