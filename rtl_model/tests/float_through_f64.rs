//! The two golden routes against each other: integer arithmetic on bits, and one operation in `f64`
//! followed by one rounding. And the slices, which take the second.
//!
//! Two million pairs an operator at e7f16, random and hard ones, under both policies and all
//! roundings; `STEPWELL_FLOAT_CASES` sets another number, for long runs. Every pair at four small
//! formats; every format that the second route serves.

mod float_oracle;

use float_oracle::compare::Subject;
use float_oracle::operands::{Case, Random, case};
use rayon::prelude::*;
use rtl_model::float::slices::{self, Operator};
use rtl_model::float::{FloatFormat, Operation, Policy, Rounding};
use rtl_model::instruction_set::InstructionSet;

const SEED: u64 = 0x2f64_0001;

/// What the second route has.
const OPERATIONS: [Operation; 5] = [
    Operation::Add,
    Operation::Subtract,
    Operation::Multiply,
    Operation::Divide,
    Operation::SquareRoot,
];

fn cases() -> u64 {
    match std::env::var("STEPWELL_FLOAT_CASES") {
        Ok(text) => text.parse().expect("STEPWELL_FLOAT_CASES is a number"),
        Err(_) => 2_000_000,
    }
}

#[inline(always)]
fn first_route(operation: Operation, format: FloatFormat, case: Case) -> u64 {
    let arithmetic = format.arithmetic(case.policy, case.rounding);
    operation.evaluate(arithmetic, case.operands).bits
}

#[inline(always)]
fn second_route(operation: Operation, format: FloatFormat, case: Case) -> u64 {
    let arithmetic = format.arithmetic(case.policy, case.rounding).through_f64();
    let arithmetic = arithmetic.expect("at most 25 significant bits");
    let [a, b, _] = case.operands;
    match operation {
        Operation::Add => arithmetic.add(a, b),
        Operation::Subtract => arithmetic.sub(a, b),
        Operation::Multiply => arithmetic.mul(a, b),
        Operation::Divide => arithmetic.div(a, b),
        Operation::SquareRoot => arithmetic.sqrt(a),
        other => unreachable!("{other} is not one of the second route's"),
    }
}

/// A case on which the two differ, if one is found.
fn search(
    operation: Operation,
    format: FloatFormat,
    count: u64,
    second: impl Fn(Operation, FloatFormat, Case) -> u64 + Sync,
) -> Option<String> {
    (0..count).into_par_iter().find_map_any(|index| {
        let case = case(Subject::Operation(operation), format, SEED, index);
        difference(operation, format, case, &second)
    })
}

#[inline(always)]
fn difference(
    operation: Operation,
    format: FloatFormat,
    case: Case,
    second: impl Fn(Operation, FloatFormat, Case) -> u64,
) -> Option<String> {
    let (first, second) = (
        first_route(operation, format, case),
        second(operation, format, case),
    );
    (first != second).then(|| {
        format!("{operation} {format} {case:x?}: by integers {first:x}, through f64 {second:x}")
    })
}

#[test]
fn the_routes_agree_at_e7f16() {
    for operation in OPERATIONS {
        let found = search(operation, FloatFormat::E7F16, cases(), second_route);
        assert_eq!(found, None);
    }
}

#[test]
fn the_routes_agree_on_every_pair_of_small_formats() {
    let mut compared = 0;
    for (exponent_bits, fraction_bits) in [(4, 3), (3, 4), (5, 2), (4, 5)] {
        let format = FloatFormat::new(exponent_bits, fraction_bits);
        let patterns = 1_u64 << format.width();
        for operation in OPERATIONS {
            let found = (0..patterns * patterns)
                .into_par_iter()
                .find_map_any(|pair| {
                    let operands = [pair % patterns, pair / patterns, 0];
                    Policy::ALL.into_iter().find_map(|policy| {
                        Rounding::ALL.into_iter().find_map(|rounding| {
                            let case = Case {
                                policy,
                                rounding,
                                operands,
                            };
                            difference(operation, format, case, second_route)
                        })
                    })
                });
            assert_eq!(found, None);
            compared += patterns * patterns * 8;
        }
    }
    assert_eq!(compared, (3 * (1 << 16) + (1 << 20)) * 8 * 5);
}

