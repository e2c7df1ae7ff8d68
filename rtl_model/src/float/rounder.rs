//! The one rounder behind every inexact operator: from an exact result to the nearest pattern.

use super::{Answer, Flags, FloatArithmetic, Policy, Rounding};

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

/// `value >> amount`, with bit 0 set if a 1 was shifted out.
#[inline(always)]
pub(super) const fn shift_right_sticky(value: u64, amount: u32) -> u64 {
    let amount = if amount > 63 { 63 } else { amount };
    let shifted = value >> amount;
    shifted | (shifted << amount != value) as u64
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

impl FloatArithmetic {
    /// The pattern of a result, and its flags overflow, underflow and inexact.
    ///
    /// First it is rounded to `F` fraction bits as if the exponent had no bounds. Beyond the largest
    /// finite number it is then replaced by infinity or that number. Below the smallest normal
    /// number it is *tiny*: under `flush` it becomes the zero of its sign; under `full` the exact
    /// result is rounded anew, to a multiple of the smallest subnormal number.
    #[inline(always)]
    pub(super) const fn round(self, exact: Unrounded) -> Answer {
        let format = self.format;
        let (kept, dropped) = self.split(exact.significand);
        let increments = self
            .rounding
            .increments(exact.negative, kept & 1 == 1, dropped);

        // Fields this far outside decide the result alone; bounding them keeps the shift within
        // 64 bits. The kept leading one and a carry out of the rounding both add to the field, so
        // with one more for its lower bound the sum stands two too high.
        let field = exact.exponent + format.exponent_bias();
        let all_ones = format.exponent_all_ones() as i32;
        let bounded = if field < 0 {
            -1
        } else if field > all_ones {
            all_ones
        } else {
            field
        };
        let sum = (((bounded + 1) as u64) << format.fraction_bits) + kept + increments as u64;
        let magnitude = sum.saturating_sub(2 << format.fraction_bits);

        let tiny = magnitude < format.min_normal();
        if matches!(self.policy, Policy::Full) && field < 1 {
            return self.round_below_normal(exact.negative, field, exact.significand, tiny);
        }
        let overflow = magnitude >= format.infinity();
        let magnitude = if !overflow {
            // Under `full` no tiny result gets here.
            format.flushed_magnitude(magnitude)
        } else if self.rounding.overflows_to_infinity(exact.negative) {
            format.infinity()
        } else {
            format.max_finite()
        };
        Answer {
            bits: format.zero_of_sign(exact.negative) | magnitude,
            flags: Flags::INEXACT
                .when(dropped != 0 || overflow || tiny)
                .union(Flags::UNDERFLOW.when(tiny))
                .union(Flags::OVERFLOW.when(overflow)),
        }
    }

    /// A result whose leading one is below the smallest normal number: a multiple of the smallest
    /// subnormal number, up to that normal number itself.
    #[inline]
    const fn round_below_normal(
        self,
        negative: bool,
        field: i32,
        significand: u64,
        tiny: bool,
    ) -> Answer {
        let aligned = shift_right_sticky(significand, (1 - field) as u32);
        let (kept, dropped) = self.split(aligned);
        let increments = self.rounding.increments(negative, kept & 1 == 1, dropped);
        let inexact = dropped != 0;
        Answer {
            bits: self.format.zero_of_sign(negative) | (kept + increments as u64),
            flags: Flags::INEXACT
                .when(inexact)
                .union(Flags::UNDERFLOW.when(inexact && tiny)),
        }
    }

    /// The `F + 1` leading bits of a significand, and those after them, moved up to bit 63.
    #[inline(always)]
    const fn split(self, significand: u64) -> (u64, u64) {
        let fraction_bits = self.format.fraction_bits;
        (
            significand >> (63 - fraction_bits),
            significand << (fraction_bits + 1),
        )
    }
}
