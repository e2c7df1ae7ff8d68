//! The float operators against exact results in big integers, correctly rounded, and the flags
//! against their definitions.
//!
//! All roundings and both policies: a million random and hard cases an operator at e7f16 (a quarter
//! of that for comparisons and conversions); every pair of operands at e4f3 and at the smallest
//! formats; every format there is. `STEPWELL_FLOAT_CASES` sets another number of cases an operator
//! at e7f16, for long runs.

mod float_oracle;

use std::path::Path;

use float_oracle::compare::{
    Subject, check, implementation, oracle, search, search_all_pairs, subjects,
};
use float_oracle::counter_examples;
use float_oracle::operands::{self, Case};
use rayon::prelude::*;
use rtl_model::float::{
    Answer, Flags, FloatFormat, Operation, Policy, Rounding, SUPPORTED_FORMATS, ToIntegerError,
};

const SEED: u64 = 0x57e9_0e11;

const ARITHMETIC: [Operation; 6] = [
    Operation::Add,
    Operation::Subtract,
    Operation::Multiply,
    Operation::Divide,
    Operation::SquareRoot,
    Operation::FusedMultiplyAdd,
];

fn cases() -> u64 {
    match std::env::var("STEPWELL_FLOAT_CASES") {
        Ok(text) => text.parse().expect("STEPWELL_FLOAT_CASES is a number"),
        Err(_) => 1_000_000,
    }
}

fn agree_at_e7f16(subject: Subject, count: u64) {
    // The constant format, so that the code under test is what a fixed datapath compiles to.
    let found = search(
        subject,
        FloatFormat::E7F16,
        SEED,
        count,
        |subject, _, case| implementation(subject, FloatFormat::E7F16, case),
    );
    if let Some(mismatch) = found {
        panic!("{mismatch}");
    }
}

fn is_arithmetic(subject: Subject) -> bool {
    ARITHMETIC.map(Subject::Operation).contains(&subject)
}

#[test]
fn arithmetic_is_exactly_rounded() {
    for operation in ARITHMETIC {
        agree_at_e7f16(Subject::Operation(operation), cases());
    }
}

#[test]
fn comparisons_and_conversions_are_exact() {
    for subject in subjects() {
        if !is_arithmetic(subject) {
            agree_at_e7f16(subject, cases() / 4);
        }
    }
}

/// Some have next to no exponents, or more fraction bits than exponents: there the range ends
/// inside every alignment and below the integers.
#[test]
fn every_pair_of_small_operands_agrees() {
    let mut formats = 0;
    for supported in SUPPORTED_FORMATS {
        let format = supported.format;
        if !supported.is_exhaustive || format.width() > 8 {
            continue;
        }
        for subject in subjects() {
            if let Some(mismatch) = search_all_pairs(subject, format, implementation) {
                panic!("{mismatch}");
            }
        }
        formats += 1;
    }
    assert_eq!(formats, 6);
}

/// Every operand of the operators with one, and a part of the pairs.
#[test]
fn ten_bits_agree() {
    let format = FloatFormat::new(4, 5);
    for subject in subjects() {
        let found = if subject.operand_count(format) == 1 {
            search_all_pairs(subject, format, implementation)
        } else {
            search(subject, format, SEED, cases() / 10, implementation)
        };
        if let Some(mismatch) = found {
            panic!("{mismatch}");
        }
    }
}

#[test]
fn every_format_agrees() {
    let formats: Vec<FloatFormat> = FloatFormat::EXPONENT_BITS
        .flat_map(|e| FloatFormat::FRACTION_BITS.map(move |f| FloatFormat::new(e, f)))
        .collect();
    assert_eq!(formats.len(), 510);
    let subjects = subjects();
    formats.par_iter().for_each(|&format| {
        for &subject in &subjects {
            let count = if is_arithmetic(subject) { 1_000 } else { 100 };
            if let Some(mismatch) = search(subject, format, SEED, count, implementation) {
                panic!("{mismatch}");
            }
        }
    });
}

/// What was found wrong once is tried for ever.
#[test]
fn counter_examples_hold() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/counter_examples");
    let examples = counter_examples::read(&folder);
    assert!(examples.len() >= 10, "only {} examples", examples.len());
    for example in examples {
        let found = check(
            Subject::Operation(example.operation),
            example.format,
            example.case,
            0,
            0,
            &implementation,
        );
        if let Some(mismatch) = found {
            panic!("{}: {mismatch}", example.name);
        }
        let answer = oracle(
            Subject::Operation(example.operation),
            example.format,
            example.case,
        );
        assert_eq!(answer, example.answer, "{}: the oracle", example.name);
    }
}

