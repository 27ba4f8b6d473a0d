//! Where Gaussians stop light: their optical depth on a grid.
//!
//! A Gaussian of opacity alpha is a soft surface element of optical depth -ln(1 - alpha) at its
//! centre, falling off as its density does. A voxel is occupied where the depths of all Gaussians,
//! each blurred by the voxel's own size so that none falls between two centres, add up to
//! [`OCCUPIED_DEPTH`]. The voxel follows the Gaussians' spacing, never the solver's cell, so that
//! draft and full see the same solid.

use super::ProxyError;
use super::grid::Grid;
use crate::scene::Gaussians;
use glam::{Mat3, UVec3, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;
use std::num::NonZero;

/// Optical depth from which a voxel counts as solid: it stops half of the light.
const OCCUPIED_DEPTH: f32 = std::f32::consts::LN_2;
/// Variance that blurs each Gaussian, in squared voxels: about that of a voxel's own box, 1/12 along
/// each axis, and of its place between the centres.
const VOXEL_VARIANCE: f32 = 0.15;
/// Gaussians below this opacity are haze and make no solid.
const HAZE_OPACITY: f32 = 0.05;
/// Opacity is capped here, so that the optical depth stays finite.
const LARGEST_OPACITY: f32 = 0.99;
/// exp(-q/2) is taken as (1 - q/2n)^n with n = 4: equal to second order at the centre and zero
/// beyond q = 2n, so that each Gaussian touches a bounded set of voxels.
const REACH_SQUARED: f32 = 8.0;
/// An opaque Gaussian alone is [`OCCUPIED_DEPTH`] deep up to this many standard deviations.
const SOLID_REACH: f32 = 1.75;
/// Neighbours whose mean distance is a Gaussian's spacing.
const SPACING_NEIGHBOURS: usize = 8;
/// Gaussians asked for their spacing; the median of so many is within a few per cent.
const SPACING_SAMPLES: usize = 2048;
/// The grid never has more voxels; it is coarsened instead.
const MOST_VOXELS: f64 = 3.0e6;
/// Rasterising never visits more voxels; the grid is coarsened instead.
const MOST_VISITS: f64 = 2.5e8;
/// A Gaussian is left out when its standard deviation is above this many spacings and above half the object's longest side.
const WIDEST_SPACINGS: f32 = 32.0;
/// A grid this much coarser than the Gaussians' spacing shows nothing of them.
const COARSEST: f32 = 16.0;

/// The occupied voxels of an object's Gaussians.
pub(super) struct Density {
    /// Its voxels; the lowest layer stands on the ground or on the object's lowest centre.
    pub grid: Grid,
    /// Whether each voxel stops light; never on a side or on top of the grid.
    pub occupied: Vec<bool>,
    /// Median over the Gaussians of the mean distance to their eight nearest, metres.
    pub spacing_m: f32,
    /// Gaussians left out because they are wider than the object itself.
    pub wide: usize,
}

/// One Gaussian in voxel units, ready to be rasterised.
struct Element {
    centre: Vec3,
    /// Inverse of the covariance blurred by the voxel.
    inverse: Mat3,
    depth: f32,
    low: UVec3,
    high: UVec3,
}

/// Rasterises all Gaussians that are more than haze, above the floor, with room for `margin_spacings`
/// spacings around them.
pub(super) fn rasterise(gaussians: &Gaussians, ground_m: f32, margin_spacings: f32) -> Result<Density, ProxyError> {
    let visible: Vec<usize> = (0..gaussians.len()).filter(|&i| gaussians.opacity[i] >= HAZE_OPACITY).collect();
    if visible.is_empty() {
        return Err(ProxyError::Invisible { gaussians: gaussians.len() });
    }
    let centres: Vec<[f32; 3]> = visible.iter().map(|&i| gaussians.mean[i].to_array()).collect();
    let spacing_m = spacing(&centres).max(typical_size(gaussians, &visible));
    if !(spacing_m > 0.0 && spacing_m.is_finite()) {
        return Err(ProxyError::NoExtent { gaussians: visible.len() });
    }
    let (low, high) = bounds(&centres);
    let widest = (WIDEST_SPACINGS * spacing_m).max(0.5 * (high - low).max_element());
    let (visible, haze): (Vec<usize>, Vec<usize>) = visible.into_iter().partition(|&i| gaussians.scale[i].max_element() <= widest);
    let floor_m = low.z.max(ground_m);
    let grid = choose_grid(gaussians, &visible, floor_m, spacing_m, margin_spacings)?;
    let elements: Vec<Element> = visible.iter().filter_map(|&i| element(gaussians, i, &grid)).collect();
    let occupied = occupy(&grid, &elements);
    Ok(Density { grid, occupied, spacing_m, wide: haze.len() })
}

/// The grid over all Gaussians from the floor up: half the spacing a voxel, coarsened where that is too many.
fn choose_grid(gaussians: &Gaussians, visible: &[usize], floor_m: f32, spacing_m: f32, margin_spacings: f32) -> Result<Grid, ProxyError> {
    let reach = |i: usize| {
        let s = gaussians.covariance(i);
        Vec3::new(s.x_axis.x, s.y_axis.y, s.z_axis.z).max(Vec3::ZERO).map(f32::sqrt)
    };
    let reaches: Vec<Vec3> = visible.iter().map(|&i| reach(i)).collect();
    let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let solid = visible.iter().zip(&reaches).map(|(&i, &reach)| (gaussians.mean[i], SOLID_REACH * reach));
    let (low, high) = solid.fold(start, |(low, high), (mean, reach)| (low.min(mean - reach), high.max(mean + reach)));
    if high.z <= floor_m {
        return Err(ProxyError::BelowGround { ground_m: floor_m, highest_m: high.z });
    }
    let mut voxel_m = 0.5 * spacing_m;
    let extent = |voxel_m: f32| {
        let margin = Vec3::splat(margin_spacings * spacing_m + 3.0 * voxel_m);
        let low = (low - margin).with_z(floor_m);
        (low, ((high + margin - low) / voxel_m).ceil())
    };
    let support = 2.0 * REACH_SQUARED.sqrt();
    let visits = |voxel_m: f32| -> f64 { reaches.iter().map(|&reach| f64::from((reach * (support / voxel_m) + 3.0).element_product())).sum() };
    loop {
        let (low, size) = extent(voxel_m);
        let voxels = f64::from(size.x) * f64::from(size.y) * f64::from(size.z);
        if voxels <= MOST_VOXELS && visits(voxel_m) <= MOST_VISITS {
            return Ok(Grid { low, voxel_m, size: size.as_uvec3() });
        }
        voxel_m *= (voxels / MOST_VOXELS).cbrt().max(1.05) as f32;
        // Also where the spacing is 0 or no number.
        if !(voxel_m > 0.0 && voxel_m <= COARSEST * spacing_m) {
            return Err(ProxyError::TooSparse { extent_m: (high - low).max_element(), spacing_m });
        }
    }
}

/// A Gaussian in voxel units; none where it lies below the floor.
fn element(gaussians: &Gaussians, index: usize, grid: &Grid) -> Option<Element> {
    let centre = (gaussians.mean[index] - grid.low) / grid.voxel_m;
    let blurred = gaussians.covariance(index) * grid.voxel_m.powi(-2) + Mat3::from_diagonal(Vec3::splat(VOXEL_VARIANCE));
    let reach = Vec3::new(blurred.x_axis.x, blurred.y_axis.y, blurred.z_axis.z).map(f32::sqrt) * REACH_SQUARED.sqrt();
    if centre.z + reach.z <= 0.0 {
        return None;
    }
    let last = (grid.size - 1).as_vec3();
    Some(Element {
        centre,
        inverse: blurred.inverse(),
        depth: -(1.0 - gaussians.opacity[index].min(LARGEST_OPACITY)).ln(),
        low: (centre - reach).clamp(Vec3::ZERO, last).as_uvec3(),
        high: (centre + reach).clamp(Vec3::ZERO, last).as_uvec3(),
    })
}

/// Adds up the optical depths, slab by slab and in the Gaussians' order: the same bits on any number of threads.
fn occupy(grid: &Grid, elements: &[Element]) -> Vec<bool> {
    let (row, slab) = (grid.size.x as usize, grid.slab());
    let mut occupied = vec![false; grid.len()];
    occupied.par_chunks_mut(slab).enumerate().for_each_init(
        || vec![0.0f32; slab],
        |depth, (z, occupied)| {
            depth.fill(0.0);
            for element in elements.iter().filter(|e| (e.low.z as usize..=e.high.z as usize).contains(&z)) {
                for y in element.low.y..=element.high.y {
                    let start = y as usize * row;
                    element.add_row(y, z, &mut depth[start..start + row]);
                }
            }
            // the outermost voxels stay air, so that everything inside has neighbours
            let (columns, rows) = (1..row - 1, 1..grid.size.y as usize - 1);
            for y in rows.filter(|_| z + 1 < grid.size.z as usize) {
                for x in columns.clone() {
                    occupied[y * row + x] = depth[y * row + x] >= OCCUPIED_DEPTH;
                }
            }
        },
    );
    occupied
}

impl Element {
    /// Adds this Gaussian's optical depth along one row of voxel centres, where it is not zero.
    fn add_row(&self, y: u32, z: usize, row: &mut [f32]) {
        let (dy, dz) = (y as f32 + 0.5 - self.centre.y, z as f32 + 0.5 - self.centre.z);
        // q(x) = a x^2 + 2 b x + c along the row, x from the Gaussian's centre
        let across = self.inverse * Vec3::new(0.0, dy, dz);
        let (a, b, c) = (self.inverse.x_axis.x, across.x, across.y * dy + across.z * dz);
        let root = b * b - a * (c - REACH_SQUARED);
        if root <= 0.0 {
            return;
        }
        let (half, middle) = (root.sqrt() / a, self.centre.x - b / a - 0.5);
        let from = (middle - half).ceil().max(0.0) as usize;
        let to = ((middle + half).floor() + 1.0).clamp(0.0, row.len() as f32) as usize;
        for (x, depth) in row.iter_mut().enumerate().take(to).skip(from) {
            let dx = x as f32 + 0.5 - self.centre.x;
            let falloff = (1.0 - (a * dx * dx + 2.0 * b * dx + c) / REACH_SQUARED).max(0.0);
            let squared = falloff * falloff;
            *depth += self.depth * squared * squared;
        }
    }
}

fn bounds(points: &[[f32; 3]]) -> (Vec3, Vec3) {
    points.iter().map(|&p| Vec3::from(p)).fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)))
}

