//! Conversions between fixed point and floats: against exact ratios, every pattern of small formats;
//! against the crate `fixed` and the host, where these have the formats.

mod fixed_oracle;

use std::cmp::Ordering;

use fixed::types::extra::{U0, U12, U20, U32, U63, U64};
use fixed::{FixedI16, FixedI32, FixedI64, FixedU32, FixedU64};
use fixed_oracle::operands::{Random, every_format};
use fixed_oracle::{Exact, Order, Ratio, every_arithmetic, power_of_two};
use rtl_model::fixed::{Fixed, FixedArithmetic, FixedFormat, Overflow};
use rtl_model::float::{Flags, FloatFormat, Policy, Rounding};

/// The number that a float's pattern is; `None` for infinities and NaNs.
fn number(format: FloatFormat, policy: Policy, pattern: u64) -> Option<Ratio<i128>> {
    let fraction_bits = format.fraction_bits;
    let fraction = i128::from(pattern % (1 << fraction_bits));
    let field = pattern >> fraction_bits & ((1 << format.exponent_bits) - 1);
    let significand = match (field, policy) {
        (0, Policy::Flush) => 0,
        (0, Policy::Full) => fraction,
        _ if field + 1 == 1 << format.exponent_bits => return None,
        _ => fraction + power_of_two::<i128>(fraction_bits),
    };
    let bias = power_of_two::<i128>(format.exponent_bits - 1) - 1;
    let exponent = i128::from(field.max(1)) - bias - i128::from(fraction_bits);
    let negative = pattern >> (fraction_bits + format.exponent_bits) & 1 == 1;
    let power = power_of_two::<i128>(exponent.unsigned_abs() as u32);
    let signed = if negative { -significand } else { significand };
    Some(if exponent < 0 {
        Ratio {
            numerator: signed,
            denominator: power,
        }
    } else {
        Ratio {
            numerator: signed * power,
            denominator: 1,
        }
    })
}

const SMALL_FLOATS: [FloatFormat; 4] = [
    FloatFormat::E4F3,
    FloatFormat::new(3, 4),
    FloatFormat::new(2, 5),
    FloatFormat::new(5, 2),
];

#[test]
fn every_small_float_to_every_small_format() {
    let mut compared = 0;
    for source in SMALL_FLOATS {
        for policy in Policy::ALL {
            for result in (1..=6).flat_map(every_format) {
                for pattern in 0..=source.value_mask() {
                    for arithmetic in every_arithmetic(result) {
                        let (got, flags) = arithmetic.from_float(source, policy, pattern);
                        let expected = match number(source, policy, pattern) {
                            Some(ratio) => {
                                Exact::Ratio(ratio).expected(arithmetic, Order::RoundThenRange)
                            }
                            None if source.is_nan(pattern) => (0, Flags::INVALID),
                            None if pattern & source.sign_bit() == 0 => {
                                (result.max(), Flags::INVALID)
                            }
                            None => (result.min(), Flags::INVALID),
                        };
                        assert_eq!(
                            (got.bits, flags),
                            expected,
                            "{source} {policy} {pattern:#x} {arithmetic:?}"
                        );
                        compared += 1;
                    }
                }
            }
        }
    }
    assert_eq!(compared, 4 * 2 * 48 * 256 * 8);
}

/// What `exact` rounds to among all finite floats of a format with subnormal numbers: the
/// neighbours are found by looking at every one.
fn nearest(format: FloatFormat, rounding: Rounding, exact: &Ratio<i128>) -> u64 {
    let order = |pattern: u64| {
        let value = number(format, Policy::Full, pattern)?;
        Some((value.numerator * exact.denominator).cmp(&(exact.numerator * value.denominator)))
    };
    let (mut below, mut above) = (None::<u64>, None::<u64>);
    for magnitude in 0..format.infinity() {
        for pattern in [magnitude | format.sign_bit(), magnitude] {
            // One of the zeros is enough to look at.
            if pattern == format.sign_bit() {
                continue;
            }
            let negative = pattern & format.sign_bit() != 0;
            match order(pattern).expect("finite") {
                Ordering::Equal => return pattern,
                // Magnitudes are met in order: a later one is nearer only on its own side of zero.
                Ordering::Less if !negative || below.is_none() => below = Some(pattern),
                Ordering::Greater if negative || above.is_none() => above = Some(pattern),
                _ => {}
            }
        }
    }
    let negative = exact.numerator < 0;
    let (below, above) = (below.expect("in range"), above.expect("in range"));
    let rounded = match rounding {
        Rounding::Down => below,
        Rounding::Up => above,
        Rounding::TowardZero if negative => above,
        Rounding::TowardZero => below,
        Rounding::NearestEven => {
            // Twice the exact value beside the sum of the neighbours.
            let value = |pattern| number(format, Policy::Full, pattern).expect("finite");
            let (p, q) = (value(below), value(above));
            let sum = p.numerator * q.denominator + q.numerator * p.denominator;
            let middle = sum * exact.denominator;
            match (2 * exact.numerator * p.denominator * q.denominator).cmp(&middle) {
                Ordering::Less => below,
                Ordering::Greater => above,
                Ordering::Equal if below & 1 == 0 => below,
                Ordering::Equal => above,
            }
        }
    };
    // A negative number that rounds to zero keeps its sign.
    if rounded == 0 && negative {
        format.sign_bit()
    } else {
        rounded
    }
}

