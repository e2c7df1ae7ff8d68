//! Division and the reciprocal.

use super::rounder::{Cut, Dropped};
use super::{Fixed, FixedArithmetic, FixedFormat};
use crate::float::Flags;

/// Quotient bits found by one division of machine words.
const BITS_AT_ONCE: u32 = 64;

impl FixedArithmetic {
    /// `a / b`. A nonzero number divided by zero is the end of the range on its side, wherever
    /// results may wrap, with [`Flags::DIVIDE_BY_ZERO`] alone; `0 / 0` is 0, with
    /// [`Flags::INVALID`] alone.
    pub fn div(self, a: Fixed, b: Fixed) -> (Fixed, Flags) {
        let (dividend, divisor) = (a.magnitude(), b.magnitude());
        if divisor == 0 {
            return if dividend == 0 {
                self.invalid()
            } else {
                self.end_of_range(a.is_negative(), Flags::DIVIDE_BY_ZERO)
            };
        }
        // The quotient of the words is in units of 2^(Fb - Fa); those of the result are so many
        // places finer.
        let places = (self.format.fraction_bits + b.format.fraction_bits).cast_signed()
            - a.format.fraction_bits.cast_signed();
        let cut = if places < 0 {
            coarser(dividend, divisor, places.unsigned_abs())
        } else {
            finer(dividend, divisor, places.unsigned_abs())
        };
        self.fit(Cut {
            negative: a.is_negative() != b.is_negative(),
            ..cut
        })
    }

    /// `1 / a`: as [`FixedArithmetic::div`], the reciprocal of zero is the largest number.
    pub fn reciprocal(self, a: Fixed) -> (Fixed, Flags) {
        self.div(Fixed::new(FixedFormat::uq(1, 0), 1), a)
    }
}

/// `dividend / (divisor * 2^places)`, cut at 1; at most 64 places.
fn coarser(dividend: u64, divisor: u64, places: u32) -> Cut {
    let divisor = u128::from(divisor) << places;
    let dividend = u128::from(dividend);
    Cut {
        negative: false,
        units: dividend / divisor,
        beyond: false,
        dropped: dropped(dividend % divisor, divisor),
    }
}

/// `dividend * 2^places / divisor`, cut at 1.
fn finer(dividend: u64, divisor: u64, mut places: u32) -> Cut {
    let divisor = u128::from(divisor);
    let mut units = u128::from(dividend) / divisor;
    let mut remainder = u128::from(dividend) % divisor;
    let mut beyond = false;
    // Long division: the remainder is below the divisor, so every step adds that many bits.
    while places > 0 {
        let step = places.min(BITS_AT_ONCE);
        let moved = remainder << step;
        beyond |= units.leading_zeros() < step;
        units = (units << step) | (moved / divisor);
        remainder = moved % divisor;
        places -= step;
    }
    Cut {
        negative: false,
        units,
        beyond,
        dropped: dropped(remainder, divisor),
    }
}

/// What a remainder is beside half of the divisor.
fn dropped(remainder: u128, divisor: u128) -> Dropped {
    if remainder == 0 {
        Dropped::Nothing
    } else {
        Dropped::beside_half(remainder.cmp(&(divisor - remainder)))
    }
}
