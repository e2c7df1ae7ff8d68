//! Comparisons, and the smaller and larger of two values.

use std::cmp::Ordering;

use super::FloatFormat;

impl FloatFormat {
    /// `a < b`. False where either is NaN; zeros are equal whatever their signs.
    #[inline]
    pub const fn less_than(self, a: u64, b: u64) -> bool {
        self.is_ordered(a, b) && self.order_key(a) < self.order_key(b)
    }

    /// `a <= b`. False where either is NaN; zeros are equal whatever their signs.
    #[inline]
    pub const fn less_equal(self, a: u64, b: u64) -> bool {
        self.is_ordered(a, b) && self.order_key(a) <= self.order_key(b)
    }

    /// `a == b`. False where either is NaN, even the same one; zeros are equal whatever their signs.
    #[inline]
    pub const fn equal(self, a: u64, b: u64) -> bool {
        self.is_ordered(a, b) && self.order_key(a) == self.order_key(b)
    }

    /// The order of two values; `None` where either is NaN (IEEE's "unordered").
    #[inline]
    pub fn compare(self, a: u64, b: u64) -> Option<Ordering> {
        self.is_ordered(a, b)
            .then(|| self.order_key(a).cmp(&self.order_key(b)))
    }

    /// The smaller of two values: `minimumNumber` of IEEE 754-2019, 9.6.
    ///
    /// -0 is taken as smaller than +0; where one operand is NaN the result is the other, where both
    /// are the canonical NaN. The result is canonical: a subnormal pattern comes out as its zero.
    /// (The datapath operator [`crate::arith::Arith::min`] is a comparator and a selector instead:
    /// it has the same value for any two numbers, but the first operand's bits where they are equal
    /// or either is NaN.)
    #[inline]
    pub const fn min(self, a: u64, b: u64) -> u64 {
        if self.is_nan(b) || (!self.is_nan(a) && self.total_key(a) <= self.total_key(b)) {
            self.canonical(a)
        } else {
            self.canonical(b)
        }
    }

    /// The larger of two values: `maximumNumber` of IEEE 754-2019, 9.6; the rest as in
    /// [`FloatFormat::min`].
    #[inline]
    pub const fn max(self, a: u64, b: u64) -> u64 {
        if self.is_nan(b) || (!self.is_nan(a) && self.total_key(a) >= self.total_key(b)) {
            self.canonical(a)
        } else {
            self.canonical(b)
        }
    }

    /// Neither is NaN.
    #[inline(always)]
    const fn is_ordered(self, a: u64, b: u64) -> bool {
        !(self.is_nan(a) || self.is_nan(b))
    }

    /// A signed integer in the order of the numbers: the magnitude, negated where the sign is 1.
    /// Both zeros have the key 0.
    #[inline(always)]
    const fn order_key(self, a: u64) -> i64 {
        let magnitude = self.flushed_magnitude(a) as i64;
        if self.has_sign(a) {
            -magnitude
        } else {
            magnitude
        }
    }

    /// As [`FloatFormat::order_key`], with -0 just below +0.
    #[inline(always)]
    const fn total_key(self, a: u64) -> i64 {
        let magnitude = self.flushed_magnitude(a) as i64;
        if self.has_sign(a) {
            !magnitude
        } else {
            magnitude
        }
    }
}
