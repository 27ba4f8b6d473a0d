//! Sections of a solid across the way from its base, and the parts that hang on them.
//!
//! The way leads from where the solid stands through the solid ([`way`]), so that the voxels that are
//! equally far along it lie across a stem wherever the stem goes: up, sideways or drooping. They fall into
//! sections of voxels that touch. Going from the farthest to the base, a section carries every section
//! farther on that it can be reached from without going nearer than it: one part for each cut, with its
//! volume, how far it reaches out, and the sections that carry it.

use super::grid::Grid;
use super::way::{self, Around, STEP};
use glam::{DVec3, IVec3, Vec3};
use std::f64::consts::PI;

/// No section.
const NONE: u32 = u32::MAX;
/// A cut is averaged over this share of the reach of what it carries: a narrower spot is too short to bend.
const CUT_SHARE: f64 = 0.1;
/// A point belongs to the nearest section within this many voxels.
const NEAR_VOXELS: i32 = 3;

/// The sections of all layers, farthest layer first.
pub(super) struct Sections {
    voxel_m: f64,
    /// Section of each voxel.
    of: Vec<u32>,
    sections: Vec<Section>,
    /// First section of each layer, farthest layer first, and the end.
    layers: Vec<usize>,
    /// The voxels around one, nearest first.
    near: Vec<IVec3>,
}

/// Lengths in voxels.
struct Section {
    layer: usize,
    voxels: f64,
    /// Sum of its voxels' places.
    sum: DVec3,
    /// How it resists bending about its own centre, in the direction that bends most easily: least second
    /// moment of area.
    moment: f64,
    /// Sections farther on that touch it.
    beyond: Vec<u32>,
    /// For one that is left out: the centre of the cut that it hung on.
    hung_at: Option<DVec3>,
}

/// A part of the solid from one cut on.
pub(super) struct Cut {
    /// Sections of one layer that carry it.
    pub sections: Vec<u32>,
    /// All of it, cubic metres.
    pub volume_m3: f64,
    /// Twice the way, up and sideways, from the cut to its centre of mass: the length of a stem, which a few
    /// thin tips do not change. What hangs straight down bends nothing.
    pub reach_m: f64,
    /// How the cut resists bending: least second moment of area, m^4, averaged over the first tenth of the
    /// reach (harmonic mean: compliances add up).
    pub moment_m4: f64,
}

/// What a union of sections weighs.
#[derive(Clone, Copy, Default)]
struct Part {
    voxels: f64,
    sum: DVec3,
}

impl Sections {
    /// Finds the sections of a solid's layers.
    pub fn find(grid: &Grid, solid: &[bool]) -> Sections {
        let way = way::from_base(grid, solid);
        let layer_of = |voxel: u32| (way[voxel as usize] / STEP) as usize;
        let mut layers: Vec<Vec<u32>> = Vec::new();
        for voxel in (0..grid.len() as u32).filter(|&v| solid[v as usize]) {
            let layer = layer_of(voxel);
            layers.resize_with(layers.len().max(layer + 1), Vec::new);
            layers[layer].push(voxel);
        }
        let of = vec![NONE; grid.len()];
        let mut found = Sections { voxel_m: f64::from(grid.voxel_m), of, sections: Vec::new(), layers: vec![0], near: around_nearest_first() };
        let around = Around::new(grid);
        for (layer, voxels) in layers.iter().rev().enumerate() {
            let ways = (layers.len() - 1 - layer) as u32 * STEP..(layers.len() - layer) as u32 * STEP;
            for &seed in voxels {
                if found.of[seed as usize] == NONE {
                    found.spread(grid, seed, layer, &around, |voxel| ways.contains(&way[voxel as usize]));
                }
            }
            found.layers.push(found.sections.len());
        }
        found
    }

