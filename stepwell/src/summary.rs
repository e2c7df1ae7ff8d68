//! What walking many rays came to, for people and for programs.

use std::time::Duration;

use serde::Serialize;

use rtl_model::early::EarlyBound;
use rtl_model::frame::{Counts, Fit};
use rtl_model::maps::MapSource;
use rtl_model::scene::{Crossing, Walk};

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
    /// `index`, or `offset:X`.
    crossing: String,
    rays: u64,
    guards: u64,
    steps: StepCounts,
    crossings: CrossingCounts,
    #[serde(skip_serializing_if = "Option::is_none")]
    ray_format: Option<RayFormatSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    early_bound: Option<EarlyBoundSummary>,
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

/// The formats of rays in fixed point, and why.
#[derive(Debug, Serialize)]
struct RayFormatSummary {
    slopes: String,
    entries: String,
    reasons: [String; 3],
    saturated: u64,
    #[serde(skip)]
    text: String,
}

/// How much earlier than the exact hit an answer can be; null where nothing is promised.
#[derive(Debug, Serialize)]
struct EarlyBoundSummary {
    text: String,
    depth: Option<f64>,
    missed_texels: Option<f64>,
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
            crossing: walk.crossing.to_string(),
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
            ray_format: None,
            early_bound: None,
            seconds: time.as_secs_f64(),
            simulator: None,
            mismatches: None,
            cycles: None,
            signals_compared: None,
            cycles_compared: None,
        }
    }

    /// With what the rays made of the walk: their formats in fixed point, and the bound on how
    /// early an answer can be.
    pub fn fitted(mut self, fit: &Fit) -> WalkSummary {
        self.ray_format = fit.ray_format.map(|format| RayFormatSummary {
            slopes: format.slope.to_string(),
            entries: format.entry().to_string(),
            reasons: format.reasons(),
            saturated: fit.saturated,
            text: format.to_string(),
        });
        let bound = EarlyBound::of(fit.walk, fit.most_texels);
        let (depth, missed_texels) = match bound {
            EarlyBound::Float {
                depth,
                missed_texels,
            } => (Some(depth), Some(missed_texels)),
            EarlyBound::Nearest | EarlyBound::LastPlace => (Some(0.0), Some(0.0)),
            EarlyBound::Measured | EarlyBound::None => (None, None),
        };
        self.early_bound = Some(EarlyBoundSummary {
            text: bound.to_string(),
            depth,
            missed_texels,
        });
        self
    }

    fn crosses_by_offset(&self) -> bool {
        self.crossing != Crossing::Index.to_string()
    }

    /// The lines of the table that every walk has.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let mean = |mean: Option<f64>| mean.map_or("none".to_owned(), |mean| format!("{mean:.2}"));
        let rate = self.rays as f64 / self.seconds.max(1e-9);
        let mut walk = format!("{} in {}", self.method, self.format);
        if self.crosses_by_offset() {
            walk += &format!(", borders crossed by {}", self.crossing);
        }
        let mut rows = vec![("walk", walk)];
        if let Some(format) = &self.ray_format {
            rows.push(("ray format", format.text.clone()));
            rows.extend(format.reasons.iter().map(|reason| ("", reason.clone())));
            rows.push((
                "saturated",
                format!("{} of {} rays", format.saturated, self.rays),
            ));
        }
        rows.extend([
            (
                "steps",
                format!("{} mean, {} max", mean(self.steps.mean), self.steps.max),
            ),
            ("crossings", format!("{} mean", mean(self.crossings.mean))),
            ("guards", self.guards.to_string()),
        ]);
        if let Some(bound) = &self.early_bound {
            rows.push(("early by", bound.text.clone()));
        }
        rows.push((
            "time",
            format!("{:.3} s, {} rays/s", self.seconds, rounded(rate)),
        ));
        rows
    }

    /// Agreed, unless a walk ended without a hit: then the person is told.
    ///
    /// Rays that were saturated are told too: what was walked for them is another ray.
    pub fn outcome(&self) -> Outcome {
        if let Some(format) = &self.ray_format
            && format.saturated > 0
        {
            terminal::complain(&format!(
                "{} of {} rays have a slope beyond {} and were walked with its largest: take                  --format fixed, which is chosen from the rays, or more integer bits",
                format.saturated, self.rays, format.slopes
            ));
        }
        if self.guards == 0 {
            return Outcome::Agreed;
        }
        let cause = match self.crosses_by_offset() {
            true => format!(
                "rounding in {} loses {} on this map, so that the walk stays where it is; cross by \
                 the index",
                self.format, self.crossing
            ),
            false => format!(
                "{} is too coarse for these rays on this map, or the traversal has a defect",
                self.format
            ),
        };
        terminal::complain(&format!(
            "{} of {} rays ended at the step bound without a hit (status guard): {cause}",
            self.guards, self.rays
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

/// The digest of a unit, with that of the operator in it where it is one.
pub fn netlist_row(unit: &str, core: Option<&str>) -> String {
    match core {
        Some(core) => format!("{unit}, of the operator without handshakes {core}"),
        None => unit.to_owned(),
    }
}

/// JSON on several lines, ended.
pub fn json(value: &impl Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(guards: u64) -> WalkSummary {
        let counts = Counts {
            rays: 8,
            guards,
            steps: 100,
            most_steps: 40,
            crossings: 20,
        };
        let walk = Walk {
            method: "oh".parse().unwrap(),
            format: "e4f3".parse().unwrap(),
            crossing: rtl_model::scene::Crossing::Index,
        };
        let map = "procedural:flat:4:0".parse().unwrap();
        WalkSummary::new("test-1", &map, walk, &counts, Duration::from_millis(500))
    }

    #[test]
    fn a_walk_without_a_hit_is_a_disagreement() {
        assert_eq!(summary(0).outcome(), Outcome::Agreed);
        assert_eq!(summary(1).outcome(), Outcome::Disagreed);
    }

    #[test]
    fn tables_and_json_have_the_same_numbers() {
        let text = table(&summary(3).rows());
        for line in [
            "walk       oh in e4f3\n",
            "steps      12.50 mean, 40 max\n",
            "crossings  2.50 mean\n",
            "guards     3\n",
            "time       0.500 s, 16.0 rays/s\n",
        ] {
            assert!(text.contains(line), "{text}");
        }
        let json: serde_json::Value = serde_json::from_str(&json(&summary(3)).unwrap()).unwrap();
        assert_eq!(json["steps"]["mean"], 12.5);
        assert_eq!((&json["guards"], &json["rays"]), (&3.into(), &8.into()));
    }

    #[test]
    fn a_crossing_by_an_offset_is_named() {
        let mut summary = summary(1);
        assert!(!table(&summary.rows()).contains("crossed by"));
        summary.crossing = "offset:0.5".to_owned();
        let text = table(&summary.rows());
        assert!(
            text.contains("oh in e4f3, borders crossed by offset:0.5\n"),
            "{text}"
        );
    }

    #[test]
    fn rates_are_given_to_three_digits() {
        for (number, expected) in [
            (7.0, "7.00"),
            (123.4, "123"),
            (45_600.0, "45.6 thousand"),
            (2.345e6, "2.35 million"),
        ] {
            assert_eq!(rounded(number), expected);
        }
    }
}
