//! The comparer: runs an implementation and the exact oracle on the same cases.

use std::cmp::Ordering;
use std::fmt;

use rayon::prelude::*;
use rtl_model::float::{
    Answer, Comparison, Flags, FloatFormat, IntegerFormat, Operation, Policy, Relation, Rounding,
    Word,
};

use super::exact;
use super::neighbours::Rules;
use super::operands::{self, Case};

/// An operator under test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    Operation(Operation),
    /// The first operand is the integer, the second the exponent, as two's complement.
    FromScaledInteger,
}

/// Every operation, conversions with several formats each.
pub fn subjects() -> Vec<Subject> {
    let integers = [
        IntegerFormat::I32,
        IntegerFormat::U32,
        IntegerFormat::I64,
        IntegerFormat::U64,
        IntegerFormat::signed(7),
        IntegerFormat::unsigned(1),
    ];
    let floats = [(4, 3), (5, 10), (8, 23), (2, 52), (11, 52)];
    let mut operations = Operation::PLAIN.to_vec();
    for comparison in Comparison::ALL {
        operations.extend(Relation::ALL.map(|relation| Operation::Compare(relation, comparison)));
    }
    for integer in integers {
        operations.push(Operation::FromInteger(integer));
        operations.push(Operation::ToInteger(integer));
        operations.push(Operation::ToIntegerExact(integer));
    }
    for (exponent_bits, fraction_bits) in floats {
        let other = FloatFormat::new(exponent_bits, fraction_bits);
        operations.push(Operation::ToFloat(other));
        operations.push(Operation::FromFloat(other));
    }
    let operations = operations.into_iter().map(Subject::Operation);
    operations.chain([Subject::FromScaledInteger]).collect()
}

impl Subject {
    /// How many operands it reads.
    pub fn operand_count(self, format: FloatFormat) -> usize {
        match self {
            Subject::Operation(operation) => operation.operands(format).len(),
            Subject::FromScaledInteger => 2,
        }
    }
}

/// The operators under test.
#[inline(always)]
pub fn implementation(subject: Subject, format: FloatFormat, case: Case) -> Answer {
    let arithmetic = format.arithmetic(case.policy, case.rounding);
    match subject {
        Subject::Operation(operation) => operation.evaluate(arithmetic, case.operands),
        Subject::FromScaledInteger => {
            let [value, exponent, _] = case.operands;
            arithmetic.from_scaled_integer(value as i64, exponent as i64)
        }
    }
}

/// What must come out.
pub fn oracle(subject: Subject, format: FloatFormat, case: Case) -> (u64, Flags) {
    let rules = Rules {
        format,
        policy: case.policy,
        rounding: case.rounding,
    };
    let [a, b, c] = case.operands;
    let Subject::Operation(operation) = subject else {
        return exact::from_scaled_integer(rules, i128::from(a as i64), b as i64);
    };
    match operation {
        Operation::Add => exact::add(rules, a, b),
        Operation::Subtract => exact::sub(rules, a, b),
        Operation::Multiply => exact::mul(rules, a, b),
        Operation::Divide => exact::div(rules, a, b),
        Operation::SquareRoot => exact::sqrt(rules, a),
        Operation::FusedMultiplyAdd => exact::fused_multiply_add(rules, a, b, c),
        Operation::Minimum => exact::extreme(rules, Ordering::Less, a, b),
        Operation::Maximum => exact::extreme(rules, Ordering::Greater, a, b),
        Operation::Compare(relation, comparison) => {
            exact::relation(rules, relation, comparison, a, b)
        }
        Operation::RoundToIntegral => exact::round_to_integral(rules, false, a),
        Operation::RoundToIntegralExact => exact::round_to_integral(rules, true, a),
        Operation::Floor => exact::floor(rules, a),
        Operation::ToInteger(target) => exact::to_integer(rules, target, false, a),
        Operation::ToIntegerExact(target) => exact::to_integer(rules, target, true, a),
        Operation::FromInteger(source) => exact::from_integer(rules, source, a),
        Operation::ToFloat(target) => exact::convert(rules, target, a),
        Operation::FromFloat(source) => {
            let rules = Rules {
                format: source,
                ..rules
            };
            exact::convert(rules, format, a)
        }
    }
}

