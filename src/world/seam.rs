//! The height at which an object parts in two: where flowers leave their vase, or a crown its trunk. Colours say which
//! sides differ, and the profile where one thing ends: at its neck.

use crate::scene::Gaussians;
use glam::{DVec2, DVec3};

/// Slices of its height that are looked at.
const SLICES: usize = 50;
/// No border is nearer to an end than this share of the height.
const LEAST: f64 = 0.1;
/// Levels of each colour that are told apart.
const LEVELS: usize = 4;
/// What a border may tell of the colours on its sides for them to be of one kind, in nats: 0.69 is all.
const ALIKE: f64 = 0.02;
/// A neck is this much narrower than what is wider on both sides.
const NECK: f64 = 0.25;
/// Share of a slice's Gaussians that its width holds: threads and leaves that stick out are none of it.
const WITHIN: f64 = 0.9;

/// Where an object parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// Share of its height.
    pub share: f64,
    /// What tells the one side from the other.
    pub by: Mark,
}

/// What a seam was found by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// It is narrower there than below and above.
    Neck,
    /// Its colours change there most.
    Colours,
    /// Nothing: the middle.
    Nothing,
}

impl Default for Seam {
    fn default() -> Seam {
        Seam { share: 0.5, by: Mark::Nothing }
    }
}

/// Colours by how much of a picture they cover.
type Palette = [f64; LEVELS * LEVELS * LEVELS];

/// The border between slices at which palette and profile together part some Gaussians best. A painted band changes the mean
/// colour as much as a bouquet does, but neither the palette nor the profile.
pub fn of(gaussians: &Gaussians, members: &[u32]) -> Seam {
    let heights = || members.iter().map(|&g| f64::from(gaussians.mean[g as usize].z));
    let (low, high) = heights().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    let mut slices = vec![Vec::new(); SLICES];
    for (&g, z) in members.iter().zip(heights()) {
        let slice = ((z - low) / (high - low).max(1e-12) * SLICES as f64) as usize;
        slices[slice.min(SLICES - 1)].push(g as usize);
    }
    let palettes: Vec<Palette> = slices.iter().map(|slice| palette(gaussians, slice)).collect();
    let widths: Vec<f64> = slices.iter().map(|slice| width(gaussians, slice)).collect();
    let mut best = (0.0, Seam::default());
    for border in 1..SLICES {
        let share = border as f64 / SLICES as f64;
        if !(LEAST..=1.0 - LEAST).contains(&share) {
            continue;
        }
        let (told, necked) = (told(&palettes, border), necked(&widths, border));
        let value = (told + ALIKE) * (NECK + necked);
        if (told > ALIKE || necked > NECK) && value > best.0 {
            best = (value, Seam { share, by: if necked > NECK { Mark::Neck } else { Mark::Colours } });
        }
    }
    best.1
}

/// What a slice shows of each colour.
fn palette(gaussians: &Gaussians, slice: &[usize]) -> Palette {
    let mut palette = [0.0; LEVELS * LEVELS * LEVELS];
    for &g in slice {
        let [r, green, b] = (colour(gaussians, g) * LEVELS as f64).to_array().map(|c| (c as usize).min(LEVELS - 1));
        palette[(r * LEVELS + green) * LEVELS + b] += visible(gaussians, g);
    }
    palette
}

/// How much a border tells of the colours on its sides (mutual information of side and colour), nats.
fn told(palettes: &[Palette], border: usize) -> f64 {
    let sum = |part: &[Palette]| {
        let mut sum = [0.0; LEVELS * LEVELS * LEVELS];
        part.iter().for_each(|palette| sum.iter_mut().zip(palette).for_each(|(s, c)| *s += c));
        sum
    };
    let (below, above) = (sum(&palettes[..border]), sum(&palettes[border..]));
    let (low, high) = (below.iter().sum::<f64>(), above.iter().sum::<f64>());
    if low <= 0.0 || high <= 0.0 {
        return 0.0;
    }
    let of_side = |palette: &Palette, weight: f64| {
        let colours = palette.iter().zip(below.iter().zip(&above)).filter(|(c, _)| **c > 0.0);
        colours.map(|(c, (b, a))| c / (low + high) * (c * (low + high) / (weight * (b + a))).ln()).sum::<f64>()
    };
    of_side(&below, low) + of_side(&above, high)
}

/// The distance from its middle that most of a slice is within.
fn width(gaussians: &Gaussians, slice: &[usize]) -> f64 {
    let places = || slice.iter().map(|&g| gaussians.mean[g].truncate().as_dvec2());
    let middle = places().sum::<DVec2>() / slice.len().max(1) as f64;
    let mut away: Vec<f64> = places().map(|place| place.distance(middle)).collect();
    away.sort_by(f64::total_cmp);
    away.get((WITHIN * away.len() as f64) as usize).copied().unwrap_or(0.0)
}

