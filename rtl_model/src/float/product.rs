//! Multiplication and division.

use super::rounder::Unrounded;
use super::{FloatFormat, Rounding};

impl FloatFormat {
    /// `a * b`, rounded once. The sign is that of the operands, xored, of zeros and infinities too;
    /// zero times infinity is the canonical NaN.
    #[inline(always)]
    pub const fn mul(self, rounding: Rounding, a: u64, b: u64) -> u64 {
        let negative = self.has_sign(a ^ b);
        let a = self.flushed_magnitude(a);
        let b = self.flushed_magnitude(b);
        if !(self.is_normal_magnitude(a) && self.is_normal_magnitude(b)) {
            return self.mul_special(negative, a, b);
        }

        // Leading ones at bit 63 put the product's at bit 127 or 126. One 64-bit multiplier serves
        // all formats; the lower half only matters for being zero or not.
        let to_top = 63 - self.fraction_bits;
        let product =
            ((self.significand(a) << to_top) as u128) * ((self.significand(b) << to_top) as u128);
        let leading = (product >> 64) as u64 | (product as u64 != 0) as u64;
        let leading_zeros = leading.leading_zeros();
        self.round(
            rounding,
            Unrounded {
                negative,
                exponent: self.exponent_field(a) + self.exponent_field(b)
                    - 2 * self.exponent_bias()
                    + 1
                    - leading_zeros as i32,
                significand: leading << leading_zeros,
            },
        )
    }

    /// `a / b`, rounded once. The sign is that of the operands, xored, of zeros and infinities too;
    /// a nonzero number divided by zero is infinite; `0 / 0` and infinity over infinity are the
    /// canonical NaN.
    #[inline(always)]
    pub const fn div(self, rounding: Rounding, a: u64, b: u64) -> u64 {
        let negative = self.has_sign(a ^ b);
        let a = self.flushed_magnitude(a);
        let b = self.flushed_magnitude(b);
        if !(self.is_normal_magnitude(a) && self.is_normal_magnitude(b)) {
            return self.div_special(negative, a, b);
        }

        // F + 2 more bits in the dividend give a quotient of F + 2 or F + 3 bits: all that is kept
        // and a guard bit at least; the remainder is the sticky bit. Dividends of up to 64 bits
        // take the machine's divider, wider ones a routine several times slower.
        let extra_bits = self.fraction_bits + 2;
        let divisor = self.significand(b);
        let (quotient, inexact) = if 2 * self.fraction_bits + 3 <= 64 {
            let dividend = self.significand(a) << extra_bits;
            let quotient = dividend / divisor;
            (quotient, quotient * divisor != dividend)
        } else {
            let dividend = (self.significand(a) as u128) << extra_bits;
            let quotient = dividend / divisor as u128;
            (quotient as u64, quotient * divisor as u128 != dividend)
        };
        let leading_zeros = quotient.leading_zeros();
        self.round(
            rounding,
            Unrounded {
                negative,
                exponent: self.exponent_field(a) - self.exponent_field(b) + 63
                    - leading_zeros as i32
                    - extra_bits as i32,
                significand: quotient << leading_zeros | inexact as u64,
            },
        )
    }

    /// A product of magnitudes of which at least one is zero, infinite or NaN.
    #[cold]
    const fn mul_special(self, negative: bool, a: u64, b: u64) -> u64 {
        let invalid = (a == 0 && b == self.infinity()) || (a == self.infinity() && b == 0);
        if a > self.infinity() || b > self.infinity() || invalid {
            self.quiet_nan()
        } else if a == 0 || b == 0 {
            self.zero_of_sign(negative)
        } else {
            self.zero_of_sign(negative) | self.infinity()
        }
    }

    /// A quotient of magnitudes of which at least one is zero, infinite or NaN.
    #[cold]
    const fn div_special(self, negative: bool, a: u64, b: u64) -> u64 {
        // 0 / 0 and infinity / infinity: the one case of equal operands that gets here.
        if a > self.infinity() || b > self.infinity() || a == b {
            self.quiet_nan()
        } else if a == 0 || b == self.infinity() {
            self.zero_of_sign(negative)
        } else {
            self.zero_of_sign(negative) | self.infinity()
        }
    }
}
