//! Loose pieces of a solid.
//!
//! Captures lose thin stems, and what they held would fall by itself. Each loose piece is joined to
//! the body over the shortest gap by a thread one voxel wide; growing a front from the body outward,
//! the nearest piece first, lets one piece hold the next. A speck that is too far away is dropped:
//! its Gaussians follow the nearest particles. A large piece that is too far away stays a body of its own.

use super::grid::Grid;
use glam::UVec3;

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
        let mut pieces = Pieces { of: vec![NONE; grid.len()], voxels: Vec::new(), starts: vec![0] };
        for seed in 0..grid.len() {
            if !solid[seed] || pieces.of[seed] != NONE {
                continue;
            }
            let piece = pieces.count() as u32;
            pieces.of[seed] = piece;
            pieces.voxels.push(seed as u32);
            let mut next = pieces.starts[piece as usize];
            while let Some(&voxel) = pieces.voxels.get(next) {
                for near in grid.faces(voxel) {
                    if solid[near as usize] && pieces.of[near as usize] == NONE {
                        pieces.of[near as usize] = piece;
                        pieces.voxels.push(near);
                    }
                }
                next += 1;
            }
            pieces.starts.push(pieces.voxels.len());
        }
        pieces
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    fn voxels(&self, piece: u32) -> &[u32] {
        &self.voxels[self.starts[piece as usize]..self.starts[piece as usize + 1]]
    }
}

/// Free voxels around the bodies, nearest first.
struct Front<'a> {
    grid: &'a Grid,
    /// Steps from the body to each free voxel met.
    steps: Vec<u8>,
    /// Voxels to go on from and the body's voxel each came from, by steps.
    buckets: Vec<Vec<(u32, u32)>>,
    joined: Vec<bool>,
}

impl<'a> Front<'a> {
    fn new(grid: &'a Grid, most_steps: usize, pieces: usize) -> Front<'a> {
        Front { grid, steps: vec![u8::MAX; grid.len()], buckets: vec![Vec::new(); most_steps + 1], joined: vec![false; pieces] }
    }

    /// Makes a piece part of the body.
    fn add(&mut self, pieces: &Pieces, piece: u32) {
        self.joined[piece as usize] = true;
        self.buckets[0].extend(pieces.voxels(piece).iter().map(|&v| (v, v)));
        pieces.voxels(piece).iter().for_each(|&v| self.steps[v as usize] = 0);
    }

    /// Spreads to the widest gap and joins the pieces it meets; returns how many.
    fn grow(&mut self, pieces: &Pieces, solid: &mut [bool]) -> usize {
        let mut joined = 0;
        while let Some(at) = self.buckets.iter().position(|b| !b.is_empty()) {
            let Some((voxel, source)) = self.buckets[at].pop() else { break };
            if usize::from(self.steps[voxel as usize]) < at {
                continue;
            }
            for near in self.grid.faces(voxel) {
                let piece = pieces.of[near as usize];
                if piece != NONE && !self.joined[piece as usize] {
                    thread(self.grid, solid, source, near);
                    self.add(pieces, piece);
                    joined += 1;
                } else if piece == NONE && at + 1 < self.buckets.len() && usize::from(self.steps[near as usize]) > at + 1 {
                    self.steps[near as usize] = (at + 1) as u8;
                    self.buckets[at + 1].push((near, source));
                }
            }
        }
        joined
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
