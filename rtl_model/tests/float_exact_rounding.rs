//! The float operators against exact results in big integers, correctly rounded.
//!
//! Ten million cases an operator at e7f16, random and hard ones, all four roundings; every pair of
//! operands at e4f3 and at the smallest formats; every format there is. `STEPWELL_FLOAT_CASES`
//! sets another number of cases an operator at e7f16, for long runs.

mod float_oracle;

use float_oracle::compare::{Operation, Outcome, implementation, search, search_all_pairs};
use float_oracle::operands::{self, Case};
use float_oracle::{exact, neighbours};
use rayon::prelude::*;
use rtl_model::float::{FloatFormat, Rounding};

const SEED: u64 = 0x57e9_0e11;

fn cases() -> u64 {
    match std::env::var("STEPWELL_FLOAT_CASES") {
        Ok(text) => text.parse().expect("STEPWELL_FLOAT_CASES is a number"),
        Err(_) => 10_000_000,
    }
}

fn agree_at_e7f16(operation: Operation) {
    // The constant format, so that the code under test is what a fixed datapath compiles to.
    let found = search(
        operation,
        FloatFormat::E7F16,
        SEED,
        cases(),
        |operation, _, case| implementation(operation, FloatFormat::E7F16, case),
    );
    if let Some(mismatch) = found {
        panic!("{mismatch}");
    }
}

#[test]
fn add_is_exactly_rounded() {
    agree_at_e7f16(Operation::Add);
}

#[test]
fn sub_is_exactly_rounded() {
    agree_at_e7f16(Operation::Sub);
}

#[test]
fn mul_is_exactly_rounded() {
    agree_at_e7f16(Operation::Mul);
}

#[test]
fn div_is_exactly_rounded() {
    agree_at_e7f16(Operation::Div);
}

#[test]
fn comparisons_are_exact() {
    agree_at_e7f16(Operation::LessThan);
    agree_at_e7f16(Operation::LessEqual);
    agree_at_e7f16(Operation::Equal);
    agree_at_e7f16(Operation::Compare);
}

#[test]
fn min_and_max_are_exact() {
    agree_at_e7f16(Operation::Min);
    agree_at_e7f16(Operation::Max);
}

#[test]
fn integer_conversions_are_exactly_rounded() {
    agree_at_e7f16(Operation::FromInteger);
    agree_at_e7f16(Operation::ToInteger);
    agree_at_e7f16(Operation::Floor);
}

/// e2f2, e3f2 and e2f5 have next to no exponents, or more fraction bits than exponents: there the
/// range ends inside every alignment and below the integers.
#[test]
fn every_pair_of_small_formats_agrees() {
    for (exponent_bits, fraction_bits) in [(4, 3), (2, 2), (3, 2), (2, 5)] {
        let format = FloatFormat::new(exponent_bits, fraction_bits);
        for operation in Operation::ALL {
            if let Some(mismatch) = search_all_pairs(operation, format, implementation) {
                panic!("{mismatch}");
            }
        }
    }
}

/// All 510 formats, the widths known only at run time: the wide divider, 64-bit patterns.
#[test]
fn every_format_agrees() {
    let formats: Vec<FloatFormat> = (2..=11)
        .flat_map(|e| (2..=52).map(move |f| FloatFormat::new(e, f)))
        .collect();
    formats.par_iter().for_each(|&format| {
        for operation in Operation::ALL {
            if let Some(mismatch) = search(operation, format, SEED, 1_000, implementation) {
                panic!("{mismatch}");
            }
        }
    });
}

/// Conversion from and to `f64` in every format, by way of the exact oracle: an `f64` is read as an
/// integer times a power of two.
#[test]
fn f64_conversions_are_exactly_rounded() {
    let formats = [(7, 16), (4, 3), (11, 52), (11, 20), (2, 52), (8, 23)];
    for (exponent_bits, fraction_bits) in formats {
        let format = FloatFormat::new(exponent_bits, fraction_bits);
        let wide = FloatFormat::new(11, 52);
        (0..300_000u64).into_par_iter().for_each(|index| {
            let mut random = operands::Random::new(SEED, index);
            // Around the format's range, its ends and its ties; and anywhere.
            let case = operands::case(Operation::Mul, format, SEED, index);
            let value = match random.below(3) {
                0 => f64::from_bits(random.next()),
                1 => f64::from_bits(format.to_f64(case.a).to_bits() ^ (random.next() >> 12)),
                _ => (format.to_f64(case.a) + format.to_f64(case.b)) / 2.0,
            };
            let bits = value.to_bits();
            let negative = value.is_sign_negative();
            let (field, fraction) = (bits >> 52 & 0x7ff, bits & ((1 << 52) - 1));
            let expected = match (field, fraction) {
                (0x7ff, 0) => neighbours::infinity(format, negative),
                (0x7ff, _) => neighbours::not_a_number(format),
                (0, 0) => neighbours::zero(format, negative),
                _ => {
                    let implied = u64::from(field != 0) << 52;
                    let magnitude = (implied | fraction) as i64;
                    let integer = if negative { -magnitude } else { magnitude };
                    let exponent = field.max(1) as i64 - 1075;
                    exact::from_integer(format, case.rounding, integer, exponent)
                }
            };
            let actual = format.from_f64(case.rounding, value);
            assert_eq!(
                actual, expected,
                "{format} {} {value:e} (seed {SEED:#x}, index {index})",
                case.rounding
            );
            // Back: exact, so that the widest format reads the same number.
            let back = format.to_f64(actual);
            assert_eq!(format.from_f64(case.rounding, back), actual);
            if !value.is_nan() {
                assert_eq!(wide.to_f64(back.to_bits()).to_bits(), back.to_bits());
            }
        });
    }
}

