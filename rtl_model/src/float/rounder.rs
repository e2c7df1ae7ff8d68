//! The one rounder behind every inexact operator: from an exact result to the nearest pattern.

use super::{FloatFormat, Rounding};

/// A nonzero result before rounding: `significand / 2^63 * 2^exponent`, negated where `negative`.
///
/// Bit 63 of the significand is 1. The leading 63 bits are those of the exact result; bit 0 is
/// sticky: it is 1 where the exact result has a 1 there or anywhere below. The widest format keeps
/// 53 bits, so that at least the guard bit and the sticky bit are always there to decide by.
#[derive(Clone, Copy)]
pub(super) struct Unrounded {
    pub(super) negative: bool,
    /// The exponent without bias; far from the range of `i32`, so that adding a bias is safe.
    pub(super) exponent: i32,
    pub(super) significand: u64,
}

impl Rounding {
    /// Does rounding move to the next larger magnitude?
    ///
    /// `odd` is the last bit kept; `dropped` the bits after it, its own first bit (bit 63) worth
    /// half a unit in the last place.
    #[inline(always)]
    pub(super) const fn increments(self, negative: bool, odd: bool, dropped: u64) -> bool {
        const HALF: u64 = 1 << 63;
        match self {
            // More than half, or a tie beside an odd neighbour.
            Rounding::NearestEven => dropped > HALF - odd as u64,
            Rounding::TowardZero => false,
            Rounding::Up => !negative && dropped != 0,
            Rounding::Down => negative && dropped != 0,
        }
    }

    /// What a magnitude beyond the largest finite one becomes: infinity, or the largest finite one
    /// where this rounding never moves away from zero (IEEE 754-2019, 7.4).
    #[inline(always)]
    const fn overflows_to_infinity(self, negative: bool) -> bool {
        match self {
            Rounding::NearestEven => true,
            Rounding::TowardZero => false,
            Rounding::Up => !negative,
            Rounding::Down => negative,
        }
    }
}

impl FloatFormat {
    /// The pattern of a result: rounded to `F` fraction bits as if the exponent had no bounds, then
    /// replaced by a zero of its sign if below the smallest normal number, and by infinity or the
    /// largest finite number if above the latter.
    #[inline(always)]
    pub(super) const fn round(self, rounding: Rounding, exact: Unrounded) -> u64 {
        let kept = exact.significand >> (63 - self.fraction_bits);
        let dropped = exact.significand << (self.fraction_bits + 1);
        let increments = rounding.increments(exact.negative, kept & 1 == 1, dropped);

        // Fields this far outside decide the result alone; bounding them keeps the shift within
        // 64 bits. The kept leading one and a carry out of the rounding both add to the field, so
        // with one more for its lower bound the sum stands two too high.
        let field = exact.exponent + self.exponent_bias();
        let all_ones = self.exponent_all_ones() as i32;
        let bounded = if field < 0 {
            -1
        } else if field > all_ones {
            all_ones
        } else {
            field
        };
        let sum = (((bounded + 1) as u64) << self.fraction_bits) + kept + increments as u64;
        let magnitude = sum.saturating_sub(2 << self.fraction_bits);

        let magnitude = if magnitude < self.infinity() {
            self.flushed_magnitude(magnitude)
        } else if rounding.overflows_to_infinity(exact.negative) {
            self.infinity()
        } else {
            self.max_finite()
        };
        self.zero_of_sign(exact.negative) | magnitude
    }
}
