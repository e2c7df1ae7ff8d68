//! How a scene's rays are traversed: by which method, in which number format.

use std::fmt;
use std::str::FromStr;

use serde::Deserialize;
use thiserror::Error;

use crate::float::{FloatFormat, UnknownFloatFormat};

/// A method and a number format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Walk {
    /// The traversal.
    pub method: Method,
    /// The numbers it computes with.
    pub format: WalkFormat,
}

/// The traversals, by the names that files and the command line use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(try_from = "String")]
pub enum Method {
    /// From the root of the pyramid downwards, never up again (Oh, Ki and Lee 2006).
    Oh,
}

impl Method {
    /// All of them, in the order of the documentation.
    pub const ALL: [Method; 1] = [Method::Oh];

    /// The name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Method::Oh => "oh",
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
}

/// A method or a format that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WalkError {
    /// Not the name of a method.
    #[error(
        "unknown method `{text}`: there is {}",
        Method::ALL.map(Method::name).join(", ")
    )]
    UnknownMethod {
        /// The text found.
        text: String,
    },
    /// Not the name of a format.
    #[error(
        "unknown format `{text}`: it is eXfY with X exponent and Y fraction bits, such as e7f16, or \
         f64, or exact"
    )]
    UnknownFormat {
        /// The text found.
        text: String,
    },
    /// A float with too few or too many bits.
    #[error(transparent)]
    WidthOutOfRange(UnknownFloatFormat),
}

impl FromStr for Method {
    type Err = WalkError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Method::ALL
            .into_iter()
            .find(|method| method.name() == text)
            .ok_or_else(|| WalkError::UnknownMethod {
                text: text.to_owned(),
            })
    }
}

impl FromStr for WalkFormat {
    type Err = WalkError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "f64" => return Ok(WalkFormat::F64),
            "exact" => return Ok(WalkFormat::Exact),
            _ => {}
        }
        text.parse()
            .map(WalkFormat::Float)
            .map_err(|error| match error {
                UnknownFloatFormat::Name { text } => WalkError::UnknownFormat { text },
                width @ UnknownFloatFormat::Width { .. } => WalkError::WidthOutOfRange(width),
            })
    }
}

impl TryFrom<String> for Method {
    type Error = WalkError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl TryFrom<String> for WalkFormat {
    type Error = WalkError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for WalkFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WalkFormat::Float(format) => write!(f, "{format}"),
            WalkFormat::F64 => f.write_str("f64"),
            WalkFormat::Exact => f.write_str("exact"),
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
    fn an_unknown_method_comes_with_the_known_ones() {
        assert_eq!("oh".parse(), Ok(Method::Oh));
        let message = "tevs".parse::<Method>().unwrap_err().to_string();
        assert_eq!(message, "unknown method `tevs`: there is oh");
    }
}