    /// Makes a section of everything in the layer that touches join to a voxel.
    fn spread(&mut self, grid: &Grid, seed: u32, layer: usize, around: &Around, in_layer: impl Fn(u32) -> bool) {
        let id = self.sections.len() as u32;
        let (mut voxels, mut beyond) = (vec![seed], Vec::new());
        self.of[seed as usize] = id;
        let mut done = 0;
        while let Some(&voxel) = voxels.get(done) {
            done += 1;
            for (near, _) in around.of(voxel) {
                let Some(&other) = self.of.get(near as usize) else { continue };
                if other != NONE && other != id && !beyond.contains(&other) {
                    beyond.push(other);
                } else if other == NONE && in_layer(near) {
                    self.of[near as usize] = id;
                    voxels.push(near);
                }
            }
        }
        let places = || voxels.iter().map(|&v| grid.voxel(v as usize).as_dvec3());
        let sum = places().sum::<DVec3>();
        let centre = sum / voxels.len() as f64;
        let moment = second_moment(places().map(|p| p - centre), voxels.len() as f64);
        self.sections.push(Section { layer, voxels: voxels.len() as f64, sum, moment, beyond, hung_at: None });
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.sections.len()
    }

    /// Volume of the solid, cubic metres.
    pub fn volume_m3(&self) -> f64 {
        self.sections.iter().filter(|s| s.hung_at.is_none()).map(|s| s.voxels).sum::<f64>() * self.voxel_m.powi(3)
    }

    /// Leaves out the sections of a cut and all that hangs on them.
    pub fn leave_out(&mut self, cut: &Cut) {
        let own = cut.sections.iter().map(|&id| &self.sections[id as usize]);
        let (voxels, sum) = own.fold((0.0, DVec3::ZERO), |(n, sum), s| (n + s.voxels, sum + s.sum));
        let mut next = cut.sections.clone();
        while let Some(id) = next.pop() {
            let section = &mut self.sections[id as usize];
            if section.hung_at.is_none() {
                section.hung_at = Some(sum / voxels);
                next.extend(&section.beyond);
            }
        }
    }

    /// The sections farther on that touch one.
    pub fn beyond(&self, section: u32) -> &[u32] {
        &self.sections[section as usize].beyond
    }

    /// Whether a section is left out.
    pub fn is_out(&self, section: u32) -> bool {
        self.sections[section as usize].hung_at.is_some()
    }

    /// Where a section that is left out hung, metres.
    pub fn hung_at(&self, grid: &Grid, section: u32) -> Option<Vec3> {
        self.sections[section as usize].hung_at.map(|at| grid.low + (at.as_vec3() + 0.5) * grid.voxel_m)
    }

    /// Takes what is left out off the solid; how many voxels there were.
    pub fn clear(&self, solid: &mut [bool]) -> usize {
        let out = |&id: &u32| id != NONE && self.is_out(id);
        let mut cleared = 0;
        solid.iter_mut().zip(&self.of).filter(|(_, id)| out(id)).for_each(|(s, _)| {
            *s = false;
            cleared += 1;
        });
        cleared
    }

    /// The section at a point, or the nearest one close by.
    pub fn at(&self, grid: &Grid, point: Vec3) -> Option<u32> {
        let voxel = ((point - grid.low) / grid.voxel_m).floor().as_ivec3();
        let size = grid.size.as_ivec3();
        let around = self.near.iter().map(|&o| voxel + o).filter(|v| v.cmpge(IVec3::ZERO).all() && v.cmplt(size).all());
        around.map(|v| self.of[grid.index(v.as_uvec3())]).find(|&s| s != NONE)
    }

    /// The part from each cut on, farthest cuts first.
    pub fn cuts(&self) -> Vec<Cut> {
        let mut parents: Vec<u32> = (0..self.count() as u32).collect();
        let mut parts = vec![Part::default(); self.count()];
        let mut seen = vec![NONE; self.count()];
        let mut cuts = Vec::new();
        for layer in self.layers.windows(2) {
            let sections = (layer[0]..layer[1]).filter(|&id| !self.is_out(id as u32));
            for id in sections.clone() {
                let mut part = Part { voxels: self.sections[id].voxels, sum: self.sections[id].sum };
                for &beyond in self.sections[id].beyond.iter().filter(|&&b| !self.is_out(b)) {
                    let root = root(&mut parents, beyond);
                    if root != id as u32 {
                        part.voxels += parts[root as usize].voxels;
                        part.sum += parts[root as usize].sum;
                        parents[root as usize] = id as u32;
                    }
                }
                parts[id] = part;
            }
            let mut carrying: Vec<(u32, u32)> = sections.map(|id| (root(&mut parents, id as u32), id as u32)).collect();
            carrying.sort_unstable();
            for group in carrying.chunk_by(|a, b| a.0 == b.0) {
                let group: Vec<u32> = group.iter().map(|&(_, id)| id).collect();
                cuts.push(self.cut(parts[parents[group[0] as usize] as usize], group, &mut seen));
            }
        }
        cuts
    }

