//! A body to particles: one in each cell of a lattice of half the solver's cell, eight to a cell.
//!
//! A lattice cell that the surface cuts is probed on a finer lattice; the signed distance says how
//! much of each probe's share is solid, and the particle takes that share of the volume and stands
//! at its centre of mass. Inner cells are whole. Seeded jitter breaks up the rows, at most a fifth
//! of the spacing each way, so that no two of these particles come closer than three fifths of it.
//!
//! Threads and sheets that hold one light particle across would have no stiffness in bending: on its
//! neutral line a bent beam is not strained, and nothing else would feel the bend. Light particles
//! that found no heir are four instead, a fraction of the spacing apart.

use super::body::Body;
use glam::{UVec3, Vec3};
use rayon::prelude::*;

/// Largest shift of a particle along an axis, in spacings.
const JITTER: f32 = 0.2;
/// A cell that is less full than this gives its volume to a neighbour on the surface of something
/// thick. Thin chains have no such neighbours and keep all their particles.
const LEAST_FRACTION: f32 = 0.1;
/// How full such a neighbour is at least.
const HEIR_FRACTION: f32 = 0.5;
/// What stays lighter than [`LEAST_FRACTION`] is spread this far each way, in spacings.
const SPREAD: f32 = 0.25;
/// Every second corner of a cube.
const TETRAHEDRON: [Vec3; 4] = [Vec3::ONE, Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0)];
/// Probes along an edge of a lattice cell, at most.
const MOST_PROBES: f32 = 8.0;
/// The lattice never has more cells.
const MOST_CELLS: f64 = 6.4e7;

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
pub(super) fn reach_m(spacing_m: f32, voxel_m: f32) -> f32 {
    spacing_m + 2.0 * voxel_m
}

/// Particles of a body; none where the lattice would have too many cells.
pub(super) fn sample(body: &Body, spacing_m: f32, seed: u64) -> Option<Vec<Sample>> {
    let extent = body.grid.size.as_vec3() * body.grid.voxel_m;
    let size = (extent / spacing_m).ceil();
    if f64::from(size.x) * f64::from(size.y) * f64::from(size.z) > MOST_CELLS {
        return None;
    }
    let lattice = Lattice { low: body.grid.low, spacing_m, size: size.as_uvec3().max(UVec3::ONE) };
    let slabs: Vec<Vec<(UVec3, Sample)>> = (0..lattice.size.z).into_par_iter().map(|z| lattice.slab(body, z, seed)).collect();
    Some(lattice.fold_light(slabs.concat()).into_iter().flat_map(|sample| lattice.spread(sample)).collect())
}

impl Lattice {
    /// The particles of one horizontal layer of cells.
    fn slab(&self, body: &Body, z: u32, seed: u64) -> Vec<(UVec3, Sample)> {
        let near = body.grid.voxel_m;
        let voxel = |cell: u32, size: u32| (((cell as f32 + 0.5) * self.spacing_m / near) as u32).min(size - 1) as usize;
        let xs: Vec<usize> = (0..self.size.x).map(|x| voxel(x, body.grid.size.x)).collect();
        let (_, corner) = self.probes(body);
        let farthest = (corner + near) / near;
        let mut samples = Vec::new();
        for y in 0..self.size.y {
            let row = body.grid.index(UVec3::new(0, voxel(y, body.grid.size.y) as u32, voxel(z, body.grid.size.z) as u32));
            for x in (0..self.size.x).filter(|&x| body.signed[row + xs[x as usize]] <= farthest) {
                let cell = UVec3::new(x, y, z);
                samples.extend(self.particle(body, cell, seed).map(|sample| (cell, sample)));
            }
        }
        samples
    }

    /// Probes along an edge of a cell, and how far from its centre the surface must be for none to be cut.
    fn probes(&self, body: &Body) -> (f32, f32) {
        let probes = (self.spacing_m / body.grid.voxel_m).ceil().clamp(2.0, MOST_PROBES);
        let step = self.spacing_m / probes;
        (probes, 0.5 * 3.0f32.sqrt() * (self.spacing_m - step) + 0.5 * step)
    }

    /// The particle of one cell, where it holds any solid.
    fn particle(&self, body: &Body, cell: UVec3, seed: u64) -> Option<Sample> {
        let centre = self.low + (cell.as_vec3() + 0.5) * self.spacing_m;
        let (probes, corner) = self.probes(body);
        let step = self.spacing_m / probes;
        let depth = body.distance_m(centre);
        if depth > corner {
            return None;
        }
        let jitter = jitter(cell, seed) * (2.0 * JITTER * self.spacing_m);
        if depth < -corner {
            return Some(Sample { position: centre + jitter, fraction: 1.0 });
        }
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

    /// Slivers of the surface give their volume to their fullest neighbour.
    fn fold_light(&self, mut samples: Vec<(UVec3, Sample)>) -> Vec<Sample> {
        let index = |cell: UVec3| ((cell.z * self.size.y + cell.y) * self.size.x + cell.x) as usize;
        let mut at = vec![u32::MAX; index(self.size - 1) + 1];
        samples.iter().enumerate().for_each(|(i, (cell, _))| at[index(*cell)] = i as u32);
        for i in 0..samples.len() {
            let (cell, light) = samples[i];
            if light.fraction >= LEAST_FRACTION {
                continue;
            }
            let low = cell.saturating_sub(UVec3::ONE);
            let high = (cell + 1).min(self.size - 1);
            let near = (low.z..=high.z).flat_map(|z| (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| UVec3::new(x, y, z))));
            let fuller = near.map(|cell| at[index(cell)] as usize).filter(|&n| n < samples.len() && samples[n].1.fraction >= HEIR_FRACTION);
            if let Some(heir) = fuller.max_by(|&a, &b| samples[a].1.fraction.total_cmp(&samples[b].1.fraction)) {
                samples[heir].1.fraction += light.fraction;
                samples[i].1.fraction = 0.0;
            }
        }
        samples.into_iter().map(|(_, sample)| sample).filter(|sample| sample.fraction > 0.0).collect()
    }

    /// A light particle as the corners of a tetrahedron about it, which bends like something half a
    /// spacing thick whichever way it is turned; others as they are.
    fn spread(&self, sample: Sample) -> Vec<Sample> {
        if sample.fraction >= LEAST_FRACTION {
            return vec![sample];
        }
        let apart_m = SPREAD * self.spacing_m;
        // None gets below the floor.
        let centre = sample.position.with_z(sample.position.z.max(self.low.z + 2.0 * apart_m));
        let corner = |side: Vec3| Sample { position: centre + side * apart_m, fraction: 0.25 * sample.fraction };
        TETRAHEDRON.map(corner).to_vec()
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
