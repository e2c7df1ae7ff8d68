//! The float operators against this machine's `f32` and `f64`, to nearest even: a third party that
//! neither the operators nor their exact oracle know of.
//!
//! Under the policy `full` all results are the same. Under `flush` the two are compared where
//! operands and result are normal numbers, zeros, infinities or NaN; a host result that has just
//! rounded up to the smallest normal number is left out too, since the policies differ on which do.

mod float_oracle;

use float_oracle::compare::Subject;
use float_oracle::operands;
use rayon::prelude::*;
use rtl_model::float::{Comparison, FloatFormat, Operation, Policy, Rounding};

const SEED: u64 = 0x0405_7e9d;
const CASES: u64 = 1_000_000;
const OPERATIONS: [Operation; 6] = [
    Operation::Add,
    Operation::Subtract,
    Operation::Multiply,
    Operation::Divide,
    Operation::SquareRoot,
    Operation::FusedMultiplyAdd,
];

macro_rules! agree_with {
    ($name:ident, $host:ty, $bits:ty, $exponent_bits:literal, $fraction_bits:literal) => {
        #[test]
        fn $name() {
            const FORMAT: FloatFormat = FloatFormat::new($exponent_bits, $fraction_bits);
            for operation in OPERATIONS {
                let compared: u64 = (0..CASES)
                    .into_par_iter()
                    .map(|index| {
                        let subject = Subject::Operation(operation);
                        let case = operands::case(subject, FORMAT, SEED, index);
                        let [a, b, c] = case.operands.map(|bits| <$host>::from_bits(bits as $bits));
                        let host = match operation {
                            Operation::Add => a + b,
                            Operation::Subtract => a - b,
                            Operation::Multiply => a * b,
                            Operation::Divide => a / b,
                            Operation::SquareRoot => a.sqrt(),
                            _ => a.mul_add(b, c),
                        };
                        let expected = if host.is_nan() {
                            FORMAT.quiet_nan()
                        } else {
                            u64::from(host.to_bits())
                        };
                        let agrees = |policy| {
                            let arithmetic = FORMAT.arithmetic(policy, Rounding::NearestEven);
                            let actual = operation.evaluate(arithmetic, case.operands).bits;
                            assert_eq!(
                                actual, expected,
                                "{operation} of {:x?} in {FORMAT}, {policy}, gives {actual:#x}, \
                                 the host {expected:#x} (seed {SEED:#x}, index {index})",
                                case.operands
                            );
                            arithmetic
                        };
                        let full = agrees(Policy::Full);
                        let quiet = Comparison::Quiet;
                        let [x, y, _] = case.operands;
                        assert_eq!(full.less_than(quiet, x, y).0, a < b);
                        assert_eq!(full.less_equal(quiet, x, y).0, a <= b);
                        assert_eq!(full.compare(quiet, x, y).0, a.partial_cmp(&b));
                        for (rounding, integral) in [
                            (Rounding::NearestEven, a.round_ties_even()),
                            (Rounding::TowardZero, a.trunc()),
                            (Rounding::Up, a.ceil()),
                            (Rounding::Down, a.floor()),
                        ] {
                            let full = FORMAT.arithmetic(Policy::Full, rounding);
                            if !integral.is_nan() {
                                let ours = full.round_to_integral(x).bits;
                                assert_eq!(ours, u64::from(integral.to_bits()));
                            }
                        }
                        let tiny = host != 0.0 && host.abs() <= <$host>::MIN_POSITIVE;
                        // A zero that the host got from tiny numbers is one of ours, too.
                        if [a, b, c].iter().any(|one| one.is_subnormal()) || tiny {
                            return 0;
                        }
                        agrees(Policy::Flush);
                        1
                    })
                    .sum();
                assert!(
                    compared > CASES / 2,
                    "only {compared} of {CASES} cases of {operation} could be compared"
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
        let full = format.arithmetic(Policy::Full, Rounding::NearestEven);
        assert_eq!(
            full.from_f64(wide).bits,
            u64::from(host.to_bits()),
            "{wide:e}"
        );
        let ours = format.from_f64(Rounding::NearestEven, wide);
        assert_eq!(ours, u64::from(host.to_bits()), "{wide:e}");
        compared += 1;
    }
    assert!(compared > CASES / 2, "only {compared} values compared");
}
