//! What is inside a captured shell.
//!
//! A capture is a thin skin with holes: open below, open where the camera never looked. A voxel is
//! inside where a ball of the closing radius, rolling in from the grid's border, cannot cover it, and
//! something stands in the way in almost every direction. The first test shuts holes narrower than
//! the ball and leaves a cup open; the second leaves alone the gaps between stems and studs, which
//! the ball cannot enter either. Narrow gaps must be shut on all sides: nothing webs together. The
//! grid ends at the floor, which seals what is open below.

use super::distance;
use super::grid::Grid;
use rayon::prelude::*;

/// Radius of the rolling ball in spacings of the Gaussians: holes up to six spacings wide are closed.
pub(super) const CLOSING_SPACINGS: f32 = 3.0;
/// Enclosed space must hold a ball of this many spacings, or be shut on all sides.
const ROOMY_SPACINGS: f32 = 1.0;
/// Directions to neighbouring voxels.
const ALL_WAYS: u8 = 26;
/// Blocked directions from which a voxel counts as enclosed: a hole may show in up to four.
const MOST_WAYS: u8 = 22;

/// Marks every voxel that belongs to the solid: the occupied ones and what they enclose.
pub(super) fn solid(grid: &Grid, occupied: &[bool], spacing_m: f32) -> Vec<bool> {
    let ball = (CLOSING_SPACINGS * spacing_m / grid.voxel_m).clamp(1.0, distance::LARGEST_CAP as f32 - 2.0);
    let fits = farther(grid, occupied, ball);
    let rolled = flood(grid, &fits);
    let closed = farther(grid, &rolled, ball);
    let ways = blocked_ways(grid, occupied);
    let open: Vec<bool> = (0..grid.len()).map(|i| occupied[i] || !closed[i] || ways[i] < MOST_WAYS).collect();
    let room = (ROOMY_SPACINGS * spacing_m / grid.voxel_m).max(1.0);
    let roomy = farther(grid, &open, room);
    // one voxel more than the ball, so that its rounding leaves no seam along the shell
    let cramped = farther(grid, &roomy, room + 1.0);
    (0..grid.len()).map(|i| occupied[i] || (closed[i] && ways[i] == ALL_WAYS) || (!open[i] && !cramped[i])).collect()
}

/// Where the nearest marked voxel is more than `radius` voxels away.
fn farther(grid: &Grid, mask: &[bool], radius: f32) -> Vec<bool> {
    let reach = (radius * radius) as i16;
    distance::squared(grid, mask, radius.ceil() as u32 + 1).into_iter().map(|d| d > reach).collect()
}

/// In how many of the 26 directions something occupied, or the floor, stands between each voxel and
/// the grid's border.
fn blocked_ways(grid: &Grid, occupied: &[bool]) -> Vec<u8> {
    let steps: Vec<[i32; 3]> = (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]).filter(|&step| step != [0; 3]).collect();
    let none = || vec![0u8; grid.len()];
    steps
        .par_iter()
        .fold(none, |mut ways, &step| {
            for (ways, blocked) in ways.iter_mut().zip(blocked(grid, occupied, step)) {
                *ways += blocked;
            }
            ways
        })
        .reduce(none, |mut ways, more| {
            ways.iter_mut().zip(more).for_each(|(ways, more)| *ways += more);
            ways
        })
}

/// One where the way along `step` is blocked: voxels are visited so that the next one on the way is known already.
fn blocked(grid: &Grid, occupied: &[bool], step: [i32; 3]) -> Vec<u8> {
    let [nx, ny, nz] = grid.size.to_array().map(|n| n as i32);
    let visit = |count: i32, step: i32| (0..count).map(move |i| if step > 0 { count - 1 - i } else { i });
    let row = |y: i32, z: i32| ((z * ny + y) * nx) as usize;
    let mut blocked = vec![0u8; grid.len()];
    for z in visit(nz, step[2]) {
        for y in visit(ny, step[1]) {
            let (next_y, next_z, here) = (y + step[1], z + step[2], row(y, z));
            if next_z < 0 {
                blocked[here..here + nx as usize].fill(1);
            } else if (0..ny).contains(&next_y) && next_z < nz {
                let next = row(next_y, next_z);
                for x in visit(nx, step[0]).filter(|x| (0..nx).contains(&(x + step[0]))) {
                    let from = next + (x + step[0]) as usize;
                    blocked[here + x as usize] = blocked[from] | u8::from(occupied[from]);
                }
            }
        }
    }
    blocked
}

/// Voxels that a path over faces of open voxels joins to the sides or the top of the grid.
fn flood(grid: &Grid, open: &[bool]) -> Vec<bool> {
    let [nx, ny, nz] = grid.size.to_array().map(|n| n as usize);
    let (row, slab) = (nx, nx * ny);
    let mut reached = vec![false; grid.len()];
    let mut stack: Vec<u32> = Vec::new();
    let mut reach = |index: usize, stack: &mut Vec<u32>| {
        if open[index] && !reached[index] {
            reached[index] = true;
            stack.push(index as u32);
        }
    };
    for index in 0..grid.len() {
        let (x, y, z) = (index % nx, index / nx % ny, index / slab);
        if x == 0 || x + 1 == nx || y == 0 || y + 1 == ny || z + 1 == nz {
            reach(index, &mut stack);
        }
    }
    while let Some(index) = stack.pop() {
        let index = index as usize;
        let (x, y, z) = (index % nx, index / nx % ny, index / slab);
        let ways = [(x > 0, index.wrapping_sub(1)), (x + 1 < nx, index + 1), (y > 0, index.wrapping_sub(row)), (y + 1 < ny, index + row)];
        let vertical = [(z > 0, index.wrapping_sub(slab)), (z + 1 < nz, index + slab)];
        for (_, next) in ways.into_iter().chain(vertical).filter(|(within, _)| *within) {
            reach(next, &mut stack);
        }
    }
    reached
}
