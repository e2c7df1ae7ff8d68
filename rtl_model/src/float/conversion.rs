//! Between floats: to and from another format and the host's `f64`, and decimal text.

use super::rounder::Unrounded;
use super::{Answer, FloatArithmetic, FloatFormat, Policy, Rounding};

/// Fraction bits of an `f64`.
const F64_FRACTION_BITS: u32 = 52;
/// Exponent bias of an `f64`.
const F64_BIAS: i32 = 1023;
/// The format of an `f64`.
const F64: FloatFormat = FloatFormat::new(11, F64_FRACTION_BITS);

impl FloatArithmetic {
    /// `a` in another format, rounded once, under the same policy and rounding. Zeros and infinities
    /// keep their sign; a signalling NaN is invalid, and every NaN becomes the canonical one.
    #[inline]
    pub const fn convert_to(self, target: FloatFormat, a: u64) -> Answer {
        self.convert_into(target.arithmetic(self.policy, self.rounding), a)
    }

    /// `a`, read in this arithmetic, rounded in another.
    #[inline]
    const fn convert_into(self, into: FloatArithmetic, a: u64) -> Answer {
        let negative = self.format.has_sign(a);
        let magnitude = self.read_magnitude(a);
        if magnitude > self.format.infinity() {
            return into.not_a_number(self.format.is_signalling_nan(a));
        }
        if magnitude == self.format.infinity() {
            return into.infinite(negative);
        }
        if magnitude == 0 {
            return into.zero(negative);
        }
        let (field, significand) = self.normalised(magnitude);
        into.round(Unrounded {
            negative,
            exponent: field - self.format.exponent_bias(),
            significand: significand << (63 - self.format.fraction_bits),
        })
    }

    /// The float nearest to the number `value` under this rounding. Subnormal `f64` are numbers like
    /// any other: the policy is about this format's. The rest is as in
    /// [`FloatArithmetic::convert_to`].
    #[inline]
    pub const fn from_f64(self, value: f64) -> Answer {
        F64.arithmetic(Policy::Full, self.rounding)
            .convert_into(self, value.to_bits())
    }

    /// The number `a` as an `f64`: exact for every format. Under the policy `flush` subnormal
    /// patterns are zeros of their sign; every NaN is `f64::NAN`.
    #[inline]
    pub const fn to_f64(self, a: u64) -> f64 {
        let into = F64.arithmetic(Policy::Full, self.rounding);
        f64::from_bits(self.convert_into(into, a).bits)
    }
}

impl FloatFormat {
    /// The pattern nearest to the number `value` under this rounding and the policy `flush`. Zeros
    /// and infinities keep their sign, every NaN becomes the canonical one; subnormal `f64` are
    /// numbers like any other.
    #[inline]
    pub const fn from_f64(self, rounding: Rounding, value: f64) -> u64 {
        self.arithmetic(Policy::Flush, rounding)
            .from_f64(value)
            .bits
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
