//! `young_pa = "auto"`: soft enough to be seen moving, stiff enough that the captured thing stands.
//!
//! A column of height h and radius r stands under its own weight while h^3 <= 7.84 E r^2 / (4 rho g)
//! (Greenhill 1881). The automatic stiffness is four times that bound for the most slender cut.

use super::{density, fill};
use crate::scene::Gaussians;

/// Standard gravity, whatever the spec's is: the object stood on Earth when it was captured.
const CAPTURE_GRAVITY_M_S2: f64 = 9.81;
/// How far above the bound.
const SAFETY: f64 = 4.0;
/// Softest and stiffest automatic value, Pa.
const RANGE_PA: (f64, f64) = (5e4, 1e6);

/// The automatic stiffness of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct YoungAuto {
    /// Of the whole object.
    pub value_pa: f64,
    /// Of each Gaussian: `value_pa`, or more where a slender part needs it.
    pub local: Vec<f32>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Chooses the stiffness from the Gaussians alone: not from a grid, a quality or the spec's gravity.
pub fn young_auto(gaussians: &Gaussians, ground_m: f32, density_kg_m3: f64) -> YoungAuto {
    let value_pa = slenderest_pa(gaussians, ground_m, density_kg_m3).clamp(RANGE_PA.0, RANGE_PA.1);
    YoungAuto { value_pa, local: vec![value_pa as f32; gaussians.len()], warnings: Vec::new() }
}

/// Largest bound over all horizontal cuts, the area of a cut taken as one round column; zero without a solid.
fn slenderest_pa(gaussians: &Gaussians, ground_m: f32, density_kg_m3: f64) -> f64 {
    let Ok(density) = density::rasterise(gaussians, ground_m, fill::CLOSING_SPACINGS) else { return 0.0 };
    let grid = &density.grid;
    let solid = fill::solid(grid, &density.occupied, density.spacing_m);
    let voxel_m = f64::from(grid.voxel_m);
    let areas: Vec<f64> = solid.chunks(grid.slab()).map(|slab| slab.iter().filter(|s| **s).count() as f64 * voxel_m * voxel_m).collect();
    let volume: f64 = areas.iter().sum();
    let mut above = 0.0;
    let mut top = None;
    let mut largest: f64 = 0.0;
    for (z, area) in areas.iter().enumerate().rev() {
        above += area;
        if above < 0.01 * volume {
            continue;
        }
        let height = (*top.get_or_insert(z) - z) as f64 * voxel_m;
        let radius_squared = area.max(voxel_m * voxel_m) / std::f64::consts::PI;
        largest = largest.max(SAFETY * 4.0 * density_kg_m3 * CAPTURE_GRAVITY_M_S2 * height.powi(3) / (7.84 * radius_squared));
    }
    largest
}
