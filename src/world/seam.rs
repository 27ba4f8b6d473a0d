//! The height at which an object's colours change most: where flowers leave their vase, or a crown its trunk.

use crate::scene::Gaussians;
use glam::DVec3;

/// Slices of its height that are looked at.
const SLICES: usize = 50;
/// No border is nearer to an end than this share of the height.
const LEAST: f64 = 0.1;
/// Colours that differ by less are one, as a share of full brightness.
const ALIKE: f64 = 0.04;

/// The share of the height of some Gaussians at which the mean colours above and below differ most, weighed by how much is
/// on the smaller side (Otsu's rule); a half where nothing differs.
pub fn of(gaussians: &Gaussians, members: &[u32]) -> f64 {
    let heights = || members.iter().map(|&g| f64::from(gaussians.mean[g as usize].z));
    let (low, high) = heights().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    let mut slices = [(0.0, DVec3::ZERO); SLICES];
    for (&g, z) in members.iter().zip(heights()) {
        let slice = ((z - low) / (high - low).max(1e-12) * SLICES as f64) as usize;
        let weight = visible(gaussians, g as usize);
        let (sum, colours) = &mut slices[slice.min(SLICES - 1)];
        *sum += weight;
        *colours += weight * colour(gaussians, g as usize);
    }
    let add = |a: (f64, DVec3), b: &(f64, DVec3)| (a.0 + b.0, a.1 + b.1);
    let sum = |part: &[(f64, DVec3)]| part.iter().fold((0.0, DVec3::ZERO), add);
    let mut best = (0.0, 0.5);
    for border in 1..SLICES {
        let share = border as f64 / SLICES as f64;
        let (below, above) = (sum(&slices[..border]), sum(&slices[border..]));
        if !(LEAST..=1.0 - LEAST).contains(&share) || below.0 <= 0.0 || above.0 <= 0.0 {
            continue;
        }
        let apart = (below.1 / below.0).distance(above.1 / above.0);
        let between = below.0 * above.0 * apart * apart;
        if apart > ALIKE && between > best.0 {
            best = (between, share);
        }
    }
    best.1
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

    #[test]
    fn the_border_is_where_the_colour_changes() {
        let mut gaussians = Gaussians::default();
        for i in 0..1000 {
            let z = i as f32 * 1e-3;
            gaussians.mean.push(Vec3::new(0.0, (i % 7) as f32, z));
            gaussians.scale.push(Vec3::splat(0.01));
            gaussians.opacity.push(0.9);
            gaussians.rotation.push([1.0, 0.0, 0.0, 0.0]);
            // Blue below three tenths, greens and reds above.
            let other = if i % 2 == 0 { [1.2, -0.5, -0.5] } else { [-0.5, 1.2, -0.5] };
            gaussians.sh.extend(if z < 0.3 { [-0.8, -0.5, 1.5] } else { other });
        }
        let all: Vec<u32> = (0..1000).collect();
        assert!((of(&gaussians, &all) - 0.3).abs() < 0.021);
        gaussians.sh.iter_mut().for_each(|c| *c = 0.3);
        assert_eq!(of(&gaussians, &all), 0.5);
        assert_eq!(of(&gaussians, &[]), 0.5);
    }
}
