//! Hardware held against the golden model, output by output and cycle by cycle.

mod dependencies;
mod divergence;
mod embedded;
mod golden;
mod icarus;
mod operands;
mod record;
mod stream;
mod traverse;
mod vectors;
mod verilator;
mod waveform;

pub use divergence::{Comparison, Divergence};
pub use embedded::run_embedded;
pub use golden::{GoldenRun, History};
pub use icarus::{Icarus, IcarusError};
pub use operands::OperandSets;
pub use record::{HarnessPlan, MemoryPorts};
pub use stream::StreamRun;
pub use traverse::{run_verilator, traverse_plan};
pub use vectors::run_vectors_embedded;
pub use verilator::{TraceWindow, Verilator, VerilatorError, run_harness};
pub use waveform::{golden_waveform, traverse_declarations};
