//! Numbers of a case: exact, or refused.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// The `f64` that a decimal (`-0.25`, `1e-3`) or a hex float (`-0x1.8p-2`) is: not the nearest, but
/// the very number. A negative zero keeps its sign.
pub(super) fn exact_number(text: &str) -> Result<f64, String> {
    let value = rational(text).ok_or_else(|| {
        format!("`{text}` is not a number: write a decimal such as -0.25, or a hex float such as -0x1p-2")
    })?;
    let nearest = value.abs().to_f64().filter(|nearest| nearest.is_finite());
    let exact = nearest.filter(|&nearest| {
        BigRational::from_float(nearest).is_some_and(|nearest| nearest == value.abs())
    });
    let magnitude = exact.ok_or_else(|| {
        format!(
            "`{text}` is not exact in 64 bits: write it as a hex float, or choose another number"
        )
    })?;
    let is_negative = text.starts_with('-');
    Ok(if is_negative { -magnitude } else { magnitude })
}

/// Numerator and denominator of `2/5` or `1`, in lowest terms.
pub(super) fn ratio(text: &str) -> Result<(i128, i128), String> {
    let (numerator, denominator) = text.split_once('/').unwrap_or((text, "1"));
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let parse = |text: &str| is_digits(text).then(|| text.parse::<i128>().ok()).flatten();
    match (parse(numerator), parse(denominator)) {
        (Some(numerator), Some(denominator))
            if denominator > 0 && super::greatest_common_divisor(numerator, denominator) == 1 =>
        {
            Ok((numerator, denominator))
        }
        _ => Err(format!(
            "`{text}` is not a depth: write a ratio of whole numbers in lowest terms, such as 2/5"
        )),
    }
}

/// The exponents that are read: beyond them no `f64` lies, and a power would take all memory.
const EXPONENTS: std::ops::RangeInclusive<i32> = -1200..=1200;

fn rational(text: &str) -> Option<BigRational> {
    let unsigned = text.strip_prefix(['-', '+']).unwrap_or(text);
    let (digits, radix, marker, base) = match unsigned.strip_prefix("0x") {
        Some(digits) => (digits, 16, 'p', 2),
        None => (unsigned, 10, 'e', 10),
    };
    let (digits, exponent) = match digits.split_once(marker) {
        Some((digits, exponent)) => (digits, exponent.parse::<i32>().ok()?),
        None => (digits, 0),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let digits = format!("{whole}{fraction}");
    let is_number = !digits.is_empty() && digits.chars().all(|digit| digit.is_digit(radix));
    if !is_number || digits.len() > 1200 || !EXPONENTS.contains(&exponent) {
        return None;
    }
    let significand = BigInt::parse_bytes(digits.as_bytes(), radix)?;
    let power = |base: i32, exponent: i32| {
        num_traits::pow(
            BigRational::from_integer(base.into()),
            exponent.unsigned_abs() as usize,
        )
    };
    let scale = power(base, exponent);
    let scale = if exponent < 0 { scale.recip() } else { scale };
    let places = power(radix as i32, fraction.len() as i32);
    let magnitude = BigRational::from_integer(significand) * scale / places;
    let is_negative = text.starts_with('-') && !magnitude.is_zero();
    Some(if is_negative { -magnitude } else { magnitude })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_numbers_are_read_in_either_notation() {
        for (text, expected) in [
            ("0", 0.0),
            ("-0.25", -0.25),
            ("57.3125", 57.3125),
            ("1e3", 1000.0),
            ("125e-3", 0.125),
            ("0x1p-62", 2_f64.powi(-62)),
            ("-0x1.8p-2", -0.375),
            ("0x1.fffffffffffffp-2", 0.5_f64.next_down()),
            ("0x0.4p0", 0.25),
            ("16384", 16384.0),
            ("0x1p-1074", f64::from_bits(1)),
        ] {
            assert_eq!(exact_number(text), Ok(expected), "{text}");
        }
        let zero = exact_number("-0").unwrap();
        assert!(zero == 0.0 && zero.is_sign_negative());
    }

    #[test]
    fn what_is_not_exact_is_refused() {
        for text in ["0.1", "1e-3", "0x1.00000000000001p0", "1e400", "1e1000"] {
            let message = exact_number(text).unwrap_err();
            assert!(message.contains("not exact"), "{message}");
        }
        for text in [
            "",
            "-",
            "x",
            "0x",
            "1/3",
            "--1",
            "nan",
            "inf",
            "0x1p",
            "1e99999999",
        ] {
            let message = exact_number(text).unwrap_err();
            assert!(message.contains("not a number"), "{message}");
        }
    }

    #[test]
    fn depths_are_ratios_in_lowest_terms() {
        for (text, expected) in [("0", (0, 1)), ("1", (1, 1)), ("254/255", (254, 255))] {
            assert_eq!(ratio(text), Ok(expected), "{text}");
        }
        for text in ["2/4", "0/3", "1/0", "-1/2", "1/-2", "0.5", "", "/", "1/"] {
            assert!(ratio(text).is_err(), "{text}");
        }
    }
}
