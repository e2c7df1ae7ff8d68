//! The exact result of every operator, in big integers.

use std::cmp::Ordering;

use num_bigint::{BigInt, BigUint, Sign};
use num_traits::{One, ToPrimitive, Zero};
use rtl_model::float::{FloatFormat, Rounding};

use super::neighbours::{Exact, Value, decode, infinity, not_a_number, round, zero};

/// `mantissa * 2^(exponent - unit)` with its sign, as an integer.
fn in_units(negative: bool, mantissa: u64, exponent: i64, unit: i64) -> BigInt {
    let magnitude = BigUint::from(mantissa) << (exponent - unit);
    let sign = if negative { Sign::Minus } else { Sign::Plus };
    BigInt::from_biguint(sign, magnitude)
}

fn opposite(value: Value) -> Value {
    match value {
        Value::NotANumber => Value::NotANumber,
        Value::Infinite { negative } => Value::Infinite {
            negative: !negative,
        },
        Value::Finite {
            negative,
            mantissa,
            exponent,
        } => Value::Finite {
            negative: !negative,
            mantissa,
            exponent,
        },
    }
}

pub fn add(format: FloatFormat, rounding: Rounding, a: u64, b: u64) -> u64 {
    add_values(format, rounding, decode(format, a), decode(format, b))
}

pub fn sub(format: FloatFormat, rounding: Rounding, a: u64, b: u64) -> u64 {
    add_values(
        format,
        rounding,
        decode(format, a),
        opposite(decode(format, b)),
    )
}

fn add_values(format: FloatFormat, rounding: Rounding, a: Value, b: Value) -> u64 {
    use Value::{Finite, Infinite, NotANumber};
    match (a, b) {
        (NotANumber, _) | (_, NotANumber) => not_a_number(format),
        (Infinite { negative: x }, Infinite { negative: y }) if x != y => not_a_number(format),
        (Infinite { negative }, _) | (_, Infinite { negative }) => infinity(format, negative),
        (
            Finite {
                negative: a_negative,
                mantissa: a,
                exponent: a_exponent,
            },
            Finite {
                negative: b_negative,
                mantissa: b,
                exponent: b_exponent,
            },
        ) => {
            let unit = a_exponent.min(b_exponent);
            let sum = in_units(a_negative, a, a_exponent, unit)
                + in_units(b_negative, b, b_exponent, unit);
            let (sign, numerator) = sum.into_parts();
            if sign == Sign::NoSign {
                let same_signed_zeros = a == 0 && b == 0 && a_negative == b_negative;
                let negative = if same_signed_zeros {
                    a_negative
                } else {
                    rounding == Rounding::Down
                };
                return zero(format, negative);
            }
            round(
                format,
                rounding,
                &Exact {
                    negative: sign == Sign::Minus,
                    numerator,
                    denominator: BigUint::one(),
                    exponent: i128::from(unit),
                },
            )
        }
    }
}

pub fn mul(format: FloatFormat, rounding: Rounding, a: u64, b: u64) -> u64 {
    use Value::{Finite, Infinite, NotANumber};
    match (decode(format, a), decode(format, b)) {
        (NotANumber, _) | (_, NotANumber) => not_a_number(format),
        (Infinite { .. }, Finite { mantissa: 0, .. })
        | (Finite { mantissa: 0, .. }, Infinite { .. }) => not_a_number(format),
        (Infinite { negative: x }, Infinite { negative: y } | Finite { negative: y, .. })
        | (Finite { negative: x, .. }, Infinite { negative: y }) => infinity(format, x != y),
        (
            Finite {
                negative: a_negative,
                mantissa: a,
                exponent: a_exponent,
            },
            Finite {
                negative: b_negative,
                mantissa: b,
                exponent: b_exponent,
            },
        ) => {
            let negative = a_negative != b_negative;
            let numerator = BigUint::from(a) * BigUint::from(b);
            if numerator.is_zero() {
                return zero(format, negative);
            }
            round(
                format,
                rounding,
                &Exact {
                    negative,
                    numerator,
                    denominator: BigUint::one(),
                    exponent: i128::from(a_exponent + b_exponent),
                },
            )
        }
    }
}

pub fn div(format: FloatFormat, rounding: Rounding, a: u64, b: u64) -> u64 {
    use Value::{Finite, Infinite, NotANumber};
    match (decode(format, a), decode(format, b)) {
        (NotANumber, _) | (_, NotANumber) | (Infinite { .. }, Infinite { .. }) => {
            not_a_number(format)
        }
        (Finite { mantissa: 0, .. }, Finite { mantissa: 0, .. }) => not_a_number(format),
        (Infinite { negative: x }, Finite { negative: y, .. })
        | (
            Finite { negative: x, .. },
            Finite {
                negative: y,
                mantissa: 0,
                ..
            },
        ) => infinity(format, x != y),
        (Finite { negative: x, .. }, Infinite { negative: y })
        | (
            Finite {
                negative: x,
                mantissa: 0,
                ..
            },
            Finite { negative: y, .. },
        ) => zero(format, x != y),
        (
            Finite {
                negative: a_negative,
                mantissa: a,
                exponent: a_exponent,
            },
            Finite {
                negative: b_negative,
                mantissa: b,
                exponent: b_exponent,
            },
        ) => round(
            format,
            rounding,
            &Exact {
                negative: a_negative != b_negative,
                numerator: BigUint::from(a),
                denominator: BigUint::from(b),
                exponent: i128::from(a_exponent - b_exponent),
            },
        ),
    }
}

