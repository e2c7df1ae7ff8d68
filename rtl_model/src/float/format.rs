//! What a float is: widths, the special patterns, the rounding directions.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use thiserror::Error;

use super::SUPPORTED_FORMATS;

/// Which representable neighbour an inexact result becomes (IEEE 754-2019, section 4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rounding {
    /// The nearest neighbour; a tie goes to the one whose last fraction bit is 0.
    NearestEven,
    /// The neighbour of smaller magnitude: truncation.
    TowardZero,
    /// The neighbour nearer to plus infinity.
    Up,
    /// The neighbour nearer to minus infinity.
    Down,
}

impl Rounding {
    /// All four, in the order of the documentation.
    pub const ALL: [Rounding; 4] = [
        Rounding::NearestEven,
        Rounding::TowardZero,
        Rounding::Up,
        Rounding::Down,
    ];

    /// The short name used in module names, file names and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Rounding::NearestEven => "rne",
            Rounding::TowardZero => "rtz",
            Rounding::Up => "rup",
            Rounding::Down => "rdn",
        }
    }
}

impl FromStr for Rounding {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Rounding::ALL
            .into_iter()
            .find(|rounding| rounding.name() == text)
            .ok_or_else(|| format!("unknown rounding `{text}`: it is one of rne, rtz, rup, rdn"))
    }
}

impl fmt::Display for Rounding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A float format `eXfY`: one sign bit, `X` exponent bits with bias `2^(X-1) - 1`, `Y` fraction
/// bits. `e7f16` is the 24-bit float of the 2013 hardware paper, written (1,7,16) there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FloatFormat {
    /// Exponent bits, 2 to 11.
    pub exponent_bits: u32,
    /// Fraction bits, 2 to 52.
    pub fraction_bits: u32,
}

/// Why a text names no float format.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum UnknownFloatFormat {
    /// It is not of the form `eXfY`, nor one of the names in [`SUPPORTED_FORMATS`].
    #[error(
        "unknown float format `{text}`: it is eXfY with X exponent and Y fraction bits, such as e7f16"
    )]
    Name {
        /// The text found.
        text: String,
    },
    /// Too few or too many bits.
    #[error("format `{text}`: {found} {part} bits; {} to {} are supported", range.start(), range.end())]
    Width {
        /// The text found.
        text: String,
        /// `exponent` or `fraction`.
        part: &'static str,
        /// The bits found.
        found: u64,
        /// The bits supported.
        range: RangeInclusive<u32>,
    },
}

impl FloatFormat {
    /// The exponent bits that a format can have.
    pub const EXPONENT_BITS: RangeInclusive<u32> = 2..=11;
    /// The fraction bits that a format can have.
    pub const FRACTION_BITS: RangeInclusive<u32> = 2..=52;

    /// The 24-bit float of the traverse unit.
    pub const E7F16: FloatFormat = FloatFormat::new(7, 16);
    /// IEEE 754 binary32, the `f32` of the host.
    pub const SINGLE: FloatFormat = FloatFormat::new(8, 23);
    /// A format of eight bits, small enough for every operand pair to be tried.
    pub const E4F3: FloatFormat = FloatFormat::new(4, 3);

    /// A format of these widths.
    ///
    /// # Panics
    /// If a width is out of its range; in a constant that is a compile error.
    #[inline]
    pub const fn new(exponent_bits: u32, fraction_bits: u32) -> FloatFormat {
        assert!(
            exponent_bits >= 2 && exponent_bits <= 11,
            "2 to 11 exponent bits"
        );
        assert!(
            fraction_bits >= 2 && fraction_bits <= 52,
            "2 to 52 fraction bits"
        );
        FloatFormat {
            exponent_bits,
            fraction_bits,
        }
    }

    /// Bits of a value: sign, exponent and fraction.
    #[inline]
    pub const fn width(self) -> u32 {
        1 + self.exponent_bits + self.fraction_bits
    }

    /// What is subtracted from the exponent field: `2^(E-1) - 1`.
    #[inline]
    pub const fn exponent_bias(self) -> i32 {
        (1 << (self.exponent_bits - 1)) - 1
    }

    /// The exponent field of infinities and NaNs: all ones.
    #[inline]
    pub const fn exponent_all_ones(self) -> u64 {
        (1 << self.exponent_bits) - 1
    }

    /// A mask of the fraction field.
    #[inline]
    pub const fn fraction_mask(self) -> u64 {
        (1 << self.fraction_bits) - 1
    }

    /// A mask of all bits of a value.
    #[inline]
    pub const fn value_mask(self) -> u64 {
        u64::MAX >> (64 - self.width())
    }

    /// The sign bit alone; also the pattern of minus zero.
    #[inline]
    pub const fn sign_bit(self) -> u64 {
        1 << (self.width() - 1)
    }

    /// Plus infinity: exponent all ones, fraction zero.
    #[inline]
    pub const fn infinity(self) -> u64 {
        self.exponent_all_ones() << self.fraction_bits
    }

    /// The one NaN every invalid operation results in: sign 0, exponent all ones, fraction 100...0.
    #[inline]
    pub const fn quiet_nan(self) -> u64 {
        self.infinity() | (1 << (self.fraction_bits - 1))
    }

    /// The largest finite value.
    #[inline]
    pub const fn max_finite(self) -> u64 {
        self.infinity() - 1
    }

    /// One: the exponent field at the bias, the fraction zero.
    #[inline]
    pub const fn one(self) -> u64 {
        (self.exponent_bias() as u64) << self.fraction_bits
    }

    /// Smallest positive normal value.
    #[inline]
    pub const fn min_normal(self) -> u64 {
        1 << self.fraction_bits
    }
}

impl fmt::Display for FloatFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "e{}f{}", self.exponent_bits, self.fraction_bits)
    }
}

impl FromStr for FloatFormat {
    type Err = UnknownFloatFormat;

    /// `eXfY`, or a name of [`SUPPORTED_FORMATS`] such as `half`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = SUPPORTED_FORMATS
            .iter()
            .find(|supported| supported.alias == Some(text));
        if let Some(supported) = named {
            return Ok(supported.format);
        }
        let unknown = || UnknownFloatFormat::Name {
            text: text.to_owned(),
        };
        let (exponent, fraction) = text
            .strip_prefix('e')
            .and_then(|widths| widths.split_once('f'))
            .ok_or_else(unknown)?;
        let width = |digits: &str, part, range: RangeInclusive<u32>| {
            // The parser of integers would also take a sign.
            if !digits.bytes().all(|byte| byte.is_ascii_digit()) {
                return Err(unknown());
            }
            let found: u64 = digits.parse().map_err(|_| unknown())?;
            u32::try_from(found)
                .ok()
                .filter(|bits| range.contains(bits))
                .ok_or_else(|| UnknownFloatFormat::Width {
                    text: text.to_owned(),
                    part,
                    found,
                    range,
                })
        };
        Ok(FloatFormat::new(
            width(exponent, "exponent", FloatFormat::EXPONENT_BITS)?,
            width(fraction, "fraction", FloatFormat::FRACTION_BITS)?,
        ))
    }
}
