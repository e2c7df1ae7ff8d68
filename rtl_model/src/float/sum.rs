//! Addition and subtraction.

use super::rounder::{Unrounded, shift_right_sticky};
use super::{Answer, FloatArithmetic};

impl FloatArithmetic {
    /// `a + b`, rounded once.
    ///
    /// A sum of exactly zero is +0, or -0 when rounding down; two zeros of one sign keep it.
    /// Infinities of opposite sign give the canonical NaN and are invalid.
    #[inline(always)]
    pub const fn add(self, a: u64, b: u64) -> Answer {
        let format = self.format;
        let signs_differ = format.has_sign(a ^ b);
        let magnitude_a = self.read_magnitude(a);
        let magnitude_b = self.read_magnitude(b);
        // Which operand is larger and whether the signs differ are coin tosses to a branch
        // predictor: masks instead of branches halve the time on random operands.
        let b_is_larger = all_bits(magnitude_b > magnitude_a);
        let exchanged = (magnitude_a ^ magnitude_b) & b_is_larger;
        let (large, small) = (magnitude_a ^ exchanged, magnitude_b ^ exchanged);
        let negative = format.has_sign(a ^ ((a ^ b) & b_is_larger));
        if large >= format.infinity() {
            return self.add_beyond_finite(a, b, negative);
        }

        // Leading ones at bit 62: one bit above for the carry of the sum, at least ten below for
        // what the alignment shifts out. Only a distance of 2 or more loses bits, and then the
        // difference cancels one leading bit at most: the sticky bit stays below the guard bit.
        let to_62 = 62 - format.fraction_bits;
        let (large_field, large_significand) = self.as_encoded(large);
        let (small_field, small_significand) = self.as_encoded(small);
        let distance = large_field - small_field;
        let aligned = shift_right_sticky(small_significand << to_62, distance as u32);
        let minus = all_bits(signs_differ);
        let total =
            (large_significand << to_62).wrapping_add((aligned ^ minus).wrapping_sub(minus));
        if total == 0 {
            return if signs_differ {
                self.cancelled()
            } else {
                self.zero(negative)
            };
        }

        let leading_zeros = total.leading_zeros();
        self.round(Unrounded {
            negative,
            exponent: large_field - format.exponent_bias() + 1 - leading_zeros as i32,
            significand: total << leading_zeros,
        })
    }

    /// `a - b`, rounded once: `a + (-b)` in every case.
    #[inline(always)]
    pub const fn sub(self, a: u64, b: u64) -> Answer {
        self.add(a, self.format.negate(b))
    }

    /// A sum of which one operand is infinite or NaN; `negative` is the sign of the larger one.
    #[cold]
    const fn add_beyond_finite(self, a: u64, b: u64, negative: bool) -> Answer {
        let format = self.format;
        if format.is_nan(a) || format.is_nan(b) {
            self.nan_operand(a, b)
        } else if format.is_infinite(a) && format.is_infinite(b) && format.has_sign(a ^ b) {
            self.not_a_number(true)
        } else {
            self.infinite(negative)
        }
    }

    /// The answer to operands of which one is NaN: invalid if one is signalling.
    #[inline(always)]
    pub(super) const fn nan_operand(self, a: u64, b: u64) -> Answer {
        self.not_a_number(self.format.is_signalling_nan(a) || self.format.is_signalling_nan(b))
    }
}

/// 64 ones where `condition` holds, else 64 zeros.
#[inline(always)]
const fn all_bits(condition: bool) -> u64 {
    (condition as u64).wrapping_neg()
}
