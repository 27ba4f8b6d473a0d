//! `body_*.wgsl` in plain Rust: every pair of particles is looked at in place of the sorted cells.

use super::*;
use crate::skin::twin::{eigen, smoothstep};
use glam::Mat3;

/// A particle as it is drawn: its record (see [`crate::skin::Splats`]) and the first coefficient of its colour.
pub type Drawn = ([f32; 16], Vec3);

/// Pass `skin.body_place`: how far those that were around a particle have left.
pub fn parted(filling: &Filling, places: &[Vec3], flow: u32, i: usize) -> f32 {
    let gone_at = if flow == 1 { GRAINS_GONE } else { GONE };
    let beside = &filling.beside[i * BESIDE as usize..(i + 1) * BESIDE as usize];
    let farther = |j: usize| places[j].distance(places[i]) - filling.rest_m[j].distance(filling.rest_m[i]);
    let gone: f32 = beside.iter().map(|&j| smoothstep(gone_at, farther(j as usize) / filling.spacing_m)).sum();
    smoothstep(PARTED, gone / BESIDE as f32)
}

/// What lies around a particle; see `struct Around`.
struct Around {
    volume: f32,
    middle: Vec3,
    spread: Mat3,
    colour: Vec3,
    lean: Vec3,
}

/// Weight of what is `from` a place, given its size.
fn weight(from: Vec3, size_m: f32, reach_m: f32) -> f32 {
    (1.0 - (from / reach_m).length_squared()).max(0.0).powi(3) * (size_m / reach_m).powi(3)
}

/// The same of its colour.
fn share(from: Vec3, size_m: f32, reach_m: f32) -> f32 {
    (1.0 - (from / reach_m).length_squared()).max(0.0) * (size_m / reach_m).powi(3)
}

/// The colour that a particle brings along.
fn brought(filling: &Filling, flow: u32, i: usize) -> Vec3 {
    Vec3::from_slice(if flow > 1 { &filling.dye[i] } else { &filling.tint[i] })
}

/// Pass `skin.body_stir`: the mean light of what a particle has come to.
pub fn stirred_light(filling: &Filling, places: &[Vec3], flow: &[u32], i: usize) -> Vec3 {
    let reach_m = REACH * filling.spacing_m;
    let (mut light, mut total) = (Vec3::ZERO, 0.0);
    for (j, &x) in places.iter().enumerate().filter(|(j, _)| flow[*j] > 0) {
        let w = share(x - places[i], filling.tint[j][3], reach_m) * if j == i { OWN_COLOUR } else { 1.0 };
        light += brought(filling, flow[j], j).powf(2.0) * w;
        total += w;
    }
    light / total
}

/// Pass `skin.body_stir`: the middle of what lies around a particle, in reaches.
fn middle(filling: &Filling, places: &[Vec3], flow: &[u32], i: usize) -> Vec3 {
    let reach_m = REACH * filling.spacing_m;
    let (mut first, mut volume) = (Vec3::ZERO, 0.0);
    for (j, &x) in places.iter().enumerate().filter(|(j, _)| flow[*j] > 0) {
        let w = weight(x - places[i], filling.tint[j][3], reach_m);
        first += (x - places[i]) * (w / reach_m);
        volume += w;
    }
    first / volume
}

fn around(filling: &Filling, places: &[Vec3], flow: &[u32], i: usize, cells: f32) -> Around {
    let reach_m = cells * REACH * filling.spacing_m;
    let (mut volume, mut first, mut second, mut lean) = (0.0, Vec3::ZERO, Mat3::ZERO, Vec3::ZERO);
    let (mut light, mut lit) = (Vec3::ZERO, 0.0);
    for (j, &x) in places.iter().enumerate().filter(|(j, _)| flow[*j] > 0) {
        let w = weight(x - places[i], filling.tint[j][3], reach_m);
        if w > 0.0 {
            let d = (x - places[i]) / reach_m;
            volume += w;
            first += d * w;
            second += outer(d, d) * w;
            let shines = share(x - places[i], filling.tint[j][3], reach_m);
            light += stirred_light(filling, places, flow, j) * shines;
            lit += shines;
            lean += middle(filling, places, flow, j) * w;
        }
    }
    let mean = first / volume;
    let spread = second * (1.0 / volume) - outer(mean, mean);
    Around { volume, middle: mean, spread, colour: (light / lit).powf(0.5), lean: lean / volume }
}

