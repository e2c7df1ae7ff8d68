//! A line of a campaign's result: one operator in one format, under one policy.

use std::time::Duration;

use serde::Serialize;

/// What was compared, how often, and what came of it.
#[derive(Clone, Debug, Serialize, PartialEq)]
pub struct Row {
    /// The campaign.
    pub campaign: &'static str,
    /// The operator, and what it is held against.
    pub operator: String,
    /// The format of its operands.
    pub format: String,
    /// What becomes of subnormal numbers.
    pub policy: String,
    /// The roundings tried, each with all the cases there are; `-` where it has none.
    pub roundings: String,
    /// The other side: a library, a simulator, a solver.
    pub judge: String,
    /// Cases, over all roundings.
    pub cases: u64,
    /// Were these all the cases there are?
    pub exhaustive: bool,
    /// Cases on which the two sides differ.
    pub differences: u64,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// The seed of the cases; `None` where there is none.
    pub seed: Option<u64>,
    /// The differences that are shown.
    pub first: Vec<String>,
}

impl Row {
    /// Cases a second.
    pub fn rate(&self) -> f64 {
        self.cases as f64 / self.seconds.max(1e-9)
    }

    /// One line for a terminal.
    pub fn line(&self) -> String {
        format!(
            "{:<24} {:<7} {:<12} {:<16} {:>13} {:<4} {:>6} differ {:>9.1} s {:>11}/s  {}",
            self.operator,
            self.format,
            self.policy,
            self.roundings,
            self.cases,
            if self.exhaustive { "all" } else { "" },
            self.differences,
            self.seconds,
            self.rate().round() as u64,
            self.judge,
        )
    }

    /// Takes the time from a duration.
    pub fn timed(self, duration: Duration) -> Row {
        Row {
            seconds: duration.as_secs_f64(),
            ..self
        }
    }
}
