//! Fixed-point operators against exact ratios: every word of small formats, random and hard words
//! of formats up to 64 bits; every rounding, saturating and wrapping, results and flags.

mod fixed_oracle;

use std::sync::atomic::{AtomicU64, Ordering};

use fixed_oracle::operands::{Random, every_format, hard_words};
use fixed_oracle::{Answer, Exact, Mismatch, Operator, Order, Ratio, compare, every_arithmetic};
use num_bigint::BigInt;
use rayon::prelude::*;
use rtl_model::fixed::{Fixed, FixedArithmetic, FixedFormat, Overflow};
use rtl_model::float::{Flags, Rounding};

/// Random cases an operator; `STEPWELL_FIXED_CASES` makes it more.
const CASES: u64 = 20_000;

/// All formats of at most so many bits.
fn formats_up_to(width: u32) -> Vec<FixedFormat> {
    (1..=width).flat_map(every_format).collect()
}

fn words(format: FixedFormat) -> impl Iterator<Item = Fixed> {
    (0..=format.value_mask()).map(move |bits| Fixed::new(format, bits))
}

/// Every pair of words of the operand formats, to every result format.
fn exhaustive(
    answer: &Answer,
    operators: &[Operator],
    operands: &[(FixedFormat, FixedFormat)],
    results: &[FixedFormat],
) -> Result<u64, Box<Mismatch>> {
    operands
        .par_iter()
        .map(|&(a_format, b_format)| {
            let mut compared = 0;
            for a in words(a_format) {
                for b in words(b_format) {
                    for &operator in operators {
                        for &result in results {
                            compared += compare::<i128>(answer, operator, result, a, b)?;
                        }
                    }
                }
            }
            Ok(compared)
        })
        .try_reduce(|| 0, |a, b| Ok(a + b))
}

fn pairs(formats: &[FixedFormat]) -> Vec<(FixedFormat, FixedFormat)> {
    let with_each = |&a| formats.iter().map(move |&b| (a, b));
    formats.iter().flat_map(with_each).collect()
}

/// One operand of every format; the other is not read.
fn alone(formats: &[FixedFormat]) -> Vec<(FixedFormat, FixedFormat)> {
    // The format of one word that exists: two words, both tried.
    let not_read = FixedFormat::uq(1, 0);
    formats.iter().map(|&format| (format, not_read)).collect()
}

#[test]
fn every_pair_of_small_words_to_every_small_format() {
    let formats = formats_up_to(3);
    let compared = exhaustive(
        &Operator::golden,
        &Operator::BINARY,
        &pairs(&formats),
        &formats,
    );
    // Words of all formats: 3 of 1 bit, 5 of 2, 7 of 3.
    let words: u64 = 3 * 2 + 5 * 4 + 7 * 8;
    assert_eq!(compared.unwrap(), words * words * 4 * 15 * 8);
}

#[test]
fn every_pair_of_words_of_eight_bits() {
    for format in [
        FixedFormat::q(1, 7),
        FixedFormat::q(4, 4),
        FixedFormat::q(8, 0),
        FixedFormat::uq(0, 8),
        FixedFormat::uq(4, 4),
    ] {
        let compared = exhaustive(
            &Operator::golden,
            &Operator::BINARY,
            &[(format, format)],
            &[format],
        );
        assert_eq!(compared.unwrap(), 65_536 * 4 * 8, "{format}");
    }
}

#[test]
fn every_word_alone_to_every_format_of_five_bits() {
    let formats = formats_up_to(5);
    let shifts =
        (0..=7).flat_map(|places| [Operator::ShiftLeft(places), Operator::ShiftRight(places)]);
    let operators: Vec<Operator> = Operator::UNARY.into_iter().chain(shifts).collect();
    let compared = exhaustive(&Operator::golden, &operators, &alone(&formats), &formats);
    // Words of all formats up to five bits, the other operand's two, the operators, 35 formats.
    let words = 6 + 20 + 56 + 144 + 352;
    assert_eq!(compared.unwrap(), words * 2 * 19 * 35 * 8);
}

#[test]
fn random_words_of_formats_up_to_64_bits() {
    let cases = std::env::var("STEPWELL_FIXED_CASES").map_or(CASES, |text| {
        text.parse().expect("STEPWELL_FIXED_CASES: a number")
    });
    let compared = AtomicU64::new(0);
    (0..cases).into_par_iter().for_each(|case| {
        let mut random = Random(case);
        let (a_format, result) = (random.format(), random.format());
        let b_format = random.format();
        let a = Fixed::new(a_format, random.word(a_format));
        let b = Fixed::new(b_format, random.word(b_format));
        let places = random.below(140) as u32;
        let shifts = [Operator::ShiftLeft(places), Operator::ShiftRight(places)];
        let operators = Operator::BINARY.into_iter().chain(Operator::UNARY);
        for operator in operators.chain(shifts) {
            let count = compare::<BigInt>(&Operator::golden, operator, result, a, b);
            compared.fetch_add(count.unwrap(), Ordering::Relaxed);
        }
    });
    assert_eq!(compared.into_inner(), cases * 9 * 8);
}

