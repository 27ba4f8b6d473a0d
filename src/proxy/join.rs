//! Loose pieces of a solid.
//!
//! Captures lose thin stems, and what they held would fall by itself. Each loose piece is joined to
//! the body over the shortest gap by a thread one voxel wide; growing a front from the body outward,
//! the nearest piece first, lets one piece hold the next. A speck that is too far away is dropped:
//! its Gaussians follow the nearest particles. A large piece that is too far away stays a body of its own.

use super::grid::Grid;
use glam::UVec3;
use std::ops::Range;

/// Widest gap that is bridged, in spacings of the Gaussians.
const BRIDGED_SPACINGS: f32 = 6.0;
/// Share of the solid from which a piece is kept wherever it is.
const BODY_SHARE: f64 = 0.01;
/// No piece.
const NONE: u32 = u32::MAX;

/// What became of the pieces.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Joined {
    /// Pieces that a thread joins to a body.
    pub bridged: usize,
    /// Specks left out.
    pub dropped: usize,
    /// Their share of the solid's volume.
    pub dropped_share: f64,
}

/// Voxels joined over faces, by piece.
struct Pieces {
    /// Piece of each voxel.
    of: Vec<u32>,
    /// Voxels of all pieces, one piece after the other.
    voxels: Vec<u32>,
    /// Where each piece begins in `voxels`, and the end.
    starts: Vec<usize>,
    /// Whether each of `voxels` has a free face.
    rim: Vec<bool>,
}

/// Joins loose pieces to the body or drops them.
pub(super) fn join(grid: &Grid, solid: &mut [bool], spacing_m: f32) -> Joined {
    let pieces = Pieces::find(grid, solid);
    let mut by_size: Vec<u32> = (0..pieces.count() as u32).collect();
    by_size.sort_by_key(|&p| std::cmp::Reverse(pieces.voxels(p).len()));
    let least = (BODY_SHARE * pieces.voxels.len() as f64).max(1.0) as usize;
    let mut front = Front::new(grid, (BRIDGED_SPACINGS * spacing_m / grid.voxel_m).clamp(1.0, 250.0) as usize, pieces.count());
    let mut outcome = Joined::default();
    for (rank, &piece) in by_size.iter().enumerate() {
        if !front.joined[piece as usize] && (rank == 0 || pieces.voxels(piece).len() >= least) {
            front.add(&pieces, piece);
            outcome.bridged += front.grow(&pieces, solid);
        }
    }
    let dropped = by_size.iter().filter(|&&p| !front.joined[p as usize]);
    let mut lost = 0;
    for &piece in dropped {
        outcome.dropped += 1;
        lost += pieces.voxels(piece).len();
        pieces.voxels(piece).iter().for_each(|&v| solid[v as usize] = false);
    }
    outcome.dropped_share = lost as f64 / pieces.voxels.len().max(1) as f64;
    outcome
}

impl Pieces {
    fn find(grid: &Grid, solid: &[bool]) -> Pieces {
        let mut pieces = Pieces { of: vec![NONE; grid.len()], voxels: Vec::new(), starts: vec![0], rim: Vec::new() };
        for seed in 0..grid.len() {
            if !solid[seed] || pieces.of[seed] != NONE {
                continue;
            }
            let piece = pieces.count() as u32;
            pieces.of[seed] = piece;
            pieces.voxels.push(seed as u32);
            while let Some(&voxel) = pieces.voxels.get(pieces.rim.len()) {
                let mut free = false;
                for near in grid.faces(voxel) {
                    let Some(of) = pieces.of.get_mut(near as usize) else { continue };
                    if !solid[near as usize] {
                        free = true;
                    } else if *of == NONE {
                        *of = piece;
                        pieces.voxels.push(near);
                    }
                }
                pieces.rim.push(free);
            }
            pieces.starts.push(pieces.voxels.len());
        }
        pieces
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    fn range(&self, piece: u32) -> Range<usize> {
        self.starts[piece as usize]..self.starts[piece as usize + 1]
    }

    fn voxels(&self, piece: u32) -> &[u32] {
        &self.voxels[self.range(piece)]
    }
}

/// Free voxels around the bodies, nearest first.
struct Front<'a> {
    grid: &'a Grid,
    /// Steps from the body to each free voxel met; 0 on the grid's border, which is never entered.
    steps: Vec<u8>,
    /// Voxels to go on from and the body's voxel each came from, by steps.
    buckets: Vec<Vec<(u32, u32)>>,
    joined: Vec<bool>,
    loose: usize,
}

impl<'a> Front<'a> {
    fn new(grid: &'a Grid, most_steps: usize, pieces: usize) -> Front<'a> {
        let mut steps = vec![u8::MAX; grid.len()];
        let rows = (0..grid.row_count()).map(|row| (row * grid.size.x as usize, grid.voxel(row * grid.size.x as usize)));
        for (first, voxel) in rows {
            let last = first + grid.size.x as usize - 1;
            let border = grid.on_border(voxel.with_x(1));
            steps[first..=last].iter_mut().step_by(if border { 1 } else { last - first }).for_each(|s| *s = 0);
        }
        Front { grid, steps, buckets: vec![Vec::new(); most_steps + 1], joined: vec![false; pieces], loose: pieces }
    }

    /// Makes a piece part of the body.
    fn add(&mut self, pieces: &Pieces, piece: u32) {
        self.joined[piece as usize] = true;
        self.loose -= 1;
        let rim = pieces.range(piece).filter(|&i| pieces.rim[i]).map(|i| pieces.voxels[i]);
        self.buckets[0].extend(rim.map(|v| (v, v)));
    }

    /// Spreads to the widest gap and joins the pieces it meets; returns how many.
    fn grow(&mut self, pieces: &Pieces, solid: &mut [bool]) -> usize {
        let before = self.loose;
        while let Some(at) = self.buckets.iter().position(|b| !b.is_empty()).filter(|_| self.loose > 0) {
            let Some((voxel, source)) = self.buckets[at].pop() else { break };
            if at > 0 && usize::from(self.steps[voxel as usize]) < at {
                continue;
            }
            for near in self.grid.faces(voxel) {
                let Some(&piece) = pieces.of.get(near as usize) else { continue };
                if piece != NONE && !self.joined[piece as usize] {
                    thread(self.grid, solid, source, near);
                    self.add(pieces, piece);
                } else if piece == NONE && at + 1 < self.buckets.len() && usize::from(self.steps[near as usize]) > at + 1 {
                    self.steps[near as usize] = (at + 1) as u8;
                    self.buckets[at + 1].push((near, source));
                }
            }
        }
        before - self.loose
    }
}

/// Marks voxels from one to another, each sharing a face with the next, always along the axis with most to go.
fn thread(grid: &Grid, solid: &mut [bool], from: u32, to: u32) {
    let (mut at, to) = (grid.voxel(from as usize), grid.voxel(to as usize));
    while at != to {
        let apart = UVec3::new(at.x.abs_diff(to.x), at.y.abs_diff(to.y), at.z.abs_diff(to.z));
        let axis = if apart.x >= apart.y && apart.x >= apart.z {
            0
        } else if apart.y >= apart.z {
            1
        } else {
            2
        };
        if at[axis] < to[axis] {
            at[axis] += 1
        } else {
            at[axis] -= 1
        }
        solid[grid.index(at)] = true;
    }
}