/// What a particle looks like; see `struct Look`.
struct Look {
    covariance: Mat3,
    normal: Vec3,
    inward: Vec3,
    thickness: f32,
    full: f32,
    loose: f32,
    joined: f32,
    colour: Vec3,
}

fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

fn looked(size_m: f32, here: &Around, cells: f32, filling: &Filling) -> Look {
    let reach_m = cells * REACH * filling.spacing_m;
    let own = (size_m / reach_m).powi(3) / here.volume;
    let (values, most, least) = principal(here.spread);
    let joined = 1.0 - smoothstep(ALONE, own);
    let broad = smoothstep(BROAD, (values[1].max(0.0) / values[0].max(1e-12)).sqrt());
    let sheet = (1.0 - smoothstep(THIN, values[2].max(0.0) / values[1].max(1e-12))) * broad * joined;

    let off = here.middle.length();
    let leaning = here.lean.length();
    let outward = -here.lean / leaning.max(1e-6);
    let skin = smoothstep(LEAN, leaning) * joined;
    let across = if least.dot(outward) >= 0.0 { least } else { -least };
    let n = (outward.lerp(across, sheet) + Vec3::X * 1e-9).normalize();

    let spare = (filling.spacing_m / size_m).max(1.0);
    let apart = mix(THREAD * cells * own, cells * (SHEET * own).sqrt(), broad);
    let held = mix(1.0, apart.max(1.0) * spare, mix(joined, sheet, broad)).min(WIDEST);
    let full = mix(1.0, spare, joined * (1.0 - sheet) * broad);
    let gaps = (cells * (BALL * own * (1.0 - 0.5 * skin)).cbrt()).clamp(1.0, LOOSEST);
    let flat = 1.0 + (FLAT - 1.0) * skin.max(sheet);
    let across_r = mix(held.powf(-0.5), held, broad) * flat * full;
    let thickness = mix(held.powf(-0.5), held.powi(-2), broad).max(THINNEST);
    let longer = (held * held - across_r * across_r).max(0.0) * (1.0 - broad) * joined;
    let flattened = outer(n, n) * (across_r * across_r - (thickness * full / flat).powi(2));
    Look {
        covariance: Mat3::IDENTITY * (across_r * across_r) - flattened + outer(most, most) * longer,
        normal: n * skin.max(sheet),
        inward: here.middle * (reach_m * EVEN * (1.0 - SKIN / off.max(1e-6)).max(0.0) * joined),
        thickness,
        full,
        loose: mix(1.0, gaps, joined * (1.0 - sheet) * broad),
        joined,
        colour: here.colour,
    }
}

fn look(filling: &Filling, places: &[Vec3], flow: &[u32], i: usize) -> Look {
    let size_m = filling.tint[i][3];
    let here = around(filling, places, flow, i, 1.0);
    let near = looked(size_m, &here, 1.0, filling);
    let few = smoothstep(FEW, (size_m / (REACH * filling.spacing_m)).powi(3) / here.volume);
    let far = looked(size_m, &around(filling, places, flow, i, 2.0), 2.0, filling);
    Look {
        covariance: near.covariance * (1.0 - few) + far.covariance * few,
        normal: near.normal.lerp(if near.normal.dot(far.normal) >= 0.0 { far.normal } else { -far.normal }, few),
        inward: near.inward.lerp(far.inward, few),
        thickness: mix(near.thickness, far.thickness, few),
        full: mix(near.full, far.full, few),
        loose: mix(near.loose, far.loose, few),
        joined: mix(near.joined, far.joined, few),
        colour: near.colour.lerp(far.colour, few),
    }
}

/// Passes `skin.body_order` and `skin.body_shape`: one particle, none where it is not seen. `flow` is 0 for what keeps its shape.
pub fn drawn(filling: &Filling, places: &[Vec3], flow: &[u32], i: usize) -> Option<Drawn> {
    all_drawn(filling, places, flow, i).into_iter().next()
}

