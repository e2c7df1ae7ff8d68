//! Multiplication.

use super::rounder::Exact;
use super::{Fixed, FixedArithmetic};
use crate::float::Flags;

impl FixedArithmetic {
    /// `a * b`.
    pub fn mul(self, a: Fixed, b: Fixed) -> (Fixed, Flags) {
        let fraction_bits = a.format.fraction_bits + b.format.fraction_bits;
        self.round(Exact {
            negative: a.is_negative() != b.is_negative(),
            magnitude: u128::from(a.magnitude()) * u128::from(b.magnitude()),
            exponent: -fraction_bits.cast_signed(),
        })
    }
}
