//! What was measured, for people, for programs and for spreadsheets.

use std::fs;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use hdl_gen::area::{Figures, Flow, Versions};
use hdl_gen::netlist::Module;
use hdl_gen::operators::{AnyOperator, FixedOperator, Multiplier, Radix};

use super::machine::MachineFigures;
use super::subject::Subject;
use crate::summary::json;

/// The JSON of a measurement.
#[derive(Serialize)]
pub struct Report {
    schema: &'static str,
    pub units: Vec<UnitFigures>,
    /// Of a scene, what its machine reaches.
    #[serde(flatten)]
    pub machine: Option<MachineFigures>,
    seconds: f64,
}

/// A unit, how it was built, and what it takes.
#[derive(Clone, Serialize)]
pub struct UnitFigures {
    pub unit: String,
    pub module: String,
    /// Of a step, its traversal.
    pub method: Option<String>,
    /// Of a step, how it crosses borders.
    pub crossing: Option<String>,
    /// Of a step, the map it is built for.
    pub map: Option<String>,
    pub format: String,
    pub rounding: Option<&'static str>,
    pub policy: Option<&'static str>,
    pub flags: bool,
    pub multiplier: Option<&'static str>,
    pub radix: Option<&'static str>,
    pub latency: u32,
    /// Look-up tables taken, those of carry cells included.
    pub lut4: u64,
    pub lut4_taken: u64,
    /// Of `lut4` the ones of distributed memory.
    pub lut4_memory: u64,
    pub ff: u64,
    pub carry: u64,
    pub dsp: u64,
    pub bram: u64,
    pub fmax_mhz: f64,
    pub fmax_mhz_of_seeds: Vec<f64>,
    pub wide_luts: bool,
    pub no_dsp: bool,
    pub lut6: u64,
    pub xilinx_carry: u64,
    pub xilinx_dsp: u64,
    pub kge: f64,
    pub um2: f64,
    pub cells: u64,
    pub delay_ns: f64,
    /// Memories of more than 64 words, which `kge` and `um2` do not count.
    pub memories_apart: u64,
    /// Of the operator or step behind its handshakes, as `verify` gives it.
    pub netlist_digest: String,
    /// Of the operator or step itself, which was measured; `verify` gives it too.
    pub core_digest: String,
    pub tools: Versions,
    #[serde(skip)]
    is_of_machine: bool,
}

/// How a unit is built, as far as there are the same words for all kinds.
#[derive(Default)]
struct Build {
    unit: String,
    module: String,
    method: Option<String>,
    crossing: Option<String>,
    map: Option<String>,
    format: String,
    flags: bool,
    latency: u32,
    rounding: Option<&'static str>,
    policy: Option<&'static str>,
    multiplier: Option<&'static str>,
    radix: Option<&'static str>,
}

impl Build {
    fn of(subject: &Subject, core: &Module) -> Build {
        let build = match subject {
            Subject::Operator(chosen) => Build {
                flags: chosen.configuration.has_flags(),
                ..Build::of_operator(chosen.configuration)
            },
            Subject::Step(step) => Build {
                unit: "traverse_step".to_owned(),
                method: Some(step.walk.method.to_string()),
                crossing: Some(step.walk.crossing.to_string()),
                map: Some(step.map.clone()),
                format: step.walk.format.to_string(),
                ..Build::default()
            },
            Subject::Unit(unit) => Build {
                unit: unit.name.clone(),
                format: unit.format.clone(),
                ..Build::default()
            },
        };
        Build {
            module: core.name.clone(),
            latency: core.latency,
            ..build
        }
    }

