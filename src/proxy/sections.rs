//! Horizontal sections of a solid and the parts that stand on them.
//!
//! Each layer of voxels falls into sections joined over faces. Going down from the top, a section
//! holds up every section above that it can be reached from without going below the layer: one part
//! for each cut, with its volume, its height and the sections it stands on.

use super::grid::Grid;
use glam::Vec3;

/// No section.
const NONE: u32 = u32::MAX;
/// A cut is averaged over this share of the height of what stands on it: a narrower spot is too short to bend.
const CUT_SHARE: f64 = 0.1;

/// The sections of all layers, highest layer first.
pub(super) struct Sections {
    voxel_m: f64,
    /// Section of each voxel.
    of: Vec<u32>,
    sections: Vec<Section>,
    /// First section of each layer, highest layer first, and the end.
    layers: Vec<usize>,
}

struct Section {
    voxels: u32,
    /// Sums of x, y, x x, y y and x y over its voxels, in voxels.
    sums: [f64; 5],
    above: Vec<u32>,
    below: Vec<u32>,
}

/// A part of the solid above one layer.
pub(super) struct Cut {
    /// Sections of this layer that it stands on.
    pub sections: Vec<u32>,
    /// All of it, cubic metres.
    pub volume_m3: f64,
    /// Twice the height of its centre of mass above the cut: a column's height, which a few thin tips do not change.
    pub height_m: f64,
    /// How its sections resist bending, each about its own centre, in the direction that bends most
    /// easily: least second moment of area, m^4, averaged over the lowest tenth of the height (harmonic
    /// mean: compliances add up).
    pub moment_m4: f64,
}

/// What a union of sections weighs.
#[derive(Clone, Copy, Default)]
struct Part {
    voxels: f64,
    /// Sum over the voxels of their layer, counted from the top.
    moment: f64,
}

impl Sections {
    /// Finds the sections of a solid's layers.
    pub fn find(grid: &Grid, solid: &[bool]) -> Sections {
        let slab = grid.slab();
        let mut found = Sections { voxel_m: f64::from(grid.voxel_m), of: vec![NONE; grid.len()], sections: Vec::new(), layers: Vec::new() };
        let mut stack = Vec::new();
        for z in (0..grid.size.z as usize).rev() {
            found.layers.push(found.sections.len());
            for seed in (z * slab..(z + 1) * slab).filter(|&i| solid[i]) {
                if found.of[seed] == NONE {
                    found.spread(grid, solid, seed, &mut stack);
                }
            }
        }
        found.layers.push(found.sections.len());
        found
    }

    /// Makes a section of everything in the layer that faces join to a voxel.
    fn spread(&mut self, grid: &Grid, solid: &[bool], seed: usize, stack: &mut Vec<u32>) {
        let (slab, id) = (grid.slab(), self.sections.len() as u32);
        let mut section = Section { voxels: 0, sums: [0.0; 5], above: Vec::new(), below: Vec::new() };
        self.of[seed] = id;
        stack.push(seed as u32);
        while let Some(voxel) = stack.pop() {
            section.voxels += 1;
            let across = voxel as usize % slab;
            let (x, y) = ((across % grid.size.x as usize) as f64, (across / grid.size.x as usize) as f64);
            for (sum, term) in section.sums.iter_mut().zip([x, y, x * x, y * y, x * y]) {
                *sum += term;
            }
            let over = self.of.get(voxel as usize + slab).copied().unwrap_or(NONE);
            if over != NONE && !section.above.contains(&over) {
                section.above.push(over);
            }
            let [_, _, beside @ ..] = grid.faces(voxel);
            for near in beside {
                if solid[near as usize] && self.of[near as usize] == NONE {
                    self.of[near as usize] = id;
                    stack.push(near);
                }
            }
        }
        for &over in &section.above {
            self.sections[over as usize].below.push(id);
        }
        self.sections.push(section);
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.sections.len()
    }