/// All that is drawn of it.
pub fn all_drawn(filling: &Filling, places: &[Vec3], flow: &[u32], i: usize) -> Vec<Drawn> {
    let parted = if flow[i] == 0 { 0.0 } else { parted(filling, places, flow[i], i) };
    if parted <= 0.0 {
        return Vec::new();
    }
    let look = look(filling, places, flow, i);
    match flow[i] {
        1 => (0..filling.grains as usize).map(|slot| grain(filling, places, &look, parted, i, slot)).collect(),
        flow => vec![poured(filling, places, &look, parted, flow, i)],
    }
}

fn grain(filling: &Filling, places: &[Vec3], look: &Look, parted: f32, i: usize, slot: usize) -> Drawn {
    let size_m = filling.tint[i][3];
    let word = (i + slot * places.len()) as u32;
    let apart = look.loose.max(look.thickness.powf(-0.5));
    let share = (filling.grains as f32).powf(-1.0 / 3.0);
    let size = mix(GRAINS[0], GRAINS[1], chance(word.wrapping_add(0x9e37_79b9)));
    let mut astray = Vec3::new(chance(3 * word), chance(3 * word + 1), chance(3 * word + 2)) * 2.0 - 1.0;
    astray -= look.normal * look.normal.dot(astray);
    let x = places[i] + astray * (ASTRAY * apart * size_m * parted);
    let radius_m = GRAIN * share * size * look.full * RADIUS * size_m * mix(YOUNG, 1.0, parted);
    let tone = 1.0 + TONE * (2.0 * chance(word) - 1.0);
    let opacity = OPACITY * smoothstep([0.0, SEEN], parted);
    record(x, opacity, Mat3::IDENTITY * (radius_m * radius_m), look.normal, 0.0, brought(filling, 1, i) * tone)
}

fn poured(filling: &Filling, places: &[Vec3], look: &Look, parted: f32, flow: u32, i: usize) -> Drawn {
    let size_m = filling.tint[i][3];
    let clear = if flow == 3 { filling.dye[i][3] } else { 0.0 };
    let shown = smoothstep([0.0, SEEN], parted);
    let wide = mix(look.loose, mix(DROP[1], WIDER, look.joined), clear);
    let radius_m = wide * RADIUS * size_m * mix(YOUNG, 1.0, parted);
    let dimmed = 1.0 - (-size_m * look.thickness / FREE_M).exp();
    let opacity = shown * mix(OPACITY, mix(DROP[0], dimmed, look.joined), clear);
    let gloss = mix(GLOSS[flow as usize - 2], GLOSS[2] / (1.0 - (-LAYERED * dimmed).exp()), clear);
    let colour = brought(filling, flow, i).lerp(look.colour, shown).lerp(Vec3::ONE, clear * mix(PALE[1], PALE[0], look.joined));
    record(places[i] + look.inward, opacity, look.covariance * (radius_m * radius_m), look.normal, gloss, colour)
}

fn record(x: Vec3, opacity: f32, c: Mat3, n: Vec3, gloss: f32, colour: Vec3) -> Drawn {
    let (a, b, d) = (c.x_axis, c.y_axis, c.z_axis);
    ([x.x, x.y, x.z, opacity, a.x, a.y, a.z, b.y, b.z, d.z, 1.0, 1.0 + gloss, n.x, n.y, n.z, 0.0], (colour - 0.5) / SH_FIRST)
}

/// 0 to 1, of a particle.
fn chance(word: u32) -> f32 {
    (stirred(word) >> 8) as f32 / 16_777_216.0
}

fn stirred(word: u32) -> u32 {
    let mut h = word;
    h = (h ^ h >> 16).wrapping_mul(0x7feb_352d);
    h = (h ^ h >> 15).wrapping_mul(0x846c_a68b);
    h ^ h >> 16
}

fn outer(a: Vec3, b: Vec3) -> Mat3 {
    Mat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Principal values, descending, and the axes of the largest and of the least.
pub fn principal(matrix: Mat3) -> ([f32; 3], Vec3, Vec3) {
    let size = (matrix.x_axis.x.abs() + matrix.y_axis.y.abs() + matrix.z_axis.z.abs()).max(1e-30);
    let (values, axes) = eigen(matrix * (1.0 / size));
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    (order.map(|k| values[k] * size), axes.col(order[0]), axes.col(order[2]))
}