/// One disagreement, with all that is needed to see it again.
#[derive(Debug)]
pub struct Mismatch {
    pub subject: Subject,
    pub format: FloatFormat,
    pub case: Case,
    pub seed: u64,
    pub index: u64,
    pub actual: Answer,
    pub expected: (u64, Flags),
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.subject {
            Subject::Operation(operation) => operation.to_string(),
            Subject::FromScaledInteger => "from_scaled_integer".to_owned(),
        };
        write!(
            f,
            "{name} {} {} {} of {:x?} gives {:x} and {}, must give {:x} and {} (seed {:#x}, \
             index {})",
            self.format,
            self.case.rounding,
            self.case.policy,
            self.case.operands,
            self.actual.bits,
            self.actual.flags,
            self.expected.0,
            self.expected.1,
            self.seed,
            self.index
        )
    }
}

/// Runs `count` cases, random and hard ones mixed, on all cores. The first mismatch found, if any.
pub fn search(
    subject: Subject,
    format: FloatFormat,
    seed: u64,
    count: u64,
    unit_under_test: impl Fn(Subject, FloatFormat, Case) -> Answer + Sync,
) -> Option<Mismatch> {
    (0..count).into_par_iter().find_map_any(|index| {
        let case = operands::case(subject, format, seed, index);
        check(subject, format, case, seed, index, &unit_under_test)
    })
}

/// Every operand, or operand pair, of a small format under every rounding and policy; third
/// operands and the integers of conversions are drawn. Patterns double as the integers and
/// exponents of `FromScaledInteger`, sign-extended.
pub fn search_all_pairs(
    subject: Subject,
    format: FloatFormat,
    unit_under_test: impl Fn(Subject, FloatFormat, Case) -> Answer + Sync,
) -> Option<Mismatch> {
    let width = format.width();
    let patterns = 1u64 << width;
    let widths: Vec<u32> = match subject {
        Subject::FromScaledInteger => vec![],
        Subject::Operation(operation) => {
            let operands = operation.operands(format);
            operands.into_iter().map(Word::width).collect()
        }
    };
    let operand = |place: usize, pattern: u64| match (subject, widths.get(place)) {
        (Subject::FromScaledInteger, _) => {
            ((pattern << (64 - width)) as i64 >> (64 - width)) as u64
        }
        (_, Some(width)) => pattern & (u64::MAX >> (64 - width)),
        (_, None) => 0,
    };
    let cases = if subject.operand_count(format) == 1 {
        patterns
    } else {
        patterns * patterns
    };
    (0..cases).into_par_iter().find_map_any(|index| {
        let third = operands::Random::new(0, index).next() >> (64 - width);
        Policy::ALL.into_iter().find_map(|policy| {
            Rounding::ALL.into_iter().find_map(|rounding| {
                let case = Case {
                    policy,
                    rounding,
                    operands: [
                        operand(0, index % patterns),
                        operand(1, index / patterns),
                        third,
                    ],
                };
                check(subject, format, case, 0, index, &unit_under_test)
            })
        })
    })
}

#[inline(always)]
pub fn check(
    subject: Subject,
    format: FloatFormat,
    case: Case,
    seed: u64,
    index: u64,
    unit_under_test: &impl Fn(Subject, FloatFormat, Case) -> Answer,
) -> Option<Mismatch> {
    let actual = unit_under_test(subject, format, case);
    let expected = oracle(subject, format, case);
    ((actual.bits, actual.flags) != expected).then_some(Mismatch {
        subject,
        format,
        case,
        seed,
        index,
        actual,
        expected,
    })
}
