//! `docs/operators.md`: our operators beside the targets and the rivals, from `docs/operators.toml`.

use std::fmt::Write as _;

use anyhow::Context;
use serde::Deserialize;

use hdl_gen::area::{Flow, Versions};
use hdl_gen::operators::{Multiplier, OperatorConfiguration, Radix, Structure};
use rtl_model::float::{FloatFormat, Policy, Rounding};

use super::report::{Report, UnitFigures};
use super::subject::Subject;
use crate::operator_options::ChosenOperator;
use crate::units::named_operator;

const ROWS: &str = include_str!("../../../../docs/operators.toml");

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    row: Vec<Row>,
    library: Vec<Library>,
}

/// An operator that is measured, and what it is measured against.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    unit: String,
    latency: u32,
    #[serde(default)]
    policy: PolicyName,
    #[serde(default)]
    flags: bool,
    #[serde(default)]
    multiplier: MultiplierName,
    #[serde(default)]
    radix: RadixName,
    #[serde(default)]
    wide_luts: bool,
    #[serde(default)]
    target: Target,
    #[serde(default)]
    rivals: Vec<Rival>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum PolicyName {
    #[default]
    Flush,
    Full,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum MultiplierName {
    #[default]
    Dsp,
    Logic,
}

#[derive(Clone, Copy, Default, Deserialize)]
enum RadixName {
    #[default]
    #[serde(rename = "2")]
    Two,
    #[serde(rename = "4")]
    Four,
    #[serde(rename = "mixed")]
    Mixed,
}

/// At most so many look-up tables and multipliers, at least so many MHz.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Target {
    lut4: Option<u64>,
    dsp: Option<u64>,
    mhz: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rival {
    name: String,
    lut4: Option<u64>,
    mhz: Option<f64>,
}

/// A library of operators, and what it supports.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Library {
    name: String,
    language: String,
    formats: String,
    rounding: String,
    subnormals: String,
    flags: String,
    latency: String,
    source: String,
}

fn table() -> anyhow::Result<Table> {
    toml::from_str(ROWS).context("docs/operators.toml")
}

impl Row {
    fn chosen(&self) -> anyhow::Result<ChosenOperator> {
        let operator = named_operator(&self.unit)?;
        let configuration = OperatorConfiguration {
            policy: match self.policy {
                PolicyName::Flush => Policy::Flush,
                PolicyName::Full => Policy::Full,
            },
            has_flags: self.flags,
            structure: Structure {
                multiplier: match self.multiplier {
                    MultiplierName::Dsp => Multiplier::Dsp,
                    MultiplierName::Logic => Multiplier::Logic,
                },
                radix: match self.radix {
                    RadixName::Two => Radix::Two,
                    RadixName::Four => Radix::Four,
                    RadixName::Mixed => Radix::Mixed,
                },
            },
            ..OperatorConfiguration::new(operator, FloatFormat::E7F16, Rounding::NearestEven)
        };
        configuration.check()?;
        Ok(ChosenOperator {
            configuration: configuration.into(),
            latency: self.latency,
        })
    }
}

/// What the table measures, in its order.
pub fn subjects(flow: Flow) -> anyhow::Result<Vec<(Subject, Flow)>> {
    let rows = table()?.row;
    let subjects = rows.iter().map(|row| {
        let wide_luts = row.wide_luts;
        Ok((Subject::Operator(row.chosen()?), Flow { wide_luts, ..flow }))
    });
    subjects.collect()
}

