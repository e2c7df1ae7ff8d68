//! The exact result of every operator, in big integers, and the flags it raises.

use std::cmp::Ordering;

use num_bigint::{BigInt, BigUint, Sign};
use num_traits::{One, Zero};
use rtl_model::float::{Comparison, Flags, FloatFormat, IntegerFormat, Relation, Rounding};

use super::neighbours::{Exact, Result, Rules, Value, decode, infinity, not_a_number, round, zero};

use Value::{Finite, Infinite, NotANumber};

/// `mantissa * 2^(exponent - unit)` with its sign, as an integer.
fn in_units(negative: bool, mantissa: &BigUint, exponent: i64, unit: i64) -> BigInt {
    let magnitude = mantissa << (exponent - unit);
    let sign = if negative { Sign::Minus } else { Sign::Plus };
    BigInt::from_biguint(sign, magnitude)
}

/// A finite number of any length: `mantissa * 2^exponent`.
struct Number {
    negative: bool,
    mantissa: BigUint,
    exponent: i64,
}

impl Rules {
    fn read(self, pattern: u64) -> Value {
        decode(self.format, self.policy, pattern)
    }

    fn nan(self, invalid: bool) -> Result {
        let flags = if invalid { Flags::INVALID } else { Flags::NONE };
        (not_a_number(self.format), flags)
    }

    fn infinity(self, negative: bool) -> Result {
        (infinity(self.format, negative), Flags::NONE)
    }

    fn zero(self, negative: bool) -> Result {
        (zero(self.format, negative), Flags::NONE)
    }

    /// The answer where one of these operands is NaN, if one is.
    fn nan_among(self, operands: &[&Value]) -> Option<Result> {
        let signalling: Vec<bool> = operands
            .iter()
            .filter_map(|value| match value {
                NotANumber { signalling } => Some(*signalling),
                _ => None,
            })
            .collect();
        (!signalling.is_empty()).then(|| self.nan(signalling.contains(&true)))
    }

    /// The rounded sum of two numbers.
    fn sum(self, a: &Number, b: &Number) -> Result {
        let unit = a.exponent.min(b.exponent);
        let sum = in_units(a.negative, &a.mantissa, a.exponent, unit)
            + in_units(b.negative, &b.mantissa, b.exponent, unit);
        let (sign, numerator) = sum.into_parts();
        if sign == Sign::NoSign {
            let same_signed_zeros = a.mantissa.is_zero() && a.negative == b.negative;
            return self.zero(if same_signed_zeros {
                a.negative
            } else {
                self.rounding == Rounding::Down
            });
        }
        round(
            self,
            &Exact {
                negative: sign == Sign::Minus,
                numerator,
                denominator: BigUint::one(),
                exponent: i128::from(unit),
            },
        )
    }
}

fn is_zero(value: &Value) -> bool {
    matches!(value, Finite { mantissa: 0, .. })
}

fn is_infinite(value: &Value) -> bool {
    matches!(value, Infinite { .. })
}

fn is_negative(value: &Value) -> bool {
    match value {
        NotANumber { .. } => false,
        Infinite { negative } | Finite { negative, .. } => *negative,
    }
}

fn number(value: &Value) -> Number {
    let Finite {
        negative,
        mantissa,
        exponent,
    } = *value
    else {
        panic!("{value:?} is not finite");
    };
    Number {
        negative,
        mantissa: mantissa.into(),
        exponent,
    }
}

pub fn add(rules: Rules, a: u64, b: u64) -> Result {
    add_values(rules, &rules.read(a), &rules.read(b))
}

pub fn sub(rules: Rules, a: u64, b: u64) -> Result {
    let opposite = match rules.read(b) {
        NotANumber { signalling } => NotANumber { signalling },
        Infinite { negative } => Infinite {
            negative: !negative,
        },
        Finite {
            negative,
            mantissa,
            exponent,
        } => Finite {
            negative: !negative,
            mantissa,
            exponent,
        },
    };
    add_values(rules, &rules.read(a), &opposite)
}

fn add_values(rules: Rules, a: &Value, b: &Value) -> Result {
    if let Some(result) = rules.nan_among(&[a, b]) {
        return result;
    }
    match (a, b) {
        (Infinite { negative: x }, Infinite { negative: y }) if x != y => rules.nan(true),
        (Infinite { negative }, _) | (_, Infinite { negative }) => rules.infinity(*negative),
        _ => rules.sum(&number(a), &number(b)),
    }
}

