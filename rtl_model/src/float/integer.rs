//! To and from integers, and to the integers among the floats.

use super::rounder::Unrounded;
use super::{Answer, Flags, FloatArithmetic, IntegerFormat, Rounding};

impl FloatArithmetic {
    /// The float of an integer, rounded once. The integer 0 is +0 under every rounding; underflow
    /// and overflow are those of the other operators.
    #[inline]
    pub const fn from_integer(self, source: IntegerFormat, value: u64) -> Answer {
        let (negative, magnitude) = source.sign_and_magnitude(value);
        self.round_scaled(negative, magnitude, 0)
    }

    /// `value * 2^exponent`, rounded once; any `exponent` is allowed. The rest is as in
    /// [`FloatArithmetic::from_integer`].
    #[inline(always)]
    pub const fn from_scaled_integer(self, value: i64, exponent: i64) -> Answer {
        // Beyond these every format has long underflowed or overflowed.
        let exponent = if exponent < -10_000 {
            -10_000
        } else if exponent > 10_000 {
            10_000
        } else {
            exponent as i32
        };
        self.round_scaled(value < 0, value.unsigned_abs(), exponent)
    }

    /// `magnitude * 2^exponent` with its sign, rounded once.
    #[inline(always)]
    const fn round_scaled(self, negative: bool, magnitude: u64, exponent: i32) -> Answer {
        if magnitude == 0 {
            return Answer::exact(0);
        }
        let leading_zeros = magnitude.leading_zeros();
        self.round(Unrounded {
            negative,
            exponent: exponent + 63 - leading_zeros as i32,
            significand: magnitude << leading_zeros,
        })
    }

    /// The integer `a` rounds to: `convertToInteger` of IEEE 754-2019, 5.8, with this rounding.
    ///
    /// What has no answer is invalid, and saturates: a value that, rounded, is out of range becomes
    /// the nearer end of the range, NaN 0. Zeros of either sign are 0, and so is whatever rounds to
    /// zero. The flag inexact is never raised; see [`FloatArithmetic::to_integer_exact`].
    #[inline]
    pub const fn to_integer(self, target: IntegerFormat, a: u64) -> Answer {
        let Answer { bits, flags } = self.to_integer_exact(target, a);
        Answer {
            bits,
            flags: flags.without(Flags::INEXACT),
        }
    }

    /// As [`FloatArithmetic::to_integer`], raising inexact where the integer is not `a` itself:
    /// `convertToIntegerExact` of IEEE 754-2019, 5.8. What is invalid is not inexact too.
    #[inline]
    pub const fn to_integer_exact(self, target: IntegerFormat, a: u64) -> Answer {
        let negative = self.format.has_sign(a);
        let magnitude = self.read_magnitude(a);
        if magnitude > self.format.infinity() {
            return Answer {
                bits: 0,
                flags: Flags::INVALID,
            };
        }
        let limit = target.limit(negative);
        match self.integer_magnitude(negative, magnitude) {
            Some((integer, inexact)) if integer <= limit => Answer {
                bits: target.value(negative, integer),
                flags: Flags::INEXACT.when(inexact),
            },
            _ => Answer {
                bits: target.value(negative, limit),
                flags: Flags::INVALID,
            },
        }
    }

    /// The integer that the value of a sign and a magnitude rounds to, and whether it is another;
    /// `None` if it has more than 64 bits.
    #[inline(always)]
    pub(super) const fn integer_magnitude(
        self,
        negative: bool,
        magnitude: u64,
    ) -> Option<(u64, bool)> {
        if magnitude == 0 {
            return Some((0, false));
        }
        let (field, significand) = self.as_encoded(magnitude);
        let exponent = field - self.format.exponent_bias();
        if magnitude >= self.format.infinity() || exponent > 63 {
            return None;
        }

        // The place of the leading one, bit 63, weighs 2^exponent. What is shifted out goes to
        // `dropped`, whose bit 63 weighs one half; below a half only "not zero" matters.
        let significand = significand << (63 - self.format.fraction_bits);
        let (kept, dropped) = match 63 - exponent {
            0 => (significand, 0),
            64 => (0, significand),
            amount if amount > 64 => (0, 1),
            amount => (significand >> amount, significand << (64 - amount)),
        };
        let increments = self.rounding.increments(negative, kept & 1 == 1, dropped);
        // No carry out of 64 bits: an integer of 64 bits has nothing to drop.
        Some((kept + increments as u64, dropped != 0))
    }

