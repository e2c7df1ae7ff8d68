//! The exact reading: numbers are exact, worked out only where an answer hangs on them.

use std::cmp::Ordering;
use std::sync::Arc;

use super::NumberFormat;
use super::enclosure::Enclosure;
use super::integer::plain_integers_and_bits;
use super::rationals::Rationals;
use super::small_ratio::SmallRatio;
use crate::arith::Arith;
use crate::float::Rounding;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};

/// A number of the exact reading: two `f64` it lies between, and its place in the reading's store.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactNum {
    enclosure: Enclosure,
    place: u32,
}

/// Numbers are rationals, or infinite. Nothing is ever rounded.
///
/// Each number is kept as the operation that made it, with two `f64` it lies between. A comparison
/// is decided in three stages, each exact where it answers, and each asked only where the one before
/// does not tell:
///
/// 1. by the enclosures: that numbers lie in intervals that do not overlap settles their order;
/// 2. by ratios of 128-bit integers, with every overflow looked for (`small_ratio`): ties, which
///    are common at borders and corners, and at depths that are reached and met again;
/// 3. by rationals of big integers, which hold everything.
///
/// So no answer depends on the stage that gave it: it is a filter before exact arithmetic, as in
/// computational geometry (Fortune and Van Wyk 1993; the lazy exact numbers of CGAL are of this kind).
///
/// The store grows with every operation; [`NumberFormat::forget`] empties it between rays.
#[derive(Clone, Debug, Default)]
pub struct ExactReading {
    /// What made each number.
    store: Vec<Origin>,
    /// The rationals that had to be worked out, by their places.
    rationals: Rationals,
    /// Works every number out at once, as if there were no filter.
    is_plain: bool,
}

/// What made a number. Operands are places in the store.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Origin {
    /// The outside world, as a rational: it is there from the start.
    Given,
    /// An `f64`, which is finite.
    Float(f64),
    /// The depth of a height of so many bits.
    Depth {
        height: i64,
        bits: u32,
    },
    /// An integer times a power of two.
    Integer(i64, i32),
    Sum(u32, u32),
    Difference(u32, u32),
    Product(u32, u32),
    /// The divisor is not zero.
    Quotient(u32, u32),
    Negated(u32),
    Magnitude(u32),
    Scaled(u32, i32),
}

/// Operations on the longest way from a number to what it is made of, beyond which it is left to
/// rationals. Numbers of a walk have eight at most; a number that is made of one other twice, over
/// and over, would else take a time that grows twofold with each.
const MOST_OPERATIONS_DEEP: u32 = 12;

/// Where infinity stands, which is what a division by zero gives. It is in no store.
const INFINITE_PLACE: u32 = u32::MAX;

const INFINITY: ExactNum = ExactNum {
    enclosure: Enclosure::INFINITY,
    place: INFINITE_PLACE,
};

impl ExactNum {
    #[inline]
    fn is_infinite(self) -> bool {
        self.place == INFINITE_PLACE
    }
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
    pub fn value(&self, number: ExactNum) -> Option<BigRational> {
        (!number.is_infinite()).then(|| self.rational(number).as_ref().clone())
    }

    /// Keeps a value.
    pub fn number(&mut self, value: BigRational) -> ExactNum {
        let number = self.made(Enclosure::ANY, Origin::Given);
        self.rationals.put(number.place, Arc::new(value));
        number
    }

    #[inline]
    fn keep(&mut self, enclosure: Enclosure, origin: Origin) -> ExactNum {
        match self.is_plain {
            true => self.work_out_at_once(origin),
            false => self.made(enclosure, origin),
        }
    }

    #[inline]
    fn made(&mut self, enclosure: Enclosure, origin: Origin) -> ExactNum {
        let place = self.store.len() as u32;
        assert!(place < INFINITE_PLACE, "a walk ends at its step bound");
        self.store.push(origin);
        ExactNum { enclosure, place }
    }

    #[cold]
    fn work_out_at_once(&mut self, origin: Origin) -> ExactNum {
        let number = self.made(Enclosure::ANY, origin);
        self.rationals.work_out(&self.store, number.place);
        number
    }

