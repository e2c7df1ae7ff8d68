//! Fixed-point operators against the crate `fixed`, where its static types reach: whole bytes, one
//! format for all operands and the result, rounding down (its products, its conversions from wider
//! formats), toward zero (its quotients) and to nearest even (its conversions from and to floats).

mod fixed_oracle;

use fixed::traits::ToFixed;
use fixed::types::extra::{U0, U4, U7, U8, U12, U20, U32, U63, U64};
use fixed::{FixedI8, FixedI16, FixedI32, FixedI64, FixedU8, FixedU16, FixedU32, FixedU64};
use fixed_oracle::operands::Random;
use rtl_model::fixed::{Fixed, FixedArithmetic, FixedFormat, Overflow};
use rtl_model::float::{Flags, Rounding};

/// Pairs of words tried of a format wider than a byte.
const PAIRS: u64 = 300_000;

/// All pairs of words of a byte, random and hard ones of a wider format.
fn pairs(format: FixedFormat) -> impl Iterator<Item = (u64, u64)> {
    let all = format.width() <= 8;
    let count = if all { 1 << 16 } else { PAIRS };
    let mut random = Random(42);
    (0..count).map(move |k| {
        if all {
            (k & 0xff, k >> 8)
        } else {
            (random.word(format), random.word(format))
        }
    })
}

/// What the crate answers, in our words: saturated, wrapped, and whether that was needed.
struct Answers {
    saturated: u64,
    wrapped: u64,
    overflow: bool,
}

/// Holds an operator against the crate's saturating, wrapping and overflowing forms; returns how
/// many results were compared.
fn compare(
    format: FixedFormat,
    rounding: Rounding,
    operator: impl Fn(FixedArithmetic) -> (Fixed, Flags),
    answers: &Answers,
    what: &str,
    operands: (u64, u64),
) -> u64 {
    for (overflow, expected) in [
        (Overflow::Saturate, answers.saturated),
        (Overflow::Wrap, answers.wrapped),
    ] {
        let (result, flags) = operator(FixedArithmetic::new(format, rounding, overflow));
        assert_eq!(
            (result.bits, flags.contains(Flags::OVERFLOW)),
            (expected, answers.overflow),
            "{what} {overflow} in {format} of {operands:x?}"
        );
    }
    2
}

/// A test of one static type against the format that it is.
macro_rules! type_agrees {
    ($test:ident, $type:ty, $bits:ty, $format:expr) => {
        #[test]
        fn $test() {
            let format: FixedFormat = $format;
            let word = |number: $type| number.to_bits() as u64 & format.value_mask();
            let mut compared = 0;
            for (a, b) in pairs(format) {
                let (p, q) = (
                    <$type>::from_bits(a as $bits),
                    <$type>::from_bits(b as $bits),
                );
                let (a, b) = (Fixed::new(format, a), Fixed::new(format, b));
                let operands = (a.bits, b.bits);
                macro_rules! agrees {
                    ($rounding:ident, $golden:expr, $name:literal,
                                     $saturating:expr, $wrapping:expr, $overflowing:expr) => {{
                        let (wrapped, overflow) = $overflowing;
                        let answers = Answers {
                            saturated: word($saturating),
                            wrapped: word(wrapped),
                            overflow,
                        };
                        assert_eq!(answers.wrapped, word($wrapping));
                        let rounding = Rounding::$rounding;
                        compared += compare(format, rounding, $golden, &answers, $name, operands);
                    }};
                }
                agrees!(
                    NearestEven,
                    |x| x.add(a, b),
                    "add",
                    p.saturating_add(q),
                    p.wrapping_add(q),
                    p.overflowing_add(q)
                );
                agrees!(
                    NearestEven,
                    |x| x.sub(a, b),
                    "sub",
                    p.saturating_sub(q),
                    p.wrapping_sub(q),
                    p.overflowing_sub(q)
                );
                agrees!(
                    NearestEven,
                    |x| x.negate(a),
                    "negate",
                    p.saturating_neg(),
                    p.wrapping_neg(),
                    p.overflowing_neg()
                );
                agrees!(
                    Down,
                    |x| x.mul(a, b),
                    "mul",
                    p.saturating_mul(q),
                    p.wrapping_mul(q),
                    p.overflowing_mul(q)
                );
                if b.bits != 0 {
                    agrees!(
                        TowardZero,
                        |x| x.div(a, b),
                        "div",
                        p.saturating_div(q),
                        p.wrapping_div(q),
                        p.overflowing_div(q)
                    );
                    agrees!(
                        TowardZero,
                        |x| x.reciprocal(b),
                        "reciprocal",
                        q.saturating_recip(),
                        q.wrapping_recip(),
                        q.overflowing_recip()
                    );
                }
                let places = b.bits as u32 % format.width();
                let arithmetic = |overflow| FixedArithmetic::new(format, Rounding::Down, overflow);
                let (shifted, _) = arithmetic(Overflow::Wrap).shift_left(a, places);
                assert_eq!(shifted.bits, word(p << places), "{a} << {places}");
                let (shifted, flags) = arithmetic(Overflow::Saturate).shift_right(a, places);
                assert_eq!(shifted.bits, word(p >> places), "{a} >> {places}");
                assert!(!flags.contains(Flags::OVERFLOW));
                assert_eq!(a.compare(b), p.cmp(&q));
                assert_eq!(a.to_f64(), p.to_num::<f64>());
                compared += 4;
            }
            assert!(compared >= 15 << 16, "{compared}");
        }
    };
}

