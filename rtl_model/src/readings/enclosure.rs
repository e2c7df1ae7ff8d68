//! Intervals of two `f64` that hold a real number: what most comparisons are decided by.

use super::small_ratio::power_of_two;

/// An interval that holds a real number; both ends may be infinite, as bounds.
///
/// Every operation rounds each end outwards by at least one unit in the last place, which is at least
/// as far as the directed rounding of interval arithmetic (Moore 1966), and needs no rounding mode.
/// What an `f64` operation gives exactly stays a single number, since products with zero, and
/// differences of a border and a coordinate, are often exact. The signs that a walk has (directions
/// and depths are not negative) come first in products and quotients, which then have two corners
/// to look at, not four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Enclosure {
    low: f64,
    high: f64,
}

impl Enclosure {
    /// Of a number of which nothing is known.
    pub(super) const ANY: Enclosure = Enclosure {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    /// Of plus infinity itself. No finite number has it: the low end of one is finite or minus
    /// infinity.
    pub(super) const INFINITY: Enclosure = Enclosure {
        low: f64::INFINITY,
        high: f64::INFINITY,
    };

    /// Of a number that is this `f64`, which is finite.
    #[inline]
    pub(super) const fn single(value: f64) -> Enclosure {
        Enclosure {
            low: value,
            high: value,
        }
    }

    /// Of a number between two that are known up to a rounding to nearest.
    ///
    /// Rounded to nearest, `low` has at most its neighbour below above the true end, and
    /// `outwards(low)` is at least the distance to that neighbour; so the difference is at most the
    /// neighbour, and stays so when it is rounded, since the neighbour is an `f64` and rounding
    /// keeps order. The same holds of `high`.
    #[inline]
    fn between(low: f64, high: f64) -> Enclosure {
        let (low, high) = (low - outwards(low), high + outwards(high));
        // Not so where an end is infinite or no number.
        match low.is_finite() && high.is_finite() {
            true => Enclosure { low, high },
            false => Enclosure::ANY,
        }
    }

    /// The number, where the interval holds no other.
    #[inline]
    pub(super) fn as_single(self) -> Option<f64> {
        (self.low == self.high).then_some(self.low)
    }

    /// Is this number below another? None where the intervals do not tell. Plus infinity is below
    /// nothing.
    #[inline]
    pub(super) fn less_than(self, other: Enclosure) -> Option<bool> {
        if self.high < other.low {
            Some(true)
        } else if self.low >= other.high {
            Some(false)
        } else {
            None
        }
    }

    /// Is this number below zero? None where the interval does not tell.
    #[inline]
    pub(super) fn is_negative(self) -> Option<bool> {
        self.less_than(Enclosure::single(0.0))
    }

    /// Is this number zero? None where the interval does not tell.
    #[inline]
    pub(super) fn is_zero(self) -> Option<bool> {
        if self.low > 0.0 || self.high < 0.0 {
            Some(false)
        } else {
            (self.low == self.high).then_some(true)
        }
    }

    /// Of the sum.
    #[inline]
    pub(super) fn plus(self, other: Enclosure) -> Enclosure {
        if let (Some(a), Some(b)) = (self.as_single(), other.as_single()) {
            let sum = a + b;
            // Knuth's TwoSum: the error of the sum, exactly, where nothing overflows.
            let b_in_sum = sum - a;
            let error = (a - (sum - b_in_sum)) + (b - b_in_sum);
            return match error == 0.0 {
                true => Enclosure::single(sum),
                false => Enclosure::between(sum, sum),
            };
        }
        Enclosure::between(self.low + other.low, self.high + other.high)
    }

    /// Of the number with the other sign.
    #[inline]
    pub(super) fn negated(self) -> Enclosure {
        Enclosure {
            low: -self.high,
            high: -self.low,
        }
    }

    /// Of the magnitude.
    #[inline]
    pub(super) fn magnitude(self) -> Enclosure {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            self.negated()
        } else {
            Enclosure {
                low: 0.0,
                high: self.high.max(-self.low),
            }
        }
    }

    /// Of the product.
    #[inline]
    pub(super) fn times(self, other: Enclosure) -> Enclosure {
        if self.low > 0.0 && other.low > 0.0 {
            return Enclosure::between(self.low * other.low, self.high * other.high);
        }
        self.times_any(other)
    }

    fn times_any(self, other: Enclosure) -> Enclosure {
        if self.as_single() == Some(0.0) || other.as_single() == Some(0.0) {
            return Enclosure::single(0.0);
        }
        let corners = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        Enclosure::around_all(corners)
    }

    /// Of the quotient by a number that is not zero.
    #[inline]
    pub(super) fn over(self, other: Enclosure) -> Enclosure {
        if self.low > 0.0 && other.low > 0.0 {
            if self.low == self.high && other.low == other.high {
                let quotient = self.low / other.low;
                return Enclosure::between(quotient, quotient);
            }
            return Enclosure::between(self.low / other.high, self.high / other.low);
        }
        self.over_any(other)
    }

    fn over_any(self, other: Enclosure) -> Enclosure {
        if self.as_single() == Some(0.0) {
            return Enclosure::single(0.0);
        }
        if other.low <= 0.0 && other.high >= 0.0 {
            return Enclosure::ANY;
        }
        let corners = [
            self.low / other.low,
            self.low / other.high,
            self.high / other.low,
            self.high / other.high,
        ];
        Enclosure::around_all(corners)
    }

