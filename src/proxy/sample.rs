//! A body to particles: one in each cell of a lattice of half the solver's cell, eight to a cell.
//!
//! A lattice cell that the surface cuts is probed on a finer lattice; the signed distance says how
//! much of each probe's share is solid, and the particle takes that share of the volume and stands
//! at its centre of mass. Inner cells are whole. Seeded jitter breaks up the rows, at most a fifth
//! of the spacing each way, so that no two particles come closer than three fifths of it.

use super::body::Body;
use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

/// Largest shift of a particle along an axis, in spacings.
const JITTER: f32 = 0.2;
/// A cell that is less full than this gives its volume to a fuller neighbour, where it has one.
const LEAST_FRACTION: f32 = 0.1;
/// Probes along an edge of a lattice cell, at most.
const MOST_PROBES: f32 = 8.0;
/// The lattice never has more cells.
const MOST_CELLS: f64 = 2.0e8;

/// One particle to be.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    pub position: Vec3,
    /// Solid share of its lattice cell, and what lighter neighbours gave.
    pub fraction: f32,
}

/// Lattice cells along each axis and the edge of one, metres.
struct Lattice {
    low: Vec3,
    spacing_m: f32,
    size: UVec3,
}

/// How far from the surface distances must be known for a lattice of this spacing, metres.
pub(super) fn reach_m(spacing_m: f32) -> f32 {
    spacing_m
}

/// Particles of a body; none where the lattice would have too many cells.
pub(super) fn sample(body: &Body, spacing_m: f32, seed: u64) -> Option<Vec<Sample>> {
    let extent = body.grid.size.as_vec3() * body.grid.voxel_m;
    let size = (extent / spacing_m).ceil();
    if f64::from(size.x) * f64::from(size.y) * f64::from(size.z) > MOST_CELLS {
        return None;
    }
    let lattice = Lattice { low: body.grid.low, spacing_m, size: size.as_uvec3().max(UVec3::ONE) };
    let slab = (lattice.size.x * lattice.size.y) as usize;
    let cells: Vec<Option<Sample>> = (0..lattice.size.z)
        .into_par_iter()
        .flat_map_iter(|z| (0..slab as u32).map(move |i| UVec3::new(i % lattice.size.x, i / lattice.size.x, z)))
        .map(|cell| lattice.particle(body, cell, seed))
        .collect();
    Some(lattice.fold_light(cells))
}

impl Lattice {
    /// The particle of one cell, where it holds any solid.
    fn particle(&self, body: &Body, cell: UVec3, seed: u64) -> Option<Sample> {
        let centre = self.low + (cell.as_vec3() + 0.5) * self.spacing_m;
        // half the cell's diagonal, and what interpolating between voxels may add
        let corner = 0.87 * self.spacing_m + body.grid.voxel_m;
        let depth = body.distance_m(centre);
        if depth > corner {
            return None;
        }
        let jitter = jitter(cell, seed) * (2.0 * JITTER * self.spacing_m);
        if depth < -corner {
            return Some(Sample { position: centre + jitter, fraction: 1.0 });
        }
        let probes = (self.spacing_m / body.grid.voxel_m).ceil().clamp(2.0, MOST_PROBES);
        let step = self.spacing_m / probes;
        let (mut total, mut moment, mut deepest) = (0.0, Vec3::ZERO, (f32::INFINITY, centre));
        let edge = probes as u32;
        for i in 0..edge * edge * edge {
            let probe = UVec3::new(i % edge, i / edge % edge, i / (edge * edge)).as_vec3();
            let point = centre + (probe + 0.5 - 0.5 * probes) * step;
            let distance = body.distance_m(point);
            let share = (0.5 - distance / step).clamp(0.0, 1.0);
            total += share;
            moment += share * (point - centre);
            if distance < deepest.0 {
                deepest = (distance, point);
            }
        }
        if total <= 0.0 {
            return None;
        }
        let fraction = total / probes.powi(3);
        let position = centre + moment / total + jitter * fraction;
        Some(Sample { position: if body.distance_m(position) > 0.0 { deepest.1 } else { position }, fraction })
    }

    /// Cells that are hardly full give their volume to their fullest neighbour.
    fn fold_light(&self, mut cells: Vec<Option<Sample>>) -> Vec<Sample> {
        let index = |cell: UVec3| ((cell.z * self.size.y + cell.y) * self.size.x + cell.x) as usize;
        let heir = |cell: UVec3| -> Option<usize> {
            let mut best: Option<(f32, usize)> = None;
            for i in 0..27 {
                let near = cell.as_ivec3() + IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
                if near.cmplt(IVec3::ZERO).any() || near.cmpge(self.size.as_ivec3()).any() {
                    continue;
                }
                let near = index(near.as_uvec3());
                let fraction = cells[near].map_or(0.0, |s| s.fraction);
                if fraction >= LEAST_FRACTION && best.is_none_or(|(most, _)| fraction > most) {
                    best = Some((fraction, near));
                }
            }
            best.map(|(_, near)| near)
        };
        let light: Vec<(usize, usize)> = (0..cells.len())
            .into_par_iter()
            .filter(|&i| cells[i].is_some_and(|s| s.fraction < LEAST_FRACTION))
            .filter_map(|i| {
                let (row, x) = (i as u32 / self.size.x, i as u32 % self.size.x);
                heir(UVec3::new(x, row % self.size.y, row / self.size.y)).map(|heir| (i, heir))
            })
            .collect();
        for (from, to) in light {
            let given = cells[from].take().map_or(0.0, |s| s.fraction);
            if let Some(heir) = &mut cells[to] {
                heir.fraction += given;
            }
        }
        cells.into_iter().flatten().collect()
    }
}

/// Three numbers in -0.5..0.5 of a cell and a seed.
fn jitter(cell: UVec3, seed: u64) -> Vec3 {
    let key = u64::from(cell.x) | u64::from(cell.y) << 21 | u64::from(cell.z) << 42;
    let bits = mix(mix(seed ^ 0x5052_4f58_5953_4f4c) ^ key);
    let part = |shift: u32| ((bits >> shift) & 0x1f_ffff) as f32 / (1u32 << 21) as f32 - 0.5;
    Vec3::new(part(0), part(21), part(42))
}

/// The finaliser of splitmix64 (Steele, Lea and Flood 2014): every bit of the input moves every bit of the output.
fn mix(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ bits >> 31
}
