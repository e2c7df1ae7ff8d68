//! A slice of the campaign against SoftFloat, and faults that it catches.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use campaigns::cases::named_cases;
use campaigns::formats::{BFLOAT16, HALF, SINGLE};
use campaigns::softfloat::{Judge, compare, compare_with, judged_operations};
use rtl_model::float::{
    Answer, Flags, FloatArithmetic, FloatFormat, IntegerFormat, Operation, Policy, Rounding,
};

const CASES: u64 = 100_000;

fn formats() -> [(FloatFormat, Policy); 5] {
    [
        (HALF, Policy::Full),
        (BFLOAT16, Policy::Full),
        (SINGLE, Policy::Full),
        (FloatFormat::E7F16, Policy::Full),
        (FloatFormat::E7F16, Policy::Flush),
    ]
}

fn agree(arithmetic: FloatArithmetic, operation: Operation) {
    let (outcome, exhaustive) = compare(arithmetic, operation, CASES, 3, &|_| {});
    let expected = if exhaustive { 1 << 16 } else { CASES };
    assert_eq!(outcome.cases, expected, "{operation} {arithmetic:?}");
    assert_eq!(outcome.first, [], "{operation} {arithmetic:?}");
    assert_eq!(outcome.differences, 0);
}

#[test]
fn the_golden_arithmetic_is_softfloats() {
    for (format, policy) in formats() {
        let target = if format == HALF { SINGLE } else { HALF };
        for operation in judged_operations(&[target]) {
            for rounding in Rounding::ALL {
                agree(format.arithmetic(policy, rounding), operation);
            }
        }
    }
}

#[test]
fn named_cases_are_answered_as_kept_by_both() {
    let cases = named_cases().unwrap();
    assert!(cases.len() >= 16);
    for case in cases {
        let golden = case.operation.evaluate(case.arithmetic, case.operands);
        assert_eq!(golden, case.answer, "{}: golden", case.name);
        let judged = Judge::new(case.arithmetic).answer(case.operation, case.operands);
        assert_eq!(judged, case.answer, "{}: SoftFloat", case.name);
    }
}

/// The judge through 64-bit floats is held against SoftFloat's own formats.
#[test]
fn both_routes_through_softfloat_agree() {
    for format in [HALF, SINGLE] {
        for operation in [
            Operation::Add,
            Operation::Multiply,
            Operation::Divide,
            Operation::SquareRoot,
            Operation::FusedMultiplyAdd,
        ] {
            for rounding in Rounding::ALL {
                let arithmetic = format.arithmetic(Policy::Full, rounding);
                let through = Judge::ThroughF64(arithmetic);
                let differs = |answer: Answer, set| {
                    let other = through.answer(operation, set);
                    if other == answer { answer } else { other }
                };
                let (outcome, _) = compare_with(arithmetic, operation, CASES, 5, &|_| {}, differs);
                assert_eq!(outcome.first, [], "{operation} {arithmetic:?}");
            }
        }
    }
}

#[test]
fn a_wrong_golden_model_is_caught() {
    let nearest = SINGLE.arithmetic(Policy::Full, Rounding::NearestEven);
    let caught = |operation, alter: fn(Answer, [u64; 3]) -> Answer| {
        let (outcome, _) = compare_with(nearest, operation, CASES, 3, &|_| {}, alter);
        assert!(outcome.differences > 0, "{operation}");
        assert!(!outcome.first.is_empty());
        outcome
    };
    // Ties away from zero: one bit, in ties only.
    let ties = caught(Operation::Add, |answer, set| {
        let nearest = SINGLE;
        let [down, up] = [Rounding::Down, Rounding::Up].map(|rounding| {
            nearest
                .arithmetic(Policy::Full, rounding)
                .add(set[0], set[1])
                .bits
        });
        let wide = FloatFormat::new(8, 24).arithmetic(Policy::Full, Rounding::Down);
        let tie = down != up && wide.add(set[0] << 1, set[1] << 1).flags == Flags::NONE;
        Answer {
            bits: if tie { down.max(up) } else { answer.bits },
            ..answer
        }
    });
    assert!(ties.differences < CASES / 4, "{}", ties.differences);
    // A flag that is never raised.
    caught(Operation::Multiply, |answer, _| Answer {
        flags: Flags::from_bits(answer.flags.bits() & !Flags::UNDERFLOW.bits()),
        ..answer
    });
    caught(
        Operation::ToIntegerExact(IntegerFormat::I32),
        |answer, _| Answer {
            flags: Flags::from_bits(answer.flags.bits() & !Flags::INEXACT.bits()),
            ..answer
        },
    );
    // One operand of a hundred thousand.
    let one = caught(Operation::SquareRoot, |answer, set| Answer {
        bits: answer.bits ^ u64::from(set[0] == 0x7f7f_ffff),
        ..answer
    });
    assert_eq!(one.first[0].operands, [0x7f7f_ffff]);
    assert_eq!(one.differences, one.first.len() as u64);
}
