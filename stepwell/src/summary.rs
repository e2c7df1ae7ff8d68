//! What walking many rays came to, for people and for programs.

use std::time::Duration;

use serde::Serialize;

use rtl_model::frame::Counts;
use rtl_model::maps::MapSource;
use rtl_model::scene::Walk;

use crate::commands::Outcome;
use crate::terminal;

/// The summary of a walk, as JSON has it. Every JSON summary of this program has the keys from
/// `mismatches` to `cycles_compared` and `simulator`; here they are null, since the golden model
/// alone has been run.
#[derive(Debug, Serialize)]
pub struct WalkSummary {
    schema: &'static str,
    map: String,
    method: String,
    format: String,
    rays: u64,
    guards: u64,
    steps: StepCounts,
    crossings: CrossingCounts,
    seconds: f64,
    simulator: Option<String>,
    mismatches: Option<u64>,
    cycles: Option<u64>,
    signals_compared: Option<u64>,
    cycles_compared: Option<u64>,
}

#[derive(Debug, Serialize)]
struct StepCounts {
    total: u64,
    mean: Option<f64>,
    max: u32,
}

#[derive(Debug, Serialize)]
struct CrossingCounts {
    total: u64,
    mean: Option<f64>,
}

impl WalkSummary {
    /// The summary of a walk that took `time`; means are null where there are no rays.
    pub fn new(
        schema: &'static str,
        map: &MapSource,
        walk: Walk,
        counts: &Counts,
        time: Duration,
    ) -> WalkSummary {
        WalkSummary {
            schema,
            map: map.to_string(),
            method: walk.method.to_string(),
            format: walk.format.to_string(),
            rays: counts.rays,
            guards: counts.guards,
            steps: StepCounts {
                total: counts.steps,
                mean: counts.mean_steps(),
                max: counts.most_steps,
            },
            crossings: CrossingCounts {
                total: counts.crossings,
                mean: counts.mean_crossings(),
            },
            seconds: time.as_secs_f64(),
            simulator: None,
            mismatches: None,
            cycles: None,
            signals_compared: None,
            cycles_compared: None,
        }
    }

    /// The lines of the table that every walk has.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let mean = |mean: Option<f64>| mean.map_or("none".to_owned(), |mean| format!("{mean:.2}"));
        let rate = self.rays as f64 / self.seconds.max(1e-9);
        vec![
            ("walk", format!("{} in {}", self.method, self.format)),
            (
                "steps",
                format!("{} mean, {} max", mean(self.steps.mean), self.steps.max),
            ),
            ("crossings", format!("{} mean", mean(self.crossings.mean))),
            ("guards", self.guards.to_string()),
            (
                "time",
                format!("{:.3} s, {} rays/s", self.seconds, rounded(rate)),
            ),
        ]
    }

    /// Agreed, unless a walk ended without a hit: then the person is told.
    pub fn outcome(&self) -> Outcome {
        if self.guards == 0 {
            return Outcome::Agreed;
        }
        terminal::complain(&format!(
            "{} of {} rays ended at the step bound without a hit (status guard): {} is too coarse \
             for these rays on this map, or the traversal has a defect",
            self.guards, self.rays, self.format
        ));
        Outcome::Disagreed
    }
}

/// A large number to three digits, with a unit.
fn rounded(number: f64) -> String {
    let (scaled, unit) = match number {
        n if n >= 1e6 => (n / 1e6, " million"),
        n if n >= 1e3 => (n / 1e3, " thousand"),
        n => (n, ""),
    };
    let decimals = if scaled < 10.0 {
        2
    } else {
        usize::from(scaled < 100.0)
    };
    format!("{scaled:.decimals$}{unit}")
}

/// Names and values in two columns.
pub fn table(rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    rows.iter()
        .map(|(name, value)| format!("{name:width$}  {value}\n"))
        .collect()
}

/// JSON on several lines, ended.
pub fn json(value: &impl Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}
