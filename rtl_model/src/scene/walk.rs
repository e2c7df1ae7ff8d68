//! How a scene's rays are traversed: by which method, in which number format.

use std::fmt;
use std::str::FromStr;

use serde::Deserialize;
use thiserror::Error;

use super::Method;
use crate::fixed::{FixedFormat, FixedFormatError};
use crate::float::{FloatFormat, UnknownFloatFormat};

/// A method, a number format, and how borders are crossed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Walk {
    /// The traversal.
    pub method: Method,
    /// The numbers it computes with.
    pub format: WalkFormat,
    /// How it gets from a node to the next.
    #[serde(default)]
    pub crossing: Crossing,
}

/// How a walk gets from a node into its neighbour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(try_from = "String")]
pub enum Crossing {
    /// The node's index is carried along and counted on: no position is rounded into a node.
    #[default]
    Index,
    /// As published: the position is moved so far beyond the border, and the node is found anew
    /// from the rounded position. For comparison; it misses, and can walk for ever.
    Offset(BorderOffset),
}

/// A distance beyond a border, along the ray, in texels: above 0, at most 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BorderOffset(u64);

impl BorderOffset {
    /// A distance in texels; none where it is not above 0 and at most 1.
    pub fn new(texels: f64) -> Option<BorderOffset> {
        (texels > 0.0 && texels <= 1.0).then(|| BorderOffset(texels.to_bits()))
    }

    /// The distance in texels.
    pub fn texels(self) -> f64 {
        f64::from_bits(self.0)
    }
}

impl FromStr for Crossing {
    type Err = WalkError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "index" {
            return Ok(Crossing::Index);
        }
        let texels = text.strip_prefix("offset:").map(str::parse);
        let Some(Ok(texels)) = texels else {
            return Err(WalkError::UnknownCrossing {
                text: text.to_owned(),
            });
        };
        let offset = BorderOffset::new(texels).ok_or_else(|| WalkError::UnknownCrossing {
            text: text.to_owned(),
        })?;
        Ok(Crossing::Offset(offset))
    }
}

impl TryFrom<String> for Crossing {
    type Error = WalkError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl fmt::Display for Crossing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Crossing::Index => f.write_str("index"),
            Crossing::Offset(offset) => write!(f, "offset:{}", offset.texels()),
        }
    }
}

/// The number format of a traversal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(try_from = "String")]
pub enum WalkFormat {
    /// A float of the hardware, `eXfY`.
    Float(FloatFormat),
    /// The machine's 64-bit float.
    F64,
    /// Rational numbers without rounding.
    Exact,
    /// Fixed point, in which every decision is exact: texels per height step in this signed
    /// format, entry coordinates with as many fewer fraction bits as a height has bits. `None`:
    /// the format is chosen from the rays.
    Fixed(Option<FixedFormat>),
}

/// A method or a format that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WalkError {
    /// Not the name of a method.
    #[error(
        "unknown method `{text}`: there is {}; multi-level-down:N goes N levels down at once, 1 to {}",
        Method::list(),
        Method::MOST_LEVELS_DOWN
    )]
    UnknownMethod {
        /// The text found.
        text: String,
    },
    /// A number of levels to go down at once that no walk has.
    #[error(
        "method `{text}`: a walk goes 1 to {} levels down at once",
        Method::MOST_LEVELS_DOWN
    )]
    LevelsDown {
        /// The text found.
        text: String,
    },
    /// Not a way to cross a border.
    #[error(
        "unknown crossing `{text}`: it is index, or offset:X with X texels beyond the border, above \
         0 and at most 1, such as offset:0.015625"
    )]
    UnknownCrossing {
        /// The text found.
        text: String,
    },
    /// Not a format of fixed point.
    #[error(transparent)]
    FixedFormat(#[from] FixedFormatError),
    /// Fixed point without a sign.
    #[error("format {format}: a slope has a sign; take qI.F, such as q8.20, or fixed")]
    Unsigned {
        /// The format found.
        format: FixedFormat,
    },
    /// Not the name of a format.
    #[error(
        "unknown format `{text}`: it is eXfY with X exponent and Y fraction bits, such as e7f16, or \
         f64, or exact, or fixed, or qI.F with I integer and F fraction bits, such as q8.20"
    )]
    UnknownFormat {
        /// The text found.
        text: String,
    },
    /// A float with too few or too many bits.
    #[error(transparent)]
    WidthOutOfRange(UnknownFloatFormat),
}

impl FromStr for WalkFormat {
    type Err = WalkError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "f64" => return Ok(WalkFormat::F64),
            "exact" => return Ok(WalkFormat::Exact),
            "fixed" => return Ok(WalkFormat::Fixed(None)),
            _ => {}
        }
        let word = text.strip_prefix("uq").or(text.strip_prefix('q'));
        if word.is_some_and(|bits| bits.starts_with(|first: char| first.is_ascii_digit())) {
            let format: FixedFormat = text.parse()?;
            if !format.signed {
                return Err(WalkError::Unsigned { format });
            }
            return Ok(WalkFormat::Fixed(Some(format)));
        }
        text.parse()
            .map(WalkFormat::Float)
            .map_err(|error| match error {
                UnknownFloatFormat::Name { text } => WalkError::UnknownFormat { text },
                width @ UnknownFloatFormat::Width { .. } => WalkError::WidthOutOfRange(width),
            })
    }
}

impl TryFrom<String> for WalkFormat {
    type Error = WalkError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl fmt::Display for WalkFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WalkFormat::Float(format) => write!(f, "{format}"),
            WalkFormat::F64 => f.write_str("f64"),
            WalkFormat::Exact => f.write_str("exact"),
            WalkFormat::Fixed(None) => f.write_str("fixed"),
            WalkFormat::Fixed(Some(format)) => write!(f, "{format}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_read_back_from_their_names() {
        for format in [
            WalkFormat::Float(FloatFormat::E7F16),
            WalkFormat::Float(FloatFormat::new(2, 2)),
            WalkFormat::Float(FloatFormat::new(11, 52)),
            WalkFormat::F64,
            WalkFormat::Exact,
            WalkFormat::Fixed(None),
            "q8.20".parse().unwrap(),
        ] {
            assert_eq!(format.to_string().parse(), Ok(format));
        }
    }

    #[test]
    fn formats_out_of_range_give_the_range() {
        for (text, expected) in [
            ("e1f16", "1 exponent bits; 2 to 11"),
            ("e12f16", "12 exponent bits; 2 to 11"),
            ("e7f1", "1 fraction bits; 2 to 52"),
            ("e7f53", "53 fraction bits; 2 to 52"),
            ("e7f4294967298", "4294967298 fraction bits"),
            ("e7", "such as e7f16"),
            ("ef", "such as e7f16"),
            ("e+7f16", "such as e7f16"),
            ("E7F16", "such as e7f16"),
            ("f32", "such as e7f16"),
            ("", "such as e7f16"),
        ] {
            let message = text.parse::<WalkFormat>().unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    #[test]
    fn crossings_read_back_from_their_names() {
        for text in ["index", "offset:0.5", "offset:0.001"] {
            assert_eq!(text.parse::<Crossing>().unwrap().to_string(), text);
        }
        for text in ["offset", "offset:0", "offset:2", "offset:NaN", "carried"] {
            let message = text.parse::<Crossing>().unwrap_err().to_string();
            assert!(message.contains("such as offset:0.015625"), "{message}");
        }
    }
}
