//! Multiplication and division.

use super::rounder::Unrounded;
use super::{Answer, Flags, FloatArithmetic};

impl FloatArithmetic {
    /// `a * b`, rounded once. The sign is that of the operands, xored, of zeros and infinities too;
    /// zero times infinity is the canonical NaN, and invalid.
    #[inline(always)]
    pub const fn mul(self, a: u64, b: u64) -> Answer {
        let format = self.format;
        let negative = format.has_sign(a ^ b);
        let magnitude_a = self.read_magnitude(a);
        let magnitude_b = self.read_magnitude(b);
        if !(self.is_nonzero_finite(magnitude_a) && self.is_nonzero_finite(magnitude_b)) {
            return self.mul_special(a, b);
        }

        // Leading ones at bit 63 put the product's at bit 127 or 126. One 64-bit multiplier serves
        // all formats; the lower half only matters for being zero or not.
        let to_top = 63 - format.fraction_bits;
        let (field_a, significand_a) = self.normalised(magnitude_a);
        let (field_b, significand_b) = self.normalised(magnitude_b);
        let product = ((significand_a << to_top) as u128) * ((significand_b << to_top) as u128);
        let leading = (product >> 64) as u64 | (product as u64 != 0) as u64;
        let leading_zeros = leading.leading_zeros();
        self.round(Unrounded {
            negative,
            exponent: field_a + field_b - 2 * format.exponent_bias() + 1 - leading_zeros as i32,
            significand: leading << leading_zeros,
        })
    }

    /// `a / b`, rounded once. The sign is that of the operands, xored, of zeros and infinities too.
    /// A finite nonzero number divided by zero is infinite and raises divide by zero; `0 / 0` and
    /// infinity over infinity are the canonical NaN, and invalid.
    #[inline(always)]
    pub const fn div(self, a: u64, b: u64) -> Answer {
        let format = self.format;
        let negative = format.has_sign(a ^ b);
        let magnitude_a = self.read_magnitude(a);
        let magnitude_b = self.read_magnitude(b);
        if !(self.is_nonzero_finite(magnitude_a) && self.is_nonzero_finite(magnitude_b)) {
            return self.div_special(a, b);
        }

        // F + 2 more bits in the dividend give a quotient of F + 2 or F + 3 bits: all that is kept
        // and a guard bit at least; the remainder is the sticky bit. Dividends of up to 64 bits
        // take the machine's divider, wider ones a routine several times slower.
        let extra_bits = format.fraction_bits + 2;
        let (field_a, dividend) = self.normalised(magnitude_a);
        let (field_b, divisor) = self.normalised(magnitude_b);
        let (quotient, inexact) = if 2 * format.fraction_bits + 3 <= 64 {
            let dividend = dividend << extra_bits;
            let quotient = dividend / divisor;
            (quotient, quotient * divisor != dividend)
        } else {
            let dividend = (dividend as u128) << extra_bits;
            let quotient = dividend / divisor as u128;
            (quotient as u64, quotient * divisor as u128 != dividend)
        };
        let leading_zeros = quotient.leading_zeros();
        self.round(Unrounded {
            negative,
            exponent: field_a - field_b + 63 - leading_zeros as i32 - extra_bits as i32,
            significand: quotient << leading_zeros | inexact as u64,
        })
    }

    /// A product of operands of which at least one is zero, infinite or NaN.
    #[cold]
    const fn mul_special(self, a: u64, b: u64) -> Answer {
        let infinity = self.format.infinity();
        let negative = self.format.has_sign(a ^ b);
        let (magnitude_a, magnitude_b) = (self.read_magnitude(a), self.read_magnitude(b));
        let a_or_b_is_zero = magnitude_a == 0 || magnitude_b == 0;
        if magnitude_a > infinity || magnitude_b > infinity {
            self.nan_operand(a, b)
        } else if magnitude_a == infinity || magnitude_b == infinity {
            if a_or_b_is_zero {
                self.not_a_number(true)
            } else {
                self.infinite(negative)
            }
        } else {
            self.zero(negative)
        }
    }

    /// A quotient of operands of which at least one is zero, infinite or NaN.
    #[cold]
    const fn div_special(self, a: u64, b: u64) -> Answer {
        let infinity = self.format.infinity();
        let negative = self.format.has_sign(a ^ b);
        let (magnitude_a, magnitude_b) = (self.read_magnitude(a), self.read_magnitude(b));
        if magnitude_a > infinity || magnitude_b > infinity {
            self.nan_operand(a, b)
        } else if magnitude_a == magnitude_b {
            // 0 / 0 or infinity / infinity: the only equal operands that get here.
            self.not_a_number(true)
        } else if magnitude_a == infinity {
            self.infinite(negative)
        } else if magnitude_b == 0 {
            self.infinite(negative).raising(Flags::DIVIDE_BY_ZERO)
        } else {
            self.zero(negative)
        }
    }
}