    /// Of a number times a power of two.
    #[inline]
    pub(super) fn scaled(self, exponent: i32) -> Enclosure {
        let is_safe = |value: f64| value == 0.0 || (2e-150..2e150).contains(&value.abs());
        if (-500..=500).contains(&exponent) && is_safe(self.low) && is_safe(self.high) {
            // Exact: neither overflow nor underflow.
            let power = power_of_two(exponent);
            return Enclosure {
                low: self.low * power,
                high: self.high * power,
            };
        }
        Enclosure::ANY
    }

    /// The floor, where both ends have the same.
    pub(super) fn floor(self) -> Option<f64> {
        let floor = self.low.floor();
        (floor == self.high.floor() && floor.is_finite()).then_some(floor)
    }

    fn around_all(corners: [f64; 4]) -> Enclosure {
        // The minimum of `f64` passes over NaN; a bound must not.
        if corners.iter().any(|corner| corner.is_nan()) {
            return Enclosure::ANY;
        }
        let low = corners.into_iter().fold(f64::INFINITY, f64::min);
        let high = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Enclosure::between(low, high)
    }
}

/// At least the distance from an `f64` to the next: that is `2^-52` of its power of two, at most
/// `2^-52` of itself, but `2^-1074` for the smallest, which are flushed or rounded in the product.
/// Both additions and the product round, and keep order, so that no result is below these.
#[inline]
fn outwards(value: f64) -> f64 {
    value.abs() * f64::EPSILON + f64::from_bits(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use proptest::prelude::*;

    fn exactly(value: f64) -> BigRational {
        BigRational::from_float(value).expect("a finite number")
    }

    fn holds(enclosure: Enclosure, value: &BigRational) -> bool {
        let above = |bound: f64| bound == f64::NEG_INFINITY || exactly(bound) <= *value;
        let below = |bound: f64| bound == f64::INFINITY || exactly(bound) >= *value;
        above(enclosure.low) && below(enclosure.high)
    }

    /// Numbers of all kinds: of any size, near each other, small integers, zeros.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            -1e3..1e3_f64,
            (-40..40_i32).prop_map(|n| f64::from(n) / 8.0),
            (-60..60_i32, 1.0..2.0_f64).prop_map(|(e, m)| m * 2_f64.powi(e)),
            Just(f64::MIN_POSITIVE),
            Just(f64::MAX),
            Just(-f64::MAX),
            Just(5e-324),
        ]
    }

    proptest! {
        #[test]
        fn results_lie_within(
            (a, b, c, d) in (number(), number(), number(), number()), exponent in -1100..1100_i32,
        ) {
            // Two intervals with a number each in them.
            let within = |a: f64, b: f64| Enclosure { low: a.min(b), high: a.max(b) };
            for (left, right) in [
                (Enclosure::single(a), Enclosure::single(b)),
                (within(a, c), within(b, d)),
                (within(a, c), Enclosure::single(b)),
            ] {
                let (x, y) = (exactly(a), exactly(b));
                prop_assert!(holds(left.plus(right), &(&x + &y)));
                prop_assert!(holds(left.plus(right.negated()), &(&x - &y)));
                prop_assert!(holds(left.times(right), &(&x * &y)));
                if b != 0.0 {
                    prop_assert!(holds(left.over(right), &(&x / &y)));
                }
                prop_assert!(holds(left.magnitude(), &num_traits::Signed::abs(&x)));
                let power = exactly(2.0).pow(exponent);
                prop_assert!(holds(left.scaled(exponent), &(&x * power)));
                if let Some(floor) = left.floor() {
                    prop_assert_eq!(exactly(floor), x.floor());
                }
                prop_assert!(left.less_than(right).is_none_or(|is_less| is_less == (x < y)));
                prop_assert!(left.is_negative().is_none_or(|is_negative| is_negative == (a < 0.0)));
                prop_assert!(left.is_zero().is_none_or(|is_zero| is_zero == (a == 0.0)));
            }
        }
    }

    #[test]
    fn ends_move_outwards_by_a_unit_or_more() {
        let ends = [
            1.0,
            1.5,
            2.0_f64.next_down(),
            1e-300,
            1e-308,
            5e-324,
            0.0,
            1e300,
            f64::MAX,
        ];
        for end in ends.into_iter().flat_map(|end| [end, -end]) {
            let Enclosure { low, high } = Enclosure::between(end, end);
            assert!(low <= end.next_down() && high >= end.next_up(), "{end}");
            assert!(
                low >= end - end.abs() * 1e-15 - 1e-322 || end.abs() == f64::MAX,
                "{end}"
            );
        }
        for end in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            assert_eq!(Enclosure::between(end, 1.0), Enclosure::ANY);
            assert_eq!(Enclosure::between(1.0, end), Enclosure::ANY);
        }
    }

    #[test]
    fn infinity_is_above_every_number() {
        let infinity = Enclosure::INFINITY;
        for value in [Enclosure::single(f64::MAX), Enclosure::single(-1.0)] {
            assert_eq!(value.less_than(infinity), Some(true));
            assert_eq!(infinity.less_than(value), Some(false));
        }
        assert_eq!(infinity.less_than(infinity), Some(false));
        assert_eq!(
            (infinity.is_zero(), infinity.is_negative()),
            (Some(false), Some(false))
        );
        // The interval alone does not tell a number of any size from it.
        assert_eq!(Enclosure::ANY.less_than(infinity), None);
    }

    #[test]
    fn exact_sums_stay_single() {
        let single = |a: f64, b: f64| Enclosure::single(a).plus(Enclosure::single(b)).as_single();
        assert_eq!(single(0.25, -3.0), Some(-2.75));
        assert_eq!(single(1.0, 1e-30), None);
        assert_eq!(single(0.1, 0.2), None);
        let zero = Enclosure::single(0.0);
        assert_eq!(zero.times(Enclosure::ANY).as_single(), Some(0.0));
    }
}
