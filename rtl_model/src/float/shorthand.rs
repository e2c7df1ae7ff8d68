//! The operators that a datapath of the policy `flush` is written with: results without flags.

use std::cmp::Ordering;

use thiserror::Error;

use super::{Comparison, Flags, FloatArithmetic, FloatFormat, IntegerFormat, Policy, Rounding};

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

/// The arithmetic in which the rounding plays no part.
#[inline(always)]
const fn unrounded(format: FloatFormat) -> FloatArithmetic {
    format.arithmetic(Policy::Flush, Rounding::NearestEven)
}

impl FloatFormat {
    /// [`FloatArithmetic::add`] under the policy `flush`, without flags.
    #[inline(always)]
    pub const fn add(self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.arithmetic(Policy::Flush, rounding).add(a, b).bits
    }

    /// [`FloatArithmetic::sub`] under the policy `flush`, without flags.
    #[inline(always)]
    pub const fn sub(self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.arithmetic(Policy::Flush, rounding).sub(a, b).bits
    }

    /// [`FloatArithmetic::mul`] under the policy `flush`, without flags.
    #[inline(always)]
    pub const fn mul(self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.arithmetic(Policy::Flush, rounding).mul(a, b).bits
    }

    /// [`FloatArithmetic::div`] under the policy `flush`, without flags.
    #[inline(always)]
    pub const fn div(self, rounding: Rounding, a: u64, b: u64) -> u64 {
        self.arithmetic(Policy::Flush, rounding).div(a, b).bits
    }

    /// `a < b`. False where either is NaN; zeros, and under the policy `flush` all subnormal
    /// patterns, are equal whatever their signs.
    #[inline(always)]
    pub const fn less_than(self, a: u64, b: u64) -> bool {
        unrounded(self).less_than(Comparison::Quiet, a, b).0
    }

    /// `a <= b`; the rest as in [`FloatFormat::less_than`].
    #[inline(always)]
    pub const fn less_equal(self, a: u64, b: u64) -> bool {
        unrounded(self).less_equal(Comparison::Quiet, a, b).0
    }

    /// `a == b`, false for a NaN and itself; the rest as in [`FloatFormat::less_than`].
    #[inline(always)]
    pub const fn equal(self, a: u64, b: u64) -> bool {
        unrounded(self).equal(Comparison::Quiet, a, b).0
    }

    /// The order of two values; `None` where either is NaN (IEEE's "unordered").
    #[inline(always)]
    pub const fn compare(self, a: u64, b: u64) -> Option<Ordering> {
        unrounded(self).compare(Comparison::Quiet, a, b).0
    }

    /// [`FloatArithmetic::min`] under the policy `flush`, without flags. (The datapath operator
    /// [`crate::arith::Arith::min`] is a comparator and a selector instead: it has the same value
    /// for any two numbers, but the first operand's bits where they are equal or either is NaN.)
    #[inline(always)]
    pub const fn min(self, a: u64, b: u64) -> u64 {
        unrounded(self).min(a, b).bits
    }

    /// [`FloatArithmetic::max`] under the policy `flush`, without flags; see [`FloatFormat::min`].
    #[inline(always)]
    pub const fn max(self, a: u64, b: u64) -> u64 {
        unrounded(self).max(a, b).bits
    }

    /// [`FloatArithmetic::floor`] under the policy `flush`, without flags.
    #[inline(always)]
    pub const fn floor(self, a: u64) -> u64 {
        unrounded(self).floor(a).bits
    }

    /// `value * 2^exponent`, rounded once: [`FloatArithmetic::from_scaled_integer`] under the policy
    /// `flush`, without flags.
    #[inline(always)]
    pub const fn from_integer(self, rounding: Rounding, value: i64, exponent: i64) -> u64 {
        self.arithmetic(Policy::Flush, rounding)
            .from_scaled_integer(value, exponent)
            .bits
    }

    /// The integer `a` rounds to. Zeros of either sign are 0.
    ///
    /// # Errors
    /// If `a` is NaN, or rounds to an integer outside `i64`. For the saturating converter of
    /// hardware: `.unwrap_or_else(ToIntegerError::saturated)`.
    #[inline(always)]
    pub const fn to_integer(self, rounding: Rounding, a: u64) -> Result<i64, ToIntegerError> {
        let answer = self
            .arithmetic(Policy::Flush, rounding)
            .to_integer(IntegerFormat::I64, a);
        if !answer.flags.contains(Flags::INVALID) {
            Ok(answer.bits as i64)
        } else if self.is_nan(a) {
            Err(ToIntegerError::NotANumber)
        } else if self.has_sign(a) {
            Err(ToIntegerError::BelowRange)
        } else {
            Err(ToIntegerError::AboveRange)
        }
    }

    /// [`FloatArithmetic::ulps_up`] under the policy `flush`.
    #[inline(always)]
    pub const fn ulps_up(self, a: u64, ulps: u32) -> u64 {
        unrounded(self).ulps_up(a, ulps)
    }

    /// [`FloatArithmetic::exact_below`] under the policy `flush`.
    #[inline(always)]
    pub const fn exact_below(self, a: u64) -> u64 {
        unrounded(self).exact_below(a)
    }

    /// [`FloatArithmetic::depth_from_height`] under the policy `flush`.
    #[inline(always)]
    pub const fn depth_from_height(self, height: u64, bits: u32) -> u64 {
        unrounded(self).depth_from_height(height, bits)
    }
}
