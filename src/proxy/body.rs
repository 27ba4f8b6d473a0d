//! A solid as a signed distance on a grid.

use super::distance;
use super::grid::Grid;
use glam::Vec3;

/// A solid body above its floor.
pub(super) struct Body {
    /// Its voxels; the lowest layer stands on the floor.
    pub grid: Grid,
    /// Distance to the surface at the voxels' centres, in voxels, negative inside, capped. The
    /// floor is no surface: the body is cut there.
    pub signed: Vec<f32>,
    /// Volume of its voxels, cubic metres.
    pub volume_m3: f64,
}

impl Body {
    /// The signed distance of marked voxels, exact to half a voxel within `reach_m` of the surface.
    pub fn new(grid: Grid, solid: &[bool], reach_m: f32) -> Body {
        let cap = (reach_m / grid.voxel_m).ceil().clamp(2.0, distance::LARGEST_CAP as f32 - 1.0) as u32 + 1;
        let empty: Vec<bool> = solid.iter().map(|s| !s).collect();
        let outside = distance::squared(&grid, solid, cap);
        let inside = distance::squared(&grid, &empty, cap);
        // distances are between centres; the surface lies half a voxel before the nearest one across
        let signed =
            outside.iter().zip(&inside).map(|(&out, &into)| if out > 0 { f32::from(out).sqrt() - 0.5 } else { 0.5 - f32::from(into).sqrt() });
        let volume_m3 = solid.iter().filter(|s| **s).count() as f64 * grid.voxel_volume_m3();
        Body { signed: signed.collect(), volume_m3, grid }
    }

    /// Distance to the surface, metres, negative inside: trilinear between voxel centres. A grid has
    /// room around its solid, so that it is never less than two voxels wide.
    pub fn distance_m(&self, point: Vec3) -> f32 {
        let last = (self.grid.size - 1).as_vec3();
        let at = ((point - self.grid.low) / self.grid.voxel_m - 0.5).clamp(Vec3::ZERO, last);
        let base = at.as_uvec3().min(self.grid.size - 2);
        let (t, first) = (at - base.as_vec3(), self.grid.index(base));
        let (row, slab) = (self.grid.size.x as usize, self.grid.slab());
        let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
        let along_x = |i: usize| mix(self.signed[i], self.signed[i + 1], t.x);
        let along_y = |i: usize| mix(along_x(i), along_x(i + row), t.y);
        mix(along_y(first), along_y(first + slab), t.z) * self.grid.voxel_m
    }
}
