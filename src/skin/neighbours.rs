//! The nearest particles of a point: a balanced k-d tree whose answers do not depend on how it was built.

use glam::Vec3;
use rayon::prelude::*;

/// Ranges up to this long are searched one by one.
const LEAF: usize = 12;

/// The most neighbours one search can give: 16 of a Gaussian and the one whose distance bounds them.
pub const MOST: usize = 17;

/// Points in tree order: the middle of a range splits it along the axis kept beside it.
#[derive(Debug)]
pub struct Tree {
    points: Vec<(Vec3, u32)>,
    axis: Vec<u8>,
}

/// The nearest points found so far, nearest first; equal distances by id.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    found: [(f32, u32); MOST],
    length: usize,
    wanted: usize,
}

impl Tree {
    /// Builds over points with ids.
    pub fn new(mut points: Vec<(Vec3, u32)>) -> Tree {
        let mut axis = vec![0; points.len()];
        split(&mut points, &mut axis);
        Tree { points, axis }
    }

    /// The `wanted` nearest points, at most [`MOST`].
    pub fn nearest(&self, query: Vec3, wanted: usize) -> Nearest {
        let mut best = Nearest { found: [(f32::INFINITY, u32::MAX); MOST], length: 0, wanted: wanted.min(MOST) };
        self.visit(query, 0, self.points.len(), &mut best);
        best
    }

    fn visit(&self, query: Vec3, low: usize, high: usize, best: &mut Nearest) {
        if high - low <= LEAF {
            self.points[low..high].iter().for_each(|&(point, id)| best.offer(point.distance_squared(query), id));
            return;
        }
        let middle = low + (high - low) / 2;
        let (point, id) = self.points[middle];
        let axis = usize::from(self.axis[middle]);
        let across = query[axis] - point[axis];
        best.offer(point.distance_squared(query), id);
        let (near, far) = if across < 0.0 { ((low, middle), (middle + 1, high)) } else { ((middle + 1, high), (low, middle)) };
        self.visit(query, near.0, near.1, best);
        // Not `<`: a point at exactly the worst distance may still win by its id.
        if across * across <= best.worst() {
            self.visit(query, far.0, far.1, best);
        }
    }
}

impl Nearest {
    /// Squared distance and id, nearest first.
    pub fn found(&self) -> &[(f32, u32)] {
        &self.found[..self.length]
    }

    fn worst(&self) -> f32 {
        if self.length < self.wanted { f32::INFINITY } else { self.found[self.length - 1].0 }
    }

    fn offer(&mut self, distance: f32, id: u32) {
        if self.length == self.wanted && (distance, id) >= self.found[self.length - 1] {
            return;
        }
        let mut place = if self.length < self.wanted { self.length } else { self.length - 1 };
        self.length = (self.length + 1).min(self.wanted);
        while place > 0 && (distance, id) < self.found[place - 1] {
            self.found[place] = self.found[place - 1];
            place -= 1;
        }
        self.found[place] = (distance, id);
    }
}

/// Puts the median along the widest axis in the middle, then does the same with both halves.
fn split(points: &mut [(Vec3, u32)], axis: &mut [u8]) {
    if points.len() <= LEAF {
        return;
    }
    let (low, high) = points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p.0), h.max(p.0)));
    let widest = (high - low).max_position();
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| a.0[widest].total_cmp(&b.0[widest]).then(a.1.cmp(&b.1)));
    axis[middle] = widest as u8;
    let (before, after) = points.split_at_mut(middle);
    let (axis_before, axis_after) = axis.split_at_mut(middle);
    let (after, axis_after) = (&mut after[1..], &mut axis_after[1..]);
    if middle > 4096 {
        rayon::join(|| split(before, axis_before), || split(after, axis_after));
    } else {
        split(before, axis_before);
        split(after, axis_after);
    }
}

/// The nearest points of many queries, in parallel, in the queries' order.
pub fn nearest_of_all(tree: &Tree, queries: &[Vec3], wanted: usize) -> Vec<Nearest> {
    queries.par_iter().map(|&query| tree.nearest(query, wanted)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scattered(count: u32) -> Vec<(Vec3, u32)> {
        // A lattice with many equal distances, so that ties matter.
        (0..count).map(|i| (Vec3::new((i % 13) as f32, (i / 13 % 11) as f32, (i / 143) as f32), i)).collect()
    }

    #[test]
    fn finds_what_a_full_search_finds_ties_included() {
        let points = scattered(1500);
        let tree = Tree::new(points.clone());
        for q in 0..200 {
            let query = Vec3::new(q as f32 * 0.07, (q % 10) as f32, 4.5);
            let mut all: Vec<(f32, u32)> = points.iter().map(|p| (p.0.distance_squared(query), p.1)).collect();
            all.sort_by(|a, b| a.partial_cmp(b).unwrap());
            assert_eq!(tree.nearest(query, 9).found(), &all[..9], "query {query}");
        }
    }

    #[test]
    fn answers_do_not_depend_on_the_order_of_the_points() {
        let mut points = scattered(900);
        let forward = Tree::new(points.clone());
        points.reverse();
        let backward = Tree::new(points);
        let query = Vec3::new(6.0, 5.0, 3.0);
        assert_eq!(forward.nearest(query, 17).found(), backward.nearest(query, 17).found());
    }

    #[test]
    fn gives_fewer_where_there_are_fewer() {
        assert_eq!(Tree::new(scattered(3)).nearest(Vec3::ZERO, 8).found().len(), 3);
        assert!(Tree::new(Vec::new()).nearest(Vec3::ZERO, 8).found().is_empty());
    }
}