#[test]
fn the_routes_agree_in_every_format_served() {
    let formats: Vec<FloatFormat> = (2..=11)
        .flat_map(|e| (2..=24).map(move |f| FloatFormat::new(e, f)))
        .collect();
    formats.par_iter().for_each(|&format| {
        for operation in OPERATIONS {
            let found = search(operation, format, 3_000, second_route);
            assert_eq!(found, None);
        }
    });
    let wider = FloatFormat::new(8, 25).arithmetic(Policy::Full, Rounding::Up);
    assert!(wider.through_f64().is_none());
}

/// What a sum would be without the error term: the cases must be hard enough to tell.
#[test]
fn a_sum_that_forgets_its_error_is_found() {
    let forgetful = |_: Operation, format: FloatFormat, case: Case| {
        let [a, b, _] = case.operands.map(|operand| format.to_f64(operand));
        format.from_f64(case.rounding, a + b)
    };
    for rounding in [Rounding::TowardZero, Rounding::Up, Rounding::Down] {
        let wrong = (0..200_000).find(|&index| {
            let format = FloatFormat::E7F16;
            let mut case = case(Subject::Operation(Operation::Add), format, SEED, index);
            case.policy = Policy::Flush;
            let is_zero = first_route(Operation::Add, format, case) & 0x7f_ffff == 0;
            case.rounding == rounding
                && !is_zero
                && difference(Operation::Add, format, case, forgetful).is_some()
        });
        assert!(wrong.is_some(), "{rounding}");
    }
}

/// Patterns of every kind: anything, specials, near one another.
fn operands(count: usize) -> (Vec<u32>, Vec<u32>) {
    (0..count as u64)
        .map(|index| {
            let mut random = Random::new(SEED, index);
            if random.below(2) == 0 {
                // Bits above the width are not read.
                (random.next() as u32, random.next() as u32)
            } else {
                let case = case(
                    Subject::Operation(Operation::Add),
                    FloatFormat::E7F16,
                    1,
                    index,
                );
                (case.operands[0] as u32, case.operands[1] as u32)
            }
        })
        .unzip()
}

#[test]
fn slices_have_the_bits_of_single_operations() {
    let (a, b) = operands(200_003);
    for operator in Operator::ALL {
        let operation = match operator {
            Operator::Add => Operation::Add,
            Operator::Subtract => Operation::Subtract,
            Operator::Multiply => Operation::Multiply,
            Operator::Divide => Operation::Divide,
        };
        for rounding in Rounding::ALL {
            let expected = |(&a, &b): (&u32, &u32)| {
                let case = Case {
                    policy: Policy::Flush,
                    rounding,
                    operands: [u64::from(a), u64::from(b), 0],
                };
                first_route(operation, FloatFormat::E7F16, case) as u32
            };
            let expected: Vec<u32> = a.iter().zip(&b).map(expected).collect();
            for instruction_set in InstructionSet::ALL {
                let mut results = vec![u32::MAX; a.len()];
                slices::evaluate(instruction_set, operator, rounding, &a, &b, &mut results);
                let wrong = (0..a.len()).find(|&place| results[place] != expected[place]);
                assert_eq!(
                    wrong.map(|place| (a[place], b[place], results[place], expected[place])),
                    None,
                    "{operator:?} {rounding} {instruction_set}"
                );
            }
        }
    }
}

#[test]
#[should_panic(expected = "slices of 2, 1 and 2 numbers")]
fn slices_are_of_one_length() {
    slices::add(Rounding::Up, &[0; 2], &[0; 1], &mut [0; 2]);
}
