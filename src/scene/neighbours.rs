//! Nearest neighbours of points among themselves.
//!
//! A balanced k-d tree in place: the points of a range are split at its middle along its longest
//! axis until few are left. Any number of points may coincide.

use super::morton_order;
use glam::Vec3;
use rayon::prelude::*;

/// Ranges up to this long are searched one by one.
const LEAF: usize = 12;

/// The mean distance of each point to its `K` nearest others, or to all others where there are
/// fewer; 0 for a single point.
pub fn mean_distances<const K: usize>(points: &[Vec3]) -> Vec<f32> {
    let tree = Tree::build(points);
    let mut mean = vec![0.0; points.len()];
    let found: Vec<(u32, f32)> = morton_order(points)
        .into_par_iter()
        .map(|i| {
            let nearest = tree.nearest::<K>(points[i as usize], i);
            let distances = nearest.iter().filter(|d| d.is_finite()).map(|d| d.sqrt());
            (i, distances.clone().sum::<f32>() / distances.count().max(1) as f32)
        })
        .collect();
    for (i, distance) in found {
        mean[i as usize] = distance;
    }
    mean
}

/// Points below it are before a range's middle, points above it from there on.
#[derive(Clone, Copy, Default)]
struct Plane {
    axis: u8,
    at: f32,
}

struct Tree {
    /// Points with their index, permuted so that each range's middle splits it.
    points: Vec<(Vec3, u32)>,
    /// At the index of each range's middle, the plane that splits it.
    planes: Vec<Plane>,
}

impl Tree {
    fn build(points: &[Vec3]) -> Tree {
        let mut points: Vec<(Vec3, u32)> = points.iter().copied().zip(0..).collect();
        let mut planes = vec![Plane::default(); points.len()];
        split(&mut points, &mut planes);
        Tree { points, planes }
    }

    /// Squared distances to the `K` nearest points but the one of index `own`, rising, infinity where there are fewer.
    fn nearest<const K: usize>(&self, query: Vec3, own: u32) -> [f32; K] {
        let mut best = [f32::INFINITY; K];
        self.search(query, own, 0, self.points.len(), &mut best);
        best
    }

    fn search<const K: usize>(&self, query: Vec3, own: u32, from: usize, to: usize, best: &mut [f32; K]) {
        if to - from <= LEAF {
            for &(point, index) in &self.points[from..to] {
                if index != own {
                    insert(best, point.distance_squared(query));
                }
            }
            return;
        }
        let middle = from + (to - from) / 2;
        let plane = self.planes[middle];
        let beyond = query[usize::from(plane.axis)] - plane.at;
        let (near, far) = if beyond < 0.0 { ((from, middle), (middle, to)) } else { ((middle, to), (from, middle)) };
        self.search(query, own, near.0, near.1, best);
        if beyond * beyond < best[K - 1] {
            self.search(query, own, far.0, far.1, best);
        }
    }
}

/// Orders a range about its middle, then both halves.
fn split(points: &mut [(Vec3, u32)], planes: &mut [Plane]) {
    if points.len() <= LEAF {
        return;
    }
    let (low, high) = points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), (p, _)| (l.min(*p), h.max(*p)));
    let axis = (high - low).max_position();
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    planes[middle] = Plane { axis: axis as u8, at: points[middle].0[axis] };
    let ((left, right), (left_planes, right_planes)) = (points.split_at_mut(middle), planes.split_at_mut(middle));
    if left.len() > 4096 {
        rayon::join(|| split(left, left_planes), || split(right, right_planes));
    } else {
        split(left, left_planes);
        split(right, right_planes);
    }
}

/// Keeps the smallest, rising.
fn insert<const K: usize>(best: &mut [f32; K], distance: f32) {
    if distance >= best[K - 1] {
        return;
    }
    let mut at = K - 1;
    while at > 0 && best[at - 1] > distance {
        best[at] = best[at - 1];
        at -= 1;
    }
    best[at] = distance;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn by_hand<const K: usize>(points: &[Vec3], i: usize) -> f32 {
        let mut distances: Vec<f32> = (0..points.len()).filter(|&j| j != i).map(|j| points[i].distance_squared(points[j])).collect();
        distances.sort_by(f32::total_cmp);
        distances.truncate(K);
        distances.iter().map(|d| d.sqrt()).sum::<f32>() / distances.len().max(1) as f32
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_a_full_search_finds(cells in prop::collection::vec((0..6_i32, 0..6_i32, 0..40_i32), 1..200)) {
            // Whole numbers: many points coincide and many distances tie.
            let points: Vec<Vec3> = cells.into_iter().map(|(x, y, z)| Vec3::new(x as f32, y as f32, z as f32)).collect();
            let mean = mean_distances::<8>(&points);
            for (i, &found) in mean.iter().enumerate() {
                prop_assert_eq!(found, by_hand::<8>(&points, i));
            }
        }
    }

    #[test]
    fn coinciding_points_and_single_ones_are_no_trouble() {
        assert!(mean_distances::<8>(&[]).is_empty());
        assert_eq!(mean_distances::<8>(&[Vec3::ONE]), [0.0]);
        assert_eq!(mean_distances::<8>(&vec![Vec3::ONE; 1000]), vec![0.0; 1000]);
    }
}
