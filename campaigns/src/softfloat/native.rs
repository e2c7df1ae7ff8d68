//! SoftFloat's own formats.

use num_traits::ToPrimitive;
use rtl_model::float::{
    Answer, Comparison, FloatFormat, IntegerFormat, Operation, Relation, Rounding,
};
use softfloat_wrapper::Float;

use super::{mode, truth, with_flags};
use crate::formats::{HALF, SINGLE};

fn bits(value: impl ToPrimitive) -> u64 {
    value.to_u64().unwrap_or(u64::MAX)
}

/// The answer in the format `T`.
pub fn answer<T: Float>(rounding: Rounding, operation: Operation, operands: [u64; 3]) -> Answer {
    let of = |operand: u64| {
        T::from_bits(num_traits::NumCast::from(operand).expect("a pattern of the format"))
    };
    let to_mode = mode(rounding);
    let (result, flags) = match operation {
        Operation::FromInteger(source) => {
            with_flags(|| bits(from_integer::<T>(source, operands[0], rounding).to_bits()))
        }
        _ => {
            let a = of(operands[0]);
            match operation {
                Operation::Add => with_flags(|| bits(a.add(of(operands[1]), to_mode).to_bits())),
                Operation::Subtract => {
                    with_flags(|| bits(a.sub(of(operands[1]), to_mode).to_bits()))
                }
                Operation::Multiply => {
                    with_flags(|| bits(a.mul(of(operands[1]), to_mode).to_bits()))
                }
                Operation::Divide => with_flags(|| bits(a.div(of(operands[1]), to_mode).to_bits())),
                Operation::SquareRoot => with_flags(|| bits(a.sqrt(to_mode).to_bits())),
                Operation::FusedMultiplyAdd => with_flags(|| {
                    bits(
                        a.fused_mul_add(of(operands[1]), of(operands[2]), to_mode)
                            .to_bits(),
                    )
                }),
                Operation::RoundToIntegral => {
                    with_flags(|| bits(a.round_to_integral(to_mode).to_bits()))
                }
                Operation::Compare(relation, kind) => {
                    return truth(compare(relation, kind, &a, &of(operands[1])));
                }
                Operation::ToIntegerExact(target) => {
                    let (value, flags) = to_integer(target, &a, rounding);
                    (if a.is_nan() { 0 } else { value }, flags)
                }
                Operation::ToFloat(target) => with_flags(|| convert(&a, target, rounding)),
                _ => unreachable!("not a judged operation"),
            }
        }
    };
    Answer {
        bits: result,
        flags,
    }
}

/// The integer as a float.
pub fn from_integer<T: Float>(source: IntegerFormat, value: u64, rounding: Rounding) -> T {
    let mode = mode(rounding);
    match (source.signed, source.bits) {
        (true, 32) => T::from_i32(value as i32, mode),
        (false, 32) => T::from_u32(value as u32, mode),
        (true, _) => T::from_i64(value as i64, mode),
        (false, _) => T::from_u64(value, mode),
    }
}

/// The float as an integer; of NaN, SoftFloat's.
pub fn to_integer<T: Float>(
    target: IntegerFormat,
    a: &T,
    rounding: Rounding,
) -> (u64, rtl_model::float::Flags) {
    let mode = mode(rounding);
    with_flags(|| match (target.signed, target.bits) {
        (true, 32) => u64::from(a.to_i32(mode, true) as u32),
        (false, 32) => u64::from(a.to_u32(mode, true)),
        (true, _) => a.to_i64(mode, true) as u64,
        (false, _) => a.to_u64(mode, true),
    })
}

/// A relation, by the functions that SoftFloat has.
pub fn compare<T: Float>(
    relation: Relation,
    kind: Comparison,
    a: &T,
    b: &T,
) -> (bool, rtl_model::float::Flags) {
    with_flags(|| match (relation, kind) {
        (Relation::Equal, Comparison::Quiet) => a.eq(b),
        (Relation::Equal, Comparison::Signalling) => a.eq_signaling(b),
        (Relation::LessThan, Comparison::Quiet) => a.lt_quiet(b),
        (Relation::LessThan, Comparison::Signalling) => a.lt(b),
        (Relation::LessEqual, Comparison::Quiet) => a.le_quiet(b),
        (Relation::LessEqual, Comparison::Signalling) => a.le(b),
        _ => unreachable!("SoftFloat has three relations, and campaigns ask for no other"),
    })
}

fn convert<T: Float>(a: &T, target: FloatFormat, rounding: Rounding) -> u64 {
    let mode = mode(rounding);
    match target {
        HALF => bits(a.to_f16(mode).to_bits()),
        SINGLE => bits(a.to_f32(mode).to_bits()),
        _ => bits(a.to_f64(mode).to_bits()),
    }
}
