//! Four-valued words: bits that may also be unknown or undriven.

/// Up to 64 bits, each 0, 1, x (unknown) or z (driven by nobody).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LogicWord {
    /// The bits. Where `unknown` has a 1, a 0 here is x and a 1 is z.
    pub value: u64,
    /// Which bits are x or z.
    pub unknown: u64,
}

impl LogicWord {
    /// All bits x: what a register without reset holds before it first takes a value.
    pub const X: LogicWord = LogicWord {
        value: 0,
        unknown: u64::MAX,
    };

    /// A word without unknown bits.
    pub const fn known(value: u64) -> LogicWord {
        LogicWord { value, unknown: 0 }
    }

    /// The value, if no bit is x or z.
    pub const fn as_known(self) -> Option<u64> {
        if self.unknown == 0 {
            Some(self.value)
        } else {
            None
        }
    }

    /// The low `width` bits (1 to 64).
    pub(crate) fn low_bits(self, width: u32) -> LogicWord {
        let mask = low_mask(width);
        LogicWord {
            value: self.value & mask,
            unknown: self.unknown & mask,
        }
    }

    /// One bit as VCD and Verilog write it.
    pub(crate) fn digit(self, bit: u32) -> u8 {
        match ((self.unknown >> bit) & 1, (self.value >> bit) & 1) {
            (0, 0) => b'0',
            (0, _) => b'1',
            (_, 0) => b'x',
            _ => b'z',
        }
    }

    pub(crate) fn set(&mut self, bit: u32, value: vcd::Value) {
        let (one, unknown) = match value {
            vcd::Value::V0 => (0, 0),
            vcd::Value::V1 => (1, 0),
            vcd::Value::X => (0, 1),
            vcd::Value::Z => (1, 1),
        };
        self.value = self.value & !(1 << bit) | one << bit;
        self.unknown = self.unknown & !(1 << bit) | unknown << bit;
    }
}

impl From<u64> for LogicWord {
    fn from(value: u64) -> LogicWord {
        LogicWord::known(value)
    }
}

impl From<bool> for LogicWord {
    fn from(value: bool) -> LogicWord {
        LogicWord::known(u64::from(value))
    }
}

/// A mask of `width` bits (1 to 64; more count as 64).
pub(crate) fn low_mask(width: u32) -> u64 {
    u64::MAX >> (64 - width.clamp(1, 64))
}

/// How many words a vector of `width` bits takes.
pub(crate) fn words_for(width: u32) -> usize {
    width.div_ceil(64) as usize
}

/// A vector's bits from the most significant down, in `0`, `1`, `x` and `z`; the first word holds
/// the least significant bits.
pub(crate) fn binary(words: &[LogicWord], width: u32) -> String {
    (0..width)
        .rev()
        .map(|bit| words[(bit / 64) as usize].digit(bit % 64) as char)
        .collect()
}

/// A vector in hexadecimal as Verilog's `%h` prints it: `x` and `z` where all bits of a digit are,
/// `X` and `Z` where some are.
pub(crate) fn hexadecimal(words: &[LogicWord], width: u32) -> String {
    let digits = (0..width.div_ceil(4)).rev().map(|digit| {
        let (word, shift) = (words[(digit / 16) as usize], digit % 16 * 4);
        let valid = low_mask((width - digit * 4).min(4));
        let (value, unknown) = (word.value >> shift & valid, word.unknown >> shift & valid);
        match (unknown == valid, unknown & !value, unknown & value) {
            (_, 0, 0) => char::from_digit(value as u32, 16).unwrap_or('?'),
            (true, _, 0) => 'x',
            (true, 0, _) => 'z',
            (_, 0, _) => 'Z',
            _ => 'X',
        }
    });
    std::iter::once('0')
        .chain(std::iter::once('x'))
        .chain(digits)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(text: &str) -> LogicWord {
        let vector: vcd::Vector = text.parse().unwrap();
        let mut word = LogicWord::known(0);
        for (index, value) in vector.iter().enumerate() {
            word.set((vector.len() - 1 - index) as u32, value);
        }
        word
    }

    #[test]
    fn digits_show_unknown_bits_as_verilog_does() {
        for (bits, hex) in [
            ("10100101", "0xa5"),
            ("1", "0x1"),
            ("111110", "0x3e"),
            ("xxxx0000", "0xx0"),
            ("x0000001", "0xX1"),
            ("zzzz1111", "0xzf"),
            ("z0001111", "0xZf"),
            ("zx001111", "0xXf"),
            ("xx0000", "0xx0"),
            ("zzxx", "0xX"),
        ] {
            let width = bits.len() as u32;
            assert_eq!(hexadecimal(&[word(bits)], width), hex, "{bits}");
            assert_eq!(binary(&[word(bits)], width), bits);
        }
    }

    #[test]
    fn a_vector_wider_than_a_word_keeps_its_order() {
        let words = [LogicWord::known(0x0123_4567_89ab_cdef), LogicWord::known(2)];
        assert_eq!(hexadecimal(&words, 66), "0x20123456789abcdef");
        assert!(binary(&words, 66).starts_with("1000000001"));
    }
}
