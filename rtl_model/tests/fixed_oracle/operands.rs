//! Formats and words to try operators on.

use rtl_model::fixed::FixedFormat;

/// A splitmix64 sequence: the tests' only source of chance, the same in every run.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }

    /// A format of any width, sign and place of the point.
    pub fn format(&mut self) -> FixedFormat {
        let width = 1 + self.below(64) as u32;
        if self.next() & 1 == 1 {
            let integer_bits = 1 + self.below(width.into()) as u32;
            FixedFormat::q(integer_bits, width - integer_bits)
        } else {
            let integer_bits = self.below(u64::from(width) + 1) as u32;
            FixedFormat::uq(integer_bits, width - integer_bits)
        }
    }

    /// A word of a format: random in every bit, of random length, or one of the hard ones.
    pub fn word(&mut self, format: FixedFormat) -> u64 {
        let word = self.next();
        match self.below(4) {
            0 => word & format.value_mask(),
            1 => (word >> self.below(64)) & format.value_mask(),
            2 => (word >> self.below(64)).wrapping_neg() & format.value_mask(),
            _ => {
                let hard = hard_words(format);
                hard[word as usize % hard.len()]
            }
        }
    }
}

/// Every format of so many bits.
pub fn every_format(width: u32) -> Vec<FixedFormat> {
    let signed = (1..=width).map(|integer_bits| FixedFormat::q(integer_bits, width - integer_bits));
    let unsigned =
        (0..=width).map(|integer_bits| FixedFormat::uq(integer_bits, width - integer_bits));
    signed.chain(unsigned).collect()
}

/// The ends of the range, powers of two and their neighbours, of both signs.
pub fn hard_words(format: FixedFormat) -> Vec<u64> {
    let mask = format.value_mask();
    let mut words = vec![0, format.min(), format.max()];
    for bit in 0..format.width() {
        let power = 1_u64 << bit;
        for near in [power.wrapping_sub(1), power, power.wrapping_add(1)] {
            words.push(near & mask);
            words.push(near.wrapping_neg() & mask);
        }
    }
    words.sort_unstable();
    words.dedup();
    words
}
