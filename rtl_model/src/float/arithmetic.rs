//! A format with its policy and its rounding: all that an operator's answer depends on.

use super::{Flags, FloatFormat, Policy, Rounding};

/// The arithmetic of a format under one policy and one rounding. Its operators answer with the
/// result and the flags it raises:
///
/// ```
/// use rtl_model::float::{Flags, FloatFormat, Policy, Rounding};
///
/// let arithmetic = FloatFormat::E7F16.arithmetic(Policy::Full, Rounding::NearestEven);
/// let third = arithmetic.div(0x3f0000, 0x408000);
/// assert_eq!(third.bits, 0x3d5555);
/// assert_eq!(third.flags, Flags::INEXACT);
/// ```
///
/// A NaN whose first fraction bit is 0 is *signalling*: operators that compute, compare or convert
/// raise [`Flags::INVALID`] for it. Every NaN result is the canonical quiet one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FloatArithmetic {
    /// Of operands, and of results that are floats.
    pub format: FloatFormat,
    /// What becomes of subnormal numbers.
    pub policy: Policy,
    /// Of inexact results.
    pub rounding: Rounding,
}

/// A result, and the flags its operation raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Answer {
    /// The result in the low bits; those above its width are 0.
    pub bits: u64,
    /// The flags.
    pub flags: Flags,
}

impl Answer {
    /// A result that raises no flag.
    #[inline(always)]
    pub(super) const fn exact(bits: u64) -> Answer {
        Answer {
            bits,
            flags: Flags::NONE,
        }
    }

    /// The same result, with these flags raised too.
    #[inline(always)]
    pub(super) const fn raising(self, flags: Flags) -> Answer {
        Answer {
            bits: self.bits,
            flags: self.flags.union(flags),
        }
    }
}

impl FloatFormat {
    /// Its arithmetic under this policy and rounding.
    #[inline(always)]
    pub const fn arithmetic(self, policy: Policy, rounding: Rounding) -> FloatArithmetic {
        FloatArithmetic {
            format: self,
            policy,
            rounding,
        }
    }

    /// Is `a` a signalling NaN: one whose first fraction bit is 0?
    #[inline]
    pub const fn is_signalling_nan(self, a: u64) -> bool {
        self.is_nan(a) && a >> (self.fraction_bits - 1) & 1 == 0
    }
}

impl FloatArithmetic {
    /// What the operators read for `a`: every NaN becomes the canonical one and, under the policy
    /// `flush`, a subnormal number the zero of its sign.
    #[inline]
    pub const fn canonical(self, a: u64) -> u64 {
        let magnitude = self.read_magnitude(a);
        if magnitude > self.format.infinity() {
            self.format.quiet_nan()
        } else {
            (a & self.format.sign_bit()) | magnitude
        }
    }

    /// Exponent and fraction of `a` as the operators read them: 0 for a subnormal number under the
    /// policy `flush`. Magnitudes of numbers are ordered as the integers they are read as; those
    /// above [`FloatFormat::infinity`] are NaNs.
    #[inline(always)]
    pub(super) const fn read_magnitude(self, a: u64) -> u64 {
        match self.policy {
            Policy::Flush => self.format.flushed_magnitude(a),
            Policy::Full => self.format.magnitude(a),
        }
    }

    /// Is what was read not zero, infinite or NaN? One comparison.
    #[inline(always)]
    pub(super) const fn is_nonzero_finite(self, magnitude: u64) -> bool {
        let smallest = match self.policy {
            Policy::Flush => self.format.min_normal(),
            Policy::Full => 1,
        };
        magnitude.wrapping_sub(smallest) < self.format.infinity() - smallest
    }

    /// Exponent field and significand of a nonzero finite magnitude. The significand has `F + 1`
    /// bits, the first of them 1: that of a subnormal number is shifted up, and its exponent field
    /// goes on below 1.
    #[inline(always)]
    pub(super) const fn normalised(self, magnitude: u64) -> (i32, u64) {
        let format = self.format;
        if matches!(self.policy, Policy::Full) && magnitude < format.min_normal() {
            let amount = magnitude.leading_zeros() - (63 - format.fraction_bits);
            return (1 - amount as i32, magnitude << amount);
        }
        (
            format.exponent_field(magnitude),
            format.significand(magnitude),
        )
    }

    /// Exponent field and significand of any finite magnitude, on the scale of the encoding: a
    /// subnormal number has the exponent of field 1 and no leading one, a zero the significand 0.
    #[inline(always)]
    pub(super) const fn as_encoded(self, magnitude: u64) -> (i32, u64) {
        let format = self.format;
        let field = format.exponent_field(magnitude);
        match self.policy {
            Policy::Flush if magnitude == 0 => (field, 0),
            Policy::Full if field == 0 => (1, magnitude),
            _ => (field, format.significand(magnitude)),
        }
    }

    /// The canonical NaN, with [`Flags::INVALID`] where `invalid`.
    #[inline(always)]
    pub(super) const fn not_a_number(self, invalid: bool) -> Answer {
        Answer {
            bits: self.format.quiet_nan(),
            flags: Flags::INVALID.when(invalid),
        }
    }

    /// The zero of this sign, exact.
    #[inline(always)]
    pub(super) const fn zero(self, negative: bool) -> Answer {
        Answer::exact(self.format.zero_of_sign(negative))
    }

    /// The infinity of this sign, exact.
    #[inline(always)]
    pub(super) const fn infinite(self, negative: bool) -> Answer {
        Answer::exact(self.format.zero_of_sign(negative) | self.format.infinity())
    }

    /// The sign of a sum that is exactly zero though its terms are not zeros of one sign.
    #[inline(always)]
    pub(super) const fn cancelled(self) -> Answer {
        self.zero(matches!(self.rounding, Rounding::Down))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_depends_on_the_policy() {
        let format = FloatFormat::E4F3;
        for rounding in Rounding::ALL {
            let flush = format.arithmetic(Policy::Flush, rounding);
            let full = format.arithmetic(Policy::Full, rounding);
            for a in 0..=0xff {
                assert_eq!(flush.canonical(a), format.canonical(a));
                let expected = if format.is_nan(a) { 0x7c } else { a };
                assert_eq!(full.canonical(a), expected, "{a:#x}");
            }
        }
    }

    #[test]
    fn the_first_fraction_bit_of_a_quiet_nan_is_one() {
        let format = FloatFormat::E4F3;
        let signalling: Vec<u64> = (0..=0xff)
            .filter(|&a| format.is_signalling_nan(a))
            .collect();
        assert_eq!(signalling, [0x79, 0x7a, 0x7b, 0xf9, 0xfa, 0xfb]);
    }

    #[test]
    fn subnormal_numbers_are_shifted_up_to_their_leading_one() {
        let full = FloatFormat::E4F3.arithmetic(Policy::Full, Rounding::NearestEven);
        assert_eq!(full.normalised(0x01), (-2, 0b1000));
        assert_eq!(full.normalised(0x07), (0, 0b1110));
        assert_eq!(full.normalised(0x08), (1, 0b1000));
        assert_eq!(full.as_encoded(0x07), (1, 0b0111));
        assert_eq!(full.as_encoded(0x09), (1, 0b1001));
    }
}
