//! Long runs that hold the arithmetic, the operators and the traversals of this workspace against independent
//! judges. The program `campaigns` is the face of it; `docs/campaigns.md` says what was run last.
//!
//! * `softfloat`: the golden arithmetic against Berkeley SoftFloat.
//! * `routes`: its two golden routes against each other.
//! * `hardware`: the operators under Verilator against the golden arithmetic.
//! * `small-worlds`: every ray of small formats through every small map, by every traversal, against
//!   the exact reference.
//! * `walks`: the exact fixed-point walk against a walk of the texels one by one.
//! * `frames`: whole frames of every safe traversal against the exact reference.
//! * `machines`: whole machines under Verilator, every signal in every cycle, and their hits against
//!   the exact reference.
//! * `formal`: hardware operators proven equal to plain specifications by a SAT solver.

pub mod cases;
pub mod formal;
pub mod formats;
pub mod frame_table;
pub mod frames;
pub mod hardware;
pub mod machine_table;
pub mod machines;
pub mod operands;
pub mod record;
pub mod routes;
pub mod row;
pub mod small_worlds;
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
pub mod softfloat;
pub mod sweep;
pub mod tier;
pub mod walks;
