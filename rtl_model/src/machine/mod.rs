//! Clocked units, cycle by cycle: which ray is where, when.
//!
//! The arithmetic of a pipeline is not simulated register by register: a datapath is evaluated
//! once for each ray that enters it, and the schedule says in which later cycle each of the
//! results stands in which register. What a machine models is control.
//!
//! The blocks that machines are made of, [`Fifo`], [`HeightCache`], [`ReadPort`], are small
//! machines of their own, each with a Verilog twin in `hdl_gen::blocks`. [`AxiMemory`] is what
//! stands outside.

mod axi_memory;
mod declaration;
mod exact;
mod exact_run;
mod exact_shape;
mod exact_state;
mod exact_trip;
mod fifo;
mod height_cache;
mod ledger;
mod occupancy;
mod paper;
mod paper_pass;
mod paper_run;
mod paper_shape;
mod read_port;
mod recirculation;
mod run_summary;
mod stall;
mod stream;

pub use axi_memory::{AxiMemory, AxiMemoryOutputs, AxiMemoryShape};
pub use declaration::{ClockedUnit, Declared, DeclaredKind, bits_for};
pub use exact::{ExactCounts, ExactHit, ExactInputs, ExactMachine, ExactOutputs};
pub use exact_run::ExactRun;
pub use exact_shape::{
    EXACT_COUNTER_BITS, ExactEffort, ExactMachineShape, KEPT_NAMES, KNOWN_STAGE, READ_STAGE,
};
pub use exact_trip::{ExactTrip, curve_address, exact_trip};
pub use fifo::{Fifo, FifoField, FifoOutputs, FifoShape};
pub use height_cache::{
    CacheAnswer, HeightCache, HeightCacheInputs, HeightCacheOutputs, HeightCacheShape, LINE_HEIGHTS,
};
pub use ledger::{HIT_WORDS, HitLedger, HitReport};
pub use occupancy::OccupancyOverTime;
pub use paper::{PaperCounts, PaperInputs, PaperMachine, PaperOutputs};
pub use paper_run::PaperRun;
pub use paper_shape::{LOOKUP_STAGE, PaperShape};
pub use read_port::{
    ADDRESS_BITS, AxiAddress, AxiBeat, BEAT_BYTES, ReadPort, ReadPortInputs, ReadPortOutputs,
    ReadPortShape,
};
pub use recirculation::{
    CycleInputs, CycleOutputs, ID_BITS, SetupEntry, StageEntry, TraverseMachine, UnitLatency,
};
pub use run_summary::{Lookups, RunSummary};
pub use stall::StallPattern;
pub use stream::{StreamMachine, StreamOutputs};
