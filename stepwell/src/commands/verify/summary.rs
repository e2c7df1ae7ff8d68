//! What a verification found, for people and for programs.

use std::path::PathBuf;
use std::sync::Arc;

use serde::Serialize;

use hdl_gen::digest::{core_digest, netlist_digest};
use hdl_gen::netlist::{Meaning, Module};
use hdl_gen::verify::{Comparison, FoundSimulator, decoded_value, units_in_the_last_place};

use super::Arguments;
use crate::commands::Outcome;
use crate::machine::MachineReport;
use crate::summary::{json, netlist_row, table};
use crate::terminal;

/// The JSON of a verification.
#[derive(Serialize)]
pub struct Summary {
    pub schema: &'static str,
    pub unit: String,
    pub simulator: String,
    pub simulator_version: String,
    pub format: String,
    pub method: Option<String>,
    pub map: Option<String>,
    pub rays: u64,
    pub rays_sent: u64,
    pub exhaustive: bool,
    pub guards: u64,
    pub mismatches: u64,
    pub cycles: u64,
    pub cycles_compared: u64,
    pub signals_compared: u64,
    /// Of the run.
    pub seconds: f64,
    /// Of building the hardware before it.
    pub build_seconds: f64,
    /// Of the unit that ran.
    pub netlist_digest: String,
    /// Of the operator inside it, behind the handshakes.
    pub core_digest: Option<String>,
    pub planted_fault: Option<String>,
    pub seed: u64,
    pub first_divergence: Vec<DecodedDivergence>,
    pub files: Vec<PathBuf>,
    /// Of a machine, what the golden one's run came to.
    #[serde(flatten)]
    pub machine: Option<MachineReport>,
}

/// A finished run, of which a [`Summary`] tells.
pub struct Finished<'a> {
    pub unit: &'a Arc<Module>,
    pub simulator: &'a FoundSimulator,
    pub format: String,
    pub method: Option<String>,
    pub map: Option<String>,
    pub comparison: Comparison,
    pub signals: Vec<SignalFacts>,
    pub sent: u64,
    pub exhaustive: bool,
    pub seconds: f64,
    pub build_seconds: f64,
    pub files: Vec<PathBuf>,
}

/// A signal that was not what the golden model says, decoded.
#[derive(Serialize)]
pub struct DecodedDivergence {
    cycle: u64,
    time_ns: u64,
    unit: String,
    signal: String,
    expected: String,
    found: String,
    expected_value: String,
    found_value: String,
    ulps: Option<u64>,
    first_cause: Option<bool>,
}

/// What the summary needs to know of a compared signal.
pub struct SignalFacts {
    pub path: String,
    pub width: u32,
    pub meaning: Meaning,
    pub sources: Vec<(String, u32)>,
}

/// Decodes the divergences of the first divergent cycle, first causes first. A signal is a first
/// cause if all its sources agreed: those of earlier cycles did, since nothing differed there.
/// Before cycle 0 the unit stood idle in reset, as it still does in cycle 0.
fn decode(comparison: &Comparison, signals: &[SignalFacts]) -> Vec<DecodedDivergence> {
    let path = |unit: &str, signal: &str| format!("{unit}.{signal}");
    let differs: Vec<String> = comparison
        .first
        .iter()
        .map(|one| path(&one.unit, &one.signal))
        .collect();
    let mut decoded: Vec<DecodedDivergence> = comparison
        .first
        .iter()
        .map(|one| {
            let own = path(&one.unit, &one.signal);
            let facts = signals.iter().find(|facts| facts.path == own);
            let (meaning, width) =
                facts.map_or((Meaning::Bits, 64), |facts| (facts.meaning, facts.width));
            let digits = width.div_ceil(4) as usize;
            let first_cause = facts
                .filter(|facts| !facts.sources.is_empty())
                .map(|facts| {
                    facts.sources.iter().all(|(source, cycles)| {
                        let earlier = *cycles > 0 && one.cycle >= u64::from(*cycles);
                        earlier || !differs.contains(source)
                    })
                });
            DecodedDivergence {
                cycle: one.cycle,
                time_ns: one.cycle * 10,
                unit: one.unit.clone(),
                signal: one.signal.clone(),
                expected: format!("{:0digits$x}", one.expected),
                found: format!("{:0digits$x}", one.found),
                expected_value: decoded_value(meaning, width, one.expected),
                found_value: decoded_value(meaning, width, one.found),
                ulps: units_in_the_last_place(meaning, one.expected, one.found),
                first_cause,
            }
        })
        .collect();
    decoded.sort_by_key(|one| one.first_cause != Some(true));
    decoded
}

/// Divergent signals shown to people.
const SHOWN: usize = 8;

