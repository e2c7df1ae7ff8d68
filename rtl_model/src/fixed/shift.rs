//! Shifts: products with powers of two.

use super::rounder::Exact;
use super::{Fixed, FixedArithmetic};
use crate::float::Flags;

/// A distance that leaves nothing of a word in any format: the word itself and both its ends are
/// within 192 places.
const FAR: u32 = 1 << 12;

impl FixedArithmetic {
    /// `a * 2^places`: what leaves the range on the left overflows, as everywhere.
    pub fn shift_left(self, a: Fixed, places: u32) -> (Fixed, Flags) {
        self.scaled(a, places.min(FAR).cast_signed())
    }

    /// `a / 2^places`: what leaves on the right is rounded. An arithmetic shift, where that means
    /// rounding down, is [`Rounding::Down`](crate::float::Rounding::Down).
    pub fn shift_right(self, a: Fixed, places: u32) -> (Fixed, Flags) {
        self.scaled(a, -places.min(FAR).cast_signed())
    }

    fn scaled(self, a: Fixed, exponent: i32) -> (Fixed, Flags) {
        self.round(Exact {
            negative: a.is_negative(),
            magnitude: a.magnitude().into(),
            exponent: exponent - a.format.fraction_bits.cast_signed(),
        })
    }
}
