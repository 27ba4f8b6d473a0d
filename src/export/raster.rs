//! A picture in memory, and how it is made smaller.

use super::ExportError;
use std::sync::LazyLock;

/// An 8-bit picture: sRGB, four bytes a pixel, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// `size[0] * size[1] * 4` bytes.
    pub rgba8: Vec<u8>,
}

impl Raster {
    /// A picture of one colour.
    pub fn filled(size: [u32; 2], colour: [u8; 4]) -> Raster {
        Raster { size, rgba8: colour.repeat(size[0] as usize * size[1] as usize) }
    }

    /// The four bytes of a pixel; outside the picture, nothing.
    pub(super) fn pixel_mut(&mut self, x: u32, y: u32) -> Option<&mut [u8]> {
        let inside = x < self.size[0] && y < self.size[1];
        let at = (y as usize * self.size[0] as usize + x as usize) * 4;
        if inside { self.rgba8.get_mut(at..at + 4) } else { None }
    }

    /// Copies a picture in with its upper left corner at (x, y).
    pub(super) fn paste(&mut self, other: &Raster, x: u32, y: u32) {
        let width = other.size[0].min(self.size[0].saturating_sub(x)) as usize;
        let rows = other.size[1].min(self.size[1].saturating_sub(y));
        for row in 0..rows {
            let from = row as usize * other.size[0] as usize * 4;
            let to = ((y + row) as usize * self.size[0] as usize + x as usize) * 4;
            self.rgba8[to..to + width * 4].copy_from_slice(&other.rgba8[from..from + width * 4]);
        }
    }
}

/// Fails where the number of values is not what the size says.
pub(super) fn check(size: [u32; 2], values_per_pixel: usize, got: usize) -> Result<(), ExportError> {
    let needed = size[0] as usize * size[1] as usize * values_per_pixel;
    if needed == got && needed > 0 { Ok(()) } else { Err(ExportError::Pixels { size, needed, got }) }
}

/// The largest size of the same shape that is at most `width` wide, at least one pixel, both sides even
/// where they are more than one, as video wants them.
pub(super) fn fitted(size: [u32; 2], width: u32) -> [u32; 2] {
    let scaled = if size[0] <= width { size } else { [width, (f64::from(size[1]) * f64::from(width) / f64::from(size[0])).round() as u32] };
    scaled.map(|side| if side > 1 { side & !1 } else { 1 })
}

/// Shrinks an opaque picture: each new pixel is the mean of the area it covers, taken in linear
/// light, so that fine bright detail does not darken.
pub(super) fn shrunk(size: [u32; 2], rgba8: &[u8], to: [u32; 2]) -> Raster {
    if size == to {
        return Raster { size, rgba8: rgba8.to_vec() };
    }
    let [width, height] = [size[0] as usize, size[1] as usize];
    let (columns, rows) = (covered(size[0], to[0]), covered(size[1], to[1]));
    let mut narrow = Vec::with_capacity(columns.len() * height);
    for row in rgba8.as_chunks::<4>().0.chunks_exact(width) {
        narrow.extend(columns.iter().map(|c| c.mean(|x| [row[x][0], row[x][1], row[x][2]].map(|v| LINEAR[usize::from(v)]))));
    }
    let mut out = Vec::with_capacity(to[0] as usize * to[1] as usize * 4);
    for row in &rows {
        for x in 0..columns.len() {
            let [r, g, b] = row.mean(|y| narrow[y * columns.len() + x]).map(to_srgb8);
            out.extend([r, g, b, 255]);
        }
    }
    Raster { size: to, rgba8: out }
}

/// The old pixels that a new one covers along one axis, with the share of each.
struct Cover {
    first: usize,
    shares: Vec<f32>,
}

impl Cover {
    fn mean(&self, value: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (i, share) in self.shares.iter().enumerate() {
            let v = value(self.first + i);
            (0..3).for_each(|k| sum[k] += share * v[k]);
        }
        sum
    }
}

fn covered(from: u32, to: u32) -> Vec<Cover> {
    let step = f64::from(from) / f64::from(to);
    (0..to)
        .map(|i| {
            let (start, end) = (f64::from(i) * step, (f64::from(i + 1) * step).min(f64::from(from)));
            let (first, last) = (start.floor() as usize, ((end - 1e-9).floor() as usize).max(start.floor() as usize));
            let share = |x: usize| ((end.min((x + 1) as f64) - start.max(x as f64)) / (end - start)) as f32;
            Cover { first, shares: (first..=last).map(share).collect() }
        })
        .collect()
}

static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|i| srgb_to_linear(i as f32 / 255.0)));

/// Linear light from which on each 8-bit value is the nearest.
static FROM: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| if i == 0 { f32::NEG_INFINITY } else { srgb_to_linear((i as f32 - 0.5) / 255.0) }));

/// The 8-bit value at the start of each of these equal parts of linear light from 0 to 1: the search goes on from there.
const PARTS: usize = 4096;
static START: LazyLock<[u8; PARTS + 1]> =
    LazyLock::new(|| std::array::from_fn(|i| (FROM.partition_point(|from| *from <= i as f32 / PARTS as f32) - 1) as u8));

/// sRGB to linear light (IEC 61966-2-1); values beyond 0 to 1 follow the same curve.
pub(super) fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// The nearest 8-bit value of linear light.
fn to_srgb8(v: f32) -> u8 {
    let mut nearest = START[((v * PARTS as f32) as usize).min(PARTS)];
    while nearest < 255 && v >= FROM[usize::from(nearest) + 1] {
        nearest += 1;
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plain_picture_stays_plain_at_any_size() {
        for colour in [0u8, 1, 77, 234, 255] {
            let big = Raster::filled([101, 57], [colour, colour, 10, 255]);
            for to in [[100, 56], [33, 19], [2, 2], [1, 1]] {
                let small = shrunk(big.size, &big.rgba8, to);
                assert_eq!(small, Raster::filled(to, [colour, colour, 10, 255]));
            }
        }
    }

    #[test]
    fn means_are_of_light_not_of_numbers() {
        let board = Raster { size: [2, 2], rgba8: [[0, 0, 0, 255], [255; 4], [255; 4], [0, 0, 0, 255]].concat() };
        assert_eq!(shrunk([2, 2], &board.rgba8, [1, 1]).rgba8, [188, 188, 188, 255]);
    }

    #[test]
    fn light_goes_to_the_nearest_value() {
        let formula = |v: f32| {
            let encoded = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
            encoded * 255.0
        };
        for i in 0..=100_000 {
            let v = i as f32 / 100_000.0;
            assert!((f32::from(to_srgb8(v)) - formula(v)).abs() < 0.502, "{v}: {} for {}", to_srgb8(v), formula(v));
        }
    }

    #[test]
    fn sizes_keep_their_shape() {
        assert_eq!(fitted([1280, 720], 640), [640, 360]);
        assert_eq!(fitted([300, 201], 640), [300, 200]);
        assert_eq!(fitted([4000, 1], 640), [640, 1]);
        assert!(check([2, 2], 4, 15).is_err() && check([0, 2], 4, 0).is_err() && check([2, 2], 4, 16).is_ok());
    }
}