pub fn mul(rules: Rules, a: u64, b: u64) -> Result {
    let (a, b) = (rules.read(a), rules.read(b));
    if let Some(result) = rules.nan_among(&[&a, &b]) {
        return result;
    }
    let negative = is_negative(&a) != is_negative(&b);
    if is_infinite(&a) || is_infinite(&b) {
        return if is_zero(&a) || is_zero(&b) {
            rules.nan(true)
        } else {
            rules.infinity(negative)
        };
    }
    let (a, b) = (number(&a), number(&b));
    let numerator = a.mantissa * b.mantissa;
    if numerator.is_zero() {
        return rules.zero(negative);
    }
    round(
        rules,
        &Exact {
            negative,
            numerator,
            denominator: BigUint::one(),
            exponent: i128::from(a.exponent + b.exponent),
        },
    )
}

pub fn div(rules: Rules, a: u64, b: u64) -> Result {
    let (a, b) = (rules.read(a), rules.read(b));
    if let Some(result) = rules.nan_among(&[&a, &b]) {
        return result;
    }
    let negative = is_negative(&a) != is_negative(&b);
    match (is_infinite(&a), is_infinite(&b)) {
        (true, true) => return rules.nan(true),
        (true, false) => return rules.infinity(negative),
        (false, true) => return rules.zero(negative),
        (false, false) => {}
    }
    match (is_zero(&a), is_zero(&b)) {
        (true, true) => rules.nan(true),
        (true, false) => rules.zero(negative),
        (false, true) => (infinity(rules.format, negative), Flags::DIVIDE_BY_ZERO),
        (false, false) => {
            let (a, b) = (number(&a), number(&b));
            round(
                rules,
                &Exact {
                    negative,
                    numerator: a.mantissa,
                    denominator: b.mantissa,
                    exponent: i128::from(a.exponent - b.exponent),
                },
            )
        }
    }
}

pub fn sqrt(rules: Rules, a: u64) -> Result {
    let value = rules.read(a);
    if let Some(result) = rules.nan_among(&[&value]) {
        return result;
    }
    if is_zero(&value) {
        return rules.zero(is_negative(&value));
    }
    if is_negative(&value) {
        return rules.nan(true);
    }
    if is_infinite(&value) {
        return rules.infinity(false);
    }
    // The integer root of 200 bits more, and half a unit of it where it is not the whole root: no
    // number and no middle of two numbers is that fine.
    let value = number(&value);
    let more = 200 + (value.exponent & 1);
    let radicand = value.mantissa << more;
    let root = radicand.sqrt();
    let whole = &root * &root == radicand;
    round(
        rules,
        &Exact {
            negative: false,
            numerator: root * 2u32 + u32::from(!whole),
            denominator: BigUint::one(),
            exponent: i128::from((value.exponent - more) / 2 - 1),
        },
    )
}

pub fn fused_multiply_add(rules: Rules, a: u64, b: u64, c: u64) -> Result {
    let (a, b, c) = (rules.read(a), rules.read(b), rules.read(c));
    if (is_infinite(&a) && is_zero(&b)) || (is_zero(&a) && is_infinite(&b)) {
        return rules.nan(true);
    }
    if let Some(result) = rules.nan_among(&[&a, &b, &c]) {
        return result;
    }
    let negative = is_negative(&a) != is_negative(&b);
    match (is_infinite(&a) || is_infinite(&b), is_infinite(&c)) {
        (true, true) if is_negative(&c) != negative => rules.nan(true),
        (true, _) => rules.infinity(negative),
        (false, true) => rules.infinity(is_negative(&c)),
        (false, false) => {
            let (a, b) = (number(&a), number(&b));
            let product = Number {
                negative,
                mantissa: a.mantissa * b.mantissa,
                exponent: a.exponent + b.exponent,
            };
            rules.sum(&product, &number(&c))
        }
    }
}

