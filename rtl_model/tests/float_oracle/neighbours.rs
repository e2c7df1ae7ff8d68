//! What a pattern stands for, and the pattern an exact value is rounded to: the nearer of two
//! neighbours, found in big integers.

use std::cmp::Ordering;

use num_bigint::BigUint;
use num_traits::{ToPrimitive, Zero};
use rtl_model::float::{Flags, FloatFormat, Policy, Rounding};

/// What a result depends on beside its operands.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    pub format: FloatFormat,
    pub policy: Policy,
    pub rounding: Rounding,
}

/// A result and the flags it raises.
pub type Result = (u64, Flags);

/// What a pattern stands for.
#[derive(Clone, Debug)]
pub enum Value {
    NotANumber {
        signalling: bool,
    },
    Infinite {
        negative: bool,
    },
    /// `mantissa * 2^exponent`, negated where `negative`; a zero has the mantissa 0.
    Finite {
        negative: bool,
        mantissa: u64,
        exponent: i64,
    },
}

/// A nonzero rational times a power of two, or zero.
pub struct Exact {
    pub negative: bool,
    pub numerator: BigUint,
    pub denominator: BigUint,
    pub exponent: i128,
}

/// `2^(E-1) - 1`.
fn bias(format: FloatFormat) -> i64 {
    2i64.pow(format.exponent_bits - 1) - 1
}

/// The pattern of these three fields.
fn encode(format: FloatFormat, negative: bool, exponent_field: u64, fraction: u64) -> u64 {
    let fractions = 2u64.pow(format.fraction_bits);
    let exponents = 2u64.pow(format.exponent_bits);
    u64::from(negative) * (exponents * fractions) + exponent_field * fractions + fraction
}

pub fn zero(format: FloatFormat, negative: bool) -> u64 {
    encode(format, negative, 0, 0)
}

pub fn infinity(format: FloatFormat, negative: bool) -> u64 {
    encode(format, negative, 2u64.pow(format.exponent_bits) - 1, 0)
}

pub fn not_a_number(format: FloatFormat) -> u64 {
    let all_ones = 2u64.pow(format.exponent_bits) - 1;
    encode(format, false, all_ones, 2u64.pow(format.fraction_bits) / 2)
}

fn max_finite(format: FloatFormat, negative: bool) -> u64 {
    let largest_field = 2u64.pow(format.exponent_bits) - 2;
    let largest_fraction = 2u64.pow(format.fraction_bits) - 1;
    encode(format, negative, largest_field, largest_fraction)
}

/// Reads a pattern; under `flush` a subnormal one is a zero.
pub fn decode(format: FloatFormat, policy: Policy, pattern: u64) -> Value {
    let fractions = 2u64.pow(format.fraction_bits);
    let exponents = 2u64.pow(format.exponent_bits);
    let fraction = pattern % fractions;
    let field = pattern / fractions % exponents;
    let negative = pattern / fractions / exponents == 1;
    if field == exponents - 1 {
        if fraction == 0 {
            Value::Infinite { negative }
        } else {
            Value::NotANumber {
                signalling: fraction < fractions / 2,
            }
        }
    } else {
        let mantissa = match (field, policy) {
            (0, Policy::Flush) => 0,
            (0, Policy::Full) => fraction,
            _ => fractions + fraction,
        };
        Value::Finite {
            negative,
            mantissa,
            exponent: field.max(1) as i64 - bias(format) - i64::from(format.fraction_bits),
        }
    }
}

/// Does rounding choose the neighbour of larger magnitude?
/// `nearer` tells whether the exact value is nearer to the smaller (`Less`) or larger one.
fn takes_larger(
    rounding: Rounding,
    negative: bool,
    nearer: Ordering,
    smaller_is_even: bool,
) -> bool {
    match rounding {
        Rounding::TowardZero => false,
        Rounding::Up => !negative,
        Rounding::Down => negative,
        Rounding::NearestEven => match nearer {
            Ordering::Less => false,
            Ordering::Equal => !smaller_is_even,
            Ordering::Greater => true,
        },
    }
}