    fn of_operator(operator: AnyOperator) -> Build {
        match operator {
            AnyOperator::Float(configuration) => Build {
                unit: configuration.operator.name().to_owned(),
                format: configuration.format.to_string(),
                rounding: configuration
                    .operator
                    .rounds()
                    .then(|| configuration.rounding.name()),
                policy: Some(configuration.policy.name()),
                multiplier: Some(match configuration.structure.multiplier {
                    Multiplier::Dsp => "dsp",
                    Multiplier::Logic => "logic",
                }),
                radix: Some(match configuration.structure.radix {
                    Radix::Two => "2",
                    Radix::Four => "4",
                    Radix::Mixed => "mixed",
                }),
                ..Build::default()
            },
            AnyOperator::Fixed(configuration) => {
                let (format, policy) = match configuration.operator {
                    FixedOperator::FromFloat { source, policy } => {
                        (source.to_string(), Some(policy.name()))
                    }
                    FixedOperator::ToFloat { policy, .. } => {
                        (configuration.a.to_string(), Some(policy.name()))
                    }
                    _ => (configuration.a.to_string(), None),
                };
                let has_rounding = configuration.operator.rounds();
                Build {
                    unit: configuration.operator.name().to_owned(),
                    format,
                    rounding: has_rounding.then(|| configuration.rounding.name()),
                    policy,
                    ..Build::default()
                }
            }
        }
    }
}

impl UnitFigures {
    /// What was measured of `core`; the digests are of the unit and of its core.
    pub fn new(
        subject: &Subject,
        core: &Module,
        flow: Flow,
        (netlist_digest, core_digest): (String, String),
        figures: Figures,
        tools: &Versions,
    ) -> UnitFigures {
        let Figures {
            ecp5,
            xilinx,
            gates,
        } = figures;
        let build = Build::of(subject, core);
        UnitFigures {
            unit: build.unit,
            module: build.module,
            method: build.method,
            crossing: build.crossing,
            map: build.map,
            format: build.format,
            rounding: build.rounding,
            policy: build.policy,
            flags: build.flags,
            multiplier: build.multiplier,
            radix: build.radix,
            latency: build.latency,
            lut4: ecp5.lut4,
            lut4_taken: ecp5.lut4_taken,
            lut4_memory: ecp5.lut4_memory,
            ff: ecp5.ff,
            carry: ecp5.carry,
            dsp: ecp5.dsp,
            bram: ecp5.bram,
            fmax_mhz: ecp5.fmax_mhz,
            fmax_mhz_of_seeds: ecp5.fmax_mhz_of_seeds,
            wide_luts: flow.wide_luts,
            no_dsp: flow.no_dsp,
            lut6: xilinx.lut6,
            xilinx_carry: xilinx.carry,
            xilinx_dsp: xilinx.dsp,
            kge: gates.kge,
            um2: gates.um2,
            cells: gates.cells,
            delay_ns: gates.delay_ns,
            memories_apart: gates.memories_apart,
            netlist_digest,
            core_digest,
            tools: tools.clone(),
            is_of_machine: matches!(subject, Subject::Unit(_)),
        }
    }

