//! What is said of a signal before it has a value: where it stands, how it is meant, what it is
//! computed from.

use super::WaveError;
use crate::netlist::Meaning;

/// Scopes below scopes, at most: far more than a design has, few enough for any reader.
pub(crate) const MAX_SCOPE_DEPTH: usize = 256;

/// A signal of a design, as a waveform shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignalDeclaration {
    /// The instances it stands in, outermost first: `["traverse", "step"]`. All declarations of
    /// one waveform share the first.
    pub path: Vec<String>,
    /// Its name in its module.
    pub name: String,
    /// Bits, 1 to 64.
    pub width: u32,
    /// How its bits are meant.
    pub meaning: Meaning,
}

impl SignalDeclaration {
    /// The hierarchical name: scopes and name with points between, `traverse.step.t`.
    pub fn full_name(&self) -> String {
        joined(&self.path, &self.name)
    }

    /// Is it something a waveform can hold?
    pub(crate) fn check(&self) -> Result<(), WaveError> {
        let wrong = |reason: &str| {
            Err(WaveError::Declaration {
                signal: self.full_name(),
                reason: reason.to_owned(),
            })
        };
        if self.path.is_empty() {
            return wrong("it stands in no scope; give it at least the design's name");
        }
        if self.path.len() > MAX_SCOPE_DEPTH {
            return wrong("more than 256 scopes deep");
        }
        // Points separate scopes and `$end` ends a declaration: neither can be part of a name.
        let is_name = |name: &String| {
            !name.is_empty()
                && name.bytes().all(|byte| byte.is_ascii_graphic())
                && !name.contains('.')
                && !name.contains("$end")
        };
        if !self.path.iter().all(is_name) || !is_name(&self.name) {
            return wrong("names are printable, not empty, without spaces, points and `$end`");
        }
        if !(1..=64).contains(&self.width) {
            return wrong("its width is not 1 to 64 bits");
        }
        let meant = match self.meaning {
            Meaning::Float(format) => Some((format!("float {format}"), format.width())),
            Meaning::Fixed(format) => Some((format!("fixed {format}"), format.width())),
            Meaning::Bits | Meaning::Signed => None,
        };
        if let Some((meant, width)) = meant
            && width != self.width
        {
            return wrong(&format!(
                "it is {} bits wide, but a {meant} has {width}",
                self.width
            ));
        }
        Ok(())
    }
}

/// Scopes and a name with points between.
pub(crate) fn joined(scopes: &[String], name: &str) -> String {
    let mut full = String::new();
    for scope in scopes {
        full.push_str(scope);
        full.push('.');
    }
    full.push_str(name);
    full
}

/// What a signal is computed from. With it, a comparison can tell a first cause from an effect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dependency {
    /// The full name of the signal.
    pub signal: String,
    /// Everything its value in a cycle is computed from.
    pub inputs: Vec<EarlierSignal>,
}

/// A signal some cycles ago.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EarlierSignal {
    /// Its full name.
    pub signal: String,
    /// How many cycles ago; 0 is the same cycle, through combinational logic.
    pub cycles_back: u32,
}

/// The inputs of a unit: where they agree and the unit's signals do not, the unit is at fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitInputs {
    /// The unit's scope, with points: `traverse.step`.
    pub unit: String,
    /// The full names of the signals that enter it, clock and reset aside.
    pub inputs: Vec<String>,
}