#[test]
fn every_small_word_to_small_floats() {
    let mut compared = 0;
    for target in [FloatFormat::E4F3, FloatFormat::new(3, 4)] {
        for format in [
            FixedFormat::q(4, 5),
            FixedFormat::uq(0, 8),
            FixedFormat::q(1, 7),
            FixedFormat::uq(3, 6),
        ] {
            for bits in 0..=format.value_mask() {
                let word = Fixed::new(format, bits);
                let exact = Ratio::of(word);
                for rounding in Rounding::ALL {
                    let expected = nearest(target, rounding, &exact);
                    let answer = word.to_float(target.arithmetic(Policy::Full, rounding));
                    let back = number(target, Policy::Full, answer.bits).unwrap();
                    let is_exact =
                        back.numerator * exact.denominator == exact.numerator * back.denominator;
                    assert_eq!(answer.bits, expected, "{word} {target} {rounding}");
                    assert_eq!(answer.flags.contains(Flags::INEXACT), !is_exact, "{word}");
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 2 * 4 * (512 + 256 + 256 + 512));
}

/// A test of a static type against the format that it is: rounding to nearest even, both ways, at
/// binary32 and binary64.
macro_rules! type_agrees {
    ($test:ident, $type:ty, $bits:ty, $format:expr) => {
        #[test]
        fn $test() {
            let format: FixedFormat = $format;
            let single = FloatFormat::new(8, 23).arithmetic(Policy::Full, Rounding::NearestEven);
            let double = FloatFormat::new(11, 52).arithmetic(Policy::Full, Rounding::NearestEven);
            let arithmetic =
                |overflow| FixedArithmetic::new(format, Rounding::NearestEven, overflow);
            let word = |number: $type| number.to_bits() as u64 & format.value_mask();
            let mut random = Random(7);
            let mut finite = 0;
            for _ in 0..200_000 {
                let bits = random.word(format);
                let (ours, theirs) = (Fixed::new(format, bits), <$type>::from_bits(bits as $bits));
                let to_single = u64::from(theirs.to_num::<f32>().to_bits());
                assert_eq!(ours.to_float(single).bits, to_single, "{ours}");
                let to_double = theirs.to_num::<f64>().to_bits();
                assert_eq!(ours.to_float(double).bits, to_double, "{ours}");

                // Floats around the range: a word of the format, a little off.
                let close = to_single ^ random.below(8) ^ random.below(4) << 23;
                let value = f32::from_bits(close as u32);
                if value.is_finite() {
                    finite += 1;
                    let convert = |overflow| {
                        arithmetic(overflow).from_float(single.format, Policy::Full, close)
                    };
                    let (wrapped, overflow) = <$type>::overflowing_from_num(value);
                    let (saturated, flags) = convert(Overflow::Saturate);
                    assert_eq!(saturated.bits, word(<$type>::saturating_from_num(value)));
                    assert_eq!(flags.contains(Flags::OVERFLOW), overflow, "{value}");
                    assert_eq!(convert(Overflow::Wrap).0.bits, word(wrapped), "{value}");
                }
            }
            assert!(finite > 150_000, "{finite}");
        }
    };
}

type_agrees!(q4_12, FixedI16<U12>, i16, FixedFormat::q(4, 12));
type_agrees!(q12_20, FixedI32<U20>, i32, FixedFormat::q(12, 20));
type_agrees!(uq0_32, FixedU32<U32>, u32, FixedFormat::uq(0, 32));
type_agrees!(q1_63, FixedI64<U63>, i64, FixedFormat::q(1, 63));
type_agrees!(uq0_64, FixedU64<U64>, u64, FixedFormat::uq(0, 64));
type_agrees!(uq64_0, FixedU64<U0>, u64, FixedFormat::uq(64, 0));