    /// The columns of the table and of the CSV file: a title, what is short for people, and the
    /// value.
    fn columns(&self) -> [(&'static str, &'static str, String); 32] {
        let of_step = |text: &Option<String>| text.clone().unwrap_or_default();
        // Operators alone have no use for the column.
        let method_title = if self.method.is_some() { "method" } else { "" };
        let is_machine = self.is_of_machine;
        let (unit_title, module_title) = if is_machine {
            ("unit", "")
        } else {
            ("", "unit")
        };
        let of_machine = |title: &'static str| if is_machine { title } else { "" };
        let seeds: Vec<String> = self.fmax_mhz_of_seeds.iter().map(f64::to_string).collect();
        [
            ("unit", unit_title, self.unit.clone()),
            ("module", module_title, self.module.clone()),
            ("method", method_title, of_step(&self.method)),
            ("crossing", "", of_step(&self.crossing)),
            ("map", "", of_step(&self.map)),
            ("format", "", self.format.clone()),
            ("rounding", "", self.rounding.unwrap_or_default().to_owned()),
            ("policy", "", self.policy.unwrap_or_default().to_owned()),
            ("flags", "", self.flags.to_string()),
            ("latency", "cycles", self.latency.to_string()),
            ("lut4", "LUT4", self.lut4.to_string()),
            ("lut4_taken", "taken", self.lut4_taken.to_string()),
            (
                "lut4_memory",
                of_machine("memory"),
                self.lut4_memory.to_string(),
            ),
            ("ff", "FF", self.ff.to_string()),
            ("carry", "carry", self.carry.to_string()),
            ("dsp", "DSP", self.dsp.to_string()),
            ("bram", of_machine("BRAM"), self.bram.to_string()),
            ("fmax_mhz", "MHz", self.fmax_mhz.to_string()),
            ("fmax_mhz_of_seeds", "", seeds.join(" ")),
            ("wide_luts", "", self.wide_luts.to_string()),
            ("no_dsp", "", self.no_dsp.to_string()),
            ("lut6", "LUT6", self.lut6.to_string()),
            ("xilinx_dsp", "", self.xilinx_dsp.to_string()),
            ("kge", "kGE", self.kge.to_string()),
            ("um2", "um2", self.um2.to_string()),
            ("delay_ns", "ns", self.delay_ns.to_string()),
            ("netlist_digest", "netlist", self.netlist_digest.clone()),
            (
                "memories_apart",
                of_machine("apart"),
                self.memories_apart.to_string(),
            ),
            (
                "core_digest",
                if is_machine { "" } else { "without handshakes" },
                self.core_digest.clone(),
            ),
            ("yosys", "", self.tools.yosys.clone()),
            ("nextpnr", "", self.tools.nextpnr.clone()),
            ("cells", "", self.tools.cells.clone()),
        ]
    }
}

impl Report {
    pub fn new(units: Vec<UnitFigures>, time: Duration) -> Report {
        Report {
            schema: "stepwell-area-1",
            units,
            machine: None,
            seconds: time.as_secs_f64(),
        }
    }

    pub fn json(&self) -> anyhow::Result<String> {
        json(self)
    }

    /// Writes `area.json` and `area.csv`.
    pub fn write(&self, folder: &Path) -> anyhow::Result<()> {
        fs::write(folder.join("area.json"), self.json()?)?;
        fs::write(folder.join("area.csv"), self.csv())?;
        Ok(())
    }

    fn csv(&self) -> String {
        let mut lines = Vec::new();
        for unit in &self.units {
            let columns = unit.columns();
            if lines.is_empty() {
                lines.push(
                    columns
                        .each_ref()
                        .map(|column| column.0.to_owned())
                        .join(","),
                );
            }
            lines.push(columns.map(|(_, _, value)| value).join(","));
        }
        lines.join("\n") + "\n"
    }

    /// A line a unit, under titles.
    pub fn text(&self) -> String {
        let mut rows: Vec<Vec<String>> = Vec::new();
        for unit in &self.units {
            let shown = unit
                .columns()
                .into_iter()
                .filter(|column| !column.1.is_empty());
            let (titles, values): (Vec<_>, Vec<_>) = shown
                .map(|(_, title, value)| (title.to_owned(), value))
                .unzip();
            if rows.is_empty() {
                rows.push(titles);
            }
            rows.push(values);
        }
        let mut text = aligned(&rows);
        if let Some(machine) = &self.machine {
            text += &machine.text();
        }
        if let Some(unit) = self.units.first() {
            let tools = &unit.tools;
            let (yosys, nextpnr, cells) = (&tools.yosys, &tools.nextpnr, &tools.cells);
            text += &format!("{yosys}, {nextpnr}, cells of {cells}\n");
        }
        text
    }
}

/// Columns, numbers to the right.
fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].len());
        cells.max().unwrap_or_default()
    };
    let numeric = |column: usize| {
        let mut values = rows.iter().skip(1).map(|row| &row[column]);
        values.all(|value| value.parse::<f64>().is_ok() && value.len() < 16)
    };
    let mut text = String::new();
    for row in rows {
        let cells: Vec<String> = (0..columns)
            .map(|column| match (numeric(column), width(column)) {
                (true, width) => format!("{:>width$}", row[column]),
                (false, width) => format!("{:width$}", row[column]),
            })
            .collect();
        text += cells.join("  ").trim_end();
        text.push('\n');
    }
    text
}
