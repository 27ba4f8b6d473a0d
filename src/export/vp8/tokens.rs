//! Coefficients as decisions in a tree, and the probabilities that suit a frame best.

use super::bits::BitWriter;
use super::tables::{BAND, CLASSES, KEPT, NODE, NODES, ROWS, ZIGZAG};

/// What a block holds: it decides which probabilities apply.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Brightness without its mean, which lies in a block of its own.
    Luma = 0,
    /// The means of sixteen blocks of brightness.
    Means = 1,
    /// Colour.
    Chroma = 2,
}

/// One decision: at a node of the tree, whose probability adapts, or with a fixed probability.
#[derive(Clone, Copy, Debug)]
enum Decision {
    Node { row: u8, node: u8, bit: bool },
    Fixed { zero: u8, bit: bool },
}

/// All decisions of a frame, in order.
#[derive(Debug, Default)]
pub struct Tokens(Vec<Decision>);

/// Probability, of 256, of the zero branch at each node.
pub type Probabilities = [[u8; NODES]; ROWS];

impl Tokens {
    /// Adds a block of levels in natural order; `context` counts the neighbours (left, above) that hold
    /// anything. Returns whether this one does.
    pub fn block(&mut self, kind: Kind, context: usize, levels: &[i32; 16]) -> bool {
        let first = usize::from(matches!(kind, Kind::Luma));
        let end = (first..16).rev().find(|&i| levels[ZIGZAG[i]] != 0).map_or(first, |i| i + 1);
        let row = |place: usize, context: usize| ((kind as usize * 8 + BAND[place]) * 3 + context) as u8;
        let (mut context, mut after_zero) = (context, false);
        for place in first..end {
            let level = levels[ZIGZAG[place]];
            let row = row(place, context);
            if !after_zero {
                self.node(row, 0, true);
            }
            self.node(row, 1, level != 0);
            if level != 0 {
                self.size(row, level.abs());
                self.0.push(Decision::Fixed { zero: 128, bit: level < 0 });
            }
            after_zero = level == 0;
            context = level.unsigned_abs().min(2) as usize;
        }
        if end < 16 {
            self.node(row(end, context), 0, false);
        }
        end > first
    }

    /// The path to a size of 1 and more.
    fn size(&mut self, row: u8, size: i32) {
        self.node(row, 2, size > 1);
        if size == 1 {
            return;
        }
        self.node(row, 3, size > 4);
        if size <= 4 {
            self.node(row, 4, size > 2);
            if size > 2 {
                self.node(row, 5, size == 4);
            }
            return;
        }
        let class = CLASSES.iter().rposition(|&(least, _)| size >= least).unwrap_or(0);
        self.node(row, 6, class >= 2);
        if class < 2 {
            self.node(row, 7, class == 1);
        } else {
            self.node(row, 8, class >= 4);
            self.node(row, 9 + u8::from(class >= 4), class % 2 == 1);
        }
        let (least, bits) = CLASSES[class];
        for (place, &zero) in bits.iter().enumerate() {
            self.0.push(Decision::Fixed { zero, bit: (size - least) >> (bits.len() - 1 - place) & 1 == 1 });
        }
    }

    fn node(&mut self, row: u8, node: u8, bit: bool) {
        self.0.push(Decision::Node { row, node, bit });
    }

    /// The probabilities to write with: where those counted here save more than it costs to say so.
    pub fn probabilities(&self) -> Probabilities {
        let mut counts = [[[0u32; 2]; NODES]; ROWS];
        for decision in &self.0 {
            if let Decision::Node { row, node, bit } = *decision {
                counts[usize::from(row)][usize::from(node)][usize::from(bit)] += 1;
            }
        }
        std::array::from_fn(|row| {
            std::array::from_fn(|node| {
                let [zeros, ones] = counts[row][node];
                let (old, kept) = (NODE[row][node], KEPT[row][node]);
                let new = (256 * zeros).checked_div(zeros + ones).map_or(old, |p| p.clamp(1, 255) as u8);
                let cost = |p: u8| zeros as f32 * bits_of(p) + ones as f32 * bits_of_rest(p);
                let saved = cost(old) + bits_of(kept) - (cost(new) + bits_of_rest(kept) + 8.0);
                if saved > 0.0 { new } else { old }
            })
        })
    }

    /// Writes which probabilities differ from those a key frame begins with.
    pub fn write_probabilities(header: &mut BitWriter, probabilities: &Probabilities) {
        for row in 0..ROWS {
            for node in 0..NODES {
                let changed = probabilities[row][node] != NODE[row][node];
                header.bit(changed, KEPT[row][node]);
                if changed {
                    header.number(u32::from(probabilities[row][node]), 8);
                }
            }
        }
    }

    /// Writes all decisions.
    pub fn write(&self, probabilities: &Probabilities) -> Vec<u8> {
        let mut writer = BitWriter::new();
        for decision in &self.0 {
            match *decision {
                Decision::Node { row, node, bit } => writer.bit(bit, probabilities[usize::from(row)][usize::from(node)]),
                Decision::Fixed { zero, bit } => writer.bit(bit, zero),
            }
        }
        writer.finish()
    }
}

/// Bits that a 0 costs where its probability is p of 256.
fn bits_of(p: u8) -> f32 {
    -(f32::from(p) / 256.0).log2()
}

/// Bits that a 1 costs there.
fn bits_of_rest(p: u8) -> f32 {
    -(1.0 - f32::from(p) / 256.0).log2()
}
