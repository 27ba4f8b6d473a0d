//! The colours that flow: of each place of a thing the colour that it has from afar, so that what is poured runs in streaks of the
//! thing's own hues, not in the specks of its petals, shadows and highlights.

use super::Filling;
use glam::Vec3;
use std::collections::BTreeMap;

/// How far colours are taken together, as a standard deviation along an axis over the extent of the thing.
const SPREAD: f32 = 0.06;
/// How far a cell's colour spreads, as a standard deviation in cells: the square root of 1/12 of the cell, 1/2 of the blur and 1/6 of
/// what is taken between cells.
const BLUR: f32 = 0.866;
/// Weight of what has no colour, a shadow or a white, beside what is vivid: 1 over its chroma.
const PALE: f32 = 0.15;
/// Chroma that hues which cancel out lose is given back, up to so many times what is left.
const VIVID_MOST: f32 = 2.0;

/// What is known of the colour around a place, each by its weight.
#[derive(Clone, Copy, Default)]
struct Pot {
    light: Vec3,
    chroma: f32,
    weight: f32,
}

impl Pot {
    fn of(colour: Vec3) -> Pot {
        let chroma = chroma(colour);
        let weight = PALE + chroma;
        Pot { light: colour * colour * weight, chroma: chroma * weight, weight }
    }

    fn plus(self, other: Pot, share: f32) -> Pot {
        Pot { light: self.light + other.light * share, chroma: self.chroma + other.chroma * share, weight: self.weight + other.weight * share }
    }

    /// As vivid as what is in it, as far as its hues allow.
    fn colour(self) -> Vec3 {
        let mean = (self.light / self.weight).map(f32::sqrt);
        let grey = Vec3::splat(mean.element_sum() / 3.0);
        let times = (self.chroma / self.weight / chroma(mean).max(1e-3)).clamp(1.0, VIVID_MOST);
        (grey + (mean - grey) * times).clamp(Vec3::ZERO, Vec3::ONE)
    }
}

/// Distance between its brightest and its darkest component.
fn chroma(colour: Vec3) -> f32 {
    colour.max_element() - colour.min_element()
}

type Pots = BTreeMap<[i32; 3], Pot>;

/// Half of each stays, a quarter goes to the cell on either side.
fn blurred(pots: &Pots, axis: usize) -> Pots {
    let mut all = Pots::new();
    for (&cell, &pot) in pots {
        for (step, share) in [(-1, 0.25), (0, 0.5), (1, 0.25)] {
            let mut to = cell;
            to[axis] += step;
            let there = all.entry(to).or_default();
            *there = there.plus(pot, share);
        }
    }
    all
}

/// What lies around a place, in cells, by the eight cells whose middles are nearest.
fn between(pots: &Pots, place: Vec3) -> Pot {
    let corner = (place - 0.5).floor();
    let f = place - 0.5 - corner;
    (0..8).fold(Pot::default(), |sum, k| {
        let step = Vec3::new((k % 2) as f32, (k / 2 % 2) as f32, (k / 4) as f32);
        let share = (Vec3::ONE - (f - step).abs()).element_product();
        pots.get(&(corner + step).as_ivec3().to_array()).map_or(sum, |&pot| sum.plus(pot, share))
    })
}

/// The colour of the surroundings of an object's particles in the captured pose.
pub(super) fn mix(filling: &Filling, own: &[usize]) -> Vec<Vec3> {
    let places = || own.iter().map(|&i| filling.rest_m[i]);
    let (low, high) = places().fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
    let cell_m = (SPREAD / BLUR * (high - low).max_element()).max(filling.spacing_m);
    let mut pots = Pots::new();
    for (&i, place) in own.iter().zip(places()) {
        let there = pots.entry(((place - low) / cell_m).floor().as_ivec3().to_array()).or_default();
        *there = there.plus(Pot::of(Vec3::from_slice(&filling.tint[i])), 1.0);
    }
    let pots = (0..3).fold(pots, |pots, axis| blurred(&pots, axis));
    places().map(|place| between(&pots, (place - low) / cell_m).colour()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn specks_and_shadows_go_and_hues_stay() {
        let rest_m: Vec<Vec3> = (0..40 * 5 * 5).map(|i| Vec3::new((i % 40) as f32, (i / 40 % 5) as f32, (i / 200) as f32) * 0.01).collect();
        // Red with specks of black and white to the left, blue with the same to the right.
        let of = |i: usize| match (i % 3, i % 40 < 20) {
            (0, _) => Vec3::splat(0.05),
            (1, _) if i.is_multiple_of(2) => Vec3::splat(0.95),
            (_, true) => Vec3::new(0.8, 0.1, 0.1),
            (_, false) => Vec3::new(0.1, 0.1, 0.8),
        };
        let tint = (0..rest_m.len()).map(|i| of(i).extend(0.01).to_array()).collect();
        let filling = Filling { tint, spacing_m: 0.01, rest_m, ..Filling::default() };
        let own: Vec<usize> = (0..filling.rest_m.len()).collect();
        for (i, dye) in mix(&filling, &own).into_iter().enumerate() {
            let hue = if i % 40 < 20 { dye.x - dye.z } else { dye.z - dye.x };
            let middle = (i % 40).abs_diff(20) < 5;
            assert!(middle || hue > 0.45, "{}: {dye}", i % 40);
            assert!(dye.max_element() < 0.9 && dye.max_element() > 0.3, "{dye}");
        }
    }
}
