//! The exact reading: numbers are rationals, worked out only where an answer hangs on them.

use std::cmp::Ordering;
use std::sync::OnceLock;

use super::NumberFormat;
use super::enclosure::Enclosure;
use super::integer::plain_integers_and_bits;
use crate::arith::Arith;
use crate::float::Rounding;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// A number of the exact reading: its place in the reading's store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactNum(usize);

/// Numbers are rationals of big integers, or infinite. Nothing is ever rounded.
///
/// Each number is kept as the operation that made it, with two `f64` it lies between. A comparison
/// is decided by those wherever they tell; only where they do not are both numbers worked out in
/// rationals. That changes no answer: it is a filter before exact arithmetic, as in computational
/// geometry (Fortune and Van Wyk 1993; the lazy exact numbers of CGAL are of this kind).
///
/// The store grows with every operation; [`NumberFormat::forget`] empties it between rays.
#[derive(Clone, Debug, Default)]
pub struct ExactReading {
    store: Vec<Number>,
    /// Works every number out at once, as if there were no filter.
    is_plain: bool,
}

/// A number as it was made.
#[derive(Clone, Debug)]
struct Number {
    enclosure: Enclosure,
    origin: Origin,
    /// Its value, once it has been worked out; `None` is plus infinity.
    value: OnceLock<Box<Option<BigRational>>>,
}

/// What made a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Origin {
    /// The outside world, as a rational: its value is there from the start.
    Given,
    /// An `f64`, which is finite.
    Float(f64),
    /// Plus infinity: what a division by zero gives.
    Infinity,
    /// A ratio of two integers.
    Ratio(i64, i64),
    /// An integer times a power of two.
    Integer(i64, i64),
    Sum(ExactNum, ExactNum),
    Difference(ExactNum, ExactNum),
    Product(ExactNum, ExactNum),
    /// The divisor is not zero.
    Quotient(ExactNum, ExactNum),
    Negated(ExactNum),
    Magnitude(ExactNum),
    Scaled(ExactNum, i32),
}

impl ExactReading {
    /// A reading that works out every number at once in rationals: the same answers, slowly. To
    /// hold the filter against.
    pub fn plain() -> ExactReading {
        ExactReading {
            is_plain: true,
            ..ExactReading::default()
        }
    }

    /// The value behind a number, not always in lowest terms; `None` is infinite.
    pub fn value(&self, number: ExactNum) -> Option<&BigRational> {
        let number = &self.store[number.0];
        let value = number.value.get_or_init(|| Box::new(self.work_out(number)));
        (**value).as_ref()
    }

    /// Keeps a value.
    pub fn number(&mut self, value: BigRational) -> ExactNum {
        self.store.push(Number {
            enclosure: Enclosure::ANY,
            origin: Origin::Given,
            value: OnceLock::from(Box::new(Some(value))),
        });
        ExactNum(self.store.len() - 1)
    }

    fn keep(&mut self, enclosure: Enclosure, origin: Origin) -> ExactNum {
        let number = ExactNum(self.store.len());
        self.store.push(Number {
            enclosure: if self.is_plain {
                Enclosure::ANY
            } else {
                enclosure
            },
            origin,
            value: OnceLock::new(),
        });
        if self.is_plain {
            self.value(number);
        }
        number
    }

    /// The value of a number, from those it was made of.
    fn work_out(&self, number: &Number) -> Option<BigRational> {
        // Infinities occur only as exits that are never reached, and those are compared and change
        // sign; they are not computed with.
        let of = |number: ExactNum| match self.value(number) {
            Some(value) => value,
            None => unreachable!("a datapath computes with an exit that is never reached"),
        };
        Some(match number.origin {
            Origin::Given => unreachable!("a number that is given has its value"),
            Origin::Infinity => return None,
            Origin::Float(value) => {
                BigRational::from_float(value).expect("rays are checked to be finite")
            }
            Origin::Ratio(above, below) => BigRational::new(above.into(), below.into()),
            Origin::Integer(value, exponent) => {
                BigRational::from(BigInt::from(value)) * power_of_two(exponent)
            }
            Origin::Sum(a, b) => sum(of(a), of(b)),
            Origin::Difference(a, b) => sum(of(a), &-of(b)),
            Origin::Product(a, b) => product(of(a), of(b)),
            Origin::Quotient(a, b) => quotient(of(a), of(b)),
            Origin::Negated(a) => -of(a),
            Origin::Magnitude(a) => of(a).abs(),
            Origin::Scaled(a, exponent) => product(of(a), &power_of_two(exponent.into())),
        })
    }