    /// The integer `a` rounds to, as a float: the operations `roundToIntegral` of IEEE 754-2019,
    /// 5.9, with this rounding. A zero result has the sign of `a`; infinities are themselves.
    ///
    /// The flag inexact is never raised; see [`FloatArithmetic::round_to_integral_exact`]. In
    /// formats with `F >= 2^(E-1)` the integer may lie beyond the largest finite number: that
    /// overflows, and raises overflow and inexact.
    #[inline]
    pub const fn round_to_integral(self, a: u64) -> Answer {
        let answer = self.round_to_integral_exact(a);
        if answer.flags.contains(Flags::OVERFLOW) {
            return answer;
        }
        Answer {
            bits: answer.bits,
            flags: answer.flags.without(Flags::INEXACT),
        }
    }

    /// As [`FloatArithmetic::round_to_integral`], raising inexact where the result is not `a`
    /// itself: `roundToIntegralExact`.
    #[inline]
    pub const fn round_to_integral_exact(self, a: u64) -> Answer {
        let format = self.format;
        let negative = format.has_sign(a);
        let magnitude = self.read_magnitude(a);
        if magnitude > format.infinity() {
            return self.nan_operand(a, a);
        }
        let exponent = format.exponent_field(magnitude) - format.exponent_bias();
        // Zeros, infinities, and numbers without a bit below the point.
        if magnitude == 0 || exponent >= format.fraction_bits as i32 {
            return Answer::exact(self.canonical(a));
        }
        // A number with bits below the point has fewer than 53 above.
        let Some((integer, inexact)) = self.integer_magnitude(negative, magnitude) else {
            return self.infinite(negative);
        };
        if integer == 0 {
            return self.zero(negative).raising(Flags::INEXACT.when(inexact));
        }
        self.round_scaled(negative, integer, 0)
            .raising(Flags::INEXACT.when(inexact))
    }

    /// The largest integer at or below `a`, as a float: [`FloatArithmetic::round_to_integral`]
    /// under [`Rounding::Down`], whatever this rounding.
    #[inline]
    pub const fn floor(self, a: u64) -> Answer {
        let down = self.format.arithmetic(self.policy, Rounding::Down);
        down.round_to_integral(a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::float::{FloatFormat, Policy};

    #[test]
    fn saturation_is_to_the_nearer_end() {
        let format = FloatFormat::E7F16;
        let arithmetic = format.arithmetic(Policy::Flush, Rounding::NearestEven);
        let minus_infinity = format.sign_bit() | format.infinity();
        for (target, largest, smallest) in [
            (IntegerFormat::I32, 0x7fff_ffff, 0x8000_0000),
            (IntegerFormat::U32, 0xffff_ffff, 0),
            (IntegerFormat::I64, i64::MAX as u64, i64::MIN as u64),
            (IntegerFormat::signed(1), 0, 1),
        ] {
            for (a, bits) in [
                (format.infinity(), largest),
                (minus_infinity, smallest),
                (format.quiet_nan(), 0),
            ] {
                let expected = Answer {
                    bits,
                    flags: Flags::INVALID,
                };
                assert_eq!(
                    arithmetic.to_integer(target, a),
                    expected,
                    "{target} {a:#x}"
                );
            }
        }
    }

    #[test]
    fn small_negative_numbers_are_unsigned_zeros() {
        let format = FloatFormat::E7F16;
        let minus_half = format.negate(format.from_f64(Rounding::NearestEven, 0.5));
        let nearest = format.arithmetic(Policy::Flush, Rounding::NearestEven);
        let answer = nearest.to_integer_exact(IntegerFormat::U32, minus_half);
        assert_eq!((answer.bits, answer.flags), (0, Flags::INEXACT));
        let down = format.arithmetic(Policy::Flush, Rounding::Down);
        let answer = down.to_integer_exact(IntegerFormat::U32, minus_half);
        assert_eq!((answer.bits, answer.flags), (0, Flags::INVALID));
    }
}
