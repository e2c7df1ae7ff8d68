//! Addition and subtraction.

use super::rounder::Unrounded;
use super::{FloatFormat, Rounding};

impl FloatFormat {
    /// `a + b`, rounded once.
    ///
    /// A sum of exactly zero is +0, or -0 under [`Rounding::Down`]; two zeros of one sign keep it.
    /// Infinities of opposite sign give the canonical NaN.
    #[inline(always)]
    pub const fn add(self, rounding: Rounding, a: u64, b: u64) -> u64 {
        let signs_differ = self.has_sign(a ^ b);
        let magnitude_a = self.flushed_magnitude(a);
        let magnitude_b = self.flushed_magnitude(b);
        // Which operand is larger and whether the signs differ are coin tosses to a branch
        // predictor: masks instead of branches halve the time on random operands.
        let b_is_larger = all_bits(magnitude_b > magnitude_a);
        let exchanged = (magnitude_a ^ magnitude_b) & b_is_larger;
        let (large, small) = (magnitude_a ^ exchanged, magnitude_b ^ exchanged);
        let negative = self.has_sign(a ^ ((a ^ b) & b_is_larger));
        if large >= self.infinity() {
            return self.add_beyond_finite(negative, large, small, signs_differ);
        }

        // Leading ones at bit 62: one bit above for the carry of the sum, at least ten below for
        // what the alignment shifts out. Only a distance of 2 or more loses bits, and then the
        // difference cancels one leading bit at most: the sticky bit stays below the guard bit.
        let distance = self.exponent_field(large) - self.exponent_field(small);
        let large_significand = self.significand_or_zero(large);
        let small_significand =
            shift_right_sticky(self.significand_or_zero(small), distance as u32);
        let minus = all_bits(signs_differ);
        let total = large_significand.wrapping_add((small_significand ^ minus).wrapping_sub(minus));
        if total == 0 {
            let minus_zero = if signs_differ {
                matches!(rounding, Rounding::Down)
            } else {
                negative
            };
            return self.zero_of_sign(minus_zero);
        }

        let leading_zeros = total.leading_zeros();
        self.round(
            rounding,
            Unrounded {
                negative,
                exponent: self.exponent_field(large) - self.exponent_bias() + 1
                    - leading_zeros as i32,
                significand: total << leading_zeros,
            },
        )
    }

    /// `a - b`, rounded once: `a + (-b)` in every case.
    #[inline(always)]
    pub const fn sub(self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.add(rounding, a, self.negate(b))
    }

    /// A sum whose larger magnitude is infinite or NaN.
    #[cold]
    const fn add_beyond_finite(
        self,
        negative: bool,
        large: u64,
        small: u64,
        signs_differ: bool,
    ) -> u64 {
        if large > self.infinity() || (small == self.infinity() && signs_differ) {
            self.quiet_nan()
        } else {
            self.zero_of_sign(negative) | self.infinity()
        }
    }

    /// The significand with its leading one at bit 62, or 0 for a zero.
    #[inline(always)]
    const fn significand_or_zero(self, magnitude: u64) -> u64 {
        if magnitude == 0 {
            0
        } else {
            self.significand(magnitude) << (62 - self.fraction_bits)
        }
    }
}

/// 64 ones where `condition` holds, else 64 zeros.
#[inline(always)]
const fn all_bits(condition: bool) -> u64 {
    (condition as u64).wrapping_neg()
}

/// `value >> amount`, with bit 0 set if a 1 was shifted out.
#[inline(always)]
const fn shift_right_sticky(value: u64, amount: u32) -> u64 {
    let amount = if amount > 63 { 63 } else { amount };
    let shifted = value >> amount;
    shifted | (shifted << amount != value) as u64
}
