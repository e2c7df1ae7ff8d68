//! Clocked units, cycle by cycle: which ray is where, when.
//!
//! The arithmetic of a pipeline is not simulated register by register: a datapath is evaluated
//! once for each ray that enters it, and the schedule says in which later cycle each of the
//! results stands in which register. What a machine models is control.

mod recirculation;
mod stall;
mod stream;

pub use recirculation::{
    CycleInputs, CycleOutputs, ID_BITS, SetupEntry, StageEntry, TraverseMachine, UnitLatency,
};
pub use stall::StallPattern;
pub use stream::{StreamMachine, StreamOutputs};