    fn enclosure(&self, number: ExactNum) -> Enclosure {
        self.store[number.0].enclosure
    }

    fn is_infinite(&self, number: ExactNum) -> bool {
        self.store[number.0].origin == Origin::Infinity
    }

    /// How two finite numbers compare.
    fn compare(&self, a: ExactNum, b: ExactNum) -> Ordering {
        let (left, right) = (&self.store[a.0], &self.store[b.0]);
        if let Some(order) = left.enclosure.compare(right.enclosure) {
            return order;
        }
        // A node's depth is often the very depth that the walk has reached: made twice, the same.
        if left.origin == right.origin && left.origin != Origin::Given {
            return Ordering::Equal;
        }
        self.value(a).cmp(&self.value(b))
    }

    /// How a finite number compares with zero.
    fn sign(&self, a: ExactNum) -> Ordering {
        if let Some(order) = self.enclosure(a).compare(Enclosure::single(0.0)) {
            return order;
        }
        let value = self.value(a).expect("a finite number");
        value.cmp(&BigRational::zero())
    }

    fn exactly(&mut self, value: f64) -> ExactNum {
        assert!(value.is_finite(), "rays are checked to be finite");
        self.keep(Enclosure::single(value), Origin::Float(value))
    }
}

/// Denominators up to so many bits are left as they come. To reduce a ratio takes longer than all
/// that is done with it: most are compared or rounded once.
const REDUCED_BEYOND_BITS: u64 = 512;

/// A ratio whose denominator is positive, reduced where it has grown long.
fn ratio(above: BigInt, below: BigInt) -> BigRational {
    debug_assert!(below.is_positive());
    let ratio = BigRational::new_raw(above, below);
    match ratio.denom().bits() > REDUCED_BEYOND_BITS {
        true => ratio.reduced(),
        false => ratio,
    }
}

fn sum(a: &BigRational, b: &BigRational) -> BigRational {
    let above = a.numer() * b.denom() + b.numer() * a.denom();
    ratio(above, a.denom() * b.denom())
}

fn product(a: &BigRational, b: &BigRational) -> BigRational {
    ratio(a.numer() * b.numer(), a.denom() * b.denom())
}

fn quotient(a: &BigRational, b: &BigRational) -> BigRational {
    let (above, below) = (a.numer() * b.denom(), a.denom() * b.numer());
    match below.is_negative() {
        true => ratio(-above, -below),
        false => ratio(above, below),
    }
}

fn power_of_two(exponent: i64) -> BigRational {
    let power = BigInt::from(1) << exponent.unsigned_abs();
    match exponent < 0 {
        true => BigRational::new(1.into(), power),
        false => BigRational::from(power),
    }
}

impl Arith for ExactReading {
    type Num = ExactNum;
    plain_integers_and_bits!();

