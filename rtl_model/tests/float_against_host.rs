//! The float operators against this machine's `f32` and `f64`, to nearest even: a third party that
//! neither the operators nor their exact oracle know of.
//!
//! The host has subnormals and the operators flush them, so the two are compared where operands and
//! result are normal numbers, zeros, infinities or NaN; a host result that has just rounded up to
//! the smallest normal number is left out too, since the policies differ on which do.

mod float_oracle;

use float_oracle::compare::Operation;
use float_oracle::operands;
use rayon::prelude::*;
use rtl_model::float::{FloatFormat, Rounding};

const SEED: u64 = 0x0405_7e9d;
const CASES: u64 = 2_000_000;
const OPERATIONS: [Operation; 4] = [
    Operation::Add,
    Operation::Sub,
    Operation::Mul,
    Operation::Div,
];

/// One operator of ours, to nearest even.
fn ours(operation: Operation, format: FloatFormat, a: u64, b: u64) -> u64 {
    let rounding = Rounding::NearestEven;
    match operation {
        Operation::Add => format.add(rounding, a, b),
        Operation::Sub => format.sub(rounding, a, b),
        Operation::Mul => format.mul(rounding, a, b),
        Operation::Div => format.div(rounding, a, b),
        other => unreachable!("{other:?} is not compared with the host"),
    }
}

macro_rules! agree_with {
    ($name:ident, $host:ty, $bits:ty, $exponent_bits:literal, $fraction_bits:literal) => {
        #[test]
        fn $name() {
            const FORMAT: FloatFormat = FloatFormat::new($exponent_bits, $fraction_bits);
            for operation in OPERATIONS {
                let compared: u64 = (0..CASES)
                    .into_par_iter()
                    .map(|index| {
                        let case = operands::case(operation, FORMAT, SEED, index);
                        let a = <$host>::from_bits(case.a as $bits);
                        let b = <$host>::from_bits(case.b as $bits);
                        let host = match operation {
                            Operation::Add => a + b,
                            Operation::Sub => a - b,
                            Operation::Mul => a * b,
                            _ => a / b,
                        };
                        let tiny = host != 0.0 && host.abs() <= <$host>::MIN_POSITIVE;
                        // A zero that the host got from tiny numbers is one of ours, too.
                        if a.is_subnormal() || b.is_subnormal() || tiny {
                            return 0;
                        }
                        let expected = if host.is_nan() {
                            FORMAT.quiet_nan()
                        } else {
                            u64::from(host.to_bits())
                        };
                        let actual = ours(operation, FORMAT, case.a, case.b);
                        assert_eq!(
                            actual, expected,
                            "{operation:?} of {:#x} and {:#x} in {FORMAT} gives {actual:#x}, \
                             the host {expected:#x} (seed {SEED:#x}, index {index})",
                            case.a, case.b
                        );
                        assert_eq!(FORMAT.less_than(case.a, case.b), a < b);
                        assert_eq!(FORMAT.less_equal(case.a, case.b), a <= b);
                        assert_eq!(FORMAT.compare(case.a, case.b), a.partial_cmp(&b));
                        let floor = a.floor();
                        if !floor.is_nan() {
                            assert_eq!(FORMAT.floor(case.a), u64::from(floor.to_bits()));
                        }
                        1
                    })
                    .sum();
                assert!(
                    compared > CASES / 2,
                    "only {compared} of {CASES} cases of {operation:?} could be compared"
                );
            }
        }
    };
}

agree_with!(f32_agrees, f32, u32, 8, 23);
agree_with!(f64_agrees, f64, u64, 11, 52);

/// Narrowing `f64` to `f32` is `from_f64`, and widening it is `to_f64`.
#[test]
fn host_conversions_agree() {
    let format = FloatFormat::new(8, 23);
    let mut compared = 0;
    for index in 0..CASES {
        let mut random = operands::Random::new(SEED, index);
        let narrow = f32::from_bits(random.next() as u32);
        if narrow.is_subnormal() || narrow.is_nan() {
            continue;
        }
        let bits = u64::from(narrow.to_bits());
        assert_eq!(format.to_f64(bits).to_bits(), f64::from(narrow).to_bits());

        // Anything within an f32's unit in the last place, ties among it.
        let disturbance = random.next() >> (35 + random.below(29));
        let wide = f64::from_bits(f64::from(narrow).to_bits() ^ disturbance);
        let host = wide as f32;
        if wide.is_nan() || host.is_subnormal() || host.abs() == f32::MIN_POSITIVE {
            continue;
        }
        let ours = format.from_f64(Rounding::NearestEven, wide);
        assert_eq!(ours, u64::from(host.to_bits()), "{wide:e}");
        compared += 1;
    }
    assert!(compared > CASES / 2, "only {compared} values compared");
}