/// The operators of `FloatFormat` are those of the arithmetic under the policy `flush`.
#[test]
fn shorthands_are_the_operators_under_flush() {
    let format = FloatFormat::E7F16;
    for index in 0..100_000 {
        let case = operands::case(Subject::Operation(Operation::Add), format, SEED, index);
        let (rounding, [a, b, _]) = (case.rounding, case.operands);
        let flush = format.arithmetic(Policy::Flush, rounding);
        assert_eq!(format.add(rounding, a, b), flush.add(a, b).bits);
        assert_eq!(format.sub(rounding, a, b), flush.sub(a, b).bits);
        assert_eq!(format.mul(rounding, a, b), flush.mul(a, b).bits);
        assert_eq!(format.div(rounding, a, b), flush.div(a, b).bits);
        assert_eq!(format.min(a, b), flush.min(a, b).bits);
        assert_eq!(format.max(a, b), flush.max(a, b).bits);
        assert_eq!(format.floor(a), flush.floor(a).bits);
        let quiet = rtl_model::float::Comparison::Quiet;
        assert_eq!(format.less_than(a, b), flush.less_than(quiet, a, b).0);
        assert_eq!(format.less_equal(a, b), flush.less_equal(quiet, a, b).0);
        assert_eq!(format.equal(a, b), flush.equal(quiet, a, b).0);
        assert_eq!(format.compare(a, b), flush.compare(quiet, a, b).0);
        let integer = format.to_integer(rounding, a);
        let answer = flush.to_integer(rtl_model::float::IntegerFormat::I64, a);
        assert_eq!(integer.is_err(), answer.flags.contains(Flags::INVALID));
        assert_eq!(
            integer.unwrap_or_else(ToIntegerError::saturated),
            answer.bits as i64
        );
    }
}

/// Conversion from and to `f64` in every policy, by way of the exact oracle: an `f64` is a number of
/// the format e11f52.
#[test]
fn f64_conversions_are_exactly_rounded() {
    let wide = FloatFormat::new(11, 52);
    for (exponent_bits, fraction_bits) in [(7, 16), (4, 3), (11, 52), (11, 20), (2, 52), (8, 23)] {
        let format = FloatFormat::new(exponent_bits, fraction_bits);
        let subject = Subject::Operation(Operation::FromFloat(wide));
        (0..50_000u64).into_par_iter().for_each(|index| {
            let case = Case {
                policy: Policy::Full,
                ..operands::case(subject, format, SEED, index)
            };
            let value = f64::from_bits(case.operands[0]);
            let full = format.arithmetic(Policy::Full, case.rounding);
            let expected = oracle(subject, format, case);
            let actual = full.from_f64(value);
            assert_eq!(
                (actual.bits, actual.flags),
                expected,
                "{format} {} {value:e}",
                case.rounding
            );
            // Back: exact, so that the format reads the same number.
            let back = full.to_f64(actual.bits);
            assert_eq!(full.from_f64(back).bits, actual.bits);
            // Under `flush` the host's subnormal numbers are read, and ours are not written.
            let flushed = format.from_f64(case.rounding, value);
            if actual.flags.contains(Flags::UNDERFLOW) {
                assert_eq!(flushed & !format.sign_bit(), 0);
            } else if format.canonical(actual.bits) == actual.bits {
                assert_eq!(flushed, actual.bits, "{format} {value:e}");
            }
        });
    }
}

