//! A slice of the comparison of the two golden routes, and a fault that it catches.

use campaigns::routes::{OPERATIONS, compare};
use rtl_model::float::{Answer, FloatFormat, Operation, Policy, Rounding};

#[test]
fn both_routes_agree() {
    for (format, count) in [(FloatFormat::E4F3, 1 << 16), (FloatFormat::E7F16, 100_000)] {
        for policy in Policy::ALL {
            for rounding in Rounding::ALL {
                for operation in OPERATIONS {
                    let arithmetic = format.arithmetic(policy, rounding);
                    let run = compare(arithmetic, operation, count, 3, &|_| {}, |own, _| own);
                    let (outcome, exhaustive) = run.unwrap();
                    assert_eq!(outcome.first, [], "{operation} {arithmetic:?}");
                    assert_eq!(exhaustive, format == FloatFormat::E4F3);
                    assert!(outcome.cases >= 256);
                }
            }
        }
    }
}

#[test]
fn a_wrong_route_is_caught() {
    let arithmetic = FloatFormat::E7F16.arithmetic(Policy::Flush, Rounding::NearestEven);
    // The smallest normal number flushed, too.
    let alter = |answer: Answer, _| Answer {
        bits: if answer.bits == 0x01_0000 {
            0
        } else {
            answer.bits
        },
        ..answer
    };
    let run = compare(arithmetic, Operation::Multiply, 100_000, 3, &|_| {}, alter);
    let (outcome, _) = run.unwrap();
    assert!(outcome.differences > 0);
    assert!(outcome.differences < outcome.cases / 100);
    assert_eq!(outcome.first[0].golden, [0]);
}

#[test]
fn a_format_too_wide_for_f64_is_refused() {
    let wide = FloatFormat::new(8, 25).arithmetic(Policy::Full, Rounding::Up);
    assert!(compare(wide, Operation::Add, 10, 1, &|_| {}, |own, _| own).is_none());
}
