//! A VP8 key frame (RFC 6386): the picture inside a lossy WebP.
//!
//! Each macroblock of 16 x 16 pixels is guessed from its neighbours above and to the left; what the
//! guess misses is turned into frequencies, rounded, and written as decisions of an arithmetic
//! coder whose probabilities are fitted to the frame.

mod bits;
mod planes;
mod tables;
mod tokens;

use bits::BitWriter;
use planes::{Mode, Plane, cosine, inverse_cosine, inverse_walsh, walsh};
use tokens::{Kind, Tokens};

/// Coarseness, an index of 0 to 127 into the format's tables of steps: fine enough that single hairs
/// of a plant stay, and shadows have no steps.
const COARSENESS: u32 = 8;

/// What the format's tables hold there: the step of the mean and of the other frequencies, for
/// brightness, for the means' own block (2 and 1.55 times as much), and for colour.
const LUMA_STEPS: [i32; 2] = [11, 12];
const MEANS_STEPS: [i32; 2] = [22, 18];
const CHROMA_STEPS: [i32; 2] = [11, 12];

/// Strength of the decoder's filter across block edges, 0 to 63.
const FILTER: u32 = 5;

/// Part of a step by which a frequency must exceed a level to be rounded to it: a little over a half, since
/// zeros are cheap.
const ROUND_UP: f32 = 0.58;

/// The largest level the tree can hold.
const LARGEST: i32 = 2047;

/// Which neighbours of a block hold anything: four columns or rows of brightness, two of each
/// colour, and the means.
type Held = [bool; 9];

/// Encodes an opaque picture of at most 16383 pixels a side; `rgba8(x, y)` gives its pixels.
pub fn encode(size: [usize; 2], rgba8: impl Fn(usize, usize) -> [u8; 4]) -> Vec<u8> {
    let mut frame = FrameWriter::new(Plane::from_rgba(size, rgba8));
    let [columns, rows] = size.map(|side| side.div_ceil(16));
    let mut above: Vec<Held> = vec![[false; 9]; columns];
    for row in 0..rows {
        let mut left: Held = [false; 9];
        for (column, above) in above.iter_mut().enumerate() {
            frame.macroblock(column, row, above, &mut left);
        }
    }
    frame.finish(size)
}

/// A frame being written.
struct FrameWriter {
    source: [Plane; 3],
    rebuilt: [Plane; 3],
    blocks: Vec<Choice>,
    tokens: Tokens,
}

/// What the first partition says of a macroblock.
struct Choice {
    luma: Mode,
    chroma: Mode,
    empty: bool,
}

impl FrameWriter {
    fn new(source: [Plane; 3]) -> FrameWriter {
        let rebuilt = std::array::from_fn(|p| source[p].blank());
        FrameWriter { source, rebuilt, blocks: Vec::new(), tokens: Tokens::default() }
    }

    /// Chooses modes, rounds frequencies, rebuilds, and notes the tokens of one macroblock.
    fn macroblock(&mut self, column: usize, row: usize, above: &mut Held, left: &mut Held) {
        let (luma, guess) = self.best_mode(&[0], column, row, 16);
        let (blocks, means) = self.luma_levels(column, row, &guess[0]);
        let (chroma, guess) = self.best_mode(&[1, 2], column, row, 8);
        let colours = [1, 2].map(|p| self.chroma_levels(p, column, row, &guess[p - 1]));
        let empty = means.iter().chain(blocks.iter().flatten()).chain(colours.iter().flatten().flatten()).all(|&level| level == 0);
        self.blocks.push(Choice { luma, chroma, empty });
        if empty {
            (*above, *left) = ([false; 9], [false; 9]);
            return;
        }
        let mut add = |kind, column: usize, row: usize, levels: &[i32; 16]| {
            let held = self.tokens.block(kind, usize::from(above[column]) + usize::from(left[row]), levels);
            (above[column], left[row]) = (held, held);
        };
        add(Kind::Means, 8, 8, &means);
        blocks.iter().enumerate().for_each(|(b, levels)| add(Kind::Luma, b % 4, b / 4, levels));
        for (p, blocks) in colours.iter().enumerate() {
            blocks.iter().enumerate().for_each(|(b, levels)| add(Kind::Chroma, 4 + 2 * p + b % 2, 4 + 2 * p + b / 2, levels));
        }
    }

