//! An operator of any family, for whoever builds, verifies or measures one without asking which.

use std::fmt;
use std::sync::Arc;

use super::{FixedConfiguration, OperatorConfiguration, UnsupportedOperator};
use crate::netlist::Module;

/// A float or a fixed-point operator, with all that its module depends on but the latency.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AnyOperator {
    /// Of floats.
    Float(OperatorConfiguration),
    /// Of fixed-point numbers, or between these and floats.
    Fixed(FixedConfiguration),
}

impl From<OperatorConfiguration> for AnyOperator {
    fn from(configuration: OperatorConfiguration) -> AnyOperator {
        AnyOperator::Float(configuration)
    }
}

impl From<FixedConfiguration> for AnyOperator {
    fn from(configuration: FixedConfiguration) -> AnyOperator {
        AnyOperator::Fixed(configuration)
    }
}

impl AnyOperator {
    /// Its module's name without the latency.
    pub fn name(self) -> String {
        match self {
            AnyOperator::Float(configuration) => configuration.name(),
            AnyOperator::Fixed(configuration) => configuration.name(),
        }
    }

    /// The name of its module in so many cycles.
    pub fn module_name(self, latency: u32) -> String {
        format!("{}_l{latency}", self.name())
    }

    /// Can it be built?
    ///
    /// # Errors
    /// If a word of it would be wider than 64 bits, or a parameter is out of its range.
    pub fn check(self) -> Result<(), UnsupportedOperator> {
        match self {
            AnyOperator::Float(configuration) => configuration.check(),
            AnyOperator::Fixed(configuration) => configuration.check(),
        }
    }

    /// Its module in so many cycles.
    ///
    /// # Panics
    /// Where [`AnyOperator::check`] fails.
    pub fn build(self, latency: u32) -> Arc<Module> {
        match self {
            AnyOperator::Float(configuration) => configuration.build(latency),
            AnyOperator::Fixed(configuration) => configuration.build(latency),
        }
    }

    /// Has it the port `flags_o`?
    pub fn has_flags(self) -> bool {
        match self {
            AnyOperator::Float(configuration) => configuration.has_flags,
            AnyOperator::Fixed(configuration) => configuration.has_flags,
        }
    }

    /// Widths of its operands, in the order of its input ports.
    pub fn operand_widths(self) -> Vec<u32> {
        match self {
            AnyOperator::Float(configuration) => {
                configuration.operator.operand_widths(configuration.format)
            }
            AnyOperator::Fixed(configuration) => configuration.operand_widths(),
        }
    }

    /// Appends the golden results to `results`, in the order of its output ports. Operands are the
    /// bits of its input ports.
    pub fn golden_results(self, operands: &[u64], results: &mut Vec<u64>) {
        match self {
            AnyOperator::Float(configuration) => configuration.golden_results(operands, results),
            AnyOperator::Fixed(configuration) => configuration.golden_results(operands, results),
        }
    }

    /// Its formats, as reports name them: `e7f16`; `q4.12`, or `q4.12 uq0.16 to q12.20` where they
    /// differ.
    pub fn formats(self) -> String {
        match self {
            AnyOperator::Float(configuration) => configuration.format.to_string(),
            AnyOperator::Fixed(configuration) => configuration.formats(),
        }
    }
}

impl fmt::Display for AnyOperator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name())
    }
}
