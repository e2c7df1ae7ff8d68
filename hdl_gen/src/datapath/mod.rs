//! The netlist reading of a datapath: recorded from its Rust function, scheduled into pipeline
//! stages, built as a module.

mod build;
mod integer_product;
mod record;
mod schedule;
mod signal;
mod word_logic;

pub use build::{BuiltDatapath, PipelineRegister, Source, build};
pub use record::{Output, Recorder, Recording};
pub use schedule::{OperatorLatencies, Schedule, schedule};
pub use signal::{BitSignal, IntSignal, Kind, NumSignal, Recorded, RecordedOperation, SignalId};
