//! How much is tried.

use std::fmt;

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Tier {
    /// Seconds: what continuous integration runs.
    Quick,
    /// Minutes an operator: what is run before a release.
    Substantial,
    /// Whatever can be tried in full, in hours.
    Exhaustive,
}

impl Tier {
    /// The one of three values that is this tier's.
    pub fn of<T>(self, quick: T, substantial: T, exhaustive: T) -> T {
        match self {
            Tier::Quick => quick,
            Tier::Substantial => substantial,
            Tier::Exhaustive => exhaustive,
        }
    }
}

impl fmt::Display for Tier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.of("quick", "substantial", "exhaustive"))
    }
}
