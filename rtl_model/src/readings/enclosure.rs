//! Intervals of two `f64` that hold a real number: what most comparisons are decided by.

use std::cmp::Ordering;

/// An interval that holds a real number; both ends may be infinite, as bounds.
///
/// Every operation rounds each end outwards by one unit in the last place, which is at least as far
/// as the directed rounding of interval arithmetic (Moore 1966), and needs no rounding mode. What an
/// `f64` operation gives exactly stays a single number, since products with zero, and differences
/// of a border and a coordinate, are often exact.
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

    /// Of a number that is this `f64`, which is finite.
    pub(super) const fn single(value: f64) -> Enclosure {
        Enclosure {
            low: value,
            high: value,
        }
    }

    /// Of a number whose nearest `f64` is `value`, or next to it.
    fn around(value: f64) -> Enclosure {
        Enclosure::between(value, value)
    }

    /// Of a number between two that are known up to a rounding to nearest.
    fn between(low: f64, high: f64) -> Enclosure {
        if low.is_nan() || high.is_nan() {
            return Enclosure::ANY;
        }
        Enclosure {
            low: low.next_down(),
            high: high.next_up(),
        }
    }

    /// The number, where the interval holds no other.
    pub(super) fn as_single(self) -> Option<f64> {
        (self.low == self.high).then_some(self.low)
    }

    /// How this number compares with another; none where the intervals do not tell.
    pub(super) fn compare(self, other: Enclosure) -> Option<Ordering> {
        if self.high < other.low {
            Some(Ordering::Less)
        } else if self.low > other.high {
            Some(Ordering::Greater)
        } else {
            (self.as_single()? == other.as_single()?).then_some(Ordering::Equal)
        }
    }

    /// Of the sum.
    pub(super) fn plus(self, other: Enclosure) -> Enclosure {
        if let (Some(a), Some(b)) = (self.as_single(), other.as_single()) {
            let sum = a + b;
            // Knuth's TwoSum: the error of the sum, exactly, where nothing overflows.
            let b_in_sum = sum - a;
            let error = (a - (sum - b_in_sum)) + (b - b_in_sum);
            return match error == 0.0 {
                true => Enclosure::single(sum),
                false => Enclosure::around(sum),
            };
        }
        Enclosure::between(self.low + other.low, self.high + other.high)
    }

    /// Of the number with the other sign.
    pub(super) fn negated(self) -> Enclosure {
        Enclosure {
            low: -self.high,
            high: -self.low,
        }
    }

    /// Of the magnitude.
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
    pub(super) fn times(self, other: Enclosure) -> Enclosure {
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
    pub(super) fn over(self, other: Enclosure) -> Enclosure {
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
    pub(super) fn scaled(self, exponent: i32) -> Enclosure {
        let power = 2_f64.powi(exponent);
        let is_safe = |value: f64| value == 0.0 || (value * power).is_normal();
        if power.is_normal() && is_safe(self.low) && is_safe(self.high) {
            // Exact: neither overflow nor underflow.
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
                if let Some(order) = left.compare(right) {
                    prop_assert_eq!(order, x.cmp(&y));
                }
            }
        }
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
