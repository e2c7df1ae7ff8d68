//! What a fixed-point number is: its sign, its widths, its range.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// A fixed-point format: `qI.F`, two's complement with I integer bits of which the first is the
/// sign, or `uqI.F`, unsigned; F fraction bits. The value of a word is the integer it spells,
/// times `2^-F`.
///
/// `q12.20` reaches from -2048 to just below 2048, `uq0.16` from 0 to just below 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FixedFormat {
    /// Is it two's complement?
    pub signed: bool,
    /// Bits before the point, with the sign: 1 to 64 where signed, 0 to 64 where not.
    pub integer_bits: u32,
    /// Bits behind the point, 0 to 64; with those before it, 1 to 64.
    pub fraction_bits: u32,
}

/// Why there is no such fixed-point format.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FixedFormatError {
    /// Not written as one.
    #[error(
        "unknown format `{text}`: it is qI.F (signed, I integer bits with the sign) or uqI.F \
         (unsigned), with F fraction bits, such as q12.20 or uq0.16"
    )]
    Unknown {
        /// The text found.
        text: String,
    },
    /// Too few or too many bits.
    #[error("format `{text}`: {width} bits in all; 1 to 64 are supported")]
    Width {
        /// The text found.
        text: String,
        /// The bits found.
        width: u64,
    },
    /// A signed format without the bit of its sign.
    #[error("format `{text}`: a signed format has at least 1 integer bit, its sign")]
    NoSign {
        /// The text found.
        text: String,
    },
}

impl FixedFormat {
    /// The signed format of these widths, the sign among the integer bits.
    ///
    /// # Panics
    /// If it has no integer bit, or more than 64 bits in all; in a constant that is a compile error.
    pub const fn q(integer_bits: u32, fraction_bits: u32) -> FixedFormat {
        assert!(integer_bits >= 1, "a signed format has its sign bit");
        assert!(integer_bits <= 64 && fraction_bits <= 64 - integer_bits);
        FixedFormat {
            signed: true,
            integer_bits,
            fraction_bits,
        }
    }

    /// The unsigned format of these widths.
    ///
    /// # Panics
    /// If it has no bit or more than 64; in a constant that is a compile error.
    pub const fn uq(integer_bits: u32, fraction_bits: u32) -> FixedFormat {
        assert!(integer_bits <= 64 && fraction_bits <= 64 - integer_bits);
        assert!(integer_bits + fraction_bits >= 1, "a format has a bit");
        FixedFormat {
            signed: false,
            integer_bits,
            fraction_bits,
        }
    }

    /// Bits of a value, 1 to 64.
    #[inline]
    pub const fn width(self) -> u32 {
        self.integer_bits + self.fraction_bits
    }

    /// A mask of all bits of a value.
    #[inline]
    pub const fn value_mask(self) -> u64 {
        u64::MAX >> (64 - self.width())
    }

    /// The largest number's word.
    #[inline]
    pub const fn max(self) -> u64 {
        self.value_mask() >> (self.signed as u32)
    }

    /// The smallest number's word: the most negative one, or zero.
    #[inline]
    pub const fn min(self) -> u64 {
        if self.signed {
            1 << (self.width() - 1)
        } else {
            0
        }
    }
}

impl fmt::Display for FixedFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let prefix = if self.signed { "q" } else { "uq" };
        write!(f, "{prefix}{}.{}", self.integer_bits, self.fraction_bits)
    }
}

impl FromStr for FixedFormat {
    type Err = FixedFormatError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let unknown = || FixedFormatError::Unknown {
            text: text.to_owned(),
        };
        let (signed, widths) = match (text.strip_prefix("uq"), text.strip_prefix('q')) {
            (Some(widths), _) => (false, widths),
            (None, Some(widths)) => (true, widths),
            (None, None) => return Err(unknown()),
        };
        let (integer, fraction) = widths.split_once('.').ok_or_else(unknown)?;
        let bits = |digits: &str| {
            // The parser of integers would also take a sign.
            let plain = digits.bytes().all(|byte| byte.is_ascii_digit());
            let bits: Option<u32> = digits.parse().ok().filter(|_| plain);
            bits.ok_or_else(unknown)
        };
        let (integer_bits, fraction_bits) = (bits(integer)?, bits(fraction)?);
        let width = u64::from(integer_bits) + u64::from(fraction_bits);
        let text = text.to_owned();
        if !(1..=64).contains(&width) {
            Err(FixedFormatError::Width { text, width })
        } else if signed && integer_bits == 0 {
            Err(FixedFormatError::NoSign { text })
        } else {
            Ok(FixedFormat {
                signed,
                integer_bits,
                fraction_bits,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_reads_back_from_its_name() {
        let mut formats = 0;
        for integer_bits in 0..=64 {
            for fraction_bits in 0..=64 - integer_bits {
                for signed in [false, true] {
                    let format = FixedFormat {
                        signed,
                        integer_bits,
                        fraction_bits,
                    };
                    let exists = format.width() >= 1 && (integer_bits >= 1 || !signed);
                    assert_eq!(format.to_string().parse().ok(), exists.then_some(format));
                    formats += u32::from(exists);
                }
            }
        }
        // Of w bits, w signed ones and w + 1 unsigned ones.
        assert_eq!(formats, 64 * 65 + 64);
    }

    #[test]
    fn what_is_no_format_is_named() {
        for (text, part) in [
            ("", "q12.20"),
            ("q", "q12.20"),
            ("q12", "q12.20"),
            ("q12.", "q12.20"),
            ("q+1.2", "q12.20"),
            ("Q1.2", "q12.20"),
            ("q1.2.3", "q12.20"),
            ("q99999999999.1", "q12.20"),
            ("q40.40", "80 bits in all"),
            ("q4294967295.1", "4294967296 bits in all"),
            ("uq0.0", "0 bits in all"),
            ("q0.8", "at least 1 integer bit"),
        ] {
            let message = text.parse::<FixedFormat>().unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
            assert!(message.contains(&format!("`{text}`")), "{text}: {message}");
        }
    }

    #[test]
    fn ranges_are_those_of_two_s_complement() {
        assert_eq!(FixedFormat::q(12, 20).min(), 0x8000_0000);
        assert_eq!(FixedFormat::q(12, 20).max(), 0x7fff_ffff);
        assert_eq!(FixedFormat::q(1, 0).max(), 0);
        assert_eq!(FixedFormat::q(64, 0).min(), 1 << 63);
        assert_eq!(FixedFormat::uq(0, 64).max(), u64::MAX);
        assert_eq!(FixedFormat::uq(3, 2).min(), 0);
        assert_eq!(FixedFormat::uq(3, 2).max(), 31);
    }
}
