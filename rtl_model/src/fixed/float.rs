//! Between fixed point and floats.

use super::rounder::Exact;
use super::{Fixed, FixedArithmetic};
use crate::float::{Answer, Flags, FloatArithmetic, FloatFormat, Policy};

impl FixedArithmetic {
    /// The float `a` as a fixed-point number. `policy` says how its subnormal patterns are read.
    /// What is no number is [`Flags::INVALID`] alone: of an infinity the result is the end of the
    /// range on its side, wherever results may wrap, and of a NaN 0. Both zeros are 0.
    pub fn from_float(self, source: FloatFormat, policy: Policy, a: u64) -> (Fixed, Flags) {
        let negative = a & source.sign_bit() != 0;
        let magnitude = a & (source.sign_bit() - 1);
        if magnitude > source.infinity() {
            return self.invalid();
        }
        if magnitude == source.infinity() {
            return self.end_of_range(negative, Flags::INVALID);
        }
        let field = magnitude >> source.fraction_bits;
        let fraction = magnitude & source.fraction_mask();
        let (significand, field) = match (field, policy) {
            (0, Policy::Flush) => (0, 1),
            (0, Policy::Full) => (fraction, 1),
            _ => (fraction | source.min_normal(), field),
        };
        let exponent = field as i32 - source.exponent_bias() - source.fraction_bits.cast_signed();
        self.round(Exact {
            negative,
            magnitude: significand.into(),
            exponent,
        })
    }
}

impl Fixed {
    /// The number as a float, rounded once; zero is +0. Underflow and overflow, and the flags, are
    /// those of the float's arithmetic.
    pub fn to_float(self, arithmetic: FloatArithmetic) -> Answer {
        let exponent = -i64::from(self.format.fraction_bits);
        let units = self.units();
        match i64::try_from(units) {
            Ok(units) => arithmetic.from_scaled_integer(units, exponent),
            // Unsigned, with its first bit set: of 64 bits a float keeps 53 at most, so that the
            // last one only matters for being there, beside the one before it.
            Err(_) => {
                let halved = (units >> 1 | units & 1) as i64;
                arithmetic.from_scaled_integer(halved, exponent + 1)
            }
        }
    }
}