impl Summary {
    /// The summary of a run.
    pub fn new(arguments: &Arguments, run: Finished<'_>) -> Summary {
        let comparison = run.comparison;
        let planted = arguments.plant_fault.as_ref();
        Summary {
            schema: "stepwell-verify-1",
            unit: run.unit.name.clone(),
            simulator: run.simulator.name().to_owned(),
            simulator_version: run.simulator.version().to_owned(),
            format: run.format,
            method: run.method,
            map: run.map,
            rays: comparison.rays,
            rays_sent: run.sent,
            exhaustive: run.exhaustive,
            guards: comparison.guards,
            mismatches: comparison.mismatches,
            cycles: comparison.cycles,
            cycles_compared: comparison.cycles_compared,
            signals_compared: comparison.signals_compared,
            seconds: run.seconds,
            build_seconds: run.build_seconds,
            netlist_digest: netlist_digest(run.unit),
            core_digest: core_digest(run.unit),
            planted_fault: planted.map(|fault| format!("{}:{}", fault.signal, fault.bit)),
            seed: arguments.seed,
            first_divergence: decode(&comparison, &run.signals),
            files: run.files,
            machine: None,
        }
    }

    /// With what the golden machine's run came to.
    pub fn of_machine(mut self, report: MachineReport) -> Summary {
        self.machine = Some(report);
        self
    }

    /// Tells person or program, and says how it came out.
    pub fn answer(&self, as_json: bool) -> anyhow::Result<Outcome> {
        let compared = self.cycles_compared > 0 && self.signals_compared > 0;
        // A fault may keep every result from leaving: that is a difference, not an empty run.
        if !compared || (self.rays == 0 && self.mismatches == 0) {
            anyhow::bail!(
                "nothing was compared ({} of {} results left the unit in {} cycles): this run \
                 proves nothing",
                self.rays,
                self.rays_sent,
                self.cycles
            );
        }
        let text = if as_json { json(self)? } else { self.text() };
        terminal::answer(|output| output.write_all(text.as_bytes()))?;
        if self.guards > 0 {
            terminal::complain(&format!("{} walks ended at the step bound", self.guards));
        }
        let complete = self.rays == self.rays_sent;
        Ok(match self.mismatches == 0 && self.guards == 0 && complete {
            true => Outcome::Agreed,
            false => Outcome::Disagreed,
        })
    }

    fn text(&self) -> String {
        let tried = if self.exhaustive {
            ", every one there is"
        } else {
            ""
        };
        let mut rows = vec![("unit", self.unit.clone())];
        if let Some(map) = &self.map {
            rows.push(("map", map.clone()));
        }
        rows.extend([
            ("format", self.format.clone()),
            (
                "simulator",
                format!("{} {}", self.simulator, self.simulator_version),
            ),
            (
                "results",
                format!("{} of {} sent{tried}", self.rays, self.rays_sent),
            ),
            (
                "compared",
                format!(
                    "{} signals in each of {} cycles",
                    self.signals_compared, self.cycles_compared
                ),
            ),
            ("mismatches", self.mismatches.to_string()),
            ("guards", self.guards.to_string()),
            (
                "netlist",
                netlist_row(&self.netlist_digest, self.core_digest.as_deref()),
            ),
            (
                "time",
                format!(
                    "{:.2} s to build, {:.2} s to run, {:.2} million cycles/s",
                    self.build_seconds,
                    self.seconds,
                    self.cycles as f64 / self.seconds.max(1e-9) / 1e6
                ),
            ),
        ]);
        rows.extend(self.machine.iter().flat_map(MachineReport::rows));
        if let Some(fault) = &self.planted_fault {
            rows.push(("planted", fault.clone()));
        }
        for file in &self.files {
            rows.push(("written", file.display().to_string()));
        }
        let mut text = table(&rows);
        if let Some(first) = self.first_divergence.first() {
            text.push_str(&format!(
                "\nfirst divergence in cycle {} ({} ns):\n",
                first.cycle, first.time_ns
            ));
        }
        for one in self.first_divergence.iter().take(SHOWN) {
            let distance = one
                .ulps
                .map_or(String::new(), |ulps| format!(", {ulps} ulp apart"));
            let cause = match one.first_cause {
                Some(true) => ", its inputs agreed: a first cause",
                Some(false) => ", its inputs differ too",
                None => "",
            };
            text.push_str(&format!(
                "  {}.{}: must be {} ({}), is {} ({}){distance}{cause}\n",
                one.unit, one.signal, one.expected, one.expected_value, one.found, one.found_value
            ));
        }
        if self.first_divergence.len() > SHOWN {
            let more = self.first_divergence.len() - SHOWN;
            text.push_str(&format!("  and {more} more signals in the same cycle\n"));
        }
        text
    }
}
