//! The exact reading: numbers are rationals of big integers.

use super::NumberFormat;
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
/// The store grows with every operation; [`NumberFormat::forget`] empties it between rays.
#[derive(Clone, Debug, Default)]
pub struct ExactReading {
    /// `None` is plus infinity: what a division by zero gives.
    store: Vec<Option<BigRational>>,
}

impl ExactReading {
    /// The value behind a number; `None` is infinite.
    pub fn value(&self, number: ExactNum) -> Option<&BigRational> {
        self.store[number.0].as_ref()
    }

    /// Keeps a value.
    pub fn number(&mut self, value: BigRational) -> ExactNum {
        self.keep(Some(value))
    }

    fn keep(&mut self, value: Option<BigRational>) -> ExactNum {
        self.store.push(value);
        ExactNum(self.store.len() - 1)
    }

    /// Both values, which must be finite: infinities occur only as exits that are never reached,
    /// and those are compared, not computed with.
    fn finite(&self, a: ExactNum, b: ExactNum) -> (&BigRational, &BigRational) {
        match (self.value(a), self.value(b)) {
            (Some(a), Some(b)) => (a, b),
            _ => unreachable!("a datapath computes with an exit that is never reached"),
        }
    }

    fn exactly(&mut self, value: f64) -> ExactNum {
        let value = BigRational::from_float(value).expect("rays are checked to be finite");
        self.number(value)
    }
}

impl Arith for ExactReading {
    type Num = ExactNum;
    plain_integers_and_bits!();

    fn zero(&mut self) -> ExactNum {
        self.number(BigRational::zero())
    }
    fn add(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let (a, b) = self.finite(a, b);
        let sum = a + b;
        self.number(sum)
    }
    fn sub(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let (a, b) = self.finite(a, b);
        let difference = a - b;
        self.number(difference)
    }
    fn mul(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let (a, b) = self.finite(a, b);
        let product = a * b;
        self.number(product)
    }
    fn div(&mut self, _: Rounding, a: ExactNum, b: ExactNum) -> ExactNum {
        let (a, b) = self.finite(a, b);
        let quotient = if b.is_zero() { None } else { Some(a / b) };
        self.keep(quotient)
    }
    fn ulps_up(&mut self, a: ExactNum, _: u32) -> ExactNum {
        a
    }
    fn exact_below(&mut self, _: ExactNum) -> ExactNum {
        self.keep(None)
    }
    fn negate_if(&mut self, condition: bool, a: ExactNum) -> ExactNum {
        if !condition {
            return a;
        }
        let negated = self.value(a).map(|value| -value);
        self.keep(negated)
    }
    fn magnitude(&mut self, a: ExactNum) -> ExactNum {
        let magnitude = self.value(a).map(|value| value.abs());
        self.keep(magnitude)
    }
    fn is_negative(&mut self, a: ExactNum) -> bool {
        self.value(a).is_some_and(|value| value.is_negative())
    }
    fn is_zero(&mut self, a: ExactNum) -> bool {
        self.value(a).is_some_and(|value| value.is_zero())
    }
    fn less_than(&mut self, a: ExactNum, b: ExactNum) -> bool {
        match (self.value(a), self.value(b)) {
            (None, _) => false,
            (Some(_), None) => true,
            (Some(a), Some(b)) => a < b,
        }
    }
    fn less_equal(&mut self, a: ExactNum, b: ExactNum) -> bool {
        !self.less_than(b, a)
    }
    fn select(&mut self, condition: bool, when_one: ExactNum, when_zero: ExactNum) -> ExactNum {
        if condition { when_one } else { when_zero }
    }
    fn number_from_integer(&mut self, _: Rounding, value: i64, exponent: i64) -> ExactNum {
        let power = BigInt::from(1) << exponent.unsigned_abs();
        let value = BigInt::from(value);
        self.number(if exponent < 0 {
            BigRational::new(value, power)
        } else {
            BigRational::from(value * power)
        })
    }
    fn scale(&mut self, a: ExactNum, exponent: i32) -> ExactNum {
        let power = self.number_from_integer(Rounding::NearestEven, 1, exponent.into());
        match self.value(a) {
            None => a,
            Some(_) => self.mul(Rounding::NearestEven, a, power),
        }
    }
    fn floor(&mut self, a: ExactNum, bits: u32) -> i64 {
        let most = (1_i64 << (bits - 1)) - 1;
        let floor = self.value(a).map(|value| value.floor().to_integer());
        match floor {
            None => most,
            Some(floor) => floor
                .clamp((-1 - most).into(), most.into())
                .to_i64()
                .expect("within the range"),
        }
    }
    fn depth_from_height(&mut self, height: i64, bits: u32) -> ExactNum {
        let full = (1_i64 << bits) - 1;
        self.number(BigRational::new((full - height).into(), full.into()))
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
        match self.value(value) {
            Some(value) => value.to_f64().unwrap_or(f64::NAN),
            None => f64::INFINITY,
        }
    }
    fn forget(&mut self) {
        self.store.clear();
    }
}
