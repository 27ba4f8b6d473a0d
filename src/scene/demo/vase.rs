//! The vase: a turned body in a running teal glaze, a painted ivory band, a bare clay foot.

use super::dab::{Dab, Finish, Paint, cell_dab, cover, linear};
use super::random::{Random, cloud, noise, smooth};
use glam::Vec3;
use std::f32::consts::TAU;

/// Height of the lip above the foot.
pub const HEIGHT_M: f32 = 0.262;
/// Height of the closed mouth above the foot, and its radius.
pub const MOUTH_M: [f32; 2] = [0.236, 0.0375];

/// The turned profile from the middle of the foot, up the outside, over the lip and down to the mouth: radius, height.
const PROFILE: [[f32; 2]; 19] = [
    [0.0670, 0.0000],
    [0.0705, 0.0012],
    [0.0720, 0.0050],
    [0.0710, 0.0110],
    [0.0715, 0.0170],
    [0.0760, 0.0340],
    [0.0835, 0.0620],
    [0.0890, 0.0930],
    [0.0905, 0.1220],
    [0.0862, 0.1500],
    [0.0755, 0.1760],
    [0.0605, 0.1980],
    [0.0480, 0.2150],
    [0.0425, 0.2310],
    [0.0445, 0.2470],
    [0.0525, 0.2590],
    [0.0548, 0.2620],
    [0.0505, 0.2615],
    [0.0375, 0.2360],
];
/// Heights between which the band is painted.
const BAND_M: [f32; 2] = [0.098, 0.146];
/// Leaf pairs around the band.
const LEAVES: f32 = 15.0;
/// Edge of a dab's cell on the body, and in the band where the painting is finer.
const CELL_M: [f32; 2] = [0.0041, 0.0025];

/// All dabs of the vase; its foot stands at `foot`.
pub fn vase(seed: u64, foot: Vec3) -> Vec<Dab> {
    let mut random = Random::new(seed, 3);
    let mut dabs = Vec::new();
    let rows = rows();
    for pair in rows.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        let (radius, height) = ((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0);
        let cell = (high[0] - low[0]).hypot(high[1] - low[1]);
        let count = (TAU * radius / cell).round().max(3.0);
        let start = random.unit();
        let outside = high[1] > low[1] || low[0] < high[0];
        for i in 0..count as usize {
            let turn = (i as f32 + start + random.about(0.06)) / count * TAU;
            let (sin, cos) = turn.sin_cos();
            let around = Vec3::new(-sin, cos, 0.0) * (TAU * radius / count);
            let up = Vec3::new(cos * (high[0] - low[0]), sin * (high[0] - low[0]), high[1] - low[1]);
            let centre = Vec3::new(cos * radius, sin * radius, height);
            let paint = glaze(turn, height, outside, random.unit());
            dabs.push(cell_dab(foot + centre, around, up, paint));
        }
    }
    lids(&mut dabs, &mut random, foot);
    dabs
}

/// Points of the profile at even distances: a cell apart, finer in the band.
fn rows() -> Vec<[f32; 2]> {
    let mut rows = vec![PROFILE[0]];
    let mut along = 0.0;
    let fine = 400;
    for i in 0..(PROFILE.len() - 1) * fine {
        let (a, b) = (curve(i as f32 / fine as f32), curve((i + 1) as f32 / fine as f32));
        along += (b[0] - a[0]).hypot(b[1] - a[1]);
        let in_band = (BAND_M[0] - 0.004..BAND_M[1] + 0.004).contains(&b[1]) && b[0] > 0.06;
        if along >= CELL_M[usize::from(in_band)] {
            rows.push(b);
            along = 0.0;
        }
    }
    rows
}

/// Catmull and Rom's spline through the profile.
fn curve(t: f32) -> [f32; 2] {
    let last = PROFILE.len() - 1;
    let i = (t.floor() as usize).min(last - 1);
    let f = t - i as f32;
    let p = |k: usize| PROFILE[k.min(last)];
    let (a, b, c, d) = (p(i.saturating_sub(1)), p(i), p(i + 1), p(i + 2));
    let at = |k: usize| {
        0.5 * (2.0 * b[k]
            + (c[k] - a[k]) * f
            + (2.0 * a[k] - 5.0 * b[k] + 4.0 * c[k] - d[k]) * f * f
            + (3.0 * (b[k] - c[k]) + d[k] - a[k]) * f * f * f)
    };
    [at(0).max(0.0), at(1).clamp(0.0, HEIGHT_M)]
}

