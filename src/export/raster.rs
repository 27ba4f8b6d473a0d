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
    let narrow: Vec<[f32; 3]> = (0..height)
        .flat_map(|y| {
            let row = &rgba8[y * width * 4..(y + 1) * width * 4];
            columns.iter().map(move |c| c.mean(|x| std::array::from_fn(|k| LINEAR[usize::from(row[x * 4 + k])])))
        })
        .collect();
    let mut out = Vec::with_capacity(to[0] as usize * to[1] as usize * 4);
    for row in &rows {
        for x in 0..columns.len() {
            let colour = row.mean(|y| narrow[y * columns.len() + x]);
            out.extend(colour.map(to_srgb8));
            out.push(255);
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
        self.shares.iter().enumerate().fold([0.0; 3], |sum, (i, share)| {
            let v = value(self.first + i);
            std::array::from_fn(|k| sum[k] + share * v[k])
        })
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

/// sRGB to linear light (IEC 61966-2-1); values beyond 0 to 1 follow the same curve.
pub(super) fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

fn to_srgb8(v: f32) -> u8 {
    let encoded = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5).clamp(0.0, 255.0) as u8
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
    fn sizes_keep_their_shape() {
        assert_eq!(fitted([1280, 720], 640), [640, 360]);
        assert_eq!(fitted([300, 201], 640), [300, 200]);
        assert_eq!(fitted([4000, 1], 640), [640, 1]);
        assert!(check([2, 2], 4, 15).is_err() && check([0, 2], 4, 0).is_err() && check([2, 2], 4, 16).is_ok());
    }
}
