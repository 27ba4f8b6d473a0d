//! The colours that flow: of each place of a thing the colour that it has from afar, so that what is poured runs in streaks of the
//! thing's own hues, not in the specks of its petals, shadows and highlights.

use super::{BESIDE, Filling};
use glam::Vec3;

/// How far colours are taken together, as a standard deviation along an axis over the extent of the thing.
const SPREAD: f32 = 0.03;
/// Rounds of that at most, where particles are tiny.
const ROUNDS_MOST: u32 = 100;
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

/// The colour of the surroundings of an object's particles in the captured pose: it spreads from each to those beside it.
pub(super) fn mix(filling: &Filling, own: &[usize]) -> Vec<Vec3> {
    let (low, high) = own.iter().map(|&i| filling.rest_m[i]).fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
    // Of a round half stays and half comes from a spacing away: a sixth of a spacing squared along each axis.
    let spacings = SPREAD * (high - low).max_element() / filling.spacing_m;
    let rounds = ((6.0 * spacings * spacings).ceil() as u32).min(ROUNDS_MOST);
    let mut slot = vec![0usize; filling.rest_m.len()];
    own.iter().enumerate().for_each(|(k, &i)| slot[i] = k);
    let beside = |i: usize| filling.beside[i * BESIDE as usize..(i + 1) * BESIDE as usize].iter().map(|&j| slot[j as usize]);
    let mut pots: Vec<Pot> = own.iter().map(|&i| Pot::of(Vec3::from_slice(&filling.tint[i]))).collect();
    for _ in 0..rounds {
        let shared = |(k, &i): (usize, &usize)| beside(i).fold(Pot::default().plus(pots[k], 0.5), |pot, j| pot.plus(pots[j], 0.5 / BESIDE as f32));
        pots = own.iter().enumerate().map(shared).collect();
    }
    pots.into_iter().map(Pot::colour).collect()
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
        let mut filling = Filling { tint, spacing_m: 0.01, beside: vec![0; BESIDE as usize * rest_m.len()], rest_m, ..Filling::default() };
        let own: Vec<usize> = (0..filling.rest_m.len()).collect();
        filling.watch(&own);
        for (i, dye) in mix(&filling, &own).into_iter().enumerate() {
            let hue = if i % 40 < 20 { dye.x - dye.z } else { dye.z - dye.x };
            let middle = (i % 40).abs_diff(20) < 5;
            assert!(middle || hue > 0.45, "{}: {dye}", i % 40);
            assert!(dye.max_element() < 0.9 && dye.max_element() > 0.3, "{dye}");
        }
    }
}