    fn zero(&mut self) -> ExactNum {
        self.exactly(0.0)
    }
    fn add(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let sum = self.enclosure(a).plus(self.enclosure(b));
        self.keep(sum, Origin::Sum(a, b))
    }
    fn sub(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let difference = self.enclosure(a).plus(self.enclosure(b).negated());
        self.keep(difference, Origin::Difference(a, b))
    }
    fn mul(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let product = self.enclosure(a).times(self.enclosure(b));
        self.keep(product, Origin::Product(a, b))
    }
    fn div(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        if self.sign(b) == Ordering::Equal {
            return self.keep(Enclosure::ANY, Origin::Infinity);
        }
        let quotient = self.enclosure(a).over(self.enclosure(b));
        self.keep(quotient, Origin::Quotient(a, b))
    }
    fn ulps_up(&mut self, a: ExactNum, _: u32) -> ExactNum {
        a
    }
    fn exact_below(&mut self, _: ExactNum) -> ExactNum {
        self.keep(Enclosure::ANY, Origin::Infinity)
    }
    fn negate_if(&mut self, condition: bool, a: ExactNum) -> ExactNum {
        if !condition || self.is_infinite(a) {
            return a;
        }
        let negated = self.enclosure(a).negated();
        self.keep(negated, Origin::Negated(a))
    }
    fn magnitude(&mut self, a: ExactNum) -> ExactNum {
        if self.is_infinite(a) {
            return a;
        }
        let magnitude = self.enclosure(a).magnitude();
        self.keep(magnitude, Origin::Magnitude(a))
    }
    fn is_negative(&mut self, a: ExactNum) -> bool {
        !self.is_infinite(a) && self.sign(a) == Ordering::Less
    }
    fn is_zero(&mut self, a: ExactNum) -> bool {
        !self.is_infinite(a) && self.sign(a) == Ordering::Equal
    }
    fn less_than(&mut self, a: ExactNum, b: ExactNum) -> bool {
        match (self.is_infinite(a), self.is_infinite(b)) {
            (true, _) => false,
            (false, true) => true,
            (false, false) => a != b && self.compare(a, b) == Ordering::Less,
        }
    }
    fn less_equal(&mut self, a: ExactNum, b: ExactNum) -> bool {
        !self.less_than(b, a)
    }
    fn select(&mut self, condition: bool, when_one: ExactNum, when_zero: ExactNum) -> ExactNum {
        if condition { when_one } else { when_zero }
    }
    fn number_from_integer(&mut self, _: Rounding, value: i64, exponent: i64) -> ExactNum {
        // Integers of a walk, and its exponents, are small: the enclosure is then a single number.
        let enclosure = match i32::try_from(exponent) {
            Ok(exponent) if value.unsigned_abs() < 1 << 53 => {
                Enclosure::single(value as f64).scaled(exponent)
            }
            _ => Enclosure::ANY,
        };
        self.keep(enclosure, Origin::Integer(value, exponent))
    }
    fn scale(&mut self, a: ExactNum, exponent: i32) -> ExactNum {
        if self.is_infinite(a) {
            return a;
        }
        let scaled = self.enclosure(a).scaled(exponent);
        self.keep(scaled, Origin::Scaled(a, exponent))
    }
    fn floor(&mut self, a: ExactNum, bits: u32) -> i64 {
        let most = (1_i64 << (bits - 1)) - 1;
        if self.is_infinite(a) {
            return most;
        }
        if let Some(floor) = self.enclosure(a).floor() {
            // The conversion saturates.
            return (floor as i64).clamp(-1 - most, most);
        }
        let value = self.value(a).expect("a finite number");
        value
            .floor()
            .to_integer()
            .clamp((-1 - most).into(), most.into())
            .to_i64()
            .expect("within the range")
    }
    fn depth_from_height(&mut self, height: i64, bits: u32) -> ExactNum {
        let full = (1_i64 << bits) - 1;
        let depth = Enclosure::single((full - height) as f64);
        let depth = match height {
            0 => Enclosure::single(1.0),
            _ => depth.over(Enclosure::single(full as f64)),
        };
        self.keep(depth, Origin::Ratio(full - height, full))
    }
}