    /// Measures the part that a group of sections of one layer carries.
    fn cut(&self, part: Part, group: Vec<u32>, seen: &mut [u32]) -> Cut {
        let own = group.iter().map(|&id| &self.sections[id as usize]);
        let (voxels, sum) = own.fold((0.0, DVec3::ZERO), |(n, sum), s| (n + s.voxels, sum + s.sum));
        let arm = part.sum / part.voxels - sum / voxels;
        let reach = 2.0 * arm.with_z(arm.z.max(0.0)).length() + 1.0;
        let mut moments = vec![0.0; (CUT_SHARE * reach) as usize + 1];
        let last = self.sections[group[0] as usize].layer;
        let mut next = group.clone();
        while let Some(id) = next.pop() {
            let section = &self.sections[id as usize];
            if let Some(moment) = moments.get_mut(last - section.layer)
                && !self.is_out(id)
                && std::mem::replace(&mut seen[id as usize], group[0]) != group[0]
            {
                *moment += section.moment;
                next.extend(&section.beyond);
            }
        }
        let compliance: f64 = moments.iter().filter(|m| **m > 0.0).map(|m| 1.0 / m).sum();
        let layers = moments.iter().filter(|m| **m > 0.0).count() as f64;
        Cut {
            sections: group,
            volume_m3: part.voxels * self.voxel_m.powi(3),
            reach_m: reach * self.voxel_m,
            moment_m4: layers / compliance * self.voxel_m.powi(4),
        }
    }
}

/// Steps to the voxels around one and to itself, nearest first.
fn around_nearest_first() -> Vec<IVec3> {
    let side = 2 * NEAR_VOXELS + 1;
    let step = |k: i32| IVec3::new(k % side, k / side % side, k / (side * side)) - NEAR_VOXELS;
    let mut steps: Vec<IVec3> = (0..side * side * side).map(step).filter(|o| o.length_squared() <= NEAR_VOXELS * NEAR_VOXELS).collect();
    steps.sort_by_key(|o| o.length_squared());
    steps
}

/// Least second moment of area of a section of voxels about their centre. The section is thin: the least
/// spread of the three is across it.
fn second_moment(places: impl Iterator<Item = DVec3>, voxels: f64) -> f64 {
    let (mut square, mut cross) = (DVec3::ZERO, DVec3::ZERO);
    for p in places {
        square += p * p;
        cross += DVec3::new(p.x * p.y, p.x * p.z, p.y * p.z);
    }
    middle_principal(square + voxels / 12.0, cross)
}

/// The middle eigenvalue of a symmetric matrix of diagonal x x, y y, z z and of x y, x z, y z beside it,
/// by the cosine of a third of an angle (Smith 1961).
fn middle_principal(square: DVec3, cross: DVec3) -> f64 {
    let mean = square.element_sum() / 3.0;
    let off = square - mean;
    let size = ((off.length_squared() + 2.0 * cross.length_squared()) / 6.0).sqrt();
    if size <= 1e-12 * mean {
        return mean;
    }
    let (d, c) = (off / size, cross / size);
    let half = 0.5 * (d.x * (d.y * d.z - c.z * c.z) - c.x * (c.x * d.z - c.z * c.y) + c.y * (c.x * c.z - d.y * c.y));
    // The largest is at a third of the angle, the least a third of a turn on, the middle one between them.
    mean + 2.0 * size * ((half.clamp(-1.0, 1.0).acos() - 2.0 * PI) / 3.0).cos()
}

