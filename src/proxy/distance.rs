//! Exact Euclidean distances on a grid, up to a cap.
//!
//! The squared distance separates: along each axis in turn, d(i) = min over j of d(j) + (i - j)^2.
//! With a cap the minimum runs over a short window, so that every pass is a few vector
//! operations a voxel and the work is known beforehand.

use super::grid::Grid;
use rayon::prelude::*;

/// The largest cap, in voxels: its square fits i16, whose minimum every processor has as a vector operation.
pub(super) const LARGEST_CAP: u32 = 180;

/// Squared distance of each voxel's centre to the nearest voxel where `mask` holds, in squared
/// voxels; `cap^2 + 1` where that is farther than `cap`.
pub(super) fn squared(grid: &Grid, mask: &[bool], cap: u32) -> Vec<i16> {
    let cap = cap.clamp(1, LARGEST_CAP) as i16;
    let far = cap * cap + 1;
    let (row, slab) = (grid.size.x as usize, grid.slab());
    let mut along_x = vec![far; grid.len()];
    along_x.par_chunks_mut(row).zip(mask.par_chunks(row)).for_each(|(out, mask)| sweep_row(out, mask));
    let mut along_y = vec![far; grid.len()];
    along_y.par_chunks_mut(slab).zip(along_x.par_chunks(slab)).for_each(|(out, from)| {
        for (y, out) in out.chunks_exact_mut(row).enumerate() {
            lower(out, from, y, row, cap);
        }
    });
    let mut along_z = along_x;
    along_z.par_chunks_mut(slab).enumerate().for_each(|(z, out)| {
        out.fill(far);
        lower(out, &along_y, z, slab, cap);
    });
    along_z
}

/// Squared distances within one row, by a sweep each way.
fn sweep_row(out: &mut [i16], mask: &[bool]) {
    if !mask.contains(&true) {
        return;
    }
    let sweep = |cells: &mut dyn Iterator<Item = (&mut i16, &bool)>| {
        let mut steps = LARGEST_CAP as i16;
        for (out, &set) in cells {
            steps = if set { 0 } else { (steps + 1).min(LARGEST_CAP as i16) };
            *out = (*out).min(steps * steps);
        }
    };
    sweep(&mut out.iter_mut().zip(mask));
    sweep(&mut out.iter_mut().zip(mask).rev());
}

/// out = min over lines j within `cap` of line `at` of `from[j] + (at - j)^2`, `line` values a line.
fn lower(out: &mut [i16], from: &[i16], at: usize, line: usize, cap: i16) {
    let lines = from.len() / line;
    let reach = cap as usize;
    for j in at.saturating_sub(reach)..(at + reach + 1).min(lines) {
        let apart = at.abs_diff(j) as i16;
        let add = apart * apart;
        for (out, &value) in out.iter_mut().zip(&from[j * line..(j + 1) * line]) {
            *out = (*out).min(value.saturating_add(add));
        }
    }
}