/// The order of two values; `None` where either is NaN.
pub fn compare(format: FloatFormat, a: u64, b: u64) -> Option<Ordering> {
    use Value::{Finite, Infinite, NotANumber};
    /// -1, 0 or 1: below, among or above the finite numbers.
    fn band(value: &Value) -> i32 {
        match value {
            Infinite { negative: true } => -1,
            Infinite { negative: false } => 1,
            _ => 0,
        }
    }
    match (decode(format, a), decode(format, b)) {
        (NotANumber, _) | (_, NotANumber) => None,
        (
            Finite {
                negative: a_negative,
                mantissa: a,
                exponent: a_exponent,
            },
            Finite {
                negative: b_negative,
                mantissa: b,
                exponent: b_exponent,
            },
        ) => {
            let unit = a_exponent.min(b_exponent);
            let a = in_units(a_negative, a, a_exponent, unit);
            Some(a.cmp(&in_units(b_negative, b, b_exponent, unit)))
        }
        (a, b) => Some(band(&a).cmp(&band(&b))),
    }
}

/// `minimumNumber` where `wanted` is `Less`, `maximumNumber` where it is `Greater`.
pub fn extreme(format: FloatFormat, wanted: Ordering, a: u64, b: u64) -> u64 {
    let read = |pattern| match decode(format, pattern) {
        Value::NotANumber => not_a_number(format),
        Value::Finite {
            negative,
            mantissa: 0,
            ..
        } => zero(format, negative),
        _ => pattern,
    };
    match (decode(format, a), decode(format, b), compare(format, a, b)) {
        (Value::NotANumber, _, _) => read(b),
        (_, Value::NotANumber, _) => read(a),
        (_, _, Some(order)) if order == wanted => read(a),
        (_, _, Some(order)) if order == wanted.reverse() => read(b),
        (
            Value::Finite {
                negative: x,
                mantissa: 0,
                ..
            },
            Value::Finite { negative: y, .. },
            _,
        ) => {
            let negative = if wanted == Ordering::Less {
                x || y
            } else {
                x && y
            };
            zero(format, negative)
        }
        _ => a,
    }
}

pub fn from_integer(format: FloatFormat, rounding: Rounding, value: i64, exponent: i64) -> u64 {
    let (sign, numerator) = BigInt::from(value).into_parts();
    if sign == Sign::NoSign {
        return zero(format, false);
    }
    round(
        format,
        rounding,
        &Exact {
            negative: sign == Sign::Minus,
            numerator,
            denominator: BigUint::one(),
            exponent: i128::from(exponent),
        },
    )
}

/// The largest integer at or below a finite value, and what it is short of the value by, in units
/// of `1 / denominator`.
fn floor_and_rest(negative: bool, mantissa: u64, exponent: i64) -> (BigInt, BigUint, BigUint) {
    if exponent >= 0 {
        let integer = in_units(negative, mantissa, exponent, 0);
        return (integer, BigUint::zero(), BigUint::one());
    }
    let denominator = BigUint::one() << -exponent;
    let numerator = BigUint::from(mantissa);
    let quotient = &numerator / &denominator;
    let rest = numerator - &quotient * &denominator;
    match (negative, rest.is_zero()) {
        (false, _) => (quotient.into(), rest, denominator),
        (true, true) => (-BigInt::from(quotient), rest, denominator),
        (true, false) => {
            let rest = &denominator - rest;
            (-BigInt::from(quotient) - 1, rest, denominator)
        }
    }
}

/// The rounded integer; `Err` with NaN as `None`, or the side of the range of `i64` it falls on.
pub fn to_integer(
    format: FloatFormat,
    rounding: Rounding,
    a: u64,
) -> Result<i64, Option<Ordering>> {
    let (negative, mantissa, exponent) = match decode(format, a) {
        Value::NotANumber => return Err(None),
        Value::Infinite { negative: true } => return Err(Some(Ordering::Less)),
        Value::Infinite { negative: false } => return Err(Some(Ordering::Greater)),
        Value::Finite {
            negative,
            mantissa,
            exponent,
        } => (negative, mantissa, exponent),
    };
    let (floor, rest, denominator) = floor_and_rest(negative, mantissa, exponent);
    let goes_up = !rest.is_zero()
        && match rounding {
            Rounding::Up => true,
            Rounding::Down => false,
            Rounding::TowardZero => negative,
            Rounding::NearestEven => match (&rest + &rest).cmp(&denominator) {
                Ordering::Less => false,
                Ordering::Equal => (&floor % 2u32) != BigInt::zero(),
                Ordering::Greater => true,
            },
        };
    let integer = if goes_up { floor + 1 } else { floor };
    integer.to_i64().ok_or(Some(integer.cmp(&BigInt::zero())))
}

pub fn floor(format: FloatFormat, a: u64) -> u64 {
    match decode(format, a) {
        Value::NotANumber => not_a_number(format),
        Value::Infinite { .. } => a,
        Value::Finite {
            negative,
            mantissa: 0,
            ..
        } => zero(format, negative),
        Value::Finite {
            negative,
            mantissa,
            exponent,
        } => {
            let (floor, _, _) = floor_and_rest(negative, mantissa, exponent);
            let (sign, numerator) = floor.into_parts();
            if sign == Sign::NoSign {
                return zero(format, false);
            }
            let exact = Exact {
                negative: sign == Sign::Minus,
                numerator,
                denominator: BigUint::one(),
                exponent: 0,
            };
            round(format, Rounding::Down, &exact)
        }
    }
}
