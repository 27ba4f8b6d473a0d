//! The nearest Gaussian of a point.

use crate::scene::Gaussians;
use glam::Vec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;

/// Index of the Gaussian whose centre is nearest to each point; 0 where there are no Gaussians.
pub fn nearest(gaussians: &Gaussians, points: &[Vec3]) -> Vec<u32> {
    let centres: Vec<[f32; 3]> = gaussians.mean.iter().map(|m| m.to_array()).collect();
    let Ok(tree) = ImmutableKdTree::<f32, 3>::new_from_slice(&centres) else { return vec![0; points.len()] };
    points.par_iter().map(|p| tree.query(&p.to_array()).nearest_one::<SquaredEuclidean<f32>>().execute().item).collect()
}
