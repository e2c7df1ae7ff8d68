//! What a fixed-point operator must answer, from the exact result as a ratio of integers: the grid's
//! neighbours on both sides, a choice between them by distance, and then the range.
//!
//! It shares no code with the operators: there magnitudes are shifted and cut, here a ratio is
//! divided with its sign, toward minus infinity.
#![allow(dead_code)] // every test program uses its own part of it

pub mod operands;

use std::fmt;

use num_bigint::BigInt;
use num_traits::{Euclid, FromPrimitive, Signed, ToPrimitive};
use rtl_model::fixed::{Fixed, FixedArithmetic, FixedFormat, Overflow};
use rtl_model::float::{Flags, Rounding};

/// The integers of an oracle: 128-bit ones for formats up to 24 bits, big ones for all.
pub trait Integer:
    Clone + Ord + Signed + Euclid + FromPrimitive + ToPrimitive + fmt::Debug + Send + Sync
{
}

impl Integer for i128 {}
impl Integer for BigInt {}

/// The operators, with the distance of the shifts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    Reciprocal,
    Negate,
    Convert,
    ShiftLeft(u32),
    ShiftRight(u32),
}

impl Operator {
    pub const BINARY: [Operator; 4] = [Operator::Add, Operator::Sub, Operator::Mul, Operator::Div];
    pub const UNARY: [Operator; 3] = [Operator::Reciprocal, Operator::Negate, Operator::Convert];

    /// The model's answer.
    pub fn golden(self, arithmetic: FixedArithmetic, a: Fixed, b: Fixed) -> (u64, Flags) {
        let (result, flags) = match self {
            Operator::Add => arithmetic.add(a, b),
            Operator::Sub => arithmetic.sub(a, b),
            Operator::Mul => arithmetic.mul(a, b),
            Operator::Div => arithmetic.div(a, b),
            Operator::Reciprocal => arithmetic.reciprocal(a),
            Operator::Negate => arithmetic.negate(a),
            Operator::Convert => arithmetic.convert(a),
            Operator::ShiftLeft(places) => arithmetic.shift_left(a, places),
            Operator::ShiftRight(places) => arithmetic.shift_right(a, places),
        };
        assert_eq!(result.format, arithmetic.format);
        (result.bits, flags)
    }

    /// The exact result.
    pub fn exact<T: Integer>(self, a: Fixed, b: Fixed) -> Exact<T> {
        let (a, b) = (Ratio::of(a), Ratio::of(b));
        let one = Ratio {
            numerator: T::one(),
            denominator: T::one(),
        };
        match self {
            Operator::Add => Exact::Ratio(a.plus(b)),
            Operator::Sub => Exact::Ratio(a.plus(b.negated())),
            Operator::Mul => Exact::Ratio(Ratio {
                numerator: a.numerator * b.numerator,
                denominator: a.denominator * b.denominator,
            }),
            Operator::Div => a.over(b),
            Operator::Reciprocal => one.over(a),
            Operator::Negate => Exact::Ratio(a.negated()),
            Operator::Convert => Exact::Ratio(a),
            Operator::ShiftLeft(places) => Exact::Ratio(Ratio {
                numerator: a.numerator * power_of_two(places),
                ..a
            }),
            Operator::ShiftRight(places) => Exact::Ratio(Ratio {
                denominator: a.denominator * power_of_two(places),
                ..a
            }),
        }
    }
}

/// A ratio of integers, not in lowest terms; the denominator is above zero.
#[derive(Clone, Debug)]
pub struct Ratio<T> {
    pub numerator: T,
    pub denominator: T,
}

pub fn power_of_two<T: Integer>(places: u32) -> T {
    num_traits::pow(T::one() + T::one(), places as usize)
}

impl<T: Integer> Ratio<T> {
    pub fn of(number: Fixed) -> Ratio<T> {
        let unsigned = T::from_u64(number.bits).unwrap();
        let size = power_of_two(number.format.width());
        let negative = number.format.signed && unsigned.clone() + unsigned.clone() >= size;
        Ratio {
            numerator: if negative { unsigned - size } else { unsigned },
            denominator: power_of_two(number.format.fraction_bits),
        }
    }

    fn negated(self) -> Ratio<T> {
        Ratio {
            numerator: -self.numerator,
            ..self
        }
    }

    fn plus(self, b: Ratio<T>) -> Ratio<T> {
        Ratio {
            numerator: self.numerator * b.denominator.clone()
                + b.numerator * self.denominator.clone(),
            denominator: self.denominator * b.denominator,
        }
    }

    fn over(self, b: Ratio<T>) -> Exact<T> {
        if b.numerator.is_zero() {
            return if self.numerator.is_zero() {
                Exact::Undefined
            } else {
                Exact::Pole {
                    negative: self.numerator.is_negative(),
                }
            };
        }
        let sign = b.numerator.signum();
        Exact::Ratio(Ratio {
            numerator: self.numerator * b.denominator * sign,
            denominator: self.denominator * b.numerator.abs(),
        })
    }
}