/// Median over a sample of the mean distance to the nearest neighbours, metres; zero for a single point.
fn spacing(centres: &[[f32; 3]]) -> f32 {
    let Ok(tree) = ImmutableKdTree::<f32, 3>::new_from_slice(centres) else { return 0.0 };
    let wanted = NonZero::new(SPACING_NEIGHBOURS + 1).unwrap_or(NonZero::<usize>::MIN);
    let mut means: Vec<f32> = (0..centres.len().min(SPACING_SAMPLES))
        .into_par_iter()
        .map(|sample| {
            let centre = centres[sample * centres.len() / centres.len().min(SPACING_SAMPLES)];
            let near = tree.query(&centre).nearest_n::<SquaredEuclidean<f32>>(wanted).execute();
            near.iter().map(|n| n.distance.sqrt()).sum::<f32>() / (near.len().saturating_sub(1)).max(1) as f32
        })
        .collect();
    median(&mut means)
}

/// Median over the Gaussians of a third of their largest standard deviation: what stands in for the
/// spacing of a few large ones.
fn typical_size(gaussians: &Gaussians, visible: &[usize]) -> f32 {
    let mut sizes: Vec<f32> = visible.iter().map(|&i| gaussians.scale[i].max_element() / 3.0).collect();
    median(&mut sizes)
}

fn median(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f32::total_cmp).1 }
}
