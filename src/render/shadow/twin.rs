//! The contact shadow in plain Rust, pass by pass.

use super::{
    DARKNESS, DEPTH_UNIT, LARGEST_DEPTH, LAYERS, LEVELS, MAP_EDGE, ROOF_OPACITY, ROOF_REACH, ROOF_SLOTS, ROOF_STEEP, ROOF_TEXELS, SIDE,
    SMALLEST_TEXEL, SPREAD, TEXEL_STEPS, WIDEST_TENT,
};
use glam::{Vec2, Vec3};

/// Cells along a side of the static surface's map.
const ROOF_SIDE: i32 = (SIDE / ROOF_TEXELS) as i32;

/// The record of a Gaussian, as in [`crate::skin::Splats`].
type Record = [f32; 16];

/// The shadow of one frame.
#[derive(Clone, Debug)]
pub struct ShadowTwin {
    map: Map,
    /// `[layer][level]`, rows along x.
    pyramid: Vec<Vec<Vec<f32>>>,
    /// `[slot][cell]`, rows along x.
    roof: Vec<Vec<Option<f32>>>,
}

/// Where the map lies.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Map {
    origin: Vec2,
    texel: f32,
    low: f32,
    height: f32,
}

impl ShadowTwin {
    /// Passes `bounds`, `splat`, `roof` and `pyramid`. `None` where nothing casts.
    pub fn new(casters: &[Record], receivers: &[Record], ground_m: Option<f32>) -> Option<ShadowTwin> {
        let casters: Vec<&Record> = casters.iter().filter(|c| c[3] > 0.0).collect();
        let first = Vec3::from_slice(*casters.first()?);
        let (low, high) = casters.iter().fold((first, first), |(low, high), c| (low.min(Vec3::from_slice(*c)), high.max(Vec3::from_slice(*c))));
        let map = Map::around(low, high, ground_m);
        let mut depth = vec![vec![0u32; (SIDE * SIDE) as usize]; LAYERS as usize];
        casters.iter().for_each(|caster| map.splat(caster, &mut depth));
        let mut roof = vec![vec![None; (ROOF_SIDE * ROOF_SIDE) as usize]; ROOF_SLOTS as usize];
        let lies = |r: &&Record| r[3] >= ROOF_OPACITY && r[2] <= map.low + map.height + map.texel && r[9] <= ROOF_STEEP * (r[4] + r[7]);
        receivers.iter().filter(lies).for_each(|r| map.cover(r, &mut roof[map.slot_of(r[2])]));
        Some(ShadowTwin { map, pyramid: depth.iter().map(|layer| pyramid(layer)).collect(), roof })
    }

    /// The factor on the colour of a point, as in passes `receive` and `plane`.
    pub fn shade(&self, p: Vec3) -> f32 {
        let place = (p.truncate() - self.map.origin) / self.map.texel;
        let edge = place.min_element().min(SIDE as f32 - place.max_element()) / (SIDE as f32 * MAP_EDGE);
        if edge <= 0.0 {
            return 1.0;
        }
        let (mut apart, mut together) = (1.0, 1.0f32);
        let mut open = self.slot_open(0, p);
        for (layer, levels) in self.pyramid.iter().enumerate() {
            let (bottom, top) = (self.map.boundary(layer as u32), self.map.boundary(layer as u32 + 1));
            let above = ((top - p.z) / (top - bottom)).clamp(0.0, 1.0);
            if above <= 0.0 {
                continue;
            }
            open = std::array::from_fn(|k| open[k].min(self.slot_open(layer + 1, p)[k]));
            if levels[LEVELS as usize - 1][0] > 0.0 {
                let rise = 0.5 * (top + bottom.max(p.z)) - p.z;
                let passed = 1.0 - above * self.share(open, p) * blurred(levels, place, SPREAD * rise / self.map.texel);
                apart *= passed;
                together = together.min(passed);
            }
        }
        let light = (apart * together).sqrt();
        1.0 - DARKNESS * (1.0 - light) * smoothstep(0.0, 1.0, edge)
    }