/// The document, of the figures of all [`subjects`] in their order.
pub fn markdown(report: &Report, seeds: u32, versions: &Versions) -> anyhow::Result<String> {
    let table = table()?;
    let Versions {
        yosys,
        nextpnr,
        cells,
    } = versions;
    let seeds_option = match seeds == Flow::DEFAULT.seeds {
        true => String::new(),
        false => format!(" --seeds {seeds}"),
    };
    let mut text = format!(
        "# Operators: area and speed\n\n\
         Written by `stepwell area --table docs/operators.md{seeds_option}` (`make operators`) from \
         what it measured and from [operators.toml](operators.toml), which holds the targets and \
         the rivals' figures: change that, not this.\n\n\
         All in e7f16, to nearest even, on Lattice ECP5, speed grade 6: `synth_ecp5 -nowidelut` \
         (\"wide\": without that option), then `nextpnr-ecp5 --85k --speed 6`, the median of {seeds} \
         {}. The operator stands between two layers of registers on each side, so that pads \
         and their place draw on nothing; those registers are not counted. With n cycles there \
         are n stretches of logic from register to register.\n\n\
         LUT4 is what Yosys counts as `LUT4`: look-up tables of logic. The targets seem to count \
         so: a product of two words of 17 bits without a DSP block takes 733 of them here, and the \
         targets of `float_mul` with and without one differ by 735. \"Taken\" is nextpnr's \
         count (`TRELLIS_COMB`), with two for every carry cell, those that lead into and out of \
         carry chains, and one or two that drive constants.\n\n\
         Tools: {yosys}, {nextpnr}, standard cells {cells}. Figures compare only at one version of \
         them.\n\n\
         ## Beside targets and rivals\n\n\
         | operator | cycles | built | LUT4 | taken | DSP | FF | MHz | target | met | rivals |\n\
         |---|--:|---|--:|--:|--:|--:|--:|---|---|---|\n",
        if seeds == 1 { "seed" } else { "seeds" }
    );
    for (row, unit) in table.row.iter().zip(&report.units) {
        let rivals: Vec<String> = row.rivals.iter().map(Rival::text).collect();
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {:.1} | {} | {} | {} |",
            unit.unit,
            unit.latency,
            built(unit),
            unit.lut4,
            unit.lut4_taken,
            unit.dsp,
            unit.ff,
            unit.fmax_mhz,
            row.target.text(),
            row.target.verdict(unit),
            rivals.join("; ")
        )?;
    }
    text += "\n## On other targets\n\n\
             LUT6 is what `synth_xilinx -family xc7` takes; gates are standard cells by abc, before \
             placement, registers included (kGE: thousands of the library's two-input NAND gates), \
             and the delay is of the longest path through logic, without registers and wires. The \
             digests are those that `stepwell verify` prints: of the operator behind its \
             handshakes, and of the operator itself, which was measured.\n\n\
             | module | built | LUT6 | DSP48 | kGE | um2 | ns | unit's netlist | operator's netlist |\n\
             |---|---|--:|--:|--:|--:|--:|---|---|\n";
    for unit in &report.units {
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            unit.module,
            built(unit),
            unit.lut6,
            unit.xilinx_dsp,
            unit.kge,
            unit.um2,
            unit.delay_ns,
            unit.netlist_digest,
            unit.core_digest
        )?;
    }
    text += "\n## What each supports\n\n\
             | library | language | formats | rounding | subnormals | flags | latency |\n\
             |---|---|---|---|---|---|---|\n";
    for library in &table.library {
        let Library {
            name,
            language,
            formats,
            rounding,
            subnormals,
            flags,
            latency,
            source: _,
        } = library;
        writeln!(
            text,
            "| {name} | {language} | {formats} | {rounding} | {subnormals} | {flags} | {latency} |"
        )?;
    }
    text += "\n## Where it is from\n\n";
    for library in &table.library {
        writeln!(text, "- {}: {}", library.name, library.source)?;
    }
    Ok(text)
}

/// How an operator is built, where that is not the default.
fn built(unit: &UnitFigures) -> String {
    let parts = [
        (unit.policy == Some("full"), "full subnormals"),
        (unit.flags, "flags"),
        (unit.multiplier == Some("logic"), "no DSP"),
        (unit.radix == Some("4"), "radix 4"),
        (unit.radix == Some("mixed"), "radix 2 and 4"),
        (unit.wide_luts, "wide"),
    ];
    let parts: Vec<&str> = parts
        .into_iter()
        .filter_map(|(is_so, name)| is_so.then_some(name))
        .collect();
    parts.join(", ")
}