/// The order of two values; `None` where either is NaN.
pub fn order(rules: Rules, a: u64, b: u64) -> Option<Ordering> {
    /// -1, 0 or 1: below, among or above the finite numbers.
    fn band(value: &Value) -> i32 {
        match value {
            Infinite { negative: true } => -1,
            Infinite { negative: false } => 1,
            _ => 0,
        }
    }
    match (rules.read(a), rules.read(b)) {
        (NotANumber { .. }, _) | (_, NotANumber { .. }) => None,
        (a @ Finite { .. }, b @ Finite { .. }) => {
            let (a, b) = (number(&a), number(&b));
            let unit = a.exponent.min(b.exponent);
            let a = in_units(a.negative, &a.mantissa, a.exponent, unit);
            Some(a.cmp(&in_units(b.negative, &b.mantissa, b.exponent, unit)))
        }
        (a, b) => Some(band(&a).cmp(&band(&b))),
    }
}

pub fn relation(
    rules: Rules,
    relation: Relation,
    comparison: Comparison,
    a: u64,
    b: u64,
) -> Result {
    // Less, equal, greater, unordered: tables 5.1 to 5.3 of IEEE 754-2019.
    let row = match relation {
        Relation::Equal => [0, 1, 0, 0],
        Relation::NotEqual => [1, 0, 1, 1],
        Relation::LessThan => [1, 0, 0, 0],
        Relation::LessEqual => [1, 1, 0, 0],
        Relation::GreaterThan => [0, 0, 1, 0],
        Relation::GreaterEqual => [0, 1, 1, 0],
        Relation::NotLessThan => [0, 1, 1, 1],
        Relation::NotLessEqual => [0, 0, 1, 1],
        Relation::NotGreaterThan => [1, 1, 0, 1],
        Relation::NotGreaterEqual => [1, 0, 0, 1],
        Relation::Unordered => [0, 0, 0, 1],
        Relation::Ordered => [1, 1, 1, 0],
    };
    let place = match order(rules, a, b) {
        Some(Ordering::Less) => 0,
        Some(Ordering::Equal) => 1,
        Some(Ordering::Greater) => 2,
        None => 3,
    };
    let invalid = match rules.nan_among(&[&rules.read(a), &rules.read(b)]) {
        Some((_, flags)) => comparison == Comparison::Signalling || flags == Flags::INVALID,
        None => false,
    };
    let flags = if invalid { Flags::INVALID } else { Flags::NONE };
    (row[place], flags)
}

/// `minimumNumber` where `wanted` is `Less`, `maximumNumber` where it is `Greater`.
pub fn extreme(rules: Rules, wanted: Ordering, a: u64, b: u64) -> Result {
    let canonical = |pattern| match rules.read(pattern) {
        NotANumber { .. } => not_a_number(rules.format),
        value if is_zero(&value) => zero(rules.format, is_negative(&value)),
        _ => pattern,
    };
    let (x, y) = (rules.read(a), rules.read(b));
    let flags = rules
        .nan_among(&[&x, &y])
        .map_or(Flags::NONE, |(_, flags)| flags);
    let pattern = match (&x, &y, order(rules, a, b)) {
        (NotANumber { .. }, _, _) => canonical(b),
        (_, NotANumber { .. }, _) => canonical(a),
        (_, _, Some(order)) if order == wanted => canonical(a),
        (_, _, Some(order)) if order == wanted.reverse() => canonical(b),
        _ if is_zero(&x) => {
            let (x, y) = (is_negative(&x), is_negative(&y));
            zero(
                rules.format,
                if wanted == Ordering::Less {
                    x || y
                } else {
                    x && y
                },
            )
        }
        _ => a,
    };
    (pattern, flags)
}

/// `value * 2^exponent`.
pub fn from_scaled_integer(rules: Rules, value: i128, exponent: i64) -> Result {
    let (sign, numerator) = BigInt::from(value).into_parts();
    if sign == Sign::NoSign {
        return rules.zero(false);
    }
    round(
        rules,
        &Exact {
            negative: sign == Sign::Minus,
            numerator,
            denominator: BigUint::one(),
            // Any further away it would fill the memory, and change nothing.
            exponent: i128::from(exponent).clamp(-100_000, 100_000),
        },
    )
}

pub fn from_integer(rules: Rules, source: IntegerFormat, word: u64) -> Result {
    let range = 1i128 << source.bits;
    let word = i128::from(word) % range;
    let is_negative = source.signed && word >= range / 2;
    from_scaled_integer(rules, if is_negative { word - range } else { word }, 0)
}

