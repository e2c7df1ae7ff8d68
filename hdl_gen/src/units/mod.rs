//! The units of the hardware as modules: recorded from the golden model's datapaths, with control
//! built anew around them.

mod probe;
mod traverse;
mod traverse_datapaths;
mod traverse_step_unit;

pub use probe::{CycleWords, Probe};
pub use traverse::{TraverseUnit, UnitConfiguration};
pub use traverse_datapaths::{build_setup, build_step};
pub use traverse_step_unit::build_step_unit;
