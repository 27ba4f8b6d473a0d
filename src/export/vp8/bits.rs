//! The arithmetic coder of VP8 (RFC 6386, section 7): bits with known probabilities.

/// Writes bits, each in as little space as its probability allows.
#[derive(Debug)]
pub struct BitWriter {
    bytes: Vec<u8>,
    /// The start of the interval that the bits so far select: 8 bits and `fraction` more behind them.
    low: u64,
    fraction: u32,
    /// Its length, 128 to 255.
    range: u32,
}

impl BitWriter {
    /// Nothing written.
    pub fn new() -> BitWriter {
        BitWriter { bytes: Vec::new(), low: 0, fraction: 0, range: 255 }
    }

    /// Writes a bit that is 0 with a probability of `zero` in 256.
    pub fn bit(&mut self, bit: bool, zero: u8) {
        let split = 1 + (((self.range - 1) * u32::from(zero)) >> 8);
        if bit {
            self.low += u64::from(split);
            self.range -= split;
        } else {
            self.range = split;
        }
        let shift = self.range.leading_zeros() - 24;
        self.range <<= shift;
        self.low <<= shift;
        self.fraction += shift;
        self.spill();
    }

    /// Writes a number of `bits` bits, the highest first, each as likely as not.
    pub fn number(&mut self, value: u32, bits: u32) {
        (0..bits).rev().for_each(|b| self.bit(value >> b & 1 == 1, 128));
    }

    /// The bytes, padded so that a reader never wants more.
    pub fn finish(mut self) -> Vec<u8> {
        for _ in 0..4 {
            self.low <<= 8;
            self.fraction += 8;
            self.spill();
        }
        self.bytes
    }

    /// Moves whole bytes out; one that overflowed carries into those before it.
    fn spill(&mut self) {
        while self.fraction >= 8 {
            let top = self.low >> self.fraction;
            if top > 255 {
                for byte in self.bytes.iter_mut().rev() {
                    *byte = byte.wrapping_add(1);
                    if *byte != 0 {
                        break;
                    }
                }
            }
            self.bytes.push(top as u8);
            self.low &= (1 << self.fraction) - 1;
            self.fraction -= 8;
        }
    }
}
