//! The netlist reading of a datapath: recorded from its Rust function, scheduled into pipeline
//! stages, built as a module.

mod build;
mod delay;
mod elements;
mod integer_product;
mod naming;
mod record;
mod schedule;
mod signal;
mod word_logic;

pub use build::{BuiltDatapath, PipelineRegister, Source, build};
pub use delay::Delay;
pub use elements::ElementCounts;
pub use record::{Output, Recorder, Recording};
pub use schedule::{
    OperatorLatencies, Schedule, schedule, schedule_in_stages, schedule_within, shortest_period,
};
pub use signal::{BitSignal, IntSignal, Kind, NumSignal, Recorded, RecordedOperation, SignalId};