impl NumberFormat for ExactReading {
    fn coordinate(&mut self, value: f64) -> ExactNum {
        self.exactly(value)
    }
    fn direction(&mut self, value: f64) -> ExactNum {
        self.exactly(value)
    }
    fn to_f64(&self, value: ExactNum) -> f64 {
        if let Some(single) = self.enclosure(value).as_single() {
            // A rational has one zero.
            return single + 0.0;
        }
        match self.value(value) {
            Some(value) => value.to_f64().unwrap_or(f64::NAN),
            None => f64::INFINITY,
        }
    }
    fn forget(&mut self) {
        self.store.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ROUNDING: Rounding = Rounding::NearestEven;

    /// An operation on the two numbers at these places of the numbers so far, and a small integer.
    type Step = (u32, usize, usize, i32);

    /// Does as told in a reading; all that can be seen of it.
    fn run(mut reading: ExactReading, numbers: &[f64], steps: &[Step]) -> Vec<String> {
        let mut made: Vec<ExactNum> = numbers.iter().map(|&n| reading.exactly(n)).collect();
        let mut seen = Vec::new();
        for &(operation, a, b, small) in steps {
            let (a, b) = (made[a % made.len()], made[b % made.len()]);
            seen.push(format!(
                "{} {} {} {}",
                reading.less_than(a, b),
                reading.less_equal(a, b),
                reading.is_zero(a),
                reading.is_negative(b)
            ));
            let is_finite = !reading.is_infinite(a) && !reading.is_infinite(b);
            let result = match operation % 10 {
                0 if is_finite => reading.add(ROUNDING, a, b),
                1 | 2 if is_finite => reading.sub(ROUNDING, a, b),
                3 if is_finite => reading.mul(ROUNDING, a, b),
                4 | 5 if is_finite => reading.div(ROUNDING, a, b),
                6 => reading.negate_if(small > 0, a),
                7 => reading.magnitude(a),
                8 => reading.scale(a, small),
                9 => reading.number_from_integer(ROUNDING, small.into(), -3),
                _ => reading.depth_from_height(i64::from(small.unsigned_abs()), 8),
            };
            let floor = reading.floor(result, 12);
            let nearest = reading.to_f64(result);
            seen.push(format!("{:?} {floor} {nearest}", reading.value(result)));
            made.push(result);
        }
        seen
    }

    proptest! {
        /// Comparisons are asked before any value is: the filter must stand on its own.
        #[test]
        fn the_filter_changes_no_answer(
            numbers in prop::collection::vec(
                prop_oneof![-2.0..2.0_f64, (-16..16_i32).prop_map(|n| f64::from(n) / 8.0)], 2..6),
            steps in prop::collection::vec((0..10_u32, 0..64_usize, 0..64_usize, -20..20_i32), 1..24),
        ) {
            let filtered = run(ExactReading::default(), &numbers, &steps);
            prop_assert_eq!(filtered, run(ExactReading::plain(), &numbers, &steps));
        }
    }

    #[test]
    fn what_intervals_cannot_tell_is_told_exactly() {
        let mut reading = ExactReading::default();
        let (one, three) = (reading.exactly(1.0), reading.exactly(3.0));
        let third = reading.div(ROUNDING, one, three);
        let sum = reading.add(ROUNDING, third, third);
        let sum = reading.add(ROUNDING, sum, third);
        assert!(!reading.less_than(sum, one) && reading.less_equal(sum, one));
        let tiny = reading.exactly(2_f64.powi(-200));
        let above = reading.add(ROUNDING, sum, tiny);
        assert!(reading.less_than(one, above));
    }

    #[test]
    fn a_wrong_enclosure_would_be_seen() {
        // A number whose enclosure is planted beside it answers otherwise than the plain reading.
        let mut reading = ExactReading::default();
        let two = reading.exactly(2.0);
        let planted = reading.keep(Enclosure::single(3.0), Origin::Float(1.0));
        assert!(reading.less_than(two, planted));
        let mut plain = ExactReading::plain();
        let two = plain.exactly(2.0);
        let planted = plain.keep(Enclosure::single(3.0), Origin::Float(1.0));
        assert!(!plain.less_than(two, planted));
    }
}
