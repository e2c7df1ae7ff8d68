//! Numbers in text files: decimal, or hexadecimal as C99's `%a` and Python's `float.hex` write them.

use thiserror::Error;

/// Why a text is not a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NumberError {
    /// Neither decimal nor hexadecimal.
    #[error("not a number: write a decimal such as -0.25 or 1e-3, or a hex float such as -0x1p-2")]
    Malformed,
    /// Digits of a number that no `f64` holds.
    #[error("beyond the largest f64")]
    TooLarge,
}

/// The `f64` nearest to the number in `text`, ties to even. `inf` and `nan` are numbers here: what
/// they are no use for refuses them itself.
///
/// # Errors
/// A text that is no number, or digits that round to infinity.
pub fn parse_f64(text: &str) -> Result<f64, NumberError> {
    let (negative, unsigned) = match text.as_bytes().first() {
        Some(b'-') => (true, &text[1..]),
        Some(b'+') => (false, &text[1..]),
        _ => (false, text),
    };
    let hex = ["0x", "0X"]
        .iter()
        .find_map(|prefix| unsigned.strip_prefix(prefix));
    let value = match hex {
        Some(digits) => parse_hex(digits)?,
        // A second sign would pass Rust's own parser.
        None if unsigned.starts_with(['-', '+']) => return Err(NumberError::Malformed),
        None => unsigned.parse().map_err(|_| NumberError::Malformed)?,
    };
    if value.is_infinite() && unsigned.contains(|letter: char| letter.is_ascii_digit()) {
        return Err(NumberError::TooLarge);
    }
    Ok(if negative { -value } else { value })
}

/// Digits of a significand kept exactly; what lies behind them only matters as being zero or not.
const KEPT_BITS: u32 = 60;

/// `H.HHHp±D` without its `0x`: the point, the digits after it and the exponent may be missing.
fn parse_hex(text: &str) -> Result<f64, NumberError> {
    let (digits, exponent) = match text.split_once(['p', 'P']) {
        Some((digits, exponent)) => (digits, parse_exponent(exponent)?),
        None => (text, 0),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    if whole.is_empty() && fraction.is_empty() {
        return Err(NumberError::Malformed);
    }
    let mut significand = 0_u64;
    let mut exponent = exponent;
    let mut sticky = false;
    for (digit, is_fraction) in whole
        .chars()
        .map(|digit| (digit, false))
        .chain(fraction.chars().map(|digit| (digit, true)))
    {
        let digit = u64::from(digit.to_digit(16).ok_or(NumberError::Malformed)?);
        if significand >> (KEPT_BITS - 4) == 0 {
            significand = significand << 4 | digit;
        } else {
            sticky |= digit != 0;
            exponent += 4;
        }
        if is_fraction {
            exponent -= 4;
        }
    }
    Ok(round_to_f64(
        significand << 1 | u64::from(sticky),
        exponent - 1,
    ))
}

fn parse_exponent(text: &str) -> Result<i64, NumberError> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(NumberError::Malformed);
    }
    // Beyond this every number is 0 or infinite, however many digits a line can hold.
    const FAR: i64 = 1 << 40;
    let magnitude = digits
        .parse()
        .map_or(FAR, |exponent: i64| exponent.min(FAR));
    Ok(if text.starts_with('-') {
        -magnitude
    } else {
        magnitude
    })
}

