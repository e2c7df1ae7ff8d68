//! The formats that have a name here: those the tests try, the documentation lists and the command
//! line's help offers. Any other width works too.

use super::FloatFormat;

/// A format with what it is called and what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupportedFormat {
    /// The format.
    pub format: FloatFormat,
    /// What it is called elsewhere; the command line takes this name, too.
    pub alias: Option<&'static str>,
    /// What it is for.
    pub purpose: &'static str,
    /// Are all its operand pairs few enough to be tried in every test run?
    pub is_exhaustive: bool,
}

const fn named(
    exponent_bits: u32,
    fraction_bits: u32,
    alias: &'static str,
    purpose: &'static str,
) -> SupportedFormat {
    SupportedFormat {
        format: FloatFormat::new(exponent_bits, fraction_bits),
        alias: Some(alias),
        purpose,
        is_exhaustive: false,
    }
}

const fn small(exponent_bits: u32, fraction_bits: u32, purpose: &'static str) -> SupportedFormat {
    SupportedFormat {
        format: FloatFormat::new(exponent_bits, fraction_bits),
        alias: None,
        purpose,
        is_exhaustive: true,
    }
}

/// The list, by purpose.
pub const SUPPORTED_FORMATS: [SupportedFormat; 12] = [
    named(7, 16, "fp24", "the traverse unit"),
    named(5, 10, "half", "IEEE 754 binary16"),
    named(8, 7, "bfloat16", "machine learning"),
    named(8, 23, "single", "IEEE 754 binary32"),
    named(11, 52, "double", "IEEE 754 binary64"),
    small(4, 3, "tests of every operand pair, in eight bits"),
    small(3, 4, "the same, with more fraction than exponent"),
    small(5, 2, "the same, with more exponent than fraction"),
    small(2, 2, "the fewest bits there can be"),
    small(3, 2, "an exponent that just holds a cancellation"),
    small(2, 5, "a range that ends within every alignment"),
    small(4, 5, "the widest that is tried with every operand pair"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_their_formats() {
        for supported in SUPPORTED_FORMATS {
            let name = supported.format.to_string();
            assert_eq!(name.parse(), Ok(supported.format));
            if let Some(alias) = supported.alias {
                assert_eq!(alias.parse(), Ok(supported.format));
            }
        }
    }

    #[test]
    fn no_format_is_listed_twice() {
        for (place, one) in SUPPORTED_FORMATS.iter().enumerate() {
            for other in &SUPPORTED_FORMATS[place + 1..] {
                assert_ne!(one.format, other.format);
            }
        }
    }
}
