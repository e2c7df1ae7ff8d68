//! What becomes of a result beyond the range of its format.

use std::fmt;
use std::str::FromStr;

/// What an operator makes of a result that, rounded, is beyond the range of its format. Either way
/// the flag `overflow` is raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Overflow {
    /// The nearer end of the range.
    #[default]
    Saturate,
    /// The number in the range that differs from it by a multiple of the range's size: the low bits.
    Wrap,
}

impl Overflow {
    /// Both, in the order of the documentation.
    pub const ALL: [Overflow; 2] = [Overflow::Saturate, Overflow::Wrap];

    /// The name used in module names, file names and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Overflow::Saturate => "saturate",
            Overflow::Wrap => "wrap",
        }
    }
}

impl FromStr for Overflow {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Overflow::ALL
            .into_iter()
            .find(|overflow| overflow.name() == text)
            .ok_or_else(|| format!("unknown overflow `{text}`: it is saturate or wrap"))
    }
}

impl fmt::Display for Overflow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
