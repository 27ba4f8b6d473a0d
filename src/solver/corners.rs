//! Corners: where several colliders are near each other a node of the grid answers to all of them. Each of those that may
//! meet has a place of its own among the marks of a node (`shaders/solver/corner.wgsl`). Where none meet there is nothing
//! of this.

use super::constants::{CORNERS_MOST, REACH_CELLS, REST_CELLS_MAX};
use super::core::Solver;
use super::grid::GridBuffers;
use super::obstacles::ColliderRecord;
use super::state::StateBuffers;
use crate::gpu::Recording;
use glam::Vec3;

passes! {
    /// Compiled where colliders meet.
    CornerPasses;
    corner: ["substance", "particle", "contact", "on_grid", "marks", "corner"] [Read, Read, Read, Read, Read, Write] 0;
}

/// Cells from a collider to the farthest node that answers to it: a particle that it is in reach of, and that one's stencil.
const NODES_CELLS: f32 = REACH_CELLS + REST_CELLS_MAX + 2.6;

/// Gives each of the colliders from `first` on a place that no other has which a node may meet besides, the lowest that is free;
/// what finds none shares one.
pub(super) fn place(colliders: &mut [ColliderRecord], first: usize, cell_m: f32) {
    let near_m = 2.0 * NODES_CELLS * cell_m;
    for k in first..colliders.len() {
        let (before, rest) = colliders.split_at_mut(k);
        let taken = |place: &u32| before[first..].iter().any(|other| other.corner() == *place && meet(other, &rest[0], near_m));
        let free = (0..CORNERS_MOST).find(|place| !taken(place));
        rest[0].surface[2] = free.unwrap_or((k - first) as u32 % CORNERS_MOST) as f32;
    }
}

/// Places that a node needs: 0 where one is enough.
pub(super) fn places(colliders: &[ColliderRecord]) -> u32 {
    let most = colliders.iter().map(ColliderRecord::corner).max().unwrap_or(0);
    if most > 0 { most + 1 } else { 0 }
}

/// Whether anything may be so near to both.
fn meet(a: &ColliderRecord, b: &ColliderRecord, near_m: f32) -> bool {
    match (a.span(), b.span()) {
        (Some((low, high)), Some((other_low, other_high))) => (low - near_m).cmple(other_high).all() && (other_low - near_m).cmple(high).all(),
        (Some(span), None) => reaches(b, span, near_m),
        (None, Some(span)) => reaches(a, span, near_m),
        (None, None) => {
            let [n, m] = [a, b].map(|c| c.normal(0, Vec3::ZERO));
            n.cross(m).length() > 1e-3 || a.touch(Vec3::from_slice(&b.at)).distance_m.abs() <= near_m
        }
    }
}

/// Whether some of a box is so near to a plane.
fn reaches(plane: &ColliderRecord, (low, high): (Vec3, Vec3), near_m: f32) -> bool {
    let (middle_m, half) = (plane.touch(0.5 * (low + high)).distance_m, 0.5 * (high - low));
    middle_m.abs() <= near_m + half.dot(plane.normal(0, Vec3::ZERO).abs())
}

impl Solver {
    /// The pass over one of the two state buffers, where colliders meet.
    pub(super) fn bind_corner(&self, grid: &GridBuffers, state: &StateBuffers) -> Option<wgpu::BindGroup> {
        let passes = self.corners.as_ref()?;
        let buffers = [&self.params_buffer, &state.kinematics, &state.matter, &self.colliders_buffer, &self.laws.table, &grid.corners];
        Some(self.gpu.bind(&passes.corner, &buffers))
    }

    /// Adds what comes between particles to grid and the grid's own pass.
    pub(super) fn record_corner(&self, bound: Option<&wgpu::BindGroup>, recording: &mut Recording) {
        if let (Some(passes), Some(bound)) = (&self.corners, bound) {
            recording.dispatch(&passes.corner, bound, self.particle_groups());
        }
    }
}