    /// Whether the four cells around a place let light of a slot through.
    fn slot_open(&self, slot: usize, p: Vec3) -> [f32; 4] {
        let cell = self.cells(p).floor().as_ivec2();
        let open = |x: i32, y: i32| {
            let (x, y) = (cell.x + x, cell.y + y);
            let inside = x >= 0 && y >= 0 && x < ROOF_SIDE && y < ROOF_SIDE;
            let top = if inside { self.roof[slot][(y * ROOF_SIDE + x) as usize] } else { None };
            let uneven_m = (0.5 * self.map.height).clamp(0.5 * self.map.cell_m(), self.map.cell_m());
            top.map_or(1.0, |top| 1.0 - smoothstep(0.5, 1.0, (top - p.z) / uneven_m))
        };
        [open(0, 0), open(1, 0), open(0, 1), open(1, 1)]
    }

    fn cells(&self, p: Vec3) -> Vec2 {
        (p.truncate() - self.map.origin) / self.map.cell_m() - 0.5
    }

    /// What four cells say at a place between them.
    fn share(&self, of: [f32; 4], p: Vec3) -> f32 {
        let f = self.cells(p) - self.cells(p).floor();
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        mix(mix(of[0], of[1], f.x), mix(of[2], of[3], f.x), f.y)
    }
}

impl Map {
    fn around(low: Vec3, high: Vec3, ground_m: Option<f32>) -> Map {
        let extent = (high.x - low.x).max(high.y - low.y);
        let height = (high.z - low.z).max(SMALLEST_TEXEL);
        let lift = ground_m.map_or(0.0, |ground| (low.z - ground).max(0.0));
        let side = extent + extent.max(height) + 4.0 * SPREAD * lift;
        let mut texel = SMALLEST_TEXEL;
        for _ in 0..TEXEL_STEPS {
            if texel * (SIDE - 2) as f32 >= side {
                break;
            }
            texel *= 1.25;
        }
        let middle = (0.5 * (low.truncate() + high.truncate()) / texel).floor();
        Map { origin: (middle - (SIDE / 2) as f32) * texel, texel, low: low.z, height }
    }

    fn boundary(&self, layer: u32) -> f32 {
        let t = layer as f32 / LAYERS as f32;
        self.low + self.height * t * t
    }

    fn layer_of(&self, z: f32) -> usize {
        let t = ((z - self.low) / self.height).clamp(0.0, 1.0).sqrt();
        ((t * LAYERS as f32) as usize).min(LAYERS as usize - 1)
    }

    fn slot_of(&self, z: f32) -> usize {
        if z <= self.low + self.texel { 0 } else { self.layer_of(z) + 1 }
    }

    fn cell_m(&self) -> f32 {
        self.texel * ROOF_TEXELS as f32
    }

    fn cover(&self, receiver: &Record, roof: &mut [Option<f32>]) {
        let centre = (Vec2::from_slice(receiver) - self.origin) / self.cell_m();
        let reach = (1.5 * Vec2::new(receiver[4].sqrt(), receiver[7].sqrt()) / self.cell_m()).min(Vec2::splat(ROOF_REACH));
        let (first, last) = ((centre - reach).floor().as_ivec2(), (centre + reach).floor().as_ivec2());
        for y in first.y.max(0)..=last.y.min(ROOF_SIDE - 1) {
            for x in first.x.max(0)..=last.x.min(ROOF_SIDE - 1) {
                let cell = &mut roof[(y * ROOF_SIDE + x) as usize];
                *cell = Some(cell.map_or(receiver[2], |top: f32| top.max(receiver[2])));
            }
        }
    }

