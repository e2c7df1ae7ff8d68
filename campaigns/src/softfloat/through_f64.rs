//! Formats of at most 25 significant bits and 8 exponent bits, through SoftFloat's 64-bit floats.
//!
//! Every such number is a normal `F64`, and so is every result, as far as its exponent goes. Truncating
//! there and setting the last bit where anything was lost ("rounding to odd") leaves 53 bits that
//! round to the narrower format as the exact result does, under every rounding.

use rtl_model::float::{Answer, Flags, FloatArithmetic, FloatFormat, Operation, Policy, Rounding};
use softfloat_wrapper::{F64, Float, RoundingMode};

use super::{mode, native, truth, with_flags};

/// The answer in this arithmetic.
pub fn answer(arithmetic: FloatArithmetic, operation: Operation, operands: [u64; 3]) -> Answer {
    let number = |operand: u64| widened(arithmetic, operand);
    if let Operation::FromInteger(source) = operation {
        return rounded(arithmetic, |rounding| {
            native::from_integer(source, operands[0], rounding)
        });
    }
    let a = number(operands[0]);
    let b = number(operands[1]);
    match operation {
        Operation::Add => rounded(arithmetic, |rounding| a.add(b, mode(rounding))),
        Operation::Subtract => rounded(arithmetic, |rounding| a.sub(b, mode(rounding))),
        Operation::Multiply => rounded(arithmetic, |rounding| a.mul(b, mode(rounding))),
        Operation::Divide => rounded(arithmetic, |rounding| a.div(b, mode(rounding))),
        Operation::SquareRoot => rounded(arithmetic, |rounding| a.sqrt(mode(rounding))),
        Operation::FusedMultiplyAdd => {
            let c = number(operands[2]);
            rounded(arithmetic, |rounding| a.fused_mul_add(b, c, mode(rounding)))
        }
        Operation::RoundToIntegral => rounded(arithmetic, |_| {
            a.round_to_integral(mode(arithmetic.rounding))
        }),
        Operation::Compare(relation, kind) => truth(native::compare(relation, kind, &a, &b)),
        Operation::ToIntegerExact(target) => {
            let (value, flags) = native::to_integer(target, &a, arithmetic.rounding);
            Answer {
                bits: if a.is_nan() { 0 } else { value },
                flags,
            }
        }
        // Times one: turns a signalling NaN into an invalid operation, and nothing else into
        // anything.
        Operation::ToFloat(target) => {
            let target = target.arithmetic(arithmetic.policy, arithmetic.rounding);
            rounded(target, |_| a.mul(power_of_two(0), RoundingMode::TowardZero))
        }
        _ => unreachable!("not a judged operation"),
    }
}

/// 2 to this power, which is within the range of normal numbers.
fn power_of_two(power: i64) -> F64 {
    F64::from_bits(((power + 1023) as u64) << 52)
}

/// `a * 2^power`, exact where the result is a normal number.
fn scaled(a: F64, power: i64) -> F64 {
    a.mul(power_of_two(power), RoundingMode::TowardZero)
}

/// The number of a pattern: exact; a NaN stays quiet or signalling.
fn widened(arithmetic: FloatArithmetic, pattern: u64) -> F64 {
    let format = arithmetic.format;
    let sign = pattern >> (format.width() - 1) & 1;
    let field = pattern >> format.fraction_bits & format.exponent_all_ones();
    let fraction = pattern & format.fraction_mask();
    let magnitude = if field == format.exponent_all_ones() {
        F64::from_bits(0x7ff << 52 | fraction << (52 - format.fraction_bits))
    } else if field == 0 && arithmetic.policy == Policy::Flush {
        F64::from_bits(0)
    } else {
        let hidden = u64::from(field != 0) << format.fraction_bits;
        let integer = F64::from_u64(fraction | hidden, RoundingMode::TowardZero);
        let scale = field.max(1) as i64
            - i64::from(format.exponent_bias())
            - i64::from(format.fraction_bits);
        if integer.to_bits() == 0 {
            integer
        } else {
            scaled(integer, scale)
        }
    };
    F64::from_bits(magnitude.to_bits() | sign << 63)
}

