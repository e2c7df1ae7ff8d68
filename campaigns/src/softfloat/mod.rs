//! Berkeley SoftFloat as the judge of the golden arithmetic, results and flags.
//!
//! At `e5f10` and `e8f23` SoftFloat has the format itself (`native`). Any narrower format (`e8f7`,
//! `e7f16`) is judged through SoftFloat's 64-bit floats (`through_f64`): the operation truncated there, with the
//! last bit set where it was inexact, so that nothing is rounded twice; then scaled so that the
//! last place to be kept is a one, rounded to an integer by SoftFloat, and scaled back.
//!
//! The specialisation is that for RISC-V: every NaN result is the canonical quiet NaN, and tininess is detected
//! after rounding. Its conversions to integers saturate as ours do, but for NaN, which is the
//! largest integer there and 0 here: of a NaN only the flags are compared.

mod native;
mod through_f64;

use rtl_model::float::{
    Answer, Comparison, Flags, FloatArithmetic, FloatFormat, IntegerFormat, Operation, Policy,
    Relation, Rounding,
};
use softfloat_wrapper::{ExceptionFlags, RoundingMode};

use crate::formats::{HALF, SINGLE};
use crate::operands::Operands;
use crate::sweep::{Difference, Outcome, sweep};

/// SoftFloat's name of a rounding.
fn mode(rounding: Rounding) -> RoundingMode {
    match rounding {
        Rounding::NearestEven => RoundingMode::TiesToEven,
        Rounding::TowardZero => RoundingMode::TowardZero,
        Rounding::Up => RoundingMode::TowardPositive,
        Rounding::Down => RoundingMode::TowardNegative,
    }
}

/// A value with the flags that SoftFloat raised for it, in this thread.
fn with_flags<T>(operation: impl FnOnce() -> T) -> (T, Flags) {
    ExceptionFlags::from_bits(0).set();
    let value = operation();
    let mut raised = ExceptionFlags::default();
    raised.get();
    // The bits stand in the same order.
    (value, Flags::from_bits(raised.to_bits()))
}

/// The integers that SoftFloat converts from and to.
const INTEGERS: [IntegerFormat; 4] = [
    IntegerFormat::I32,
    IntegerFormat::U32,
    IntegerFormat::I64,
    IntegerFormat::U64,
];

/// The operations that are judged in a format; conversions to `targets`. SoftFloat's other functions
/// are the same ones by other names, or belong to no operator of this project.
pub fn judged_operations(targets: &[FloatFormat]) -> Vec<Operation> {
    let mut all = vec![
        Operation::Add,
        Operation::Subtract,
        Operation::Multiply,
        Operation::Divide,
        Operation::SquareRoot,
        Operation::FusedMultiplyAdd,
        Operation::RoundToIntegral,
    ];
    for relation in [Relation::Equal, Relation::LessThan, Relation::LessEqual] {
        all.extend(Comparison::ALL.map(|kind| Operation::Compare(relation, kind)));
    }
    all.extend(INTEGERS.map(Operation::ToIntegerExact));
    all.extend(INTEGERS.map(Operation::FromInteger));
    all.extend(targets.iter().map(|&target| Operation::ToFloat(target)));
    all
}

/// A predicate's answer.
fn truth((holds, flags): (bool, Flags)) -> Answer {
    Answer {
        bits: holds.into(),
        flags,
    }
}

/// A judge of one arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judge {
    /// SoftFloat's own format of this width.
    Native(Rounding, u32),
    /// SoftFloat's 64-bit floats, for narrower formats.
    ThroughF64(FloatArithmetic),
}

impl Judge {
    /// SoftFloat's own format where it has this one, under the policy `full`.
    pub fn new(arithmetic: FloatArithmetic) -> Judge {
        let FloatArithmetic {
            format,
            policy,
            rounding,
        } = arithmetic;
        let own = [HALF, SINGLE].contains(&format);
        if own && policy == Policy::Full {
            Judge::Native(rounding, format.width())
        } else {
            Judge::ThroughF64(arithmetic)
        }
    }

    /// Has SoftFloat the format itself?
    pub fn is_native(self) -> bool {
        matches!(self, Judge::Native(..))
    }

    /// What it is called in tables.
    pub fn name(self) -> &'static str {
        match self {
            Judge::Native(_, 16) => "SoftFloat f16",
            Judge::Native(..) => "SoftFloat f32",
            Judge::ThroughF64(_) => "SoftFloat f64, rounded once",
        }
    }

    /// Its answer.
    #[inline]
    pub fn answer(self, operation: Operation, operands: [u64; 3]) -> Answer {
        match self {
            Judge::Native(rounding, 16) => {
                native::answer::<softfloat_wrapper::F16>(rounding, operation, operands)
            }
            Judge::Native(rounding, _) => {
                native::answer::<softfloat_wrapper::F32>(rounding, operation, operands)
            }
            Judge::ThroughF64(arithmetic) => through_f64::answer(arithmetic, operation, operands),
        }
    }
}

/// The golden arithmetic against its judge on `count` cases, or all where there are no more; and
/// whether these were all.
pub fn compare(
    arithmetic: FloatArithmetic,
    operation: Operation,
    count: u64,
    seed: u64,
    progress: &(dyn Fn(u64) + Sync),
) -> (Outcome, bool) {
    compare_with(arithmetic, operation, count, seed, progress, |answer, _| {
        answer
    })
}

/// As [`compare`], with the golden answer as `alter` leaves it: for planting faults.
pub fn compare_with(
    arithmetic: FloatArithmetic,
    operation: Operation,
    count: u64,
    seed: u64,
    progress: &(dyn Fn(u64) + Sync),
    alter: impl Fn(Answer, [u64; 3]) -> Answer + Sync,
) -> (Outcome, bool) {
    let judge = Judge::new(arithmetic);
    let operands = Operands::new(operation, arithmetic.format, count, seed);
    let outcome = sweep(
        operands.count(),
        |cases, tell| {
            for index in cases {
                let set = operands.set(index);
                let golden = alter(operation.evaluate(arithmetic, set), set);
                let judged = judge.answer(operation, set);
                if golden != judged {
                    tell(Difference {
                        index,
                        operands: set[..operands.width()].to_vec(),
                        golden: vec![golden.bits, golden.flags.bits().into()],
                        other: vec![judged.bits, judged.flags.bits().into()],
                    });
                }
            }
        },
        progress,
    );
    (outcome, operands.is_exhaustive())
}
