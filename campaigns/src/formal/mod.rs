//! Hardware operators proven equal to plain specifications, by a SAT solver.
//!
//! The specification is Verilog by a third route, beside the golden integer arithmetic and the
//! emitted hardware: `campaigns/formal/plain_*.v` computes exactly in wide words and rounds by the
//! definition. Yosys makes gates of both and of a *miter*, a circuit with one output that is 1
//! where they differ; a solver proves that it never is, or answers with operands.
//!
//! A large operator is proven case by case. Constants for some inputs fold most of the circuit
//! away: for a sum, how far the exponents are apart and which is the larger. That the cases leave
//! nothing out is proven likewise.

mod graph;
mod miter;
mod proof;
mod solver;
mod yosys;

pub use proof::{Counterexample, Proof, ProofError, Prover, Unproven};
pub use solver::{Solver, SolverError};
pub use yosys::{Yosys, YosysError};