/// The result of `operation`, rounded once to the format: it is called with a rounding for `F64`.
fn rounded(arithmetic: FloatArithmetic, operation: impl Fn(Rounding) -> F64) -> Answer {
    let format = arithmetic.format;
    let (truncated, flags) = with_flags(|| operation(Rounding::TowardZero));
    let sign = (truncated.to_bits() >> 63) << (format.width() - 1);
    if truncated.is_nan() {
        return Answer {
            bits: format.quiet_nan(),
            flags,
        };
    }
    if truncated.is_positive_infinity() || truncated.is_negative_infinity() {
        return Answer {
            bits: sign | format.infinity(),
            flags,
        };
    }
    if truncated.to_bits() << 1 == 0 {
        // Exactly zero: its sign may depend on the rounding.
        let (zero, flags) = with_flags(|| operation(arithmetic.rounding));
        return Answer {
            bits: (zero.to_bits() >> 63) << (format.width() - 1),
            flags,
        };
    }
    let lost = u64::from(flags.contains(Flags::INEXACT));
    let odd = F64::from_bits(truncated.to_bits() | lost);

    let exponent = (odd.to_bits() >> 52 & 0x7ff) as i64 - 1023;
    let least_normal = 1 - i64::from(format.exponent_bias());
    let places = i64::from(format.fraction_bits);
    let (free, free_inexact) = at_place(odd, exponent - places, arithmetic.rounding);
    let magnitude = |value: F64| F64::from_bits(value.to_bits() & (u64::MAX >> 1));
    let past_the_end = power_of_two(i64::from(format.exponent_bias()) + 1);
    if past_the_end.le_quiet(magnitude(free)) {
        // Twice the largest F64 says whether this rounding goes to infinity.
        let largest = F64::from_bits(odd.to_bits() & 1 << 63 | 0x7fef_ffff_ffff_ffff);
        let beyond = largest.add(largest, mode(arithmetic.rounding));
        let is_infinite = beyond.to_bits() << 1 >> 1 == 0x7ff << 52;
        return Answer {
            bits: sign
                | if is_infinite {
                    format.infinity()
                } else {
                    format.max_finite()
                },
            flags: Flags::OVERFLOW | Flags::INEXACT,
        };
    }
    let tiny = magnitude(free).lt_quiet(power_of_two(least_normal));
    if tiny && arithmetic.policy == Policy::Flush {
        return Answer {
            bits: sign,
            flags: Flags::UNDERFLOW | Flags::INEXACT,
        };
    }
    let (value, inexact) = if arithmetic.policy == Policy::Full && exponent < least_normal {
        at_place(odd, least_normal - places, arithmetic.rounding)
    } else {
        (free, free_inexact)
    };
    Answer {
        bits: sign | pattern(format, magnitude(value)),
        flags: Flags::INEXACT.when(inexact) | Flags::UNDERFLOW.when(inexact && tiny),
    }
}

/// Rounded to a multiple of 2^place, and whether that changed it.
fn at_place(value: F64, place: i64, rounding: Rounding) -> (F64, bool) {
    let units = scaled(value, -place);
    let whole = units.round_to_integral(mode(rounding));
    let inexact = whole.to_bits() != units.to_bits();
    if whole.to_bits() << 1 == 0 {
        return (whole, inexact);
    }
    (scaled(whole, place), inexact)
}

/// The pattern of a magnitude that the format has.
fn pattern(format: FloatFormat, value: F64) -> u64 {
    let smallest = i64::from(format.exponent_bias()) - 1 + i64::from(format.fraction_bits);
    let exponent = (value.to_bits() >> 52) as i64 - 1023;
    let least_normal = 1 - i64::from(format.exponent_bias());
    if value.to_bits() == 0 {
        0
    } else if exponent < least_normal {
        scaled(value, smallest).to_u64(RoundingMode::TowardZero, false)
    } else {
        let field = (exponent + i64::from(format.exponent_bias())) as u64;
        let fraction = value.to_bits() & ((1 << 52) - 1);
        field << format.fraction_bits | fraction >> (52 - format.fraction_bits)
    }
}
