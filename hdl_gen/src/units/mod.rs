//! The units of the hardware as modules: recorded from the golden model's datapaths, with control
//! built anew around them.

mod bounded_datapaths;
mod configuration;
mod probe;
mod traverse;
mod traverse_datapaths;
mod traverse_probes;
mod traverse_step_unit;

pub use bounded_datapaths::{build_bounded, record_bounded};
pub use configuration::{NoHardware, UnitConfiguration};
pub use probe::{CycleLayout, CycleWords, Probe};
pub use traverse::TraverseUnit;
pub use traverse_datapaths::{BuiltSetup, FreshValue, build_setup, build_step, step_registers};
pub use traverse_step_unit::build_step_unit;
