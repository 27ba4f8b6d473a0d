//! Mutations that keep some structure: of bits, of runs of bytes, of numbers in text and in binary, and by words of the target's
//! language.

/// Numbers at the edges of types, as they lie in binary files.
const EDGES: [u32; 14] = [
    0,
    1,
    0x7f,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7f80_0000, // infinity
    0x7fc0_0000, // NaN
    0x7f7f_ffff, // the largest f32
    0x0000_0001, // the smallest
    0x3f80_0000, // one
];

/// And as they stand in text.
const NUMBERS: [&str; 16] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "1e-45",
    "1e-300",
    "1e30",
    "1e308",
    "1e999",
    "-1e999",
    "4294967296",
    "18446744073709551615",
    "99999999999999999999",
    "nan",
    "inf",
    "0x10",
];

/// SplitMix64 (Steele et al. 2014): small, fast, and the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// From 0, below `end`; 0 where that is 0.
    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

/// Makes inputs of inputs.
pub struct Mutator {
    random: Random,
    dictionary: Vec<&'static [u8]>,
}

impl Mutator {
    /// Equal seeds make equal mutations.
    pub fn new(seed: u64, dictionary: Vec<&'static [u8]>) -> Mutator {
        Mutator { random: Random(seed), dictionary }
    }

    /// One of some inputs, changed in one to eight places.
    pub fn mutated(&mut self, inputs: &[Vec<u8>], longest: usize) -> Vec<u8> {
        let pick = self.random.below(inputs.len());
        let mut input = inputs.get(pick).cloned().unwrap_or_default();
        for _ in 0..1 << self.random.below(4) {
            self.mutate(&mut input, inputs);
        }
        input.truncate(longest);
        input
    }

    fn mutate(&mut self, input: &mut Vec<u8>, inputs: &[Vec<u8>]) {
        let at = self.random.below(input.len() + 1);
        match self.random.below(10) {
            0 => self.flip(input, at),
            1 => input.truncate(at),
            2 => {
                let run = self.run(input, at);
                input.drain(run);
            }
            3 => {
                let run = self.run(input, at);
                let copy = input[run].to_vec();
                insert(input, at, &copy);
            }
            4 => {
                let other = &inputs[self.random.below(inputs.len())];
                let from = self.random.below(other.len() + 1);
                let run = self.run(other, from);
                insert(input, at, &other[run]);
            }
            5 | 6 => {
                let word = self.dictionary.get(self.random.below(self.dictionary.len())).copied().unwrap_or_default();
                insert(input, at, word);
            }
            7 => self.edge(input, at),
            _ => self.number(input, at),
        }
    }

    fn flip(&mut self, input: &mut [u8], at: usize) {
        let bit = self.random.below(8);
        if let Some(byte) = input.get_mut(at) {
            *byte ^= 1 << bit;
        }
    }

    /// Up to 64 bytes from a place, seldom more.
    fn run(&mut self, input: &[u8], at: usize) -> std::ops::Range<usize> {
        let most = if self.random.below(8) == 0 { input.len() } else { 64 };
        at..(at + self.random.below(most + 1)).min(input.len())
    }

    /// An edge of a type over four bytes, where numbers of a file mostly lie.
    fn edge(&mut self, input: &mut [u8], at: usize) {
        let edge = EDGES[self.random.below(EDGES.len())].to_le_bytes();
        let at = if self.random.below(2) == 0 { at } else { at & !3 };
        input.iter_mut().skip(at).zip(edge).for_each(|(byte, edge)| *byte = edge);
    }

    /// Another number in place of the next one in text: lengths lie, values leave their range.
    fn number(&mut self, input: &mut Vec<u8>, at: usize) {
        let is_part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+');
        let Some(start) = (at..input.len()).find(|&i| input[i].is_ascii_digit()) else { return self.edge(input, at) };
        let end = (start..input.len()).find(|&i| !is_part(&input[i])).unwrap_or(input.len());
        let number = NUMBERS[self.random.below(NUMBERS.len())];
        input.splice(start..end, number.bytes());
    }
}

fn insert(input: &mut Vec<u8>, at: usize, bytes: &[u8]) {
    input.splice(at..at, bytes.iter().copied());
}