/// The last section that a section was united with, paths halved on the way (Tarjan and van Leeuwen 1984).
fn root(parents: &mut [u32], mut section: u32) -> u32 {
    while parents[section as usize] != section {
        let up = parents[parents[section as usize] as usize];
        parents[section as usize] = up;
        section = up;
    }
    section
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec3;

    /// Stems of 4 x 4 voxels on a plate: one up, one that reaches out at its height, one that hangs from there.
    fn gallows() -> (Grid, Vec<bool>) {
        let grid = Grid { low: Vec3::ZERO, voxel_m: 0.01, size: UVec3::new(70, 30, 60) };
        let within = |v: UVec3, low: [u32; 3], high: [u32; 3]| v.cmpge(low.into()).all() && v.cmplt(high.into()).all();
        let solid = |v: UVec3| {
            let plate = within(v, [4, 4, 0], [24, 24, 4]);
            plate || within(v, [12, 12, 4], [16, 16, 44]) || within(v, [16, 12, 40], [56, 16, 44]) || within(v, [52, 12, 20], [56, 16, 40])
        };
        let solid = (0..grid.len()).map(|i| solid(grid.voxel(i))).collect();
        (grid, solid)
    }

    #[test]
    fn cuts_lie_across_stems_whichever_way_they_go() {
        let (grid, solid) = gallows();
        let sections = Sections::find(&grid, &solid);
        let cuts = sections.cuts();
        let at = |p: [f32; 3]| {
            let id = sections.at(&grid, Vec3::from(p)).expect("a section");
            cuts.iter().find(|c| c.sections.contains(&id)).expect("its cut")
        };
        let volume = sections.volume_m3();
        assert!((volume - solid.iter().filter(|s| **s).count() as f64 * 1e-6).abs() < 1e-9);
        // 16 voxels a layer: I = 4^4 / 12, but for what a corner rounds off.
        let square = 4f64.powi(4) / 12.0 * 1e-8;
        let (hanging, arm, post) = (at([0.54, 0.14, 0.25]), at([0.35, 0.14, 0.42]), at([0.14, 0.14, 0.15]));
        for cut in [hanging, arm, post] {
            assert!((0.8..1.3).contains(&(cut.moment_m4 / square)), "{} of {square}", cut.moment_m4);
        }
        // What hangs bends nothing. The arm carries its outer half and what hangs there; the post all of it.
        assert!(hanging.reach_m < 0.03, "{}", hanging.reach_m);
        let outer: f64 = 0.21 * 0.0016;
        let hung = 0.2 * 0.0016;
        assert!((arm.volume_m3 / (outer + hung) - 1.0).abs() < 0.05, "{}", arm.volume_m3);
        let lever = (outer * 0.105 + hung * 0.19) / (outer + hung);
        assert!((arm.reach_m / (2.0 * lever) - 1.0).abs() < 0.1, "{} of {}", arm.reach_m, 2.0 * lever);
        assert!(post.reach_m > 0.3, "{}", post.reach_m);
    }

    #[test]
    fn the_middle_of_three_principal_moments() {
        let (a, b, c) = (DVec3::new(1.0, 2.0, 2.0) / 3.0, DVec3::new(2.0, 1.0, -2.0) / 3.0, DVec3::new(2.0, -2.0, 1.0) / 3.0);
        let term = |v: DVec3, w: f64| (v * v * w, DVec3::new(v.x * v.y, v.x * v.z, v.y * v.z) * w);
        for values in [[5.0, 3.0, 1.0], [1.0, 1.0, 4.0], [2.0, 2.0, 2.0]] {
            let [x, y, z] = [term(a, values[0]), term(b, values[1]), term(c, values[2])];
            let mut sorted = values;
            sorted.sort_by(f64::total_cmp);
            assert!((middle_principal(x.0 + y.0 + z.0, x.1 + y.1 + z.1) - sorted[1]).abs() < 1e-6);
        }
    }
}
