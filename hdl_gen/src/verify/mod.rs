//! Hardware held against the golden model, output by output and cycle by cycle.

mod divergence;
mod embedded;
mod golden;
mod record;
mod traverse;
mod verilator;

pub use divergence::{Comparison, Divergence};
pub use embedded::run_embedded;
pub use golden::{GoldenRun, History};
pub use record::{HarnessPlan, MemoryPorts};
pub use traverse::{run_verilator, traverse_plan};
pub use verilator::{TraceWindow, Verilator, VerilatorError, run_harness};
