//! Hardware held against the golden model, output by output and cycle by cycle.

mod divergence;
mod embedded;
mod golden;

pub use divergence::{Comparison, Divergence};
pub use embedded::run_embedded;
pub use golden::{GoldenRun, History};
