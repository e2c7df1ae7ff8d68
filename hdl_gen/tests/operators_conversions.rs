//! The operators between floats, integers and heights against the golden arithmetic.

mod bench;

use bench::{Bench, Random, golden_unary};
use hdl_gen::operators::{FloatOperator, OperatorConfiguration};
use rayon::prelude::*;
use rtl_model::float::{FloatFormat, Rounding};

const SHAPES: [FloatFormat; 5] = [
    FloatFormat::E4F3,
    FloatFormat::new(3, 4),
    FloatFormat::new(5, 2),
    FloatFormat::new(5, 10),
    FloatFormat::E7F16,
];

/// Every operand of a format up to 2^16 patterns, every 61st of a wider one.
fn operands(format: FloatFormat) -> impl Iterator<Item = [u64; 1]> {
    let step = if format.width() > 16 { 61 } else { 1 };
    (0..1_u64 << format.width()).step_by(step).map(|a| [a])
}

fn compare_unary(kind: FloatOperator, format: FloatFormat, rounding: Rounding, latency: u32) {
    let module = OperatorConfiguration::new(kind, format, rounding).build(latency);
    let vectors: Box<dyn Iterator<Item = [u64; 1]>> = match kind {
        FloatOperator::DepthFromHeight { bits } => Box::new((0..1 << bits).map(|height| [height])),
        _ => Box::new(operands(format)),
    };
    let agreed = Bench::new(&module).run(vectors, |[a]| golden_unary(kind, format, rounding, a));
    assert!(matches!(agreed, Ok(count) if count >= 256), "{agreed:?}");
}

#[test]
fn floor_agrees() {
    SHAPES.into_par_iter().for_each(|format| {
        for latency in 0..=2 {
            compare_unary(FloatOperator::Floor, format, Rounding::Down, latency);
        }
    });
}

#[test]
fn conversion_to_integer_agrees() {
    SHAPES.into_par_iter().for_each(|format| {
        for rounding in Rounding::ALL {
            for bits in [2, 5, 14, 32, 63] {
                for latency in [0, 2] {
                    compare_unary(FloatOperator::ToInteger { bits }, format, rounding, latency);
                }
            }
        }
    });
}

#[test]
fn steps_of_units_in_the_last_place_agree() {
    SHAPES.into_par_iter().for_each(|format| {
        for ulps in [0, 1, 2, 4, 9, 300, u32::MAX] {
            for latency in 0..=1 {
                let kind = FloatOperator::UlpsUp { ulps };
                compare_unary(kind, format, Rounding::Up, latency);
            }
        }
    });
}

#[test]
fn limits_of_exact_differences_agree() {
    SHAPES.into_par_iter().for_each(|format| {
        for latency in 0..=2 {
            compare_unary(
                FloatOperator::ExactBelow,
                format,
                Rounding::NearestEven,
                latency,
            );
        }
    });
}

#[test]
fn every_height_gives_its_depth() {
    SHAPES.into_par_iter().for_each(|format| {
        for bits in [8, 16] {
            for latency in 0..=2 {
                let kind = FloatOperator::DepthFromHeight { bits };
                compare_unary(kind, format, Rounding::TowardZero, latency);
            }
        }
    });
}

fn sign_extended(word: u64, bits: u32) -> i64 {
    (word << (64 - bits)).cast_signed() >> (64 - bits)
}

#[test]
fn conversion_from_integer_agrees() {
    let widths = [(2, 1), (5, 4), (8, 6), (14, 6), (20, 5), (30, 10), (64, 16)];
    SHAPES.into_par_iter().for_each(|format| {
        for rounding in Rounding::ALL {
            for (value_bits, exponent_bits) in widths {
                for latency in [0, 2] {
                    let kind = FloatOperator::FromInteger {
                        value_bits,
                        exponent_bits,
                    };
                    let module = OperatorConfiguration::new(kind, format, rounding).build(latency);
                    let golden = |[value, exponent]: [u64; 2]| {
                        let value = sign_extended(value, value_bits);
                        format.from_integer(rounding, value, sign_extended(exponent, exponent_bits))
                    };
                    let all_bits = value_bits + exponent_bits;
                    let (mut random, count) = (Random(3), 1 << all_bits.min(13));
                    let vectors = (0..count).map(|index| {
                        // All of a small pair; of others, values of every length.
                        let word = if all_bits <= 13 { index } else { random.next() };
                        let value = word & (u64::MAX >> (64 - value_bits));
                        let exponent = word >> (64 - exponent_bits);
                        if all_bits <= 13 {
                            [value, word >> value_bits]
                        } else {
                            let shorter = random.below(value_bits.into());
                            let value = sign_extended(value, value_bits) >> shorter;
                            [
                                value.cast_unsigned() & (u64::MAX >> (64 - value_bits)),
                                exponent,
                            ]
                        }
                    });
                    assert_eq!(Bench::new(&module).run(vectors, golden), Ok(count));
                }
            }
        }
    });
}

#[test]
fn parameters_out_of_range_are_named() {
    let wide = FloatFormat::new(11, 52);
    let error = FloatOperator::Multiply.check(wide).unwrap_err().to_string();
    assert!(
        error.contains("float_mul in e11f52") && error.contains("at most 31"),
        "{error}"
    );
    let kind = FloatOperator::FromInteger {
        value_bits: 65,
        exponent_bits: 4,
    };
    let error = kind.check(FloatFormat::E7F16).unwrap_err().to_string();
    assert_eq!(
        error,
        "float_from_integer: value_bits of 65 bits; use 2 to 64"
    );
}