    /// Volume of the solid, cubic metres.
    pub fn volume_m3(&self) -> f64 {
        self.sections.iter().map(|s| f64::from(s.voxels)).sum::<f64>() * self.voxel_m.powi(3)
    }

    /// The section at a point, or in the voxels around it.
    pub fn at(&self, grid: &Grid, point: Vec3) -> Option<u32> {
        let offsets = (0..27).map(|i| Vec3::new((i % 3 - 1) as f32, (i / 3 % 3 - 1) as f32, (i / 9 - 1) as f32));
        let mut around = offsets.map(|o| point + o * grid.voxel_m).filter(|p| (*p - grid.low).cmpge(Vec3::ZERO).all());
        let found = |p: Vec3| {
            let voxel = ((p - grid.low) / grid.voxel_m).as_uvec3();
            voxel.cmplt(grid.size).all().then(|| self.of[grid.index(voxel)]).filter(|&s| s != NONE)
        };
        found(point).or_else(|| around.find_map(found))
    }

    /// The part above each cut, highest cuts first.
    pub fn cuts(&self) -> Vec<Cut> {
        let mut parents: Vec<u32> = (0..self.count() as u32).collect();
        let mut parts = vec![Part::default(); self.count()];
        let mut cuts = Vec::new();
        for layer in 0..self.layers.len().saturating_sub(1) {
            let sections = self.layers[layer]..self.layers[layer + 1];
            for id in sections.clone() {
                let voxels = f64::from(self.sections[id].voxels);
                let mut part = Part { voxels, moment: voxels * layer as f64 };
                for &above in &self.sections[id].above {
                    let root = root(&mut parents, above);
                    if root != id as u32 {
                        part.voxels += parts[root as usize].voxels;
                        part.moment += parts[root as usize].moment;
                        parents[root as usize] = id as u32;
                    }
                }
                parts[id] = part;
            }
            let mut standing: Vec<(u32, u32)> = sections.map(|id| (root(&mut parents, id as u32), id as u32)).collect();
            standing.sort_unstable();
            for group in standing.chunk_by(|a, b| a.0 == b.0) {
                cuts.push(self.cut(layer, parts[group[0].0 as usize], group, &mut parents));
            }
        }
        cuts
    }

    /// Measures the part that a group of sections of one layer holds up.
    fn cut(&self, layer: usize, part: Part, group: &[(u32, u32)], parents: &mut [u32]) -> Cut {
        let height = 2.0 * (layer as f64 - part.moment / part.voxels) + 1.0;
        let window = (CUT_SHARE * height) as usize + 1;
        let mut compliance = 0.0;
        let mut layers = 0.0;
        for layer in (layer.saturating_sub(window - 1)..=layer).rev() {
            let held = (self.layers[layer]..self.layers[layer + 1]).filter(|&id| root(parents, id as u32) == group[0].0);
            let moments = held.map(|id| self.sections[id].second_moments()).fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
            let least = least_principal(moments);
            if least > 0.0 {
                compliance += 1.0 / least;
                layers += 1.0;
            }
        }
        Cut {
            sections: group.iter().map(|&(_, id)| id).collect(),
            volume_m3: part.voxels * self.voxel_m.powi(3),
            height_m: height * self.voxel_m,
            moment_m4: layers / compliance * self.voxel_m.powi(4),
        }
    }
}

impl Section {
    /// Second moments of area about its own centre, of x x, y y and x y, in voxels.
    fn second_moments(&self) -> [f64; 3] {
        let [x, y, xx, yy, xy] = self.sums;
        let n = f64::from(self.voxels);
        let own = n / 12.0;
        [xx - x * x / n + own, yy - y * y / n + own, xy - x * y / n]
    }
}

/// The smaller eigenvalue of a symmetric matrix, of its x x, y y and x y.
fn least_principal([xx, yy, xy]: [f64; 3]) -> f64 {
    0.5 * (xx + yy) - (0.25 * (xx - yy).powi(2) + xy * xy).sqrt()
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
