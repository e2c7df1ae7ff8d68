//! What a pattern stands for, and the pattern an exact value is rounded to: the nearer of two
//! neighbours, found in big integers.

use std::cmp::Ordering;

use num_bigint::BigUint;
use num_traits::{ToPrimitive, Zero};
use rtl_model::float::{FloatFormat, Rounding};

/// What a pattern stands for, subnormals read as zeros.
#[derive(Clone, Debug)]
pub enum Value {
    NotANumber,
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

/// Reads a pattern.
pub fn decode(format: FloatFormat, pattern: u64) -> Value {
    let fractions = 2u64.pow(format.fraction_bits);
    let exponents = 2u64.pow(format.exponent_bits);
    let fraction = pattern % fractions;
    let field = pattern / fractions % exponents;
    let negative = pattern / fractions / exponents == 1;
    if field == exponents - 1 {
        if fraction == 0 {
            Value::Infinite { negative }
        } else {
            Value::NotANumber
        }
    } else {
        Value::Finite {
            negative,
            mantissa: if field == 0 { 0 } else { fractions + fraction },
            exponent: field as i64 - bias(format) - i64::from(format.fraction_bits),
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

/// Rounds a nonzero exact result: searches the power of two at which it lies between two
/// neighbouring `F + 1`-bit integers, and compares it with both.
pub fn round(format: FloatFormat, rounding: Rounding, exact: &Exact) -> u64 {
    let negative = exact.negative;
    let digits = u64::from(format.fraction_bits) + 1;
    let smallest = 2u64.pow(format.fraction_bits);

    // The quotient has `digits` bits or one more at this unit; never fewer.
    let mut unit = exact.numerator.bits() as i128 - exact.denominator.bits() as i128
        + exact.exponent
        - i128::from(digits);
    let (lower, below, scaled_denominator) = loop {
        // numerator / denominator * 2^exponent / 2^unit
        let shift = exact.exponent - unit;
        let (numerator, denominator) = if shift >= 0 {
            (&exact.numerator << shift, exact.denominator.clone())
        } else {
            (exact.numerator.clone(), &exact.denominator << -shift)
        };
        let quotient = &numerator / &denominator;
        let bits = quotient.bits();
        if bits > digits {
            unit += 1;
        } else {
            assert_eq!(bits, digits, "the first unit tried is never too coarse");
            let below = numerator - &quotient * &denominator;
            break (quotient, below, denominator);
        }
    };

    let lower_integer = lower.to_u64().expect("F + 1 bits");
    let chosen = if below.is_zero() {
        lower_integer
    } else {
        // The exact value is `below` above the lower neighbour and `above` below the upper one.
        let above = &scaled_denominator - &below;
        let larger = takes_larger(
            rounding,
            negative,
            below.cmp(&above),
            lower_integer.is_multiple_of(2),
        );
        lower_integer + u64::from(larger)
    };

    // The upper neighbour may be the next power of two.
    let (significand, unit) = if chosen == 2 * smallest {
        (smallest, unit + 1)
    } else {
        (chosen, unit)
    };
    let field = unit + i128::from(format.fraction_bits) + i128::from(bias(format));
    let largest_field = 2i128.pow(format.exponent_bits) - 2;
    if field < 1 {
        zero(format, negative)
    } else if field > largest_field {
        match (rounding, negative) {
            (Rounding::NearestEven, _) | (Rounding::Up, false) | (Rounding::Down, true) => {
                infinity(format, negative)
            }
            _ => max_finite(format, negative),
        }
    } else {
        encode(format, negative, field as u64, significand - smallest)
    }
}