/// The colour of a place: angle, height, and a random number of its own for specks.
fn glaze(turn: f32, height: f32, outside: bool, chance: f32) -> Paint {
    let round = Vec3::new(turn.cos(), turn.sin(), 0.0);
    let coat = |albedo: Vec3, reflectance: f32, roughness: f32| Paint { albedo, finish: Finish::Coated { reflectance, roughness }, opacity: 0.98 };
    // The glaze ran down and stopped above the foot in uneven drops.
    let run = 0.0165 + 0.0055 * noise(round * 3.1 + 2.0) + 0.0035 * noise(round * 8.3);
    if height < run {
        let clay = linear(0xa8643c) * (1.0 + 0.14 * cloud(round * 9.0 + Vec3::Z * height * 160.0));
        return coat(clay * smooth(0.0, 0.004, run - height).max(0.55), 0.02, 0.9);
    }
    if !outside {
        return coat(linear(0x2c4f4c), 0.04, 0.5);
    }
    let flow = cloud(round * 3.2 + Vec3::Z * height * 9.0);
    let streak = noise(round * 17.0 + Vec3::Z * height * 6.0);
    let mut albedo = linear(0x0d5058).lerp(linear(0x2f9490), (0.42 + 0.5 * flow + 0.22 * streak).clamp(0.0, 1.0));
    // Thick where it gathers above the foot, thin and brown where it leaves the lip.
    albedo = albedo.lerp(linear(0x083238), smooth(0.05, 0.018, height) * 0.75);
    let lip = smooth(HEIGHT_M - 0.013, HEIGHT_M - 0.003, height + 0.003 * streak);
    albedo = albedo.lerp(linear(0x9a6a35), lip * 0.85);
    if let Some(band) = painted(turn, height) {
        albedo = band * (1.0 + 0.06 * flow);
    }
    if chance < 0.022 {
        albedo *= 0.45;
    }
    coat(albedo, 0.06, 0.1)
}

/// The band: ivory between two lines of gold, a wreath of slanted leaves in dark blue.
fn painted(turn: f32, height: f32) -> Option<Vec3> {
    let s = (height - BAND_M[0]) / (BAND_M[1] - BAND_M[0]);
    if !(0.0..=1.0).contains(&s) {
        return None;
    }
    let (ivory, gold, blue) = (linear(0xf0e6d0), linear(0xb98a3e), linear(0x1d3f6e));
    let rim = s.min(1.0 - s);
    if rim < 0.055 {
        return Some(gold);
    }
    // One unit is the width of a leaf pair; lengths along and across the band share it.
    let unit = TAU * 0.0888 / LEAVES;
    let across = (s - 0.5) * (BAND_M[1] - BAND_M[0]) / unit;
    let along = (turn / TAU * LEAVES).rem_euclid(1.0) - 0.5;
    let wave = 0.055 * (along * TAU).sin();
    // Painted edges are as soft as the dabs are wide.
    let soft = |inside: f32| smooth(-0.03, 0.03, inside);
    let stem = soft(0.045 - (across - wave).abs());
    let leaf = |side: f32, shift: f32| {
        let (x, y) = ((along - shift + 0.5).rem_euclid(1.0) - 0.5, (across - wave) * side);
        // An almond that leans forward.
        let (l, w) = (x * 0.80 + (y - 0.24) * 0.60, (y - 0.24) * 0.80 - x * 0.60);
        let reach = 0.31;
        soft(0.135 * (1.0 - (l / reach) * (l / reach)) - w.abs())
    };
    let berry = soft(0.07 - along.hypot(across - wave));
    let ink = stem.max(leaf(1.0, 0.0)).max(leaf(-1.0, 0.5));
    Some(ivory.lerp(blue, ink).lerp(gold, berry))
}

/// The foot's underside and the moss that fills the mouth.
fn lids(dabs: &mut Vec<Dab>, random: &mut Random, foot: Vec3) {
    let disc = |radius: f32, height: f32, sign: f32| {
        move |u: f32, v: f32| {
            let (turn, reach) = (sign * v * TAU, u.max(0.0).sqrt() * radius);
            foot + Vec3::new(reach * turn.cos(), reach * turn.sin(), height)
        }
    };
    let clay = Paint { albedo: linear(0x9a5c38), finish: Finish::Sheet { translucency: 0.0 }, opacity: 0.97 };
    cover(dabs, [9, 26], 0.1, random, &disc(PROFILE[0][0], 0.0, -1.0), &mut |_, _, _| Some(clay));
    let mut tint = Random::new(7, 7);
    cover(dabs, [8, 26], 0.3, random, &disc(MOUTH_M[1] + 0.002, MOUTH_M[0], 1.0), &mut |_, _, _| {
        let moss = linear(0x4c5a26).lerp(linear(0x6f7d36), tint.unit());
        Some(Paint { albedo: moss, finish: Finish::Sheet { translucency: 0.1 }, opacity: 0.97 })
    });
}
