//! How fine a number is: up to where a difference with it stays exact.

use super::FloatArithmetic;

impl FloatArithmetic {
    /// The power of two below which every multiple of `a`'s last nonzero significand bit is
    /// representable: that bit's weight times `2^(F+1)`. Infinity for a zero (which a subnormal
    /// reads as under the policy `flush`), for infinities and NaN, and where the power is out of
    /// range. The sign of `a` is not read; no flag is raised.
    ///
    /// In hardware: the exponent, plus one, plus the number of zeros at the fraction's end.
    #[inline(always)]
    pub const fn exact_below(self, a: u64) -> u64 {
        let format = self.format;
        let magnitude = self.read_magnitude(a);
        if !self.is_nonzero_finite(magnitude) {
            return format.infinity();
        }
        let (field, significand) = self.as_encoded(magnitude);
        let exponent = field as u64 + 1 + significand.trailing_zeros() as u64;
        if exponent >= format.exponent_all_ones() {
            return format.infinity();
        }
        exponent << format.fraction_bits
    }
}

#[cfg(test)]
mod tests {
    use crate::float::{FloatFormat, Rounding};

    const F: FloatFormat = FloatFormat::E7F16;

    fn number(value: f64) -> u64 {
        F.from_f64(Rounding::NearestEven, value)
    }

    #[test]
    fn the_limit_is_the_last_bit_times_two_to_the_significand() {
        // 1.0 is a multiple of 1: integers are exact below 2^17.
        assert_eq!(F.to_f64(F.exact_below(number(1.0))), 131_072.0);
        assert_eq!(F.to_f64(F.exact_below(number(-0.75))), 32_768.0);
        // All 17 bits used, the last of weight 2^-17.
        assert_eq!(F.to_f64(F.exact_below(number(1.0 - 2_f64.powi(-17)))), 1.0);
        assert_eq!(F.exact_below(0), F.infinity());
        assert_eq!(F.exact_below(1), F.infinity());
        assert_eq!(F.exact_below(F.max_finite()), F.infinity());
        assert_eq!(F.exact_below(F.quiet_nan()), F.infinity());
    }

    #[test]
    fn differences_below_the_limit_are_exact_and_some_at_it_are_not() {
        let small = FloatFormat::E4F3;
        let mut inexact_at_limit = 0;
        for a in small.min_normal()..small.infinity() {
            let limit = small.to_f64(small.exact_below(a));
            for b in small.min_normal()..small.infinity() {
                let exact = small.to_f64(b) - small.to_f64(a);
                let difference = small.to_f64(small.sub(Rounding::TowardZero, b, a));
                let finer = small.exact_below(b) < small.exact_below(a);
                // Below the smallest normal value the flush, not the grain, rounds.
                if finer || exact.abs() < small.to_f64(small.min_normal()) {
                    continue;
                }
                if difference.abs() < limit {
                    assert_eq!(difference, exact, "{b:02x} - {a:02x}");
                } else {
                    inexact_at_limit += u32::from(difference != exact);
                }
            }
        }
        assert!(inexact_at_limit > 0, "the limit is never needed");
    }
}
