//! What a comparison found.

use serde::Serialize;

/// A signal that was not what the golden model says.
#[derive(Clone, Debug, Serialize, PartialEq, Eq)]
pub struct Divergence {
    /// Cycle since reset.
    pub cycle: u64,
    /// The instance it stands in, from the top.
    pub unit: String,
    /// The signal.
    pub signal: String,
    /// What it must be.
    pub expected: u64,
    /// What it was.
    pub found: u64,
}

/// The outcome of a run.
#[derive(Clone, Debug, Default, Serialize, PartialEq, Eq)]
pub struct Comparison {
    /// Rays (or operand sets) whose results left the unit.
    pub rays: u64,
    /// Walks that ended at the step bound.
    pub guards: u64,
    /// Cycles run.
    pub cycles: u64,
    /// Cycles in which signals were compared.
    pub cycles_compared: u64,
    /// Signals compared in each of them.
    pub signals_compared: u64,
    /// Signals that differed, summed over the cycles.
    pub mismatches: u64,
    /// Those of the first cycle that had any, in the order of the dataflow.
    pub first: Vec<Divergence>,
}
