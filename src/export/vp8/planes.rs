//! Brightness and colour planes, prediction within them, and the 4 x 4 transforms.

/// One plane of a picture, padded to whole macroblocks by repeating its edge.
#[derive(Clone, Debug)]
pub struct Plane {
    pub width: usize,
    pub values: Vec<u8>,
}

/// How a block is guessed from the row above and the column to the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Their mean.
    Mean,
    /// The row above, repeated.
    Down,
    /// The column to the left, repeated.
    Across,
    /// Left plus above less the corner.
    Slope,
}

impl Mode {
    pub const ALL: [Mode; 4] = [Mode::Mean, Mode::Down, Mode::Across, Mode::Slope];
}

impl Plane {
    /// Brightness and the two colour differences (BT.601, video range) of an RGBA rectangle, the latter at
    /// half the size.
    pub fn from_rgba(size: [usize; 2], rgba8: impl Fn(usize, usize) -> [u8; 4]) -> [Plane; 3] {
        let [width, height] = size.map(|side| side.next_multiple_of(16));
        let at = |x: usize, y: usize| rgba8(x.min(size[0] - 1), y.min(size[1] - 1)).map(f32::from);
        let mix = |base: f32, [r, g, b]: [f32; 3], c: [f32; 4]| (base + r * c[0] + g * c[1] + b * c[2] + 0.5) as u8;
        let luma = (0..width * height).map(|i| mix(16.0, [0.2568, 0.5041, 0.0979], at(i % width, i / width))).collect();
        let half = |weights: [f32; 3]| {
            let value = |i: usize| {
                let (x, y) = (2 * (i % (width / 2)), 2 * (i / (width / 2)));
                let four = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
                mix(128.0, weights, std::array::from_fn(|k| four.iter().map(|c| c[k]).sum::<f32>() / 4.0))
            };
            Plane { width: width / 2, values: (0..width * height / 4).map(value).collect() }
        };
        [Plane { width, values: luma }, half([-0.1482, -0.2910, 0.4392]), half([0.4392, -0.3678, -0.0714])]
    }

    /// A plane of the same size to rebuild the picture in.
    pub fn blank(&self) -> Plane {
        Plane { width: self.width, values: vec![0; self.values.len()] }
    }

    /// A 4 x 4 block, rows first.
    pub fn block(&self, x: usize, y: usize) -> [i32; 16] {
        std::array::from_fn(|i| i32::from(self.values[(y + i / 4) * self.width + x + i % 4]))
    }

    /// Overwrites a 4 x 4 block.
    pub fn set_block(&mut self, x: usize, y: usize, values: [i32; 16]) {
        for (i, value) in values.into_iter().enumerate() {
            self.values[(y + i / 4) * self.width + x + i % 4] = value.clamp(0, 255) as u8;
        }
    }

    /// What `mode` guesses for the square of `side` at (x, y) from what is rebuilt so far. Beyond the
    /// picture lie 127 above and 129 to the left.
    pub fn predicted(&self, x: usize, y: usize, side: usize, mode: Mode) -> Vec<i32> {
        let value = |x: usize, y: usize| i32::from(self.values[y * self.width + x]);
        let above: Vec<i32> = (0..side).map(|i| if y > 0 { value(x + i, y - 1) } else { 127 }).collect();
        let left: Vec<i32> = (0..side).map(|i| if x > 0 { value(x - 1, y + i) } else { 129 }).collect();
        let corner = match (x > 0, y > 0) {
            (true, true) => value(x - 1, y - 1),
            (false, true) => 129,
            (_, false) => 127,
        };
        let mean = match (x > 0, y > 0) {
            (true, true) => (above.iter().chain(&left).sum::<i32>() + side as i32) / (2 * side as i32),
            (true, false) => (left.iter().sum::<i32>() + side as i32 / 2) / side as i32,
            (false, true) => (above.iter().sum::<i32>() + side as i32 / 2) / side as i32,
            (false, false) => 128,
        };
        let guess = |i: usize| match mode {
            Mode::Mean => mean,
            Mode::Down => above[i % side],
            Mode::Across => left[i / side],
            Mode::Slope => (left[i / side] + above[i % side] - corner).clamp(0, 255),
        };
        (0..side * side).map(guess).collect()
    }
}

/// Rows of the cosine transform that VP8 inverts, each of squared length 4.
const COSINES: [[f32; 4]; 4] = [
    [1.0, 1.0, 1.0, 1.0],
    [1.306_563, 0.541_196_1, -0.541_196_1, -1.306_563],
    [1.0, -1.0, -1.0, 1.0],
    [0.541_196_1, -1.306_563, 1.306_563, -0.541_196_1],
];

/// Rows of its Walsh-Hadamard transform.
const SIGNS: [[f32; 4]; 4] = [[1.0, 1.0, 1.0, 1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0], [1.0, -1.0, 1.0, -1.0]];

/// Half of B v B^T.
fn transformed(basis: &[[f32; 4]; 4], v: [i32; 16]) -> [f32; 16] {
    let rows: [f32; 16] = std::array::from_fn(|i| (0..4).map(|k| basis[i % 4][k] * v[i / 4 * 4 + k] as f32).sum());
    std::array::from_fn(|i| 0.5 * (0..4).map(|k| basis[i / 4][k] * rows[k * 4 + i % 4]).sum::<f32>())
}

/// Frequencies of a 4 x 4 block of differences.
pub fn cosine(block: [i32; 16]) -> [f32; 16] {
    transformed(&COSINES, block)
}

/// Frequencies of the 16 means of a macroblock's blocks.
pub fn walsh(means: [i32; 16]) -> [f32; 16] {
    transformed(&SIGNS, means)
}

/// Runs a transform of four numbers down the columns, then along the rows.
fn both_ways(v: [i32; 16], pass: impl Fn([i32; 4]) -> [i32; 4]) -> [i32; 16] {
    let mut down = [0; 16];
    for x in 0..4 {
        let column = pass(std::array::from_fn(|y| v[y * 4 + x]));
        (0..4).for_each(|y| down[y * 4 + x] = column[y]);
    }
    let mut out = [0; 16];
    for y in 0..4 {
        out[y * 4..y * 4 + 4].copy_from_slice(&pass(std::array::from_fn(|x| down[y * 4 + x])));
    }
    out
}

/// Differences from frequencies, in the integers that every decoder uses (section 14.3).
pub fn inverse_cosine(frequencies: [i32; 16]) -> [i32; 16] {
    // 2^16 times sqrt(2) sin(pi/8), and times sqrt(2) cos(pi/8) less one.
    let by_sine = |v: i32| (v * 35468) >> 16;
    let by_cosine = |v: i32| v + ((v * 20091) >> 16);
    let pass = |[a, b, c, d]: [i32; 4]| {
        let (even, odd) = ((a + c, a - c), (by_sine(b) - by_cosine(d), by_cosine(b) + by_sine(d)));
        [even.0 + odd.1, even.1 + odd.0, even.1 - odd.0, even.0 - odd.1]
    };
    both_ways(frequencies, pass).map(|v| (v + 4) >> 3)
}

/// The means from their frequencies.
pub fn inverse_walsh(frequencies: [i32; 16]) -> [i32; 16] {
    let pass = |[a, b, c, d]: [i32; 4]| [a + d + b + c, a - d + b - c, a + d - b - c, a - d - b + c];
    both_ways(frequencies, pass).map(|v| (v + 3) >> 3)
}