/// The largest integer at or below a finite value, and what it is short of the value by, in units
/// of `1 / denominator`.
fn floor_and_rest(value: &Number) -> (BigInt, BigUint, BigUint) {
    if value.exponent >= 0 {
        let integer = in_units(value.negative, &value.mantissa, value.exponent, 0);
        return (integer, BigUint::zero(), BigUint::one());
    }
    let denominator = BigUint::one() << -value.exponent;
    let quotient = &value.mantissa / &denominator;
    let rest = &value.mantissa - &quotient * &denominator;
    match (value.negative, rest.is_zero()) {
        (false, _) => (quotient.into(), rest, denominator),
        (true, true) => (-BigInt::from(quotient), rest, denominator),
        (true, false) => {
            let rest = &denominator - rest;
            (-BigInt::from(quotient) - 1, rest, denominator)
        }
    }
}

/// A finite value rounded to an integer, and whether it was none.
fn nearest_integer(rounding: Rounding, value: &Number) -> (BigInt, bool) {
    let (floor, rest, denominator) = floor_and_rest(value);
    let goes_up = !rest.is_zero()
        && match rounding {
            Rounding::Up => true,
            Rounding::Down => false,
            Rounding::TowardZero => value.negative,
            Rounding::NearestEven => match (&rest + &rest).cmp(&denominator) {
                Ordering::Less => false,
                Ordering::Equal => (&floor % 2u32) != BigInt::zero(),
                Ordering::Greater => true,
            },
        };
    (if goes_up { floor + 1 } else { floor }, !rest.is_zero())
}

pub fn to_integer(rules: Rules, target: IntegerFormat, exact: bool, a: u64) -> Result {
    let bits = target.bits;
    let (least, most) = if target.signed {
        (
            -(BigInt::one() << (bits - 1)),
            (BigInt::one() << (bits - 1)) - 1,
        )
    } else {
        (BigInt::zero(), (BigInt::one() << bits) - 1)
    };
    let word = |integer: &BigInt| {
        let range = BigInt::one() << bits;
        let word = ((integer % &range) + &range) % &range;
        u64::try_from(word).expect("at most 64 bits")
    };
    let end = |negative| (word(if negative { &least } else { &most }), Flags::INVALID);
    match rules.read(a) {
        NotANumber { .. } => (0, Flags::INVALID),
        Infinite { negative } => end(negative),
        value => {
            let (integer, inexact) = nearest_integer(rules.rounding, &number(&value));
            if integer < least || integer > most {
                return end(integer < BigInt::zero());
            }
            let flags = if inexact && exact {
                Flags::INEXACT
            } else {
                Flags::NONE
            };
            (word(&integer), flags)
        }
    }
}

pub fn round_to_integral(rules: Rules, exact: bool, a: u64) -> Result {
    let value = rules.read(a);
    if let Some(result) = rules.nan_among(&[&value]) {
        return result;
    }
    let negative = is_negative(&value);
    if is_infinite(&value) {
        return rules.infinity(negative);
    }
    let (integer, inexact) = nearest_integer(rules.rounding, &number(&value));
    let said = if inexact && exact {
        Flags::INEXACT
    } else {
        Flags::NONE
    };
    if integer.is_zero() {
        return (zero(rules.format, negative), said);
    }
    // In some formats that is beyond the largest number.
    let (pattern, flags) = round(
        rules,
        &Exact {
            negative,
            numerator: integer.into_parts().1,
            denominator: BigUint::one(),
            exponent: 0,
        },
    );
    (pattern, flags | said)
}

pub fn floor(rules: Rules, a: u64) -> Result {
    let down = Rules {
        rounding: Rounding::Down,
        ..rules
    };
    round_to_integral(down, false, a)
}

/// A value of the rules' format in another one.
pub fn convert(rules: Rules, target: FloatFormat, a: u64) -> Result {
    let value = rules.read(a);
    let rules = Rules {
        format: target,
        ..rules
    };
    if let Some(result) = rules.nan_among(&[&value]) {
        return result;
    }
    if is_infinite(&value) {
        return rules.infinity(is_negative(&value));
    }
    let value = number(&value);
    if value.mantissa.is_zero() {
        return rules.zero(value.negative);
    }
    round(
        rules,
        &Exact {
            negative: value.negative,
            numerator: value.mantissa,
            denominator: BigUint::one(),
            exponent: i128::from(value.exponent),
        },
    )
}
