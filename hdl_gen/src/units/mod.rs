//! The units of the hardware as modules: recorded from the golden model's datapaths, with control
//! built anew around them.

mod probe;
mod traverse;
mod traverse_datapaths;

pub use probe::{CycleWords, Probe};
pub use traverse::{TraverseUnit, UnitConfiguration};
pub use traverse_datapaths::{build_setup, build_step};