/// The exact result of an operator.
#[derive(Clone, Debug)]
pub enum Exact<T> {
    Ratio(Ratio<T>),
    /// A nonzero number over zero.
    Pole {
        negative: bool,
    },
    /// Zero over zero.
    Undefined,
}

/// Where a wrong operator would look at the range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The contract.
    RoundThenRange,
    /// The exact result is saturated, then rounded, and what that carries beyond is cut off.
    RangeThenRound,
}

impl<T: Integer> Exact<T> {
    /// The word and the flags that the contract asks for, or what the wrong order gives.
    pub fn expected(&self, arithmetic: FixedArithmetic, order: Order) -> (u64, Flags) {
        let FixedArithmetic {
            format, rounding, ..
        } = arithmetic;
        let ratio = match self {
            Exact::Ratio(ratio) => ratio,
            Exact::Pole { negative } => {
                let end = if *negative {
                    format.min()
                } else {
                    format.max()
                };
                return (end, Flags::DIVIDE_BY_ZERO);
            }
            Exact::Undefined => return (0, Flags::INVALID),
        };
        let (least, most) = range::<T>(format);
        // In units of the result's last place.
        let numerator = ratio.numerator.clone() * power_of_two(format.fraction_bits);
        let denominator = ratio.denominator.clone();
        let below = numerator.div_euclid(&denominator);
        let remainder = numerator.rem_euclid(&denominator);
        let exact = remainder.is_zero();
        let above = if exact {
            below.clone()
        } else {
            below.clone() + T::one()
        };
        let rounded = match rounding {
            Rounding::Down => below,
            Rounding::Up => above,
            Rounding::TowardZero if numerator.is_negative() => above,
            Rounding::TowardZero => below,
            Rounding::NearestEven => {
                let twice = remainder.clone() + remainder;
                let two = T::one() + T::one();
                let below_is_even = below.rem_euclid(&two).is_zero();
                match twice.cmp(&denominator) {
                    std::cmp::Ordering::Less => below,
                    std::cmp::Ordering::Greater => above,
                    std::cmp::Ordering::Equal if below_is_even => below,
                    std::cmp::Ordering::Equal => above,
                }
            }
        };
        let overflows = match order {
            Order::RoundThenRange => rounded < least || rounded > most,
            // The integers around the exact result are looked at before it is rounded.
            Order::RangeThenRound => {
                numerator < least.clone() * denominator.clone()
                    || numerator >= (most.clone() + T::one()) * denominator
            }
        };
        let kept = match arithmetic.overflow {
            Overflow::Saturate if overflows && rounded < least => least,
            Overflow::Saturate if overflows && rounded > most => most,
            _ => rounded.rem_euclid(&power_of_two(format.width())),
        };
        let bits = kept.rem_euclid(&power_of_two(format.width()));
        let flags = Flags::INEXACT.when(!exact || overflows) | Flags::OVERFLOW.when(overflows);
        (bits.to_u64().unwrap(), flags)
    }
}

/// The least and the most units of a format.
fn range<T: Integer>(format: FixedFormat) -> (T, T) {
    if format.signed {
        let half: T = power_of_two(format.width() - 1);
        (-half.clone(), half - T::one())
    } else {
        (T::zero(), power_of_two::<T>(format.width()) - T::one())
    }
}

/// All roundings, saturating and wrapping.
pub fn every_arithmetic(format: FixedFormat) -> impl Iterator<Item = FixedArithmetic> {
    Rounding::ALL.into_iter().flat_map(move |rounding| {
        Overflow::ALL
            .into_iter()
            .map(move |overflow| FixedArithmetic::new(format, rounding, overflow))
    })
}

/// Where two answers differ.
#[derive(Debug)]
pub struct Mismatch {
    pub operator: Operator,
    pub arithmetic: FixedArithmetic,
    pub a: Fixed,
    pub b: Fixed,
    pub expected: (u64, Flags),
    pub got: (u64, Flags),
}

/// What answers in place of the model, in tests of the comparison itself.
pub type Answer = dyn Fn(Operator, FixedArithmetic, Fixed, Fixed) -> (u64, Flags) + Sync;

/// Compares an answer with what the contract asks for, in every rounding, saturating and wrapping;
/// how many were compared.
///
/// # Errors
/// The first difference.
pub fn compare<T: Integer>(
    answer: &Answer,
    operator: Operator,
    result: FixedFormat,
    a: Fixed,
    b: Fixed,
) -> Result<u64, Box<Mismatch>> {
    let exact = operator.exact::<T>(a, b);
    let mut compared = 0;
    for arithmetic in every_arithmetic(result) {
        let expected = exact.expected(arithmetic, Order::RoundThenRange);
        let got = answer(operator, arithmetic, a, b);
        if got != expected {
            return Err(Box::new(Mismatch {
                operator,
                arithmetic,
                a,
                b,
                expected,
                got,
            }));
        }
        compared += 1;
    }
    Ok(compared)
}
