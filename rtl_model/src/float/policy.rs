//! What becomes of subnormal numbers.

use std::fmt;
use std::str::FromStr;

/// What an operator makes of numbers below the smallest normal one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Policy {
    /// A subnormal operand reads as the zero of its sign; a result is rounded as if the exponent
    /// had no lower end, and is the zero of its sign if then below the smallest normal number.
    #[default]
    Flush,
    /// Subnormal numbers as IEEE 754-2019 has them.
    Full,
}

impl Policy {
    /// Both, in the order of the documentation.
    pub const ALL: [Policy; 2] = [Policy::Flush, Policy::Full];

    /// The short name used in module names, file names and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Policy::Flush => "flush",
            Policy::Full => "full",
        }
    }
}

impl FromStr for Policy {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Policy::ALL
            .into_iter()
            .find(|policy| policy.name() == text)
            .ok_or_else(|| format!("unknown policy `{text}`: it is flush or full"))
    }
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