type_agrees!(q1_7, FixedI8<U7>, i8, FixedFormat::q(1, 7));
type_agrees!(q4_4, FixedI8<U4>, i8, FixedFormat::q(4, 4));
type_agrees!(q8_0, FixedI8<U0>, i8, FixedFormat::q(8, 0));
type_agrees!(uq0_8, FixedU8<U8>, u8, FixedFormat::uq(0, 8));
type_agrees!(uq4_4, FixedU8<U4>, u8, FixedFormat::uq(4, 4));
type_agrees!(q4_12, FixedI16<U12>, i16, FixedFormat::q(4, 12));
type_agrees!(uq4_12, FixedU16<U12>, u16, FixedFormat::uq(4, 12));
type_agrees!(q12_20, FixedI32<U20>, i32, FixedFormat::q(12, 20));
type_agrees!(uq12_20, FixedU32<U20>, u32, FixedFormat::uq(12, 20));
type_agrees!(q32_32, FixedI64<U32>, i64, FixedFormat::q(32, 32));
type_agrees!(q1_63, FixedI64<U63>, i64, FixedFormat::q(1, 63));
type_agrees!(q64_0, FixedI64<U0>, i64, FixedFormat::q(64, 0));
type_agrees!(uq0_64, FixedU64<U64>, u64, FixedFormat::uq(0, 64));
type_agrees!(uq32_32, FixedU64<U32>, u64, FixedFormat::uq(32, 32));

/// A test of conversions and comparisons between two static types.
macro_rules! conversion_agrees {
    ($test:ident, $from:ty, $from_bits:ty, $from_format:expr, $to:ty, $to_format:expr) => {
        #[test]
        fn $test() {
            let (from, to): (FixedFormat, FixedFormat) = ($from_format, $to_format);
            let word = |number: $to| number.to_bits() as u64 & to.value_mask();
            let mut compared = 0;
            let mut orders = [0; 3];
            for (a, b) in pairs(from) {
                let p = <$from>::from_bits(a as $from_bits);
                let a = Fixed::new(from, a);
                let (wrapped, overflow) = p.overflowing_to_fixed::<$to>();
                let answers = Answers {
                    saturated: word(p.saturating_to_fixed::<$to>()),
                    wrapped: word(wrapped),
                    overflow,
                };
                let golden = |arithmetic: FixedArithmetic| arithmetic.convert(a);
                let operands = (a.bits, 0);
                compared += compare(to, Rounding::Down, golden, &answers, "convert", operands);
                let b = Fixed::new(to, b);
                let q = <$to>::from_bits(b.units() as _);
                let order = a.compare(b);
                assert_eq!(Some(order), p.partial_cmp(&q), "{a} {b}");
                orders[(order as i8 + 1) as usize] += 1;
            }
            assert!(compared >= 2 << 16, "{compared}");
            let [less, _, greater] = orders;
            assert!(less > 0 && greater > 0, "only one order occurs");
        }
    };
}

conversion_agrees!(
    q12_20_to_q4_4,
    FixedI32<U20>,
    i32,
    FixedFormat::q(12, 20),
    FixedI8<U4>,
    FixedFormat::q(4, 4)
);
conversion_agrees!(
    q4_4_to_uq4_12,
    FixedI8<U4>,
    i8,
    FixedFormat::q(4, 4),
    FixedU16<U12>,
    FixedFormat::uq(4, 12)
);
conversion_agrees!(
    uq32_32_to_q1_63,
    FixedU64<U32>,
    u64,
    FixedFormat::uq(32, 32),
    FixedI64<U63>,
    FixedFormat::q(1, 63)
);
conversion_agrees!(
    q64_0_to_uq0_8,
    FixedI64<U0>,
    i64,
    FixedFormat::q(64, 0),
    FixedU8<U8>,
    FixedFormat::uq(0, 8)
);
conversion_agrees!(
    q4_12_to_q12_20,
    FixedI16<U12>,
    i16,
    FixedFormat::q(4, 12),
    FixedI32<U20>,
    FixedFormat::q(12, 20)
);
