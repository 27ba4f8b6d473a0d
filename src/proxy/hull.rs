//! The convex hull of the centres, as in the paper.

use super::ProxyError;
use super::grid::Grid;
use crate::scene::Gaussians;
use glam::Vec3;
use parry3d::math::Vector;
use parry3d::transformation::try_convex_hull;
use rayon::prelude::*;

/// A hull with less than this share of its longest side cubed is flat but for rounding.
const FLAT: f32 = 1e-6;

/// Marks the voxels whose centre lies within the hull of the Gaussians' centres.
pub(super) fn solid(grid: &Grid, gaussians: &Gaussians) -> Result<Vec<bool>, ProxyError> {
    let points: Vec<Vector> = gaussians.mean.iter().map(|m| Vector::new(m.x, m.y, m.z)).collect();
    let flat = ProxyError::FlatHull { gaussians: gaussians.len() };
    let Ok((corners, faces)) = try_convex_hull(&points) else { return Err(flat) };
    let corner = |i: u32| Vec3::new(corners[i as usize].x, corners[i as usize].y, corners[i as usize].z);
    let planes: Vec<(Vec3, f32)> = faces
        .iter()
        .map(|&[a, b, c]| {
            let normal = (corner(b) - corner(a)).cross(corner(c) - corner(a)).normalize_or_zero();
            (normal, normal.dot(corner(a)))
        })
        .collect();
    // six times the volume, as pyramids over the faces
    let apex = corner(0);
    let pyramids = faces.iter().map(|&[a, b, c]| (corner(a) - apex).dot((corner(b) - apex).cross(corner(c) - apex)));
    let longest = corners.iter().map(|c| (Vec3::new(c.x, c.y, c.z) - apex).length()).fold(0.0, f32::max);
    if pyramids.sum::<f32>() <= FLAT * longest.powi(3) {
        return Err(flat);
    }
    let row = grid.size.x as usize;
    let mut solid = vec![false; grid.len()];
    solid.par_chunks_mut(row).enumerate().for_each(|(index, cells)| {
        let (from, to) = interval(&planes, grid.centre(grid.voxel(index * row)), grid.voxel_m);
        let from = from.clamp(0.0, row as f32);
        cells[from as usize..to.clamp(from, row as f32) as usize].fill(true);
    });
    Ok(solid)
}

/// The voxels from..to of a row, counted from the one centred at `start`, that are behind all planes.
fn interval(planes: &[(Vec3, f32)], start: Vec3, voxel_m: f32) -> (f32, f32) {
    let (mut from, mut to) = (0.0f32, f32::INFINITY);
    for &(normal, offset) in planes {
        let (slope, ahead) = (normal.x * voxel_m, offset - normal.dot(start));
        if slope.abs() < 1e-9 {
            if ahead < 0.0 {
                return (0.0, 0.0);
            }
        } else if slope > 0.0 {
            to = to.min((ahead / slope).floor() + 1.0);
        } else {
            from = from.max((ahead / slope).ceil());
        }
    }
    (from, to)
}