/// Every operator with its lowest result bit, and with each flag, flipped on one case in 256.
#[test]
fn the_comparer_sees_a_flipped_bit() {
    for subject in subjects() {
        for bit in 0..=Flags::WIDTH {
            let found = search(
                subject,
                FloatFormat::E7F16,
                SEED,
                3_000,
                |subject, format, case| {
                    let answer = implementation(subject, format, case);
                    let [a, b, _] = case.operands;
                    if (a ^ b.rotate_left(7)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 56 != 0 {
                        return answer;
                    }
                    let Some(flag) = bit.checked_sub(1) else {
                        return Answer {
                            bits: answer.bits ^ 1,
                            ..answer
                        };
                    };
                    Answer {
                        flags: Flags::from_bits(answer.flags.bits() ^ 1 << flag),
                        ..answer
                    }
                },
            );
            let mismatch = found.unwrap_or_else(|| panic!("a fault in {subject:?} was not seen"));
            assert_eq!(mismatch.subject, subject);
            assert!(mismatch.to_string().contains("index"), "{mismatch}");
        }
    }
}

/// A rounding in place of another, for every pair of roundings and every operator that rounds; and
/// a policy in place of the other.
#[test]
fn the_comparer_sees_a_wrong_rounding_or_policy() {
    let format = FloatFormat::E7F16;
    let other = FloatFormat::new(5, 10);
    let integer = rtl_model::float::IntegerFormat::I64;
    let mut rounded: Vec<Subject> = ARITHMETIC.map(Subject::Operation).to_vec();
    rounded.extend(
        [
            Operation::ToInteger(integer),
            Operation::FromInteger(integer),
            Operation::ToFloat(other),
            Operation::RoundToIntegral,
        ]
        .map(Subject::Operation),
    );
    rounded.push(Subject::FromScaledInteger);
    for subject in rounded {
        for right in Rounding::ALL {
            for wrong in Rounding::ALL.into_iter().filter(|&wrong| wrong != right) {
                // A square root is never negative: two of the roundings are one.
                let downward = [Rounding::TowardZero, Rounding::Down];
                let is_root = subject == Subject::Operation(Operation::SquareRoot);
                if is_root && downward.contains(&right) && downward.contains(&wrong) {
                    continue;
                }
                let found = search(subject, format, SEED, 20_000, |subject, format, case| {
                    let rounding = if case.rounding == right {
                        wrong
                    } else {
                        case.rounding
                    };
                    implementation(subject, format, Case { rounding, ..case })
                });
                assert!(
                    found.is_some(),
                    "{wrong} in place of {right} in {subject:?} was not seen"
                );
            }
        }
        if subject == Subject::Operation(Operation::FromInteger(integer)) {
            continue;
        }
        for right in Policy::ALL {
            let found = search(subject, format, SEED, 50_000, |subject, format, case| {
                let policy = if case.policy == right {
                    Policy::ALL[usize::from(right == Policy::Flush)]
                } else {
                    case.policy
                };
                implementation(subject, format, Case { policy, ..case })
            });
            let same = matches!(
                subject,
                Subject::Operation(Operation::ToInteger(_) | Operation::RoundToIntegral)
            );
            assert!(
                found.is_some() || same,
                "{subject:?} under {right} in disguise"
            );
        }
    }
}

/// Underflow as if tininess were detected before rounding, under `full`, and nothing else. (A
/// quotient never rounds up to a power of two, and a sum below the normal numbers is exact: there
/// the two are the same.)
#[test]
fn the_comparer_sees_tininess_before_rounding() {
    for operation in [Operation::Multiply, Operation::FusedMultiplyAdd] {
        let found = search(
            Subject::Operation(operation),
            FloatFormat::E4F3,
            SEED,
            200_000,
            |subject, format, case| {
                let answer = implementation(subject, format, case);
                let became_normal = answer.bits & !format.sign_bit() == format.min_normal();
                let toward_zero = Case {
                    rounding: Rounding::TowardZero,
                    ..case
                };
                let below = implementation(subject, format, toward_zero).bits;
                let was_below = below & !format.sign_bit() < format.min_normal();
                let before = case.policy == Policy::Full && became_normal && was_below;
                Answer {
                    flags: answer.flags | Flags::UNDERFLOW.when(before),
                    ..answer
                }
            },
        );
        assert!(found.is_some(), "tininess in {operation} was not seen");
    }
}

/// A tie broken the wrong way (up in magnitude instead of to even), and nothing else.
#[test]
fn the_comparer_sees_a_wrong_tie() {
    for operation in [
        Operation::Add,
        Operation::Subtract,
        Operation::Multiply,
        Operation::FusedMultiplyAdd,
    ] {
        let found = search(
            Subject::Operation(operation),
            FloatFormat::E4F3,
            SEED,
            200_000,
            |subject, format, case| {
                let under = |rounding| implementation(subject, format, Case { rounding, ..case });
                let nearest = implementation(subject, format, case);
                let (down, up) = (under(Rounding::Down), under(Rounding::Up));
                // Where an exact wider result lies halfway, nearest-even took the even one.
                let full = format.arithmetic(Policy::Full, Rounding::NearestEven);
                let [a, b, c] = case.operands.map(|operand| full.to_f64(operand));
                let exact = match operation {
                    Operation::Add => a + b,
                    Operation::Subtract => a - b,
                    Operation::Multiply => a * b,
                    _ => a * b + c,
                };
                let tie = exact - full.to_f64(down.bits) == full.to_f64(up.bits) - exact;
                let flip = case.rounding == Rounding::NearestEven && down.bits != up.bits && tie;
                match (flip, nearest.bits == down.bits) {
                    (true, true) => up,
                    (true, false) => down,
                    _ => nearest,
                }
            },
        );
        assert!(found.is_some(), "a wrong tie in {operation} was not seen");
    }
}
