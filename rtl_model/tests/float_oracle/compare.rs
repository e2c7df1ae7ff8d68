//! The comparer: runs an implementation and the exact oracle on the same cases.

use std::cmp::Ordering;
use std::fmt;

use rayon::prelude::*;
use rtl_model::float::{FloatFormat, Rounding, ToIntegerError};

use super::exact;
use super::operands::{self, Case};

/// An operator under test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    Add,
    Sub,
    Mul,
    Div,
    LessThan,
    LessEqual,
    Equal,
    Compare,
    Min,
    Max,
    /// `a` is the integer, `b` the exponent, as two's complement.
    FromInteger,
    /// `b` is not used.
    ToInteger,
    /// `b` is not used.
    Floor,
}

impl Operation {
    pub const ALL: [Operation; 13] = [
        Operation::Add,
        Operation::Sub,
        Operation::Mul,
        Operation::Div,
        Operation::LessThan,
        Operation::LessEqual,
        Operation::Equal,
        Operation::Compare,
        Operation::Min,
        Operation::Max,
        Operation::FromInteger,
        Operation::ToInteger,
        Operation::Floor,
    ];
}

/// A result of any operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Pattern(u64),
    Truth(bool),
    Order(Option<Ordering>),
    /// An integer, or the side it is out of range on, `None` for NaN.
    Integer(Result<i64, Option<Ordering>>),
}

/// The operators under test.
#[inline(always)]
pub fn implementation(operation: Operation, format: FloatFormat, case: Case) -> Outcome {
    use Outcome::{Integer, Order, Pattern, Truth};
    let Case { rounding, a, b } = case;
    match operation {
        Operation::Add => Pattern(format.add(rounding, a, b)),
        Operation::Sub => Pattern(format.sub(rounding, a, b)),
        Operation::Mul => Pattern(format.mul(rounding, a, b)),
        Operation::Div => Pattern(format.div(rounding, a, b)),
        Operation::LessThan => Truth(format.less_than(a, b)),
        Operation::LessEqual => Truth(format.less_equal(a, b)),
        Operation::Equal => Truth(format.equal(a, b)),
        Operation::Compare => Order(format.compare(a, b)),
        Operation::Min => Pattern(format.min(a, b)),
        Operation::Max => Pattern(format.max(a, b)),
        Operation::FromInteger => Pattern(format.from_integer(rounding, a as i64, b as i64)),
        Operation::ToInteger => {
            Integer(format.to_integer(rounding, a).map_err(|error| match error {
                ToIntegerError::NotANumber => None,
                ToIntegerError::AboveRange => Some(Ordering::Greater),
                ToIntegerError::BelowRange => Some(Ordering::Less),
            }))
        }
        Operation::Floor => Pattern(format.floor(a)),
    }
}

/// What must come out.
pub fn oracle(operation: Operation, format: FloatFormat, case: Case) -> Outcome {
    use Outcome::{Integer, Order, Pattern, Truth};
    let Case { rounding, a, b } = case;
    match operation {
        Operation::Add => Pattern(exact::add(format, rounding, a, b)),
        Operation::Sub => Pattern(exact::sub(format, rounding, a, b)),
        Operation::Mul => Pattern(exact::mul(format, rounding, a, b)),
        Operation::Div => Pattern(exact::div(format, rounding, a, b)),
        Operation::LessThan => Truth(exact::compare(format, a, b) == Some(Ordering::Less)),
        Operation::LessEqual => Truth(matches!(
            exact::compare(format, a, b),
            Some(Ordering::Less | Ordering::Equal)
        )),
        Operation::Equal => Truth(exact::compare(format, a, b) == Some(Ordering::Equal)),
        Operation::Compare => Order(exact::compare(format, a, b)),
        Operation::Min => Pattern(exact::extreme(format, Ordering::Less, a, b)),
        Operation::Max => Pattern(exact::extreme(format, Ordering::Greater, a, b)),
        Operation::FromInteger => {
            Pattern(exact::from_integer(format, rounding, a as i64, b as i64))
        }
        Operation::ToInteger => Integer(exact::to_integer(format, rounding, a)),
        Operation::Floor => Pattern(exact::floor(format, a)),
    }
}

/// One disagreement, with all that is needed to see it again.
#[derive(Debug)]
pub struct Mismatch {
    pub operation: Operation,
    pub format: FloatFormat,
    pub case: Case,
    pub seed: u64,
    pub index: u64,
    pub actual: Outcome,
    pub expected: Outcome,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:?} in {} with {}: a = {:#x}, b = {:#x} gives {:x?}, must give {:x?} \
             (seed {:#x}, index {})",
            self.operation,
            self.format,
            self.case.rounding,
            self.case.a,
            self.case.b,
            self.actual,
            self.expected,
            self.seed,
            self.index
        )
    }
}

/// Runs `count` cases, random and hard ones mixed, on all cores. The first mismatch found, if any.
pub fn search(
    operation: Operation,
    format: FloatFormat,
    seed: u64,
    count: u64,
    unit_under_test: impl Fn(Operation, FloatFormat, Case) -> Outcome + Sync,
) -> Option<Mismatch> {
    (0..count).into_par_iter().find_map_any(|index| {
        let case = operands::case(operation, format, seed, index);
        check(operation, format, case, seed, index, &unit_under_test)
    })
}

/// Every operand pair of a small format under every rounding; patterns double as the integers and
/// exponents of `FromInteger`, sign-extended.
pub fn search_all_pairs(
    operation: Operation,
    format: FloatFormat,
    unit_under_test: impl Fn(Operation, FloatFormat, Case) -> Outcome + Sync,
) -> Option<Mismatch> {
    let width = format.width();
    let patterns = 1u64 << width;
    let operand = |pattern: u64| match operation {
        Operation::FromInteger => ((pattern << (64 - width)) as i64 >> (64 - width)) as u64,
        _ => pattern,
    };
    (0..patterns * patterns)
        .into_par_iter()
        .find_map_any(|index| {
            Rounding::ALL.into_iter().find_map(|rounding| {
                let case = Case {
                    rounding,
                    a: operand(index / patterns),
                    b: operand(index % patterns),
                };
                check(operation, format, case, 0, index, &unit_under_test)
            })
        })
}

#[inline(always)]
fn check(
    operation: Operation,
    format: FloatFormat,
    case: Case,
    seed: u64,
    index: u64,
    unit_under_test: &impl Fn(Operation, FloatFormat, Case) -> Outcome,
) -> Option<Mismatch> {
    let actual = unit_under_test(operation, format, case);
    let expected = oracle(operation, format, case);
    (actual != expected).then_some(Mismatch {
        operation,
        format,
        case,
        seed,
        index,
        actual,
        expected,
    })
}
