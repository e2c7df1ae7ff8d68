//! Addition, subtraction, and what takes one operand as it is: negation, conversion.

use super::rounder::Exact;
use super::{Fixed, FixedArithmetic};
use crate::float::Flags;

impl FixedArithmetic {
    /// `a + b`.
    pub fn add(self, a: Fixed, b: Fixed) -> (Fixed, Flags) {
        self.sum(a, b, b.is_negative())
    }

    /// `a - b`.
    pub fn sub(self, a: Fixed, b: Fixed) -> (Fixed, Flags) {
        self.sum(a, b, !b.is_negative())
    }

    /// `-a`. The smallest signed number and, in an unsigned format, all but zero go beyond the range.
    pub fn negate(self, a: Fixed) -> (Fixed, Flags) {
        self.round(Exact {
            negative: !a.is_negative(),
            magnitude: a.magnitude().into(),
            exponent: -a.format.fraction_bits.cast_signed(),
        })
    }

    /// `a` in the format of results. Integers are numbers of `q64.0` ([`Fixed::from_i64`]) or of
    /// any other format without fraction bits.
    pub fn convert(self, a: Fixed) -> (Fixed, Flags) {
        self.round(Exact {
            negative: a.is_negative(),
            magnitude: a.magnitude().into(),
            exponent: -a.format.fraction_bits.cast_signed(),
        })
    }

    /// `a` plus the magnitude of `b`, or minus where `b_negative`.
    fn sum(self, a: Fixed, b: Fixed, b_negative: bool) -> (Fixed, Flags) {
        // In units of the finer operand both magnitudes are below 2^128, and so is their sum: they
        // are at most 2^64 - 1 units of their own, and where one is moved by F places it had at most
        // 64 - F bits before the point.
        let fraction_bits = a.format.fraction_bits.max(b.format.fraction_bits);
        let aligned =
            |x: Fixed| u128::from(x.magnitude()) << (fraction_bits - x.format.fraction_bits);
        let (a_magnitude, b_magnitude) = (aligned(a), aligned(b));
        let a_negative = a.is_negative();
        let (negative, magnitude) = if a_negative == b_negative {
            (a_negative, a_magnitude + b_magnitude)
        } else if a_magnitude >= b_magnitude {
            (a_negative, a_magnitude - b_magnitude)
        } else {
            (b_negative, b_magnitude - a_magnitude)
        };
        self.round(Exact {
            negative,
            magnitude,
            exponent: -fraction_bits.cast_signed(),
        })
    }
}