    /// The rational of a number, to read: worked out, but not kept, where it is not there.
    fn rational(&self, number: ExactNum) -> Arc<BigRational> {
        match self.rationals.at(number.place) {
            Some(known) => known.clone(),
            None => self.rationals.clone().work_out(&self.store, number.place),
        }
    }

    /// The number at a place as a ratio of small integers, if it is one that was made by few
    /// operations.
    fn small(&self, place: u32, operations: u32) -> Option<SmallRatio> {
        let below = operations.checked_sub(1)?;
        let of = |place| self.small(place, below);
        match self.store[place as usize] {
            Origin::Given => None,
            Origin::Float(value) => SmallRatio::float(value),
            Origin::Depth { height, bits } => {
                let full = (1_i64 << bits) - 1;
                SmallRatio::new((full - height).into(), full.into(), 0)
            }
            Origin::Integer(value, exponent) => SmallRatio::new(value.into(), 1, exponent),
            Origin::Sum(a, b) => of(a)?.plus(of(b)?),
            Origin::Difference(a, b) => of(a)?.plus(of(b)?.negated()?),
            Origin::Product(a, b) => of(a)?.times(of(b)?),
            Origin::Quotient(a, b) => of(a)?.over(of(b)?),
            Origin::Negated(a) => of(a)?.negated(),
            Origin::Magnitude(a) => of(a)?.magnitude(),
            Origin::Scaled(a, exponent) => of(a)?.scaled(exponent),
        }
    }

    /// A number as a ratio of small integers, where it is one; the plain reading has none.
    fn as_small(&self, number: ExactNum) -> Option<SmallRatio> {
        match self.is_plain {
            true => None,
            false => self.small(number.place, MOST_OPERATIONS_DEEP),
        }
    }

    /// Is a number below another? For where the enclosures do not tell.
    #[inline(never)]
    fn is_less_exactly(&mut self, a: ExactNum, b: ExactNum) -> bool {
        match (a.is_infinite(), b.is_infinite()) {
            (true, _) => false,
            (false, true) => true,
            (false, false) => self.compare_exactly(a.place, b.place).is_lt(),
        }
    }

    fn compare_exactly(&mut self, a: u32, b: u32) -> Ordering {
        // A node's depth is often the very depth that the walk has reached: made twice, the same.
        let (left, right) = (self.store[a as usize], self.store[b as usize]);
        if a == b || left == right && left != Origin::Given {
            return Ordering::Equal;
        }
        if !self.is_plain {
            let small = |place| self.small(place, MOST_OPERATIONS_DEEP);
            let order = small(a).zip(small(b)).and_then(|(a, b)| a.compare(b));
            if let Some(order) = order {
                return order;
            }
        }
        let mut rational = |place| self.rationals.work_out(&self.store, place);
        rational(a).cmp(&rational(b))
    }

    /// How a finite number compares with zero, for where its enclosure does not tell.
    #[inline(never)]
    fn sign_exactly(&mut self, a: ExactNum) -> Ordering {
        match self.as_small(a) {
            Some(ratio) => ratio.sign(),
            None => {
                let value = self.rationals.work_out(&self.store, a.place);
                value.as_ref().cmp(&BigRational::zero())
            }
        }
    }

    #[inline]
    fn exactly(&mut self, value: f64) -> ExactNum {
        assert!(value.is_finite(), "rays are checked to be finite");
        self.keep(Enclosure::single(value), Origin::Float(value))
    }
}

impl Arith for ExactReading {
    type Num = ExactNum;
    plain_integers_and_bits!();

