//! To and from integers and `f64`, the largest integer below, and decimal text.

use thiserror::Error;

use super::rounder::Unrounded;
use super::{FloatFormat, Rounding};

/// Fraction bits of an `f64`.
const F64_FRACTION_BITS: u32 = 52;
/// Exponent bias of an `f64`.
const F64_BIAS: i32 = 1023;

/// Why a float has no `i64`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ToIntegerError {
    /// The value is NaN.
    #[error("NaN has no integer value: check the operand before converting it")]
    NotANumber,
    /// The value, rounded, is above `i64::MAX`; plus infinity is.
    #[error("the value is above 2^63 - 1, the largest 64-bit integer: saturate or scale it")]
    AboveRange,
    /// The value, rounded, is below `i64::MIN`; minus infinity is.
    #[error("the value is below -2^63, the smallest 64-bit integer: saturate or scale it")]
    BelowRange,
}

impl ToIntegerError {
    /// The integer a saturating converter answers with: the nearer end of the range, 0 for NaN.
    pub const fn saturated(self) -> i64 {
        match self {
            ToIntegerError::NotANumber => 0,
            ToIntegerError::AboveRange => i64::MAX,
            ToIntegerError::BelowRange => i64::MIN,
        }
    }
}

impl FloatFormat {
    /// `value * 2^exponent`, rounded once; any `exponent` is allowed. The integer 0 is +0 under
    /// every rounding; underflow and overflow are those of the other operators.
    #[inline]
    pub const fn from_integer(self, rounding: Rounding, value: i64, exponent: i64) -> u64 {
        if value == 0 {
            return 0;
        }
        // Beyond these every format has long underflowed or overflowed.
        let exponent = if exponent < -10_000 {
            -10_000
        } else if exponent > 10_000 {
            10_000
        } else {
            exponent as i32
        };
        let magnitude = value.unsigned_abs();
        let leading_zeros = magnitude.leading_zeros();
        self.round(
            rounding,
            Unrounded {
                negative: value < 0,
                exponent: exponent + 63 - leading_zeros as i32,
                significand: magnitude << leading_zeros,
            },
        )
    }

    /// The integer `a` rounds to. Zeros of either sign are 0.
    ///
    /// # Errors
    /// If `a` is NaN, or rounds to an integer outside `i64`. For the saturating converter of
    /// hardware: `.unwrap_or_else(ToIntegerError::saturated)`.
    #[inline]
    pub const fn to_integer(self, rounding: Rounding, a: u64) -> Result<i64, ToIntegerError> {
        let negative = self.has_sign(a);
        let magnitude = self.flushed_magnitude(a);
        if magnitude == 0 {
            return Ok(0);
        }
        if magnitude > self.infinity() {
            return Err(ToIntegerError::NotANumber);
        }
        let out_of_range = if negative {
            ToIntegerError::BelowRange
        } else {
            ToIntegerError::AboveRange
        };
        let exponent = self.exponent_field(magnitude) - self.exponent_bias();
        if magnitude == self.infinity() || exponent > 63 {
            return Err(out_of_range);
        }

        // The leading one at bit 63 weighs 2^exponent. What is shifted out goes to `dropped`, whose
        // bit 63 weighs one half; below a half only "not zero" matters.
        let significand = self.significand(magnitude) << (63 - self.fraction_bits);
        let (kept, dropped) = match 63 - exponent {
            0 => (significand, 0),
            64 => (0, significand),
            amount if amount > 64 => (0, 1),
            amount => (significand >> amount, significand << (64 - amount)),
        };
        let increments = rounding.increments(negative, kept & 1 == 1, dropped);
        // No carry out of 64 bits: an integer of 64 bits has nothing to drop.
        let integer = kept + increments as u64;
        if negative && integer <= i64::MIN.unsigned_abs() {
            Ok((integer as i64).wrapping_neg())
        } else if !negative && integer <= i64::MAX as u64 {
            Ok(integer as i64)
        } else {
            Err(out_of_range)
        }
    }

    /// The largest integer at or below `a`, as a float. Exact wherever that integer is a number of
    /// the format.
    ///
    /// -0 and negative subnormal patterns give -0, infinities themselves, every NaN the canonical
    /// one. In formats with `F >= 2^(E-1)` the floor of a negative number may lie below the most
    /// negative finite one; it is minus infinity then, as rounding down has it.
    #[inline]
    pub const fn floor(self, a: u64) -> u64 {
        let negative = self.has_sign(a);
        let magnitude = self.flushed_magnitude(a);
        let exponent = self.exponent_field(magnitude) - self.exponent_bias();
        if !self.is_normal_magnitude(magnitude) || exponent >= self.fraction_bits as i32 {
            return self.canonical(a);
        }
        let floored = if exponent < 0 {
            if negative { self.one() } else { 0 }
        } else {
            // Adding to the pattern carries into the exponent where the significand overflows, and
            // to the pattern of infinity past the largest number.
            let below_one = self.fraction_mask() >> exponent;
            let moves_away = negative && magnitude & below_one != 0;
            (magnitude & !below_one) + ((below_one + 1) * moves_away as u64)
        };
        self.zero_of_sign(negative) | floored
    }

