//! Hardware held against the golden model, output by output and cycle by cycle.

mod clocked;
mod clocked_waveform;
mod divergence;
mod embedded;
mod exact;
mod golden;
mod icarus;
mod operands;
mod paper;
mod random_rays;
mod record;
mod simulator;
pub(crate) mod split_mix;
mod stream;
mod traverse;
mod vectors;
mod verilator;
mod waveform;

pub use clocked::{ClockedRun, ClockedTraffic, EachCycle, input_ports};
pub use clocked_waveform::WrittenWaveform;
pub use divergence::{Comparison, Divergence};
pub use embedded::run_embedded;
pub use exact::ExactDesign;
pub use golden::{GoldenRun, History};
pub use icarus::{Icarus, IcarusError};
pub use operands::OperandSets;
pub use paper::PaperDesign;
pub use random_rays::random_rays;
pub use record::{HarnessPlan, MemoryPorts};
pub use simulator::{FindError, FoundSimulator, SimulatorChoice};
pub use stream::{StreamRun, VectorSource};
pub use traverse::{driven_words, run_verilator, traverse_plan};
pub use vectors::run_vectors_embedded;
pub use verilator::{RecordStream, TraceWindow, Verilator, VerilatorError, run_harness};
pub use waveform::{
    SimulatedWaveform, conform_window, decoded_value, golden_waveform, units_in_the_last_place,
    verilator_waveform, waveform_options, waveform_signals,
};