impl Target {
    fn text(self) -> String {
        let parts = [
            self.lut4.map(|lut4| format!("<= {lut4} LUT4")),
            self.dsp.map(|dsp| format!("<= {dsp} DSP")),
            self.mhz.map(|mhz| format!(">= {mhz} MHz")),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        parts.join(", ")
    }

    /// What is met and what is missed, and by how much.
    fn verdict(self, unit: &UnitFigures) -> String {
        if self.text().is_empty() {
            return String::new();
        }
        let missed = [
            self.lut4
                .filter(|lut4| unit.lut4 > *lut4)
                .map(|lut4| format!("LUT4 {:.1} % too many", excess(unit.lut4, lut4))),
            self.dsp
                .filter(|dsp| unit.dsp > *dsp)
                .map(|_| "too many DSP".to_owned()),
            self.mhz
                .filter(|mhz| unit.fmax_mhz < *mhz)
                .map(|mhz| format!("{:.1} % too slow", (1.0 - unit.fmax_mhz / mhz) * 100.0)),
        ];
        let missed: Vec<String> = missed.into_iter().flatten().collect();
        match missed.is_empty() {
            true => match self.lut4.filter(|lut4| unit.lut4_taken > *lut4) {
                // Said, lest the other reading of the target go unnoticed.
                Some(lut4) => format!("yes; taken {:.1} % more", excess(unit.lut4_taken, lut4)),
                None => "yes".to_owned(),
            },
            false => format!("**no**: {}", missed.join(", ")),
        }
    }
}

/// By how much a count is above its limit, in per cent.
fn excess(count: u64, limit: u64) -> f64 {
    (count as f64 / limit as f64 - 1.0) * 100.0
}

impl Rival {
    fn text(&self) -> String {
        let figures = [
            self.lut4.map(|lut4| format!("{lut4} LUT4")),
            self.mhz.map(|mhz| format!("{mhz} MHz")),
        ];
        let figures: Vec<String> = figures.into_iter().flatten().collect();
        format!("{}: {}", self.name, figures.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hdl_gen::area::{Ecp5, Figures, Gates, Xilinx};
    use std::time::Duration;

    fn versions() -> Versions {
        Versions {
            yosys: "Yosys 1".to_owned(),
            nextpnr: "nextpnr-2".to_owned(),
            cells: "cells3".to_owned(),
        }
    }

    fn figures(lut4: u64, dsp: u64, fmax_mhz: f64) -> Figures {
        Figures {
            ecp5: Ecp5 {
                lut4: lut4 / 2,
                lut4_taken: lut4,
                lut4_memory: 0,
                ff: 24,
                carry: 5,
                dsp,
                bram: 0,
                fmax_mhz,
                fmax_mhz_of_seeds: vec![fmax_mhz],
            },
            xilinx: Xilinx {
                lut6: 300,
                lut6_memory: 0,
                carry: 4,
                dsp,
                bram: 0,
            },
            gates: Gates {
                cells: 1000,
                um2: 24000.0,
                kge: 1.0,
                delay_ns: 5.5,
                memories_apart: 0,
            },
        }
    }

    fn report(figures: &Figures) -> Report {
        let subjects = subjects(Flow::DEFAULT).unwrap();
        let units = subjects.iter().map(|(chosen, flow)| {
            let digests = ("unit".to_owned(), "core".to_owned());
            let core = chosen.core();
            UnitFigures::new(chosen, &core, *flow, digests, figures.clone(), &versions())
        });
        Report::new(units.collect(), Duration::ZERO)
    }

    #[test]
    fn every_row_can_be_built_and_stands_in_the_document() {
        let rows = table().unwrap().row;
        let text = markdown(&report(&figures(1, 0, 1e3)), 3, &versions()).unwrap();
        let lines: Vec<&str> = text
            .lines()
            .filter(|line| line.starts_with("| float_"))
            .collect();
        assert_eq!(lines.len(), 2 * rows.len());
        for row in &rows {
            assert!(
                lines.iter().any(|line| line.contains(&row.unit)),
                "{}",
                row.unit
            );
        }
        for library in table().unwrap().library {
            assert!(text.contains(&format!("- {}: {}", library.name, library.source)));
        }
        assert!(!text.contains("**no**"), "{text}");
    }

    #[test]
    fn a_missed_target_is_said_to_be_missed() {
        let target = Target {
            lut4: Some(100),
            dsp: Some(1),
            mhz: Some(50.0),
        };
        for (figures, verdict) in [
            (figures(100, 1, 50.0), "yes"),
            (figures(101, 1, 50.0), "yes; taken 1.0 % more"),
            (figures(210, 1, 60.0), "**no**: LUT4 5.0 % too many"),
            (figures(100, 2, 50.0), "**no**: too many DSP"),
            (figures(90, 0, 45.0), "**no**: 10.0 % too slow"),
        ] {
            assert_eq!(target.verdict(&report(&figures).units[0]), verdict);
        }
        let none = Target::default();
        assert_eq!(none.verdict(&report(&figures(9999, 9, 1.0)).units[0]), "");
    }
}
