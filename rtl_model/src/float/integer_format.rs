//! The integers that floats are converted from and to.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// An integer format: `iN` in two's complement, or `uN` unsigned, of N bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct IntegerFormat {
    /// Two's complement?
    pub signed: bool,
    /// Bits of a value, 1 to 64.
    pub bits: u32,
}

/// Why a text names no integer format.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown integer format `{0}`: it is iN or uN with N bits, 1 to 64, such as i32")]
pub struct UnknownIntegerFormat(pub String);

impl IntegerFormat {
    /// Signed, of 32 bits.
    pub const I32: IntegerFormat = IntegerFormat::signed(32);
    /// Unsigned, of 32 bits.
    pub const U32: IntegerFormat = IntegerFormat::unsigned(32);
    /// Signed, of 64 bits.
    pub const I64: IntegerFormat = IntegerFormat::signed(64);
    /// Unsigned, of 64 bits.
    pub const U64: IntegerFormat = IntegerFormat::unsigned(64);

    /// In two's complement.
    ///
    /// # Panics
    /// Unless it has 1 to 64 bits; in a constant that is a compile error.
    #[inline]
    pub const fn signed(bits: u32) -> IntegerFormat {
        assert!(bits >= 1 && bits <= 64, "1 to 64 bits");
        IntegerFormat { signed: true, bits }
    }

    /// Unsigned.
    ///
    /// # Panics
    /// Unless it has 1 to 64 bits; in a constant that is a compile error.
    #[inline]
    pub const fn unsigned(bits: u32) -> IntegerFormat {
        assert!(bits >= 1 && bits <= 64, "1 to 64 bits");
        IntegerFormat {
            signed: false,
            bits,
        }
    }

    /// A mask of the bits of a value.
    #[inline]
    pub const fn mask(self) -> u64 {
        u64::MAX >> (64 - self.bits)
    }

    /// The magnitude of the value at this end of the range: the largest, or where `negative` the
    /// smallest, which is 0 for unsigned ones.
    #[inline]
    pub const fn limit(self, negative: bool) -> u64 {
        match (self.signed, negative) {
            (false, false) => self.mask(),
            (false, true) => 0,
            (true, false) => self.mask() >> 1,
            (true, true) => (self.mask() >> 1) + 1,
        }
    }

    /// Sign and magnitude of a value; the bits above its width are not read.
    #[inline]
    pub const fn sign_and_magnitude(self, value: u64) -> (bool, u64) {
        let value = value & self.mask();
        if self.signed && value >> (self.bits - 1) == 1 {
            (true, value.wrapping_neg() & self.mask())
        } else {
            (false, value)
        }
    }

    /// The value of this sign and magnitude, which must be within the range.
    #[inline]
    pub const fn value(self, negative: bool, magnitude: u64) -> u64 {
        if negative {
            magnitude.wrapping_neg() & self.mask()
        } else {
            magnitude
        }
    }
}

impl FromStr for IntegerFormat {
    type Err = UnknownIntegerFormat;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let unknown = || UnknownIntegerFormat(text.to_owned());
        let (signed, digits) = match (text.strip_prefix('i'), text.strip_prefix('u')) {
            (Some(digits), _) => (true, digits),
            (_, Some(digits)) => (false, digits),
            _ => return Err(unknown()),
        };
        // The parser of integers would also take a sign.
        if !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(unknown());
        }
        match digits.parse() {
            Ok(bits @ 1..=64) => Ok(IntegerFormat { signed, bits }),
            _ => Err(unknown()),
        }
    }
}

impl fmt::Display for IntegerFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", if self.signed { 'i' } else { 'u' }, self.bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for bits in 1..=64 {
            for format in [IntegerFormat::signed(bits), IntegerFormat::unsigned(bits)] {
                assert_eq!(format.to_string().parse(), Ok(format));
            }
        }
        for text in ["i0", "i65", "u", "32", "i+8", "s32", ""] {
            let message = text.parse::<IntegerFormat>().unwrap_err().to_string();
            assert!(message.contains("such as i32"), "{message}");
        }
    }

    #[test]
    fn values_and_their_magnitudes() {
        let i4 = IntegerFormat::signed(4);
        assert_eq!(i4.sign_and_magnitude(0xf8), (true, 8));
        assert_eq!(i4.sign_and_magnitude(0x07), (false, 7));
        assert_eq!((i4.limit(false), i4.limit(true)), (7, 8));
        assert_eq!(i4.value(true, 8), 8);
        assert_eq!(i4.value(true, 1), 15);
        let i1 = IntegerFormat::signed(1);
        assert_eq!((i1.limit(false), i1.limit(true)), (0, 1));
        assert_eq!(
            IntegerFormat::I64.sign_and_magnitude(1 << 63),
            (true, 1 << 63)
        );
        assert_eq!(IntegerFormat::U64.limit(false), u64::MAX);
        assert_eq!(IntegerFormat::U64.limit(true), 0);
    }
}
