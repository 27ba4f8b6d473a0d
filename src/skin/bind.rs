//! Which particles each Gaussian follows, and how much.

use super::neighbours::{Nearest, Tree, nearest_of_all};
use crate::spec::{Skin, Weights};
use glam::Vec3;
use std::collections::BTreeMap;

/// The object of a Gaussian that nothing moves, and the particle such a Gaussian follows.
pub const STATIC: u32 = u32::MAX;

/// The paper's epsilon, m²: it keeps a Gaussian that lies on a particle from dividing by zero. The
/// paper gives no value; a tenth of a millimetre, squared, is far below any spacing of particles.
const PAPER_EPSILON_M2: f64 = 1e-8;

/// The particles that Gaussians follow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bound {
    /// K, how many particles each Gaussian follows.
    pub neighbours: u32,
    /// K particle indices a Gaussian, nearest first; all [`STATIC`] where it follows none.
    pub index: Vec<u32>,
    /// K weights a Gaussian that add up to 1; zeros where it follows none.
    pub weight: Vec<f32>,
    /// Gaussians of threads too thin to be matter, ascending, and where each thread is held, metres, world: they go and turn with
    /// what is there, as if stiff.
    pub hung: Vec<(u32, Vec3)>,
}

impl Bound {
    /// Where the thread that a Gaussian belongs to is held.
    pub(super) fn held_at(&self, gaussian: u32) -> Option<Vec3> {
        self.hung.binary_search_by_key(&gaussian, |hung| hung.0).ok().map(|at| self.hung[at].1)
    }
}

/// Binds each Gaussian to the K nearest particles of its own object, in the captured pose.
///
/// `means` and `particles` are in metres in one frame. A Gaussian whose object is [`STATIC`] or has no
/// particles follows none. An object with fewer than K particles fills up with weight 0.
pub fn bind(means: &[Vec3], object_of: &[u32], particles: &[Vec3], particle_object: &[u32], skin: &Skin) -> Bound {
    let k = skin.neighbours.clamp(1, 16) as usize;
    let mut bound = Bound { neighbours: k as u32, index: vec![STATIC; means.len() * k], weight: vec![0.0; means.len() * k], hung: Vec::new() };
    for (object, tree) in trees(particles, particle_object) {
        let members: Vec<usize> = (0..means.len()).filter(|&g| object_of[g] == object).collect();
        let centres: Vec<Vec3> = members.iter().map(|&g| means[g]).collect();
        for (nearest, g) in nearest_of_all(&tree, &centres, k + 1).iter().zip(members) {
            let slots = g * k..(g + 1) * k;
            fill(nearest, skin.weights, &mut bound.index[slots.clone()], &mut bound.weight[slots]);
        }
    }
    bound
}

/// One tree an object, by ascending object.
fn trees(particles: &[Vec3], particle_object: &[u32]) -> BTreeMap<u32, Tree> {
    let mut points: BTreeMap<u32, Vec<(Vec3, u32)>> = BTreeMap::new();
    for (i, (&position, &object)) in particles.iter().zip(particle_object).enumerate() {
        points.entry(object).or_default().push((position, i as u32));
    }
    points.into_iter().map(|(object, points)| (object, Tree::new(points))).collect()
}

/// Writes the K indices and weights of one Gaussian.
fn fill(nearest: &Nearest, weights: Weights, index: &mut [u32], weight: &mut [f32]) {
    let found = nearest.found();
    let used = &found[..found.len().min(index.len())];
    let Some(&(_, first)) = used.first() else { return };
    let raw = match weights {
        Weights::Exact => compact(used, found.get(index.len()).map(|f| f.0)),
        Weights::Paper => used.iter().map(|&(d2, _)| 1.0 / (f64::from(d2) + PAPER_EPSILON_M2)).collect(),
    };
    let sum: f64 = raw.iter().sum();
    index.fill(first);
    for (slot, &(_, particle)) in used.iter().enumerate() {
        index[slot] = particle;
        weight[slot] = if sum > 0.0 { (raw[slot] / sum) as f32 } else { 1.0 / used.len() as f32 };
    }
}

/// w = (1 - d²/r²)³ with r the distance of the next particle: a neighbour fades to nothing before it
/// is replaced, so the weights have no seams. An object that has no next particle is always followed
/// whole, and any r beyond its farthest serves.
fn compact(used: &[(f32, u32)], next: Option<f32>) -> Vec<f64> {
    let farthest = used.last().map_or(0.0, |u| f64::from(u.0));
    let r2 = next.map_or(4.0 * farthest, f64::from);
    used.iter().map(|&(d2, _)| if r2 > 0.0 { (1.0 - f64::from(d2) / r2).max(0.0).powi(3) } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(count: u32) -> Vec<Vec3> {
        (0..count).map(|i| Vec3::X * i as f32).collect()
    }

    #[test]
    fn follows_only_particles_of_its_own_object() {
        let particles = line(20);
        let objects: Vec<u32> = (0..20).map(|i| i % 2).collect();
        let means = [Vec3::X * 7.2, Vec3::X * 7.2, Vec3::X * 7.2];
        let bound = bind(&means, &[0, 1, STATIC], &particles, &objects, &Skin { neighbours: 4, weights: Weights::Exact });
        assert!(bound.index[..4].iter().all(|i| i % 2 == 0));
        assert!(bound.index[4..8].iter().all(|i| i % 2 == 1));
        assert!(bound.index[8..].iter().all(|&i| i == STATIC) && bound.weight[8..].iter().all(|&w| w == 0.0));
        assert_eq!(bound.index[4], 7);
    }

    #[test]
    fn weights_add_up_and_have_no_seam_where_neighbours_change() {
        let particles = line(40);
        let skin = Skin { neighbours: 3, weights: Weights::Exact };
        let means: Vec<Vec3> = (0..4000).map(|i| Vec3::X * (5.0 + i as f32 * 0.005)).collect();
        let bound = bind(&means, &vec![0; means.len()], &particles, &[0; 40], &skin);
        let dense = |g: usize| {
            let mut w = [0.0f32; 40];
            (0..3).for_each(|s| w[bound.index[g * 3 + s] as usize] += bound.weight[g * 3 + s]);
            w
        };
        for (g, mean) in means.iter().enumerate().skip(1) {
            let (a, b) = (dense(g - 1), dense(g));
            assert!((a.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            let jump = a.iter().zip(&b).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
            assert!(jump < 0.02, "a jump of {jump} at {mean}");
        }
    }

    #[test]
    fn fewer_particles_than_neighbours_are_all_followed() {
        for weights in [Weights::Exact, Weights::Paper] {
            let bound = bind(&[Vec3::X * 0.1], &[0], &line(2), &[0, 0], &Skin { neighbours: 8, weights });
            assert!((bound.weight.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            assert_eq!(&bound.index[..3], &[0, 1, 0]);
            assert!(bound.weight[0] > bound.weight[1] && bound.weight[1] > 0.0 && bound.weight[2] == 0.0);
        }
        let alone = bind(&[Vec3::ONE], &[0], &[Vec3::ONE; 1], &[0], &Skin::default());
        assert_eq!(alone.weight[0], 1.0);
    }

    #[test]
    fn paper_weights_are_inverse_squared_distances() {
        let bound = bind(&[Vec3::X * 0.25], &[0], &line(2), &[0, 0], &Skin { neighbours: 2, weights: Weights::Paper });
        assert!((bound.weight[0] / bound.weight[1] - 9.0).abs() < 1e-4);
    }
}