/// The quotient `numerator / denominator * 2^exponent` in units of `2^unit`, rounded to an integer;
/// and whether it was none. `None` if it has more than `digits` bits before rounding.
fn to_units(
    rounding: Rounding,
    exact: &Exact,
    unit: i128,
    digits: u64,
) -> Option<(u64, bool, u64)> {
    let shift = exact.exponent - unit;
    let (numerator, denominator) = if shift >= 0 {
        (&exact.numerator << shift, exact.denominator.clone())
    } else {
        (exact.numerator.clone(), &exact.denominator << -shift)
    };
    let lower = &numerator / &denominator;
    if lower.bits() > digits {
        return None;
    }
    let below = numerator - &lower * &denominator;
    let bits = lower.bits();
    let lower = lower.to_u64().expect("F + 1 bits");
    if below.is_zero() {
        return Some((lower, false, bits));
    }
    // The exact value is `below` above the lower neighbour and `above` below the upper one.
    let above = denominator - &below;
    let larger = takes_larger(
        rounding,
        exact.negative,
        below.cmp(&above),
        lower.is_multiple_of(2),
    );
    Some((lower + u64::from(larger), true, bits))
}

/// Rounds a nonzero exact result: searches the power of two at which it lies between two
/// neighbouring `F + 1`-bit integers, and compares it with both. What is too small for that is
/// rounded to a multiple of the smallest subnormal number, or flushed.
pub fn round(rules: Rules, exact: &Exact) -> Result {
    let Rules {
        format,
        policy,
        rounding,
    } = rules;
    let negative = exact.negative;
    let digits = u64::from(format.fraction_bits) + 1;
    let smallest = 2u64.pow(format.fraction_bits);

    // The quotient has `digits` bits or one more at this unit; never fewer.
    let mut unit = exact.numerator.bits() as i128 - exact.denominator.bits() as i128
        + exact.exponent
        - i128::from(digits);
    let (chosen, inexact) = loop {
        match to_units(rounding, exact, unit, digits) {
            None => unit += 1,
            Some((chosen, inexact, bits)) => {
                assert_eq!(bits, digits, "the first unit tried is never too coarse");
                break (chosen, inexact);
            }
        }
    };
    let raise = |flag: Flags, condition| if condition { flag } else { Flags::NONE };
    let least_unit = 1 - i128::from(bias(format)) - i128::from(format.fraction_bits);
    let below_normal = unit < least_unit;

    // The upper neighbour may be the next power of two.
    let (significand, unit) = if chosen == 2 * smallest {
        (smallest, unit + 1)
    } else {
        (chosen, unit)
    };
    let field = unit + i128::from(format.fraction_bits) + i128::from(bias(format));
    let largest_field = 2i128.pow(format.exponent_bits) - 2;
    if field > largest_field {
        let pattern = match (rounding, negative) {
            (Rounding::NearestEven, _) | (Rounding::Up, false) | (Rounding::Down, true) => {
                infinity(format, negative)
            }
            _ => max_finite(format, negative),
        };
        return (pattern, Flags::OVERFLOW | Flags::INEXACT);
    }
    let tiny = field < 1;
    match policy {
        Policy::Flush if tiny => (zero(format, negative), Flags::UNDERFLOW | Flags::INEXACT),
        Policy::Full if below_normal => {
            let (multiple, inexact, _) = to_units(rounding, exact, least_unit, digits)
                .expect("less than the smallest normal number");
            // The smallest normal number is one of these multiples, and its pattern, too.
            (
                zero(format, negative) + multiple,
                raise(Flags::INEXACT, inexact) | raise(Flags::UNDERFLOW, inexact && tiny),
            )
        }
        _ => (
            encode(format, negative, field as u64, significand - smallest),
            raise(Flags::INEXACT, inexact),
        ),
    }
}
