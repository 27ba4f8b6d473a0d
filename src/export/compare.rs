//! Whether two pictures are the same to the eye, and where they are not.

use super::Raster;
use serde::{Deserialize, Serialize};

/// How far a picture may be from the expected one. Both bounds must hold. Drivers round exponentials
/// differently, which moves single values by one or two; a splat that flips in or out of a pixel moves a
/// few pixels by more; a thing that is in another place moves many by a lot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// The least peak signal-to-noise ratio over all pixels and the three channels, dB.
    pub psnr_db: f64,
    /// A pixel differs when one of its channels is off by more than this, of 255.
    pub visible: u8,
    /// The largest share of pixels that may differ, 0 to 1.
    pub differing_share: f64,
}

impl Default for Tolerance {
    /// 40 dB, and no more than 0.2 % of the pixels off by more than 12 of 255.
    fn default() -> Self {
        Tolerance { psnr_db: 40.0, visible: 12, differing_share: 0.002 }
    }
}

/// What comparing two pictures found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Whether the picture is within the tolerance.
    pub held: bool,
    /// dB over red, green and blue; infinite (null in JSON) where nothing differs, 0 where sizes do.
    pub psnr_db: f64,
    /// The largest difference of a channel, 0 to 255.
    pub max_abs: u8,
    /// Share of pixels off by more than `tolerance.visible`, 0 to 1.
    pub differing_share: f64,
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// Width and height of the expected one.
    pub expected_size: [u32; 2],
    /// What was allowed.
    pub tolerance: Tolerance,
    /// The expected picture in dim grey with the differences glowing over it; none where sizes differ.
    #[serde(skip)]
    pub difference: Option<Raster>,
}

/// Compares the colours of two pictures; alpha does not count. Pictures of different sizes do not hold.
pub fn compare(actual: &Raster, expected: &Raster, tolerance: Tolerance) -> Comparison {
    let mut result = Comparison {
        held: false,
        psnr_db: 0.0,
        max_abs: 255,
        differing_share: 1.0,
        size: actual.size,
        expected_size: expected.size,
        tolerance,
        difference: None,
    };
    if actual.size != expected.size || actual.rgba8.len() != expected.rgba8.len() {
        return result;
    }
    let (mut squares, mut differing, mut largest) = (0u64, 0u64, 0u8);
    let mut picture = Vec::with_capacity(actual.rgba8.len());
    for (a, e) in actual.rgba8.as_chunks::<4>().0.iter().zip(expected.rgba8.as_chunks::<4>().0) {
        let off: [u8; 3] = std::array::from_fn(|k| a[k].abs_diff(e[k]));
        let worst = off.into_iter().fold(0, u8::max);
        squares += off.iter().map(|&d| u64::from(d) * u64::from(d)).sum::<u64>();
        differing += u64::from(worst > tolerance.visible);
        largest = largest.max(worst);
        picture.extend(glow(*e, worst));
    }
    let pixels = (picture.len() / 4).max(1) as f64;
    // 10 log10 of 255² over the mean square; a mean square of 0 gives infinity, as it should.
    result.psnr_db = 10.0 * (255.0 * 255.0 * 3.0 * pixels / squares as f64).log10();
    result.max_abs = largest;
    result.differing_share = differing as f64 / pixels;
    result.held = result.psnr_db >= tolerance.psnr_db && result.differing_share <= tolerance.differing_share;
    result.difference = Some(Raster { size: actual.size, rgba8: picture });
    result
}

impl Comparison {
    /// One sentence for people.
    pub fn sentence(&self) -> String {
        let ([w, h], [ew, eh]) = (self.size, self.expected_size);
        if self.size != self.expected_size {
            return format!("{w}x{h} pixels where {ew}x{eh} were expected");
        }
        if self.max_abs == 0 {
            return "equal".to_owned();
        }
        format!(
            "{:.1} dB (at least {:.0}), {:.3} % of pixels off by more than {} (at most {:.1} %), largest difference {}",
            self.psnr_db,
            self.tolerance.psnr_db,
            100.0 * self.differing_share,
            self.tolerance.visible,
            100.0 * self.tolerance.differing_share,
            self.max_abs
        )
    }
}

/// A dim grey pixel, brightened from red over yellow to white by sixteen times the difference.
fn glow(expected: [u8; 4], difference: u8) -> [u8; 4] {
    let grey = expected[..3].iter().map(|&v| u32::from(v)).sum::<u32>() / 9;
    let heat = u32::from(difference) * 16;
    let channel = |start: u32| (grey + heat.saturating_sub(start)).min(255) as u8;
    [channel(0), channel(255), channel(1020), 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pictures_hold_whatever_their_alpha() {
        let a = Raster::filled([4, 4], [10, 20, 30, 255]);
        let b = Raster::filled([4, 4], [10, 20, 30, 0]);
        let found = compare(&a, &b, Tolerance::default());
        assert!(found.held && found.psnr_db.is_infinite() && found.max_abs == 0 && found.sentence() == "equal");
        assert!(serde_json::to_string(&found).unwrap().contains("\"psnr_db\":null"));
    }

    #[test]
    fn rounding_holds_and_a_moved_thing_does_not() {
        let expected = Raster::filled([64, 64], [200, 200, 200, 255]);
        let mut rounded = expected.clone();
        rounded.rgba8.iter_mut().step_by(3).for_each(|v| *v -= 1);
        let found = compare(&rounded, &expected, Tolerance::default());
        assert!(found.held && found.max_abs == 1 && found.psnr_db > 48.0, "{}", found.sentence());

        // A dark spot of 4 x 4 is 0.4 % of the picture: more than 40 dB would let pass if it were faint.
        let mut moved = expected.clone();
        moved.paste(&Raster::filled([4, 4], [180, 180, 180, 255]), 30, 30);
        let found = compare(&moved, &expected, Tolerance::default());
        assert!(!found.held && found.psnr_db > 40.0 && found.differing_share > 0.003, "{}", found.sentence());
        let difference = found.difference.unwrap();
        assert!(difference.rgba8[(31 * 64 + 31) * 4] > 200 && difference.rgba8[0] < 100);
    }

    #[test]
    fn psnr_is_the_textbooks() {
        let a = Raster::filled([8, 8], [100, 100, 100, 255]);
        let b = Raster::filled([8, 8], [110, 110, 110, 255]);
        let expected_db = 20.0 * (255.0f64 / 10.0).log10();
        assert!((compare(&a, &b, Tolerance::default()).psnr_db - expected_db).abs() < 1e-9);
    }

    #[test]
    fn other_sizes_fail_clearly() {
        let found = compare(&Raster::filled([4, 4], [0; 4]), &Raster::filled([4, 5], [0; 4]), Tolerance::default());
        assert!(!found.held && found.difference.is_none());
        assert_eq!(found.sentence(), "4x4 pixels where 4x5 were expected");
    }
}