    /// The mode whose guesses for these planes are nearest, and the guesses.
    fn best_mode(&self, planes: &[usize], column: usize, row: usize, side: usize) -> (Mode, Vec<Vec<i32>>) {
        let (x, y) = (column * side, row * side);
        let tried = Mode::ALL.map(|mode| {
            let guesses: Vec<Vec<i32>> = planes.iter().map(|&p| self.rebuilt[p].predicted(x, y, side, mode)).collect();
            let missed = |p: usize, guess: &[i32]| -> i64 {
                let plane = &self.source[p];
                let off = |i: usize| i64::from(plane.values[(y + i / side) * plane.width + x + i % side]) - i64::from(guess[i]);
                (0..side * side).map(|i| off(i) * off(i)).sum()
            };
            let error: i64 = planes.iter().zip(&guesses).map(|(&p, guess)| missed(p, guess)).sum();
            (error, mode, guesses)
        });
        let [first, rest @ ..] = tried;
        let best = rest.into_iter().fold(first, |best, next| if next.0 < best.0 { next } else { best });
        (best.1, best.2)
    }

    /// Levels of the sixteen blocks of brightness without their means, and of the means.
    fn luma_levels(&mut self, column: usize, row: usize, guess: &[i32]) -> ([[i32; 16]; 16], [i32; 16]) {
        let corner = |b: usize| (column * 16 + b % 4 * 4, row * 16 + b / 4 * 4);
        let frequencies: [[f32; 16]; 16] = std::array::from_fn(|b| cosine(self.missed(0, corner(b), guess, 16)));
        let means = levels(walsh(frequencies.map(|f| f[0].round() as i32)), MEANS_STEPS);
        let rebuilt_means = inverse_walsh(scaled(means, MEANS_STEPS));
        let blocks = std::array::from_fn(|b| {
            let mut block = levels(frequencies[b], LUMA_STEPS);
            block[0] = 0;
            let mut whole = scaled(block, LUMA_STEPS);
            whole[0] = rebuilt_means[b];
            self.rebuild(0, corner(b), guess, 16, whole);
            block
        });
        (blocks, means)
    }

    /// Levels of the four blocks of a colour.
    fn chroma_levels(&mut self, plane: usize, column: usize, row: usize, guess: &[i32]) -> [[i32; 16]; 4] {
        std::array::from_fn(|b| {
            let corner = (column * 8 + b % 2 * 4, row * 8 + b / 2 * 4);
            let block = levels(cosine(self.missed(plane, corner, guess, 8)), CHROMA_STEPS);
            self.rebuild(plane, corner, guess, 8, scaled(block, CHROMA_STEPS));
            block
        })
    }

    /// What the guess misses of a block.
    fn missed(&self, plane: usize, (x, y): (usize, usize), guess: &[i32], side: usize) -> [i32; 16] {
        let (source, guess) = (self.source[plane].block(x, y), part(guess, x, y, side));
        std::array::from_fn(|i| source[i] - guess[i])
    }

    /// What a decoder will make of a block.
    fn rebuild(&mut self, plane: usize, (x, y): (usize, usize), guess: &[i32], side: usize, frequencies: [i32; 16]) {
        let (missed, guess) = (inverse_cosine(frequencies), part(guess, x, y, side));
        self.rebuilt[plane].set_block(x, y, std::array::from_fn(|i| guess[i] + missed[i]));
    }

    /// The frame: its tag and size, the header with the modes, the coefficients.
    fn finish(self, [width, height]: [usize; 2]) -> Vec<u8> {
        let probabilities = self.tokens.probabilities();
        let mut header = BitWriter::new();
        header.number(0, 2); // colours as usual; decoders clamp
        header.number(0, 1); // one segment
        header.number(0, 1); // the normal filter
        header.number(FILTER, 6);
        header.number(0, 3); // sharpness
        header.number(0, 1); // the same filter everywhere
        header.number(0, 2); // one partition of coefficients
        header.number(COARSENESS, 7);
        header.number(0, 5); // the same coarseness everywhere
        header.number(0, 1); // what is adapted holds for this frame alone
        Tokens::write_probabilities(&mut header, &probabilities);
        let full = self.blocks.iter().filter(|b| !b.empty).count();
        let not_empty = (256 * full).checked_div(self.blocks.len()).map_or(128, |p| p.clamp(1, 255) as u8);
        header.number(1, 1); // empty macroblocks are marked
        header.number(u32::from(not_empty), 8);
        for block in &self.blocks {
            header.bit(block.empty, not_empty);
            block.write(&mut header);
        }
        let (header, coefficients) = (header.finish(), self.tokens.write(&probabilities));

        const SHOWN: u32 = 1 << 4;
        let tag = (header.len() as u32) << 5 | SHOWN;
        let mut bytes = tag.to_le_bytes()[..3].to_vec();
        bytes.extend([0x9d, 0x01, 0x2a]);
        bytes.extend((width as u16).to_le_bytes());
        bytes.extend((height as u16).to_le_bytes());
        bytes.extend(header);
        bytes.extend(coefficients);
        bytes
    }
}