/// How much narrower it is at a border than the widest on either side: 0 where it is not, 1 where nothing is.
fn necked(widths: &[f64], border: usize) -> f64 {
    let widest = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
    let sides = widest(&widths[..border]).min(widest(&widths[border..]));
    if sides > 0.0 { (1.0 - 0.5 * (widths[border - 1] + widths[border]) / sides).max(0.0) } else { 0.0 }
}

/// About how much of a picture a Gaussian covers: opacity times its largest shadow.
fn visible(gaussians: &Gaussians, g: usize) -> f64 {
    let s = gaussians.scale[g].as_dvec3();
    f64::from(gaussians.opacity[g]) * (s.x * s.y).max(s.y * s.z).max(s.z * s.x)
}

/// Its colour without what depends on the view.
fn colour(gaussians: &Gaussians, g: usize) -> DVec3 {
    let first = 3 * gaussians.sh_coefficients() * g;
    let dc = gaussians.sh.get(first..first + 3).map_or(DVec3::ZERO, |c| DVec3::new(c[0].into(), c[1].into(), c[2].into()));
    (0.5 + 0.282_094_79 * dc).clamp(DVec3::ZERO, DVec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A thing of a thousand Gaussians in rings, with this radius and these colours at each share of its height.
    fn thing(radius: impl Fn(f32) -> f32, colour: impl Fn(f32, usize) -> [f32; 3]) -> (Gaussians, Vec<u32>) {
        let mut gaussians = Gaussians::default();
        for i in 0..1000 {
            let z = i as f32 * 1e-3;
            let (sin, cos) = (i as f32 * 2.4).sin_cos();
            gaussians.mean.push(Vec3::new(cos * radius(z), sin * radius(z), z));
            gaussians.scale.push(Vec3::splat(0.01));
            gaussians.opacity.push(0.9);
            gaussians.rotation.push([1.0, 0.0, 0.0, 0.0]);
            gaussians.sh.extend(colour(z, i));
        }
        (gaussians, (0..1000).collect())
    }

    const BLUE: [f32; 3] = [-0.8, -0.5, 1.5];
    const WHITE: [f32; 3] = [1.2, 1.2, 1.2];

    fn flowers(i: usize) -> [f32; 3] {
        if i.is_multiple_of(2) { [1.2, -0.5, -0.5] } else { [-0.5, 1.2, -0.5] }
    }

    #[test]
    fn the_border_is_where_the_colours_change() {
        let (mut gaussians, all) = thing(|_| 0.3, |z, i| if z < 0.3 { BLUE } else { flowers(i) });
        let seam = of(&gaussians, &all);
        assert!((seam.share - 0.3).abs() < 0.021 && seam.by == Mark::Colours, "{seam:?}");
        gaussians.sh.iter_mut().for_each(|c| *c = 0.3);
        assert_eq!(of(&gaussians, &all), Seam::default());
        assert_eq!(of(&gaussians, &[]), Seam::default());
    }

    #[test]
    fn a_painted_band_is_no_border_and_a_neck_is_one() {
        let profile = |z: f32| {
            if z < 0.44 {
                0.3
            } else if z < 0.5 {
                0.12
            } else {
                0.4
            }
        };
        let paint = |z: f32, i: usize| match z {
            z if z > 0.5 => flowers(i),
            z if z > 0.15 && z < 0.24 => WHITE,
            _ => BLUE,
        };
        let (gaussians, all) = thing(profile, paint);
        let seam = of(&gaussians, &all);
        assert!((0.43..=0.51).contains(&seam.share) && seam.by == Mark::Neck, "{seam:?}");
        // Of one colour the neck alone tells.
        let (gaussians, all) = thing(profile, |_, _| WHITE);
        let seam = of(&gaussians, &all);
        assert!((0.43..=0.51).contains(&seam.share) && seam.by == Mark::Neck, "{seam:?}");
    }

    #[test]
    fn the_demo_parts_in_the_neck_of_its_vase() {
        let gaussians = crate::scene::demo::gaussians(1);
        let crate::spec::Select::Box(stands) = crate::scene::demo::spec().objects[0].select.clone() else { panic!("a box") };
        let within = |p: Vec3| (p.as_dvec3() - DVec3::from(stands.centre_m)).abs().cmple(0.5 * DVec3::from(stands.size_m)).all();
        let members: Vec<u32> = (0..gaussians.len() as u32).filter(|&g| within(gaussians.mean[g as usize])).collect();
        // The neck of the turned vase is at four tenths, its lip at just under a half of it and the bouquet.
        let seam = of(&gaussians, &members);
        assert!((0.38..0.49).contains(&seam.share) && seam.by == Mark::Neck, "{seam:?}");
    }
}