/// Every operator with its lowest result bit (or its truth) flipped on one case in 1,024.
#[test]
fn the_comparer_sees_a_flipped_bit() {
    for operation in Operation::ALL {
        let format = FloatFormat::E7F16;
        let found = search(
            operation,
            format,
            SEED,
            10_000,
            |operation, format, case| {
                let outcome = implementation(operation, format, case);
                if (case.a ^ case.b.rotate_left(7)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 54 != 0 {
                    return outcome;
                }
                match outcome {
                    Outcome::Pattern(bits) => Outcome::Pattern(bits ^ 1),
                    Outcome::Truth(truth) => Outcome::Truth(!truth),
                    Outcome::Order(order) => {
                        Outcome::Order(order.map_or(Some(std::cmp::Ordering::Equal), |_| None))
                    }
                    Outcome::Integer(Ok(value)) => Outcome::Integer(Ok(value ^ 1)),
                    Outcome::Integer(Err(_)) => Outcome::Integer(Ok(0)),
                }
            },
        );
        let mismatch = found.unwrap_or_else(|| panic!("a fault in {operation:?} was not seen"));
        assert_eq!(mismatch.operation, operation);
        assert!(mismatch.to_string().contains("index"), "{mismatch}");
    }
}

/// A rounding in place of another, for every pair of roundings and every operator that rounds.
#[test]
fn the_comparer_sees_a_wrong_rounding() {
    let rounded = [
        Operation::Add,
        Operation::Sub,
        Operation::Mul,
        Operation::Div,
        Operation::FromInteger,
        Operation::ToInteger,
    ];
    for operation in rounded {
        for right in Rounding::ALL {
            for wrong in Rounding::ALL.into_iter().filter(|&wrong| wrong != right) {
                let format = FloatFormat::E7F16;
                let found = search(
                    operation,
                    format,
                    SEED,
                    20_000,
                    |operation, format, case| {
                        let rounding = if case.rounding == right {
                            wrong
                        } else {
                            case.rounding
                        };
                        implementation(operation, format, Case { rounding, ..case })
                    },
                );
                assert!(
                    found.is_some(),
                    "{wrong} in place of {right} in {operation:?} was not seen"
                );
            }
        }
    }
}

/// A tie broken the wrong way (up in magnitude instead of to even), and nothing else.
#[test]
fn the_comparer_sees_a_wrong_tie() {
    for operation in [Operation::Add, Operation::Sub, Operation::Mul] {
        let format = FloatFormat::E7F16;
        let found = search(
            operation,
            format,
            SEED,
            200_000,
            |operation, format, case| {
                let directed =
                    |rounding| match implementation(operation, format, Case { rounding, ..case }) {
                        Outcome::Pattern(bits) => bits,
                        other => panic!("{other:?} from {operation:?}"),
                    };
                let (down, up) = (directed(Rounding::Down), directed(Rounding::Up));
                let nearest = directed(Rounding::NearestEven);
                // Where an exact wider sum or product lies halfway, nearest-even took the even one.
                let wide = FloatFormat::new(11, 40);
                let widened = Case {
                    rounding: Rounding::TowardZero,
                    a: wide.from_f64(Rounding::TowardZero, format.to_f64(case.a)),
                    b: wide.from_f64(Rounding::TowardZero, format.to_f64(case.b)),
                };
                let Outcome::Pattern(exact) = implementation(operation, wide, widened) else {
                    panic!("a pattern from {operation:?}");
                };
                let tie = wide.to_f64(exact) - format.to_f64(down)
                    == format.to_f64(up) - wide.to_f64(exact);
                let flip = case.rounding == Rounding::NearestEven && down != up && tie;
                match (flip, nearest == down) {
                    (true, true) => Outcome::Pattern(up),
                    (true, false) => Outcome::Pattern(down),
                    _ => implementation(operation, format, case),
                }
            },
        );
        assert!(found.is_some(), "a wrong tie in {operation:?} was not seen");
    }
}