impl Choice {
    /// Both modes, down the trees of section 11.2 with the probabilities of a key frame.
    fn write(&self, header: &mut BitWriter) {
        header.bit(true, 145); // one guess for the whole macroblock
        let (second, third) = (matches!(self.luma, Mode::Across | Mode::Slope), matches!(self.luma, Mode::Down | Mode::Slope));
        header.bit(second, 156);
        header.bit(third, if second { 128 } else { 163 });
        header.bit(self.chroma != Mode::Mean, 142);
        if self.chroma != Mode::Mean {
            header.bit(self.chroma != Mode::Down, 114);
        }
        if matches!(self.chroma, Mode::Across | Mode::Slope) {
            header.bit(self.chroma == Mode::Slope, 183);
        }
    }
}

/// The 4 x 4 part of a guess for the square of `side` in which (x, y) lies.
fn part(guess: &[i32], x: usize, y: usize, side: usize) -> [i32; 16] {
    std::array::from_fn(|i| guess[(y % side + i / 4) * side + x % side + i % 4])
}

/// Frequencies in whole steps.
fn levels(frequencies: [f32; 16], steps: [i32; 2]) -> [i32; 16] {
    std::array::from_fn(|i| {
        let steps = frequencies[i] / steps[usize::from(i > 0)] as f32;
        let level = ((steps.abs() + 1.0 - ROUND_UP) as i32).min(LARGEST);
        if steps < 0.0 { -level } else { level }
    })
}

/// Steps back to frequencies.
fn scaled(levels: [i32; 16], steps: [i32; 2]) -> [i32; 16] {
    std::array::from_fn(|i| levels[i] * steps[usize::from(i > 0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Decodes a frame as a WebP of one picture.
    fn decoded(frame: &[u8]) -> image::RgbImage {
        let padded = frame.len() + frame.len() % 2;
        let mut file = [b"RIFF".as_slice(), &(padded as u32 + 12).to_le_bytes(), b"WEBPVP8 ", &(frame.len() as u32).to_le_bytes(), frame].concat();
        file.resize(padded + 20, 0);
        image::load_from_memory_with_format(&file, image::ImageFormat::WebP).unwrap().into_rgb8()
    }

    /// Mean square error of brightness-like sums, which colour at half the size leaves alone.
    fn error(size: [usize; 2], rgba8: impl Fn(usize, usize) -> [u8; 4] + Copy) -> (f64, usize) {
        let frame = encode(size, rgba8);
        let picture = decoded(&frame);
        assert_eq!([picture.width() as usize, picture.height() as usize], size);
        let luma = |c: &[u8]| 0.299 * f64::from(c[0]) + 0.587 * f64::from(c[1]) + 0.114 * f64::from(c[2]);
        let square = |(x, y, p): (u32, u32, &image::Rgb<u8>)| (luma(&p.0) - luma(&rgba8(x as usize, y as usize))).powi(2);
        (picture.enumerate_pixels().map(square).sum::<f64>() / (size[0] * size[1]) as f64, frame.len())
    }

    #[test]
    fn any_size_decodes_to_what_was_encoded() {
        for size in [[1, 1], [2, 3], [16, 16], [17, 33], [100, 48], [159, 31]] {
            let (error, _) = error(size, |x, y| {
                let wave = ((x as f32 * 0.3).sin() * (y as f32 * 0.2).cos() * 60.0) as i32;
                [(140 + wave) as u8, (120 + wave / 2) as u8, (x + y) as u8, 255]
            });
            assert!(error < 3.0, "{size:?}: {error}");
        }
    }

    #[test]
    fn noise_and_hard_edges_use_every_branch() {
        let noise = |x: usize, y: usize| {
            let v = ((x * 7919 + y * 104_729) ^ (x * y * 31)) % 251;
            [v as u8, v as u8, v as u8, 255]
        };
        let board = |x: usize, y: usize| if (x / 3 + y / 5).is_multiple_of(2) { [0, 0, 0, 255] } else { [255; 4] };
        assert!(error([80, 64], noise).0 < 16.0, "{}", error([80, 64], noise).0);
        assert!(error([80, 64], board).0 < 16.0, "{}", error([80, 64], board).0);
    }

    #[test]
    fn plain_ground_costs_next_to_nothing() {
        let (error, bytes) = error([640, 360], |_, _| [234, 234, 242, 255]);
        assert!(error < 1.0 && bytes < 1500, "{error}, {bytes} bytes");
    }

    #[test]
    fn transforms_invert_each_other() {
        let block: [i32; 16] = std::array::from_fn(|i| (i as i32 * 37 % 101) - 50);
        let back = inverse_cosine(cosine(block).map(|v| v.round() as i32));
        let means = inverse_walsh(walsh(block).map(|v| v.round() as i32));
        assert!((0..16).all(|i| (back[i] - block[i]).abs() <= 1 && (means[i] - block[i]).abs() <= 1), "{back:?} {means:?}");
    }
}