    /// The pattern nearest to the number `value` under this rounding. Zeros and infinities keep
    /// their sign, every NaN becomes the canonical one; subnormal `f64` are numbers like any other.
    #[inline]
    pub const fn from_f64(self, rounding: Rounding, value: f64) -> u64 {
        let bits = value.to_bits();
        let negative = bits >> 63 == 1;
        let field = (bits >> F64_FRACTION_BITS & 0x7ff) as i32;
        let fraction = bits & ((1 << F64_FRACTION_BITS) - 1);
        if field == 0x7ff {
            return if fraction == 0 {
                self.zero_of_sign(negative) | self.infinity()
            } else {
                self.quiet_nan()
            };
        }
        // An f64 with exponent field 0 has the exponent of field 1 and no leading one.
        let (significand, field) = if field == 0 {
            (fraction, 1)
        } else {
            (fraction | 1 << F64_FRACTION_BITS, field)
        };
        if significand == 0 {
            return self.zero_of_sign(negative);
        }
        let leading_zeros = significand.leading_zeros();
        self.round(
            rounding,
            Unrounded {
                negative,
                exponent: field - F64_BIAS + 63 - F64_FRACTION_BITS as i32 - leading_zeros as i32,
                significand: significand << leading_zeros,
            },
        )
    }

    /// The number `a` as an `f64`: exact for every format. Subnormal patterns are zeros of their
    /// sign, every NaN is `f64::NAN`.
    #[inline]
    pub const fn to_f64(self, a: u64) -> f64 {
        let magnitude = self.flushed_magnitude(a);
        let sign = (self.has_sign(a) as u64) << 63;
        if magnitude > self.infinity() {
            return f64::NAN;
        }
        let field = if magnitude == 0 {
            0
        } else if magnitude == self.infinity() {
            0x7ff
        } else {
            (self.exponent_field(magnitude) - self.exponent_bias() + F64_BIAS) as u64
        };
        let fraction =
            (magnitude & self.fraction_mask()) << (F64_FRACTION_BITS - self.fraction_bits);
        f64::from_bits(sign | field << F64_FRACTION_BITS | fraction)
    }

    /// The shortest decimal that reads back, as an `f64`, to the value of `a`: and so through
    /// [`FloatFormat::from_f64`] to its bits, under any rounding, since no rounding happens.
    /// Infinities are `inf` and `-inf`, every NaN is `NaN`.
    pub fn format_decimal(self, a: u64) -> String {
        format!("{:?}", self.to_f64(a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_text_reads_back_to_the_bits() {
        for format in [
            FloatFormat::E4F3,
            FloatFormat::new(5, 10),
            FloatFormat::new(11, 4),
        ] {
            for a in 0..=format.value_mask() {
                let text = format.format_decimal(a);
                let value: f64 = text.parse().expect("a decimal, `inf` or `NaN`");
                for rounding in Rounding::ALL {
                    assert_eq!(
                        format.from_f64(rounding, value),
                        format.canonical(a),
                        "{format} {a:#x} {text}"
                    );
                }
            }
        }
    }

    #[test]
    fn decimal_text_of_known_values() {
        let format = FloatFormat::E7F16;
        assert_eq!(format.format_decimal(format.one()), "1.0");
        assert_eq!(format.format_decimal(format.sign_bit() | 1), "-0.0");
        assert_eq!(format.format_decimal(format.infinity()), "inf");
        assert_eq!(format.format_decimal(format.quiet_nan()), "NaN");
    }

    #[test]
    fn saturation_is_to_the_nearer_end() {
        let format = FloatFormat::E7F16;
        let minus_infinity = format.sign_bit() | format.infinity();
        let saturating = |a| {
            format
                .to_integer(Rounding::NearestEven, a)
                .unwrap_or_else(ToIntegerError::saturated)
        };
        assert_eq!(saturating(format.infinity()), i64::MAX);
        assert_eq!(saturating(minus_infinity), i64::MIN);
        assert_eq!(saturating(format.quiet_nan()), 0);
    }

    #[test]
    fn host_subnormals_are_read_exactly() {
        // 2^-1022 * (1 - 2^-52) rounds to the smallest normal number where fewer bits are kept.
        let value = f64::from_bits((1 << 52) - 1);
        let format = FloatFormat::new(11, 20);
        assert_eq!(
            format.from_f64(Rounding::NearestEven, value),
            format.min_normal()
        );
        assert_eq!(format.from_f64(Rounding::TowardZero, value), 0);
        assert_eq!(
            format.from_f64(Rounding::Down, -value),
            format.sign_bit() | format.min_normal()
        );
    }
}