    #[inline]
    fn zero(&mut self) -> ExactNum {
        self.exactly(0.0)
    }
    #[inline]
    fn add(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let sum = a.enclosure.plus(b.enclosure);
        self.keep(sum, Origin::Sum(a.place, b.place))
    }
    #[inline]
    fn sub(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let difference = a.enclosure.plus(b.enclosure.negated());
        self.keep(difference, Origin::Difference(a.place, b.place))
    }
    #[inline]
    fn mul(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let product = a.enclosure.times(b.enclosure);
        self.keep(product, Origin::Product(a.place, b.place))
    }
    #[inline]
    fn div(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        if self.is_zero(b) {
            return INFINITY;
        }
        let quotient = a.enclosure.over(b.enclosure);
        self.keep(quotient, Origin::Quotient(a.place, b.place))
    }
    #[inline]
    fn ulps_up(&mut self, a: ExactNum, _: u32) -> ExactNum {
        a
    }
    #[inline]
    fn exact_below(&mut self, _: ExactNum) -> ExactNum {
        INFINITY
    }
    #[inline]
    fn negate_if(&mut self, condition: bool, a: ExactNum) -> ExactNum {
        if !condition || a.is_infinite() {
            return a;
        }
        self.keep(a.enclosure.negated(), Origin::Negated(a.place))
    }
    #[inline]
    fn magnitude(&mut self, a: ExactNum) -> ExactNum {
        if a.is_infinite() {
            return a;
        }
        self.keep(a.enclosure.magnitude(), Origin::Magnitude(a.place))
    }
    #[inline]
    fn is_negative(&mut self, a: ExactNum) -> bool {
        let told = a.enclosure.is_negative();
        told.unwrap_or_else(|| self.sign_exactly(a).is_lt())
    }
    #[inline]
    fn is_zero(&mut self, a: ExactNum) -> bool {
        let told = a.enclosure.is_zero();
        told.unwrap_or_else(|| self.sign_exactly(a).is_eq())
    }
    #[inline]
    fn less_than(&mut self, a: ExactNum, b: ExactNum) -> bool {
        let told = a.enclosure.less_than(b.enclosure);
        told.unwrap_or_else(|| self.is_less_exactly(a, b))
    }
    #[inline]
    fn less_equal(&mut self, a: ExactNum, b: ExactNum) -> bool {
        !self.less_than(b, a)
    }
    #[inline]
    fn select(&mut self, condition: bool, when_one: ExactNum, when_zero: ExactNum) -> ExactNum {
        if condition { when_one } else { when_zero }
    }
    #[inline]
    fn number_from_integer(&mut self, _: Rounding, value: i64, exponent: i64) -> ExactNum {
        let exponent = i32::try_from(exponent).expect("exponents are sizes of nodes");
        // Integers of a walk are small: the enclosure is then a single number.
        let enclosure = match value.unsigned_abs() < 1 << 53 {
            true => Enclosure::single(value as f64).scaled(exponent),
            false => Enclosure::ANY,
        };
        self.keep(enclosure, Origin::Integer(value, exponent))
    }
    #[inline]
    fn scale(&mut self, a: ExactNum, exponent: i32) -> ExactNum {
        if a.is_infinite() {
            return a;
        }
        let scaled = a.enclosure.scaled(exponent);
        self.keep(scaled, Origin::Scaled(a.place, exponent))
    }
    fn floor(&mut self, a: ExactNum, bits: u32) -> i64 {
        let most = (1_i64 << (bits - 1)) - 1;
        if a.is_infinite() {
            return most;
        }
        if let Some(floor) = a.enclosure.floor() {
            // The conversion saturates.
            return (floor as i64).clamp(-1 - most, most);
        }
        if let Some(floor) = self.as_small(a).and_then(SmallRatio::floor) {
            let within = floor.clamp((-1 - most).into(), most.into());
            return within as i64;
        }
        let value = self.rational(a);
        value
            .floor()
            .to_integer()
            .clamp((-1 - most).into(), most.into())
            .to_i64()
            .expect("within the range")
    }
    #[inline]
    fn depth_from_height(&mut self, height: i64, bits: u32) -> ExactNum {
        let full = (1_i64 << bits) - 1;
        let depth = Enclosure::single((full - height) as f64);
        let depth = match height {
            0 => Enclosure::single(1.0),
            _ => depth.over(Enclosure::single(full as f64)),
        };
        self.keep(depth, Origin::Depth { height, bits })
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
        if let Some(single) = value.enclosure.as_single() {
            // A rational has one zero.
            return single + 0.0;
        }
        if let Some(nearest) = self.as_small(value).and_then(SmallRatio::to_f64) {
            return nearest;
        }
        let value = self.rational(value);
        value.to_f64().unwrap_or(f64::NAN)
    }
    fn forget(&mut self) {
        self.store.clear();
        self.rationals.clear();
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
            let is_finite = !a.is_infinite() && !b.is_infinite();
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