    fn splat(&self, caster: &Record, depth: &mut [Vec<u32>]) {
        let (xx, xy, yy) = (caster[4], caster[5], caster[7]);
        let lean = SPREAD * SPREAD * caster[9];
        let area = (xx + lean) * (yy + lean) - xy * xy;
        let total = (caster[3] * std::f32::consts::TAU * area.max(0.0).sqrt() / (self.texel * self.texel)).min(LARGEST_DEPTH);
        let deviation = Vec2::new((xx + lean).sqrt(), (yy + lean).sqrt());
        let width = (6.0f32.sqrt() * deviation / self.texel).clamp(Vec2::ONE, Vec2::splat(WIDEST_TENT));
        let centre = (Vec2::from_slice(caster) - self.origin) / self.texel - 0.5;
        let (first, last) = ((centre - width).ceil().as_ivec2().max(glam::IVec2::ZERO), (centre + width).floor().as_ivec2());
        let layer = &mut depth[self.layer_of(caster[2])];
        for y in first.y..=last.y.min(SIDE as i32 - 1) {
            for x in first.x..=last.x.min(SIDE as i32 - 1) {
                let tent = (1.0 - (Vec2::new(x as f32, y as f32) - centre).abs() / width).max(Vec2::ZERO) / width;
                layer[(y * SIDE as i32 + x) as usize] += (total * tent.x * tent.y * DEPTH_UNIT + 0.5) as u32;
            }
        }
    }
}

/// Coverage of one layer and its halvings.
fn pyramid(depth: &[u32]) -> Vec<Vec<f32>> {
    let mut levels = vec![depth.iter().map(|&d| 1.0 - (-(d as f32) / DEPTH_UNIT).exp()).collect::<Vec<f32>>()];
    for level in 1..LEVELS {
        let (side, finer) = ((SIDE >> level) as i32, &levels[level as usize - 1]);
        let value = |t: i32| {
            let (x, y) = (2 * (t % side) - 1, 2 * (t / side) - 1);
            let tap = |k: i32| {
                let (tx, ty) = (k % 4, k / 4);
                let weight = |t: i32| if t == 1 || t == 2 { 3.0 } else { 1.0 };
                weight(tx) * weight(ty) * texel(finer, 2 * side, x + tx, y + ty)
            };
            (0..16).map(tap).sum::<f32>() / 64.0
        };
        let coarser = (0..side * side).map(value).collect();
        levels.push(coarser);
    }
    levels
}

/// A texel; nothing is covered outside the map.
fn texel(level: &[f32], side: i32, x: i32, y: i32) -> f32 {
    if x >= 0 && y >= 0 && x < side && y < side { level[(y * side + x) as usize] } else { 0.0 }
}

fn smooth_at(levels: &[Vec<f32>], level: usize, place: Vec2) -> f32 {
    let s = place / (1u32 << level) as f32;
    let (cell, f) = (s.floor().as_ivec2(), s - s.floor() - 0.5);
    let spline = |f: f32, tap: i32| {
        let d = (f - (tap - 1) as f32).abs();
        if d > 0.5 { 0.5 * (1.5 - d) * (1.5 - d) } else { 0.75 - d * d }
    };
    let tap = |k: i32| {
        let (tx, ty) = (k % 3, k / 3);
        spline(f.x, tx) * spline(f.y, ty) * texel(&levels[level], (SIDE >> level) as i32, cell.x + tx - 1, cell.y + ty - 1)
    };
    (0..9).map(tap).sum()
}

fn blurred(levels: &[Vec<f32>], place: Vec2, sigma: f32) -> f32 {
    let level = (sigma * std::f32::consts::SQRT_2).max(1.0).log2().clamp(0.0, (LEVELS - 1) as f32);
    let lower = (level as usize).min(LEVELS as usize - 2);
    let (a, b) = (smooth_at(levels, lower, place), smooth_at(levels, lower + 1, place));
    a + (b - a) * (level - lower as f32)
}

fn smoothstep(low: f32, high: f32, v: f32) -> f32 {
    let t = ((v - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
