//! Which simulator runs the hardware.

use super::verilator::{Verilator, VerilatorError};
use std::fmt;
use std::str::FromStr;

/// The simulator asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SimulatorChoice {
    /// The fastest that is installed: Verilator, else the embedded one.
    #[default]
    Auto,
    /// Verilator, or an error.
    Verilator,
    /// Icarus Verilog, or an error: thousands of times slower, for small frames.
    Icarus,
    /// The one in this program, which runs the netlist the Verilog is printed from.
    Embedded,
}

impl SimulatorChoice {
    /// All choices.
    pub const ALL: [SimulatorChoice; 4] = [
        SimulatorChoice::Auto,
        SimulatorChoice::Verilator,
        SimulatorChoice::Icarus,
        SimulatorChoice::Embedded,
    ];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            SimulatorChoice::Auto => "auto",
            SimulatorChoice::Verilator => "verilator",
            SimulatorChoice::Icarus => "icarus",
            SimulatorChoice::Embedded => "embedded",
        }
    }

    /// Finds the simulator.
    ///
    /// # Errors
    /// If it is not installed, or too old. `Auto` always finds one.
    pub fn find(self) -> Result<FoundSimulator, FindError> {
        Ok(match self {
            SimulatorChoice::Auto => match Verilator::find() {
                Ok(verilator) => FoundSimulator::Verilator(verilator),
                Err(_) => FoundSimulator::Embedded,
            },
            SimulatorChoice::Verilator => FoundSimulator::Verilator(Verilator::find()?),
            SimulatorChoice::Icarus => todo!(),
            SimulatorChoice::Embedded => FoundSimulator::Embedded,
        })
    }
}

impl FromStr for SimulatorChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        SimulatorChoice::ALL
            .into_iter()
            .find(|choice| choice.name() == text)
            .ok_or_else(|| "it is one of auto, verilator, icarus, embedded".to_owned())
    }
}

/// Why a simulator cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FindError {
    /// Verilator.
    #[error(transparent)]
    Verilator(#[from] VerilatorError),
}

/// A simulator that is there.
#[derive(Clone, Debug)]
pub enum FoundSimulator {
    /// Verilator.
    Verilator(Verilator),
    /// The embedded one.
    Embedded,
}

impl FoundSimulator {
    /// Its name, as in [`SimulatorChoice::name`].
    pub const fn name(&self) -> &'static str {
        match self {
            FoundSimulator::Verilator(_) => "verilator",
            FoundSimulator::Embedded => "embedded",
        }
    }
}

impl FoundSimulator {
    /// What the simulator says of its version.
    pub fn version(&self) -> &str {
        match self {
            FoundSimulator::Verilator(verilator) => &verilator.version,
            FoundSimulator::Embedded => env!("CARGO_PKG_VERSION"),
        }
    }
}

impl fmt::Display for FoundSimulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
