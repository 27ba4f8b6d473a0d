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

/// Radius of the rolling ball in spacings of the Gaussians: holes up to eight spacings wide are closed.
pub(super) const CLOSING_SPACINGS: f32 = 4.0;
/// Enclosed space must hold a ball of this many spacings, or be shut on all sides.
const ROOMY_SPACINGS: f32 = 1.0;
/// Directions to neighbouring voxels.
const ALL_WAYS: u8 = 26;
/// Blocked directions from which a voxel counts as enclosed: one hole may show.
const MOST_WAYS: u8 = 25;

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
    let filled = |i: usize| (closed[i] && ways[i] == ALL_WAYS) || !(open[i] || cramped[i]);
    let air: Vec<bool> = (0..grid.len()).map(|i| !occupied[i] && !filled(i)).collect();
    // a ray through a pinhole leaves pits inside, which nothing reaches from the border
    flood(grid, &air).into_iter().map(|outside| !outside).collect()
}

/// Where the nearest marked voxel is more than `radius` voxels away.
fn farther(grid: &Grid, mask: &[bool], radius: f32) -> Vec<bool> {
    let reach = (radius * radius) as i16;
    distance::squared(grid, mask, radius.ceil() as u32 + 1).into_iter().map(|d| d > reach).collect()
}

/// In how many of the 26 directions something occupied, or the floor, stands between each voxel and
/// the grid's border.
fn blocked_ways(grid: &Grid, occupied: &[bool]) -> Vec<u8> {
    let steps: Vec<[isize; 3]> = (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]).filter(|&step| step != [0; 3]).collect();
    let none = || vec![0u8; grid.len()];
    let count = |mut ways: Vec<u8>, step: &[isize; 3]| {
        add_blocked(grid, occupied, *step, &mut ways);
        ways
    };
    let sum = |mut ways: Vec<u8>, more: Vec<u8>| {
        ways.iter_mut().zip(more).for_each(|(ways, more)| *ways += more);
        ways
    };
    steps.par_chunks(steps.len().div_ceil(rayon::current_num_threads())).map(|steps| steps.iter().fold(none(), count)).reduce(none, sum)
}

/// Adds one where the way along `step` is blocked. Rows are visited so that the next one on the way
/// is known already.
fn add_blocked(grid: &Grid, occupied: &[bool], step: [isize; 3], ways: &mut [u8]) {
    let [nx, ny, nz] = grid.size.to_array().map(|n| n as isize);
    let visit = |count: isize, step: isize| (0..count).map(move |i| if step > 0 { count - 1 - i } else { i });
    // one voxel of air at both ends of a row, so that steps sideways need no test
    let padded = nx as usize + 2;
    let mut blocked = vec![0u8; padded * grid.row_count()];
    for (z, y) in visit(nz, step[2]).flat_map(|z| visit(ny, step[1]).map(move |y| (z, y))) {
        let (next_y, next_z, row) = (y + step[1], z + step[2], (z * ny + y) as usize);
        if next_z < 0 {
            blocked[row * padded..(row + 1) * padded].fill(1);
        } else if (0..ny).contains(&next_y) && next_z < nz {
            let next = (next_z * ny + next_y) as usize;
            if next == row {
                scan_row(&mut blocked[row * padded..(row + 1) * padded], &occupied[row * nx as usize..(row + 1) * nx as usize], step[0]);
            } else {
                let (from, to) = two_rows(&mut blocked, next, row, padded);
                shift_row(to, from, &occupied[next * nx as usize..(next + 1) * nx as usize], step[0]);
            }
        }
        let ways = &mut ways[row * nx as usize..(row + 1) * nx as usize];
        ways.iter_mut().zip(&blocked[row * padded + 1..]).for_each(|(ways, blocked)| *ways += blocked);
    }
}

/// What a row sees of the row next to it, `step` voxels along x.
fn shift_row(to: &mut [u8], from: &[u8], occupied: &[bool], step: isize) {
    let count = occupied.len();
    let start = (1 + step) as usize;
    for (to, &from) in to[1..=count].iter_mut().zip(&from[start..start + count]) {
        *to = from;
    }
    let (skip, drop) = ((step > 0) as usize, (step < 0) as usize);
    for (to, &occupied) in to[1 + drop..1 + count - skip].iter_mut().zip(&occupied[skip..count - drop]) {
        *to |= u8::from(occupied);
    }
}

/// What a row sees along itself.
fn scan_row(row: &mut [u8], occupied: &[bool], step: isize) {
    let count = occupied.len();
    let mut seen = 0;
    for i in 0..count {
        let x = if step > 0 { count - 1 - i } else { i };
        row[x + 1] = seen;
        seen |= u8::from(occupied[x]);
    }
}

/// Two different rows of a buffer, one to read and one to write.
fn two_rows(buffer: &mut [u8], read: usize, write: usize, length: usize) -> (&[u8], &mut [u8]) {
    let (low, high) = buffer.split_at_mut(read.max(write) * length);
    let first = read.min(write) * length;
    let (low, high) = (&mut low[first..first + length], &mut high[..length]);
    if read < write { (low, high) } else { (high, low) }
}

/// Voxels that a path over faces of open voxels joins to the sides or the top of the grid, found a
/// run of a row at a time.
fn flood(grid: &Grid, open: &[bool]) -> Vec<bool> {
    let [nx, ny, nz] = grid.size.to_array().map(|n| n as usize);
    let mut reached = vec![false; grid.len()];
    let mut starts: Vec<u32> = Vec::new();
    for row in 0..grid.row_count() {
        let (first, y, z) = (row * nx, row % ny, row / ny);
        let border = y == 0 || y + 1 == ny || z + 1 == nz;
        let ends = if border { (first..first + nx).step_by(1) } else { (first..first + nx).step_by((nx - 1).max(1)) };
        starts.extend(ends.filter(|&i| open[i]).map(|i| i as u32));
    }
    while let Some(start) = starts.pop() {
        let start = start as usize;
        if reached[start] {
            continue;
        }
        let row = start / nx;
        let (first, y, z) = (row * nx, row % ny, row / ny);
        let from = (first..start).rev().take_while(|&i| open[i]).last().unwrap_or(start);
        let to = (start..first + nx).take_while(|&i| open[i]).last().unwrap_or(start);
        reached[from..=to].fill(true);
        let beside = [(y > 0, row.wrapping_sub(1)), (y + 1 < ny, row + 1), (z > 0, row.wrapping_sub(ny)), (z + 1 < nz, row + ny)];
        for (_, next) in beside.into_iter().filter(|(within, _)| *within) {
            let shift = next * nx;
            let mut before = false;
            for i in from - first + shift..=to - first + shift {
                let fresh = open[i] && !reached[i];
                if fresh && !before {
                    starts.push(i as u32);
                }
                before = fresh;
            }
        }
    }
    reached
}