/// The widest words there are, where a product or an aligned sum needs all 128 bits.
#[test]
fn hard_words_of_the_widest_formats() {
    let widest = [
        FixedFormat::q(64, 0),
        FixedFormat::q(1, 63),
        FixedFormat::uq(64, 0),
        FixedFormat::uq(0, 64),
        FixedFormat::uq(32, 32),
    ];
    let compared: u64 = pairs(&widest)
        .into_par_iter()
        .map(|(a_format, b_format)| {
            let mut compared = 0;
            let some = |format| hard_words(format).into_iter().step_by(5);
            for a in some(a_format) {
                for b in some(b_format) {
                    for operator in Operator::BINARY {
                        let (a, b) = (Fixed::new(a_format, a), Fixed::new(b_format, b));
                        for result in [a_format, FixedFormat::q(20, 12)] {
                            let count =
                                compare::<BigInt>(&Operator::golden, operator, result, a, b);
                            compared += count.unwrap();
                        }
                    }
                }
            }
            compared
        })
        .sum();
    assert!(compared > 1_000_000, "{compared}");
}

#[test]
fn every_two_words_are_ordered_as_their_values() {
    let formats = formats_up_to(4);
    let mut compared = 0;
    for (a_format, b_format) in pairs(&formats) {
        for a in words(a_format) {
            for b in words(b_format) {
                let (p, q) = (Ratio::<i128>::of(a), Ratio::<i128>::of(b));
                let expected = (p.numerator * q.denominator).cmp(&(q.numerator * p.denominator));
                assert_eq!(a.compare(b), expected, "{a} {b}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, (6 + 20 + 56 + 144) * (6 + 20 + 56 + 144));
    let (a, b) = (FixedFormat::uq(64, 0), FixedFormat::uq(0, 64));
    let (most, least) = (Fixed::new(a, u64::MAX), Fixed::new(b, u64::MAX));
    assert!(most.compare(least).is_gt() && least.compare(most).is_lt());
    assert!(Fixed::new(a, 1).compare(least).is_gt());
    assert!(Fixed::from_i64(-1).compare(Fixed::new(b, 0)).is_lt());
}

/// A comparison that cannot fail proves nothing: each of these wrong operators must be found.
mod faults {
    use super::*;

    /// Is the first difference found on small words, and how does it show?
    fn found(operators: &[Operator], answer: &Answer) -> Box<Mismatch> {
        let formats = formats_up_to(3);
        exhaustive(answer, operators, &pairs(&formats), &formats)
            .expect_err("the fault was not seen")
    }

    fn with(
        change: impl Fn(FixedArithmetic) -> FixedArithmetic + Sync,
    ) -> impl Fn(Operator, FixedArithmetic, Fixed, Fixed) -> (u64, Flags) + Sync {
        move |operator, arithmetic, a, b| operator.golden(change(arithmetic), a, b)
    }

    #[test]
    fn saturation_before_rounding() {
        let swapped = |operator: Operator, arithmetic, a, b| {
            let exact: Exact<i128> = operator.exact(a, b);
            exact.expected(arithmetic, Order::RangeThenRound)
        };
        for operator in Operator::BINARY {
            if matches!(operator, Operator::Add | Operator::Sub) {
                // Aligned operands of one format need no rounding: other formats show it.
                found(&[operator], &swapped);
            } else {
                let difference = found(&[operator], &swapped);
                assert!(difference.got.1 != difference.expected.1);
            }
        }
        // The worst of it: rounded up past the end of the range, and wrapped without a word.
        let q2_2 = FixedFormat::q(2, 2);
        let arithmetic = FixedArithmetic::new(q2_2, Rounding::NearestEven, Overflow::Saturate);
        let just_below_two = Fixed::new(FixedFormat::q(2, 6), 0x7f);
        let convert = Operator::Convert;
        assert_eq!(
            convert.golden(arithmetic, just_below_two, just_below_two),
            (0x7, Flags::INEXACT | Flags::OVERFLOW)
        );
        assert_eq!(
            swapped(convert, arithmetic, just_below_two, just_below_two),
            (0x8, Flags::INEXACT),
        );
    }

    #[test]
    fn any_rounding_in_place_of_another() {
        for right in Rounding::ALL {
            for wrong in Rounding::ALL.into_iter().filter(|&wrong| wrong != right) {
                let exchanged = with(move |arithmetic| FixedArithmetic {
                    rounding: if arithmetic.rounding == right {
                        wrong
                    } else {
                        arithmetic.rounding
                    },
                    ..arithmetic
                });
                let difference = found(&[Operator::Mul], &exchanged);
                assert_eq!(difference.arithmetic.rounding, right);
                found(&[Operator::Div], &exchanged);
            }
        }
    }

    #[test]
    fn wrapping_in_place_of_saturation() {
        let wrapping = with(|arithmetic| FixedArithmetic {
            overflow: Overflow::Wrap,
            ..arithmetic
        });
        for operator in Operator::BINARY {
            found(&[operator], &wrapping);
        }
    }

    #[test]
    fn a_flipped_bit_and_a_flag_not_raised() {
        let flipped = |operator: Operator, arithmetic, a: Fixed, b: Fixed| {
            let (bits, flags) = operator.golden(arithmetic, a, b);
            let flip = a.bits == 5 && b.bits == 3 && arithmetic.format == FixedFormat::q(2, 1);
            (bits ^ u64::from(flip), flags)
        };
        let quiet = |operator: Operator, arithmetic, a, b| {
            let (bits, flags) = operator.golden(arithmetic, a, b);
            (
                bits,
                Flags::from_bits(flags.bits() & !Flags::INEXACT.bits()),
            )
        };
        for operator in Operator::BINARY {
            found(&[operator], &flipped);
            found(&[operator], &quiet);
        }
    }

    #[test]
    fn every_arithmetic_is_every_one() {
        assert_eq!(every_arithmetic(FixedFormat::q(2, 2)).count(), 8);
    }
}
