//! The units of the hardware as modules: recorded from the golden model's datapaths, with control
//! built anew around them.

mod bounded_datapaths;
mod configuration;
mod exact_machine;
mod exact_probes;
mod exact_trip;
mod paper_datapaths;
mod paper_loop;
mod paper_machine;
mod paper_probes;
mod probe;
mod traverse;
mod traverse_datapaths;
mod traverse_probes;
mod traverse_step_unit;

pub use bounded_datapaths::{build_bounded, record_bounded};
pub use configuration::{NoHardware, UnitConfiguration};
pub use exact_machine::{EXACT_MACHINE, ExactUnit};
pub use exact_probes::ExactLayout;
pub use exact_trip::{EXACT_TRIP, build_exact_trip};
pub use paper_datapaths::{
    BuiltPaperSetup, PAPER_SETUP, PAPER_STEP, build_paper_setup, build_paper_step, paper_stages,
    record_paper_step,
};
pub use paper_loop::{PAPER_LOOP, PaperLoop};
pub use paper_machine::{PAPER_MACHINE, PaperUnit};
pub use paper_probes::{PaperLayout, declared_word, loop_probes};
pub use probe::{CycleLayout, CycleWords, Probe};
pub use traverse::TraverseUnit;
pub use traverse_datapaths::{BuiltSetup, FreshValue, build_setup, build_step, step_registers};
pub(crate) use traverse_step_unit::STEP_INSTANCE;
pub use traverse_step_unit::build_step_unit;
