//! A word with its format.

use std::fmt;

use super::FixedFormat;

/// A fixed-point number: the low `format.width()` bits of a word. Bits above are not read, and are
/// zero in every result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Fixed {
    /// How the bits are read.
    pub format: FixedFormat,
    /// The bits.
    pub bits: u64,
}

impl Fixed {
    /// The number that these bits are in this format; bits above its width are cut off.
    #[inline]
    pub const fn new(format: FixedFormat, bits: u64) -> Fixed {
        Fixed {
            format,
            bits: bits & format.value_mask(),
        }
    }

    /// An integer, as a number of the format `q64.0`.
    #[inline]
    pub const fn from_i64(value: i64) -> Fixed {
        Fixed {
            format: FixedFormat::q(64, 0),
            bits: value.cast_unsigned(),
        }
    }

    /// The integer that the word spells: the value in units of its last place. It is in the range
    /// of `i64` or of `u64`.
    #[inline]
    pub const fn units(self) -> i128 {
        let above = 64 - self.format.width();
        let at_the_top = self.bits << above;
        if self.format.signed {
            (at_the_top.cast_signed() >> above) as i128
        } else {
            (at_the_top >> above) as i128
        }
    }

    /// Is it below zero?
    #[inline]
    pub const fn is_negative(self) -> bool {
        self.format.signed && self.bits >> (self.format.width() - 1) & 1 == 1
    }

    /// Its distance from zero in units of its last place, at most `2^64 - 1`.
    #[inline]
    pub(super) const fn magnitude(self) -> u64 {
        self.units().unsigned_abs() as u64
    }

    /// The nearest `f64`, ties to even: the number itself where it has at most 53 significant bits.
    pub fn to_f64(self) -> f64 {
        // The conversion of the integer rounds once, the power of two is exact.
        self.units() as f64 * 2_f64.powi(-self.format.fraction_bits.cast_signed())
    }
}

impl fmt::Display for Fixed {
    /// The exact decimal: `-0.375`, `12`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fraction_bits = self.format.fraction_bits;
        let magnitude = u128::from(self.magnitude());
        let sign = if self.is_negative() { "-" } else { "" };
        write!(f, "{sign}{}", magnitude >> fraction_bits)?;
        let mask = (1_u128 << fraction_bits) - 1;
        let mut fraction = magnitude & mask;
        if fraction != 0 {
            f.write_str(".")?;
        }
        // Each digit takes a factor of two out of the denominator: at most 64 of them.
        while fraction != 0 {
            fraction *= 10;
            write!(f, "{}", fraction >> fraction_bits)?;
            fraction &= mask;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact() {
        let text = |format: FixedFormat, bits| Fixed::new(format, bits).to_string();
        assert_eq!(text(FixedFormat::q(4, 4), 0xfa), "-0.375");
        assert_eq!(text(FixedFormat::q(4, 4), 0x80), "-8");
        assert_eq!(text(FixedFormat::uq(8, 0), 0xff), "255");
        assert_eq!(text(FixedFormat::uq(0, 8), 0x01), "0.00390625");
        assert_eq!(text(FixedFormat::q(64, 0), 1 << 63), "-9223372036854775808");
        let smallest = text(FixedFormat::uq(0, 64), 1);
        assert_eq!(smallest.len(), "0.".len() + 64);
        assert!(smallest.ends_with("25"), "{smallest}");
    }

    #[test]
    fn bits_above_the_width_are_not_read() {
        let format = FixedFormat::q(3, 5);
        for bits in 0..=0xff {
            let clean = Fixed::new(format, bits);
            let dirty = Fixed {
                format,
                bits: bits | !format.value_mask(),
            };
            assert_eq!(clean.units(), i128::from(bits as u8 as i8));
            assert_eq!(dirty.units(), clean.units());
            assert_eq!(dirty.is_negative(), clean.is_negative());
            assert_eq!(clean.to_f64() * 32.0, clean.units() as f64);
        }
    }
}
