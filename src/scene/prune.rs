//! Floaters: Gaussians of no surface that captures leave in the air.

use super::Gaussians;
use super::neighbours::mean_distances;

/// An isolated Gaussian is this many times further from its neighbours than the middle one of all.
const ISOLATION: f32 = 6.0;

/// Marks the isolated ones: those whose mean distance to their 8 nearest neighbours is over
/// six times the median of it. Thin parts stay, however far out: a stalk has neighbours.
pub fn floaters(g: &Gaussians) -> Vec<bool> {
    let distance = mean_distances::<8>(&g.mean);
    if distance.is_empty() {
        return Vec::new();
    }
    let mut sorted = distance.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f32::total_cmp).1;
    // Where most Gaussians coincide the median says nothing of the spacing.
    let limit = if median > 0.0 { ISOLATION * median } else { f32::INFINITY };
    distance.into_iter().map(|d| d > limit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_lone_point_is_a_floater_and_a_stalk_is_not() {
        let mut mean: Vec<Vec3> = (0..1000).map(|i| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32)).collect();
        mean.extend((0..40).map(|i| Vec3::new(5.0, 5.0, 10.0 + i as f32)));
        mean.push(Vec3::new(60.0, 0.0, 0.0));
        let g = Gaussians { mean, ..Gaussians::default() };
        let marked = floaters(&g);
        assert_eq!(marked.iter().filter(|&&f| f).count(), 1);
        assert!(marked[1040]);
    }

    #[test]
    fn nothing_is_a_floater_among_few_or_equal_ones() {
        let all = |mean: Vec<Vec3>| floaters(&Gaussians { mean, ..Gaussians::default() });
        assert!(all(vec![]).is_empty());
        assert_eq!(all(vec![Vec3::ONE]), [false]);
        assert_eq!(all(vec![Vec3::ONE; 20]), [false; 20]);
    }
}
