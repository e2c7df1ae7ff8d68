//! Waveforms (VCD, IEEE 1364-2005 section 18): written, conformed, compared.
//!
//! The golden model and the Verilog of one design are held against each other cycle by cycle.
//! The golden waveform is written by [`Writer`] from the values the model says each signal has;
//! a simulator's own waveform is brought to the same hierarchy, signals and times by [`conform`];
//! and [`diff`] finds the first cycle in which two waveforms disagree, and which signal began it.
//!
//! The value of a signal *in cycle c* is the one it has settled to just before the rising edge
//! that begins cycle c + 1. Registers take their value for cycle c at the edge that begins it.

mod annotations;
mod cause;
mod comparison;
mod conform;
mod cycles;
mod decode;
mod diff;
mod error;
mod excerpt;
mod logic;
mod pairing;
mod reader;
mod report;
mod scopes;
mod signal;
mod writer;

pub use cause::Cause;
pub use conform::{ConformOptions, ConformReport, Rename, Samples, conform};
pub use cycles::CycleNumbers;
pub use decode::{decoded, steps_between, two_s_complement};
pub use diff::{DiffOptions, SideOptions, Waveform, diff, diff_files};
pub use error::{Names, SideNames, WaveError};
pub use excerpt::{Excerpt, ExcerptSignal, excerpt};
pub use logic::LogicWord;
pub use report::{
    DiffReport, DivergingSignal, FirstDivergence, SideReport, ValueReport, WidthMismatch,
};
pub use signal::{Dependency, EarlierSignal, SignalDeclaration, UnitInputs};
pub use writer::{Writer, WriterOptions};

/// The clock's name in every module (see [`crate::netlist`]).
pub const CLOCK_NAME: &str = "clk_i";
/// The name of the synchronous reset, active low, in every module.
pub const RESET_NAME: &str = "rst_ni";
/// What a float signal's decoded companion, a VCD real, has after its name.
pub const REAL_SHADOW_SUFFIX: &str = "_real";
/// What a signed signal's decoded companion, a VCD integer, has after its name.
pub const INTEGER_SHADOW_SUFFIX: &str = "_int";
