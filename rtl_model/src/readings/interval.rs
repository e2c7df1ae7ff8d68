//! The interval reading: what a datapath's signals can be, for all rays of a range at once.

use std::collections::BTreeMap;

use crate::arith::Arith;
use crate::float::Rounding;

/// All numbers from `low` to `high`, which may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The smallest.
    pub low: f64,
    /// The largest.
    pub high: f64,
}

/// All integers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegerInterval {
    /// The smallest.
    pub low: i128,
    /// The largest.
    pub high: i128,
}

/// What a bit can be; at least one of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Maybe {
    /// Can it be 0?
    pub zero: bool,
    /// Can it be 1?
    pub one: bool,
}

impl Interval {
    /// A single number.
    pub fn point(value: f64) -> Interval {
        Interval {
            low: value,
            high: value,
        }
    }

    /// The smallest interval that holds both.
    pub fn hull(self, other: Interval) -> Interval {
        Interval {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// The hull of some numbers, each off by less than a rounding; what is no number (infinity
    /// less infinity) can be anything.
    fn around(corners: &[f64]) -> Interval {
        let nothing = Interval {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        };
        corners.iter().fold(nothing, |hull, &corner| {
            hull.hull(match corner.is_nan() {
                true => Interval {
                    low: f64::NEG_INFINITY,
                    high: f64::INFINITY,
                },
                false => Interval {
                    low: corner.next_down(),
                    high: corner.next_up(),
                },
            })
        })
    }

    fn map(self, exact: impl Fn(f64) -> f64) -> Interval {
        let (a, b) = (exact(self.low), exact(self.high));
        Interval {
            low: a.min(b),
            high: a.max(b),
        }
    }
}

impl IntegerInterval {
    /// A single integer.
    pub fn point(value: i128) -> IntegerInterval {
        IntegerInterval {
            low: value,
            high: value,
        }
    }

    /// All integers from `low` to `high`.
    pub fn new(low: i128, high: i128) -> IntegerInterval {
        debug_assert!(low <= high);
        IntegerInterval { low, high }
    }

    /// All two's complement integers of so many bits.
    pub fn of_bits(bits: u32) -> IntegerInterval {
        let most = (1_i128 << (bits - 1)) - 1;
        IntegerInterval::new(-1 - most, most)
    }

    /// The smallest interval that holds both.
    pub fn hull(self, other: IntegerInterval) -> IntegerInterval {
        IntegerInterval::new(self.low.min(other.low), self.high.max(other.high))
    }

    /// Are all integers of the other within this one?
    pub fn contains(self, other: IntegerInterval) -> bool {
        self.low <= other.low && other.high <= self.high
    }

    /// Bits of the narrowest two's complement word that holds all of them.
    pub fn signed_bits(self) -> u32 {
        let bits = |value: i128| 129 - (value ^ (value >> 127)).leading_zeros();
        bits(self.low).max(bits(self.high))
    }

    fn corners(
        self,
        other: IntegerInterval,
        operation: impl Fn(i128, i128) -> i128,
    ) -> IntegerInterval {
        let corner = |a, b| IntegerInterval::point(operation(a, b));
        corner(self.low, other.low)
            .hull(corner(self.low, other.high))
            .hull(corner(self.high, other.low))
            .hull(corner(self.high, other.high))
    }

    /// What a bitwise operation of the two can give, `exact` where both are known.
    fn bitwise(self, other: IntegerInterval, exact: impl Fn(i128, i128) -> i128) -> Self {
        if self.low == self.high && other.low == other.high {
            return IntegerInterval::point(exact(self.low, other.low));
        }
        let all = IntegerInterval::of_bits(self.signed_bits().max(other.signed_bits()));
        let negative = exact(self.low >> 127, other.low >> 127) < 0;
        let known_signs = (self.low < 0) == (self.high < 0) && (other.low < 0) == (other.high < 0);
        match (known_signs, negative) {
            (false, _) => all,
            (true, false) => IntegerInterval::new(0, all.high),
            (true, true) => IntegerInterval::new(all.low, -1),
        }
    }
}

impl Maybe {
    /// It can be either.
    pub const EITHER: Maybe = Maybe {
        zero: true,
        one: true,
    };

    /// It is known.
    pub fn known(value: bool) -> Maybe {
        Maybe {
            zero: !value,
            one: value,
        }
    }

    fn of(can_be_zero: bool, can_be_one: bool) -> Maybe {
        debug_assert!(can_be_zero || can_be_one);
        Maybe {
            zero: can_be_zero,
            one: can_be_one,
        }
    }
}

/// A number is an interval of `f64` that holds the exact value, every operation rounded outward; an
/// integer an interval; a bit what it can be. It keeps, by name, the hull of what each named
/// integer could be in all evaluations.
///
/// What two operands have to do with each other is not seen: a difference of the same signal taken
/// twice is not known to be zero. Ranges are therefore safe, and not always narrow.
#[derive(Clone, Debug, Default)]
pub struct IntervalReading {
    /// The named integers.
    pub integers: BTreeMap<&'static str, IntegerInterval>,
}

impl Arith for IntervalReading {
    type Num = Interval;
    type Int = IntegerInterval;
    type Bit = Maybe;

    fn zero(&mut self) -> Interval {
        Interval::point(0.0)
    }
    fn add(&mut self, _: Rounding, a: Interval, b: Interval) -> Interval {
        Interval::around(&[a.low + b.low, a.high + b.high])
    }
    fn sub(&mut self, _: Rounding, a: Interval, b: Interval) -> Interval {
        Interval::around(&[a.low - b.high, a.high - b.low])
    }
    fn mul(&mut self, _: Rounding, a: Interval, b: Interval) -> Interval {
        Interval::around(&[
            a.low * b.low,
            a.low * b.high,
            a.high * b.low,
            a.high * b.high,
        ])
    }
    fn div(&mut self, _: Rounding, a: Interval, b: Interval) -> Interval {
        if b.low <= 0.0 && b.high >= 0.0 {
            return Interval {
                low: f64::NEG_INFINITY,
                high: f64::INFINITY,
            };
        }
        Interval::around(&[
            a.low / b.low,
            a.low / b.high,
            a.high / b.low,
            a.high / b.high,
        ])
    }
    fn ulps_up(&mut self, a: Interval, _: u32) -> Interval {
        a
    }
    fn exact_below(&mut self, _: Interval) -> Interval {
        Interval::point(f64::INFINITY)
    }
    fn negate_if(&mut self, condition: Maybe, a: Interval) -> Interval {
        let negated = a.map(|value| -value);
        self.select(condition, negated, a)
    }
    fn magnitude(&mut self, a: Interval) -> Interval {
        let magnitudes = a.map(f64::abs);
        Interval {
            low: if a.low <= 0.0 && a.high >= 0.0 {
                0.0
            } else {
                magnitudes.low
            },
            ..magnitudes
        }
    }
    fn is_negative(&mut self, a: Interval) -> Maybe {
        Maybe::of(a.high >= 0.0, a.low < 0.0)
    }
    fn is_zero(&mut self, a: Interval) -> Maybe {
        Maybe::of(a.low != 0.0 || a.high != 0.0, a.low <= 0.0 && a.high >= 0.0)
    }
    fn less_than(&mut self, a: Interval, b: Interval) -> Maybe {
        Maybe::of(a.high >= b.low, a.low < b.high)
    }
    fn less_equal(&mut self, a: Interval, b: Interval) -> Maybe {
        Maybe::of(a.high > b.low, a.low <= b.high)
    }
    fn select(&mut self, condition: Maybe, when_one: Interval, when_zero: Interval) -> Interval {
        match (condition.zero, condition.one) {
            (false, _) => when_one,
            (_, false) => when_zero,
            _ => when_one.hull(when_zero),
        }
    }
    fn number_from_integer(
        &mut self,
        _: Rounding,
        value: IntegerInterval,
        exponent: IntegerInterval,
    ) -> Interval {
        let corner = |value: i128, exponent: i128| value as f64 * 2_f64.powi(exponent as i32);
        let corners = [
            corner(value.low, exponent.low),
            corner(value.low, exponent.high),
            corner(value.high, exponent.low),
            corner(value.high, exponent.high),
        ];
        // Small integers times powers of two are exact.
        let is_exact = [value.low, value.high]
            .iter()
            .all(|value| value.unsigned_abs() <= 1 << 53)
            && exponent.low > -900
            && exponent.high < 900;
        if is_exact {
            let points = corners.map(Interval::point);
            return points.into_iter().fold(points[0], Interval::hull);
        }
        Interval::around(&corners)
    }
    fn scale(&mut self, a: Interval, exponent: i32) -> Interval {
        let scaled = a.map(|value| value * 2_f64.powi(exponent));
        // Exact, but for what is scaled below the normal numbers.
        let subnormal = |value: f64| value != 0.0 && value.abs() < f64::MIN_POSITIVE;
        if exponent < 0 && (subnormal(scaled.low) || subnormal(scaled.high)) {
            return Interval::around(&[scaled.low, scaled.high]);
        }
        scaled
    }
    fn floor(&mut self, a: Interval, bits: u32) -> IntegerInterval {
        let all = IntegerInterval::of_bits(bits);
        let floor = |value: f64| (value.floor() as i128).clamp(all.low, all.high);
        IntegerInterval::new(floor(a.low), floor(a.high))
    }
    fn depth_from_height(&mut self, height: IntegerInterval, bits: u32) -> Interval {
        let full = (1_i128 << bits) - 1;
        let depth = |height: i128| (full - height) as f64 / full as f64;
        Interval::around(&[depth(height.low), depth(height.high)])
    }

    fn int_constant(&mut self, value: i64) -> IntegerInterval {
        IntegerInterval::point(value.into())
    }
    fn int_add(&mut self, a: IntegerInterval, b: IntegerInterval) -> IntegerInterval {
        IntegerInterval::new(a.low + b.low, a.high + b.high)
    }
    fn int_sub(&mut self, a: IntegerInterval, b: IntegerInterval) -> IntegerInterval {
        IntegerInterval::new(a.low - b.high, a.high - b.low)
    }
    fn int_shift_left(
        &mut self,
        a: IntegerInterval,
        amount: IntegerInterval,
        amount_bits: u32,
    ) -> IntegerInterval {
        let amount = within_amount(amount, amount_bits);
        a.corners(amount, |a, amount| a << amount)
    }
    fn int_shift_right(
        &mut self,
        a: IntegerInterval,
        amount: IntegerInterval,
        amount_bits: u32,
    ) -> IntegerInterval {
        let amount = within_amount(amount, amount_bits);
        a.corners(amount, |a, amount| a >> amount)
    }
    fn int_mul(&mut self, a: IntegerInterval, b: IntegerInterval) -> IntegerInterval {
        a.corners(b, |a, b| a * b)
    }
    fn int_bit_length(&mut self, a: IntegerInterval) -> IntegerInterval {
        let length = |value: i128| i128::from(128 - value.max(0).leading_zeros());
        IntegerInterval::new(length(a.low), length(a.high))
    }
    fn int_wrap(&mut self, a: IntegerInterval, bits: u32) -> IntegerInterval {
        let all = IntegerInterval::of_bits(bits);
        if all.contains(a) { a } else { all }
    }
    fn int_low_bits(&mut self, a: IntegerInterval, bits: u32) -> IntegerInterval {
        let all = IntegerInterval::new(0, (1 << bits) - 1);
        if all.contains(a) { a } else { all }
    }
    fn int_and(&mut self, a: IntegerInterval, b: IntegerInterval) -> IntegerInterval {
        if a.low < 0 && b.low < 0 || a.low == a.high && b.low == b.high {
            return a.bitwise(b, |a, b| a & b);
        }
        // Not negative, and no larger than an operand that is not negative.
        let unsigned = [a, b].into_iter().filter(|operand| operand.low >= 0);
        let most = unsigned
            .map(|operand| operand.high)
            .fold(i128::MAX, i128::min);
        IntegerInterval::new(0, most)
    }
    fn int_or(&mut self, a: IntegerInterval, b: IntegerInterval) -> IntegerInterval {
        a.bitwise(b, |a, b| a | b)
    }
    fn int_xor(&mut self, a: IntegerInterval, b: IntegerInterval) -> IntegerInterval {
        a.bitwise(b, |a, b| a ^ b)
    }
    fn int_complement_if(&mut self, condition: Maybe, a: IntegerInterval) -> IntegerInterval {
        let complement = IntegerInterval::new(-1 - a.high, -1 - a.low);
        self.int_select(condition, complement, a)
    }
    fn int_equal(&mut self, a: IntegerInterval, b: IntegerInterval) -> Maybe {
        let known = a.low == a.high && a == b;
        Maybe::of(!known, a.low <= b.high && b.low <= a.high)
    }
    fn int_less_than(&mut self, a: IntegerInterval, b: IntegerInterval) -> Maybe {
        Maybe::of(a.high >= b.low, a.low < b.high)
    }
    fn int_select(
        &mut self,
        condition: Maybe,
        when_one: IntegerInterval,
        when_zero: IntegerInterval,
    ) -> IntegerInterval {
        match (condition.zero, condition.one) {
            (false, _) => when_one,
            (_, false) => when_zero,
            _ => when_one.hull(when_zero),
        }
    }
    fn int_from_bit(&mut self, condition: Maybe) -> IntegerInterval {
        IntegerInterval::new(i128::from(!condition.zero), i128::from(condition.one))
    }

    fn bit_constant(&mut self, value: bool) -> Maybe {
        Maybe::known(value)
    }
    fn and(&mut self, a: Maybe, b: Maybe) -> Maybe {
        Maybe::of(a.zero || b.zero, a.one && b.one)
    }
    fn or(&mut self, a: Maybe, b: Maybe) -> Maybe {
        Maybe::of(a.zero && b.zero, a.one || b.one)
    }
    fn not(&mut self, a: Maybe) -> Maybe {
        Maybe::of(a.one, a.zero)
    }

    fn name_int(&mut self, name: &'static str, value: IntegerInterval) {
        self.integers
            .entry(name)
            .and_modify(|known| *known = known.hull(value))
            .or_insert(value);
    }
}

/// An amount to shift by, of which a circuit sees so many bits.
fn within_amount(amount: IntegerInterval, amount_bits: u32) -> IntegerInterval {
    let all = IntegerInterval::new(0, (1 << amount_bits) - 1);
    if all.contains(amount) { amount } else { all }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::F64Reading;
    use Rounding::NearestEven;
    use proptest::prelude::*;

    /// A range and an integer of it.
    fn integer() -> impl Strategy<Value = (IntegerInterval, i64)> {
        let end = prop_oneof![-9_i64..9, -5_000_000_i64..5_000_000];
        (end.clone(), end.clone(), any::<u64>()).prop_map(|(a, b, pick)| {
            let (low, high) = (a.min(b), a.max(b));
            let value = low + (pick % (high - low + 1) as u64) as i64;
            (IntegerInterval::new(low.into(), high.into()), value)
        })
    }

    /// A range and a number of it.
    fn number() -> impl Strategy<Value = (Interval, f64)> {
        let end = prop_oneof![
            Just(0.0),
            Just(1.0),
            -4.0..4.0,
            -1e6..1e6,
            proptest::num::f64::NORMAL
        ];
        (end.clone(), end.clone(), 0.0..=1.0).prop_map(|(a, b, part): (f64, f64, f64)| {
            let (low, high) = (a.min(b), a.max(b));
            let value = (low + (high - low) * part).clamp(low, high);
            let value = if value.is_nan() { low } else { value };
            (Interval { low, high }, value)
        })
    }

    fn holds(range: Interval, value: f64) -> bool {
        value.is_nan() || range.low <= value && value <= range.high
    }

    fn allows(bit: Maybe, value: bool) -> bool {
        if value { bit.one } else { bit.zero }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn what_integers_give_is_in_the_range(
            (a, x) in integer(), (b, y) in integer(), amount in 0_i64..16, bits in 1_u32..40,
        ) {
            let (mut range, mut plain) = (IntervalReading::default(), F64Reading);
            let shift = IntegerInterval::point(amount.into());
            let shifts = IntegerInterval::new(0, amount.into());
            let either = Maybe::EITHER;
            let pairs = [
                (range.int_add(a, b), plain.int_add(x, y)),
                (range.int_sub(a, b), plain.int_sub(x, y)),
                (range.int_mul(a, b), plain.int_mul(x, y)),
                (range.int_and(a, b), plain.int_and(x, y)),
                (range.int_or(a, b), plain.int_or(x, y)),
                (range.int_xor(a, b), plain.int_xor(x, y)),
                (range.int_shift_left(a, shift, 4), plain.int_shift_left(x, amount, 4)),
                (range.int_shift_left(a, shifts, 4), plain.int_shift_left(x, amount, 4)),
                (range.int_shift_right(a, shifts, 4), plain.int_shift_right(x, amount, 4)),
                (range.int_wrap(a, bits), plain.int_wrap(x, bits)),
                (range.int_low_bits(a, bits), plain.int_low_bits(x, bits)),
                (range.int_complement_if(either, a), plain.int_complement_if(true, x)),
                (range.int_complement_if(either, a), plain.int_complement_if(false, x)),
                (range.int_select(either, a, b), plain.int_select(true, x, y)),
                (range.int_select(either, a, b), plain.int_select(false, x, y)),
            ];
            for (place, (range, value)) in pairs.into_iter().enumerate() {
                prop_assert!(
                    range.contains(IntegerInterval::point(value.into())),
                    "operation {place}: {value} not in {range:?}"
                );
            }
            if a.low >= 0 {
                let length = range.int_bit_length(a);
                prop_assert!(length.contains(IntegerInterval::point(plain.int_bit_length(x).into())));
            }
            prop_assert!(allows(range.int_equal(a, b), plain.int_equal(x, y)));
            prop_assert!(allows(range.int_less_than(a, b), plain.int_less_than(x, y)));
            let word = IntegerInterval::of_bits(a.signed_bits());
            prop_assert!(word.contains(a));
            prop_assert!(a.signed_bits() == 1
                || !IntegerInterval::of_bits(a.signed_bits() - 1).contains(a));
        }

        #[test]
        fn what_numbers_give_is_in_the_range(
            (a, x) in number(), (b, y) in number(), exponent in -40_i32..40, n in integer(),
        ) {
            let (mut range, mut plain) = (IntervalReading::default(), F64Reading);
            let either = Maybe::EITHER;
            let pairs = [
                (range.add(NearestEven, a, b), x + y),
                (range.sub(NearestEven, a, b), x - y),
                (range.mul(NearestEven, a, b), x * y),
                (range.div(NearestEven, a, b), x / y),
                (range.magnitude(a), x.abs()),
                (range.negate_if(either, a), -x),
                (range.negate_if(either, a), x),
                (range.scale(a, exponent), plain.scale(x, exponent)),
                (range.min(a, b), x.min(y)),
                (range.max(a, b), x.max(y)),
                (
                    range.number_from_integer(
                        NearestEven, n.0, IntegerInterval::point(exponent.into())),
                    plain.number_from_integer(NearestEven, n.1, exponent.into()),
                ),
            ];
            for (place, (range, value)) in pairs.into_iter().enumerate() {
                prop_assert!(holds(range, value), "operation {place}: {value} not in {range:?}");
            }
            let floor = range.floor(a, 30);
            prop_assert!(floor.contains(IntegerInterval::point(plain.floor(x, 30).into())));
            prop_assert!(allows(range.is_negative(a), x < 0.0));
            prop_assert!(allows(range.is_zero(a), x == 0.0));
            prop_assert!(allows(range.less_than(a, b), x < y));
            prop_assert!(allows(range.less_equal(a, b), x <= y));
        }
    }

    #[test]
    fn every_evaluation_widens_what_is_kept_of_a_name() {
        let mut reading = IntervalReading::default();
        for value in [3, -5, 1] {
            reading.name_int("height", IntegerInterval::point(value));
        }
        assert_eq!(reading.integers["height"], IntegerInterval::new(-5, 3));
        assert_eq!(reading.integers["height"].signed_bits(), 4);
    }
}