/// `significand * 2^exponent` rounded once, to nearest, ties to even. The lowest bit of a
/// significand above 2^54 may stand for all that is cut off behind it.
fn round_to_f64(significand: u64, exponent: i64) -> f64 {
    if significand == 0 {
        return 0.0;
    }
    // The power of two of the leading bit, and of the last bit that a result of this size has.
    let leading = exponent + i64::from(63 - significand.leading_zeros());
    let last = (leading - 52).max(-1074);
    let cut = last - exponent;
    let kept = if cut <= 0 {
        // No more bits than fit: the leading one moves up to 2^52 at most.
        significand << -cut
    } else if cut > 63 {
        0
    } else {
        let (kept, rest) = (significand >> cut, significand & ((1 << cut) - 1));
        let half = 1 << (cut - 1);
        kept + u64::from(rest > half || (rest == half && kept & 1 == 1))
    };
    // A carry out of the fraction falls into the exponent field, where it belongs: up to infinity.
    let field = last + 1074;
    if field > 2045 {
        return f64::INFINITY;
    }
    f64::from_bits(((field as u64) << 52) + kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// As C's `%a` writes it.
    fn hex(value: f64) -> String {
        let bits = value.to_bits();
        let sign = if value.is_sign_negative() { "-" } else { "" };
        let (field, fraction) = (bits >> 52 & 0x7ff, bits & ((1 << 52) - 1));
        let (whole, exponent) = if field == 0 {
            (0, -1022)
        } else {
            (1, field as i64 - 1023)
        };
        format!("{sign}0x{whole}.{fraction:013x}p{exponent:+}")
    }

    #[test]
    fn known_texts_have_known_values() {
        for (text, expected) in [
            ("0", 0.0),
            ("-0.0", -0.0),
            ("+1.5", 1.5),
            (".5", 0.5),
            ("1e-3", 0.001),
            ("0x1p0", 1.0),
            ("0x1.8p-3", 0.1875),
            ("-0X1.8P+3", -12.0),
            ("+0xA", 10.0),
            ("0x.8", 0.5),
            ("0x8.", 8.0),
            ("-0x0p0", -0.0),
            ("0x0.0000000000001p-1022", 5e-324),
            ("0x1p-1074", 5e-324),
            ("0x1p-1075", 0.0),
            ("0x1.0000000000000000000000001p-1075", 5e-324),
            ("0x1.fffffffffffffp+1023", f64::MAX),
            ("0x0.00000000000000000000000001p104", 1.0),
            ("0x100000000000000000000000000p-104", 1.0),
            ("0x1p-99999999999999999999999", 0.0),
            // Ties to even, and just beside them.
            ("0x1.00000000000008p0", 1.0),
            ("0x1.00000000000018p0", 1.0 + 2.0 * f64::EPSILON),
            ("0x1.000000000000080000000000001p0", 1.0 + f64::EPSILON),
            ("0x1.fffffffffffff8p0", 2.0),
            ("0x0.fffffffffffff8p-1022", f64::MIN_POSITIVE),
        ] {
            let value = parse_f64(text).unwrap();
            assert_eq!(value.to_bits(), f64::to_bits(expected), "{text}: {value}");
        }
        assert!(parse_f64("nan").unwrap().is_nan());
        assert_eq!(parse_f64("-inf"), Ok(f64::NEG_INFINITY));
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in [
            "", "-", "x", "0x", "0x.", "0xp1", "0x1p", "0x1p+", "0x1p1.5", "0x1.2.3", "0x1g",
            "1..2", "--1", "+-1", "-0x-1", "0x1p--1", "1,5", "one", "1 2", "0x+1",
        ] {
            assert_eq!(parse_f64(text), Err(NumberError::Malformed), "{text}");
        }
        for text in [
            "1e999",
            "-1e999",
            "0x1p1024",
            "0x1.fffffffffffff8p1023",
            "0x1p99999999999",
        ] {
            assert_eq!(parse_f64(text), Err(NumberError::TooLarge), "{text}");
        }
    }

    proptest! {
        #[test]
        fn hex_and_decimal_read_back_to_the_same_bits(bits: u64) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            for text in [hex(value), format!("{value:?}"), format!("{value:e}")] {
                prop_assert_eq!(parse_f64(&text).map(f64::to_bits), Ok(bits), "{}", text);
            }
        }

        /// An integer of 128 bits has hex digits enough to be rounded; Rust rounds it to nearest.
        #[test]
        fn long_significands_are_rounded_once(value: u128, shift in 0u32..128) {
            let value = value >> shift;
            let text = format!("0x{value:x}");
            prop_assert_eq!(parse_f64(&text), Ok(value as f64), "{}", text);
        }

        #[test]
        fn any_text_is_answered(text in "-?0?x?[0-9a-fp.+-]{0,12}") {
            let _ = parse_f64(&text);
        }
    }
}
