//! A field of a vector: a port of a unit, with what its bits mean.

use std::fmt;
use std::str::FromStr;

use rtl_model::fixed::FixedFormat;
use rtl_model::float::FloatFormat;
use rtl_model::scene::WalkFormat;
use serde::{Deserialize, Serialize};

use crate::netlist::Meaning;

/// Is a field given to the unit, or expected of it?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Given to the unit.
    Input,
    /// Expected of the unit.
    Output,
    /// A word of a memory that the unit reads; its address is the number of the line, from 0.
    Memory,
}

/// How the bits of a field are read; written `float eXfY`, `fixed qI.F` or `fixed uqI.F`, `signed`,
/// `unsigned` or `bit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum FieldFormat {
    /// A float: sign, exponent, fraction (`docs/numerics.md`).
    Float(FloatFormat),
    /// A fixed-point number: the integer it spells, times a power of two (`docs/fixed_point.md`).
    Fixed(FixedFormat),
    /// A two's complement integer.
    Signed,
    /// An unsigned integer.
    Unsigned,
    /// One bit, 1 for yes.
    Bit,
}

impl FieldFormat {
    /// How the bits of a port of the netlist are read.
    pub fn of_port(meaning: Meaning, width: u32) -> FieldFormat {
        match meaning {
            Meaning::Float(format) => FieldFormat::Float(format),
            Meaning::Fixed(format) => FieldFormat::Fixed(format),
            Meaning::Signed => FieldFormat::Signed,
            Meaning::Bits if width == 1 => FieldFormat::Bit,
            Meaning::Bits => FieldFormat::Unsigned,
        }
    }
}

impl fmt::Display for FieldFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FieldFormat::Float(format) => write!(f, "float {format}"),
            FieldFormat::Fixed(format) => write!(f, "fixed {format}"),
            FieldFormat::Signed => f.write_str("signed"),
            FieldFormat::Unsigned => f.write_str("unsigned"),
            FieldFormat::Bit => f.write_str("bit"),
        }
    }
}

impl FromStr for FieldFormat {
    type Err = String;

    fn from_str(text: &str) -> Result<FieldFormat, String> {
        let float = || match text.strip_prefix("float ")?.parse() {
            Ok(WalkFormat::Float(format)) => Some(format),
            _ => None,
        };
        let fixed = || text.strip_prefix("fixed ")?.parse().ok();
        match text {
            "signed" => Ok(FieldFormat::Signed),
            "unsigned" => Ok(FieldFormat::Unsigned),
            "bit" => Ok(FieldFormat::Bit),
            _ => {
                let fixed = fixed().map(FieldFormat::Fixed);
                fixed.or(float().map(FieldFormat::Float)).ok_or_else(|| {
                    format!(
                        "unknown format `{text}`: it is float eXfY, fixed qI.F or uqI.F, signed, \
                         unsigned or bit"
                    )
                })
            }
        }
    }
}

impl From<FieldFormat> for String {
    fn from(format: FieldFormat) -> String {
        format.to_string()
    }
}

impl TryFrom<String> for FieldFormat {
    type Error = String;

    fn try_from(text: String) -> Result<FieldFormat, String> {
        text.parse()
    }
}

/// A field of every vector of a set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name: that of the unit's port where the vectors are those of one unit's ports.
    pub name: String,
    /// Given or expected.
    pub role: Role,
    /// Bits, 1 to 64.
    pub width: u32,
    /// How they are read.
    pub format: FieldFormat,
    /// What the value is, in a phrase.
    pub meaning: String,
}

impl Field {
    /// A field.
    pub fn new(
        name: impl Into<String>,
        role: Role,
        width: u32,
        format: FieldFormat,
        meaning: impl Into<String>,
    ) -> Field {
        Field {
            name: name.into(),
            role,
            width,
            format,
            meaning: meaning.into(),
        }
    }

    /// A mask of its bits.
    pub fn mask(&self) -> u64 {
        u64::MAX >> (64 - self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_read_back_from_their_names() {
        for format in [
            FieldFormat::Float(FloatFormat::E7F16),
            FieldFormat::Fixed(FixedFormat::q(12, 20)),
            FieldFormat::Fixed(FixedFormat::uq(0, 16)),
            FieldFormat::Signed,
            FieldFormat::Unsigned,
            FieldFormat::Bit,
        ] {
            assert_eq!(format.to_string().parse(), Ok(format));
        }
        for text in [
            "float",
            "float f64",
            "float e1f3",
            "fixed",
            "fixed q0.3",
            "Signed",
            "",
        ] {
            assert!(text.parse::<FieldFormat>().is_err(), "{text}");
        }
    }
}
