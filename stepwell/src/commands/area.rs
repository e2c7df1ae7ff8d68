//! `stepwell area`: what units take of a chip, and how fast they are.

mod report;
mod table;

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use clap::Args;

use hdl_gen::area::{Flow, Tools, measure};
use hdl_gen::digest::netlist_digest;
use hdl_gen::operators::stream_unit;

use self::report::{Report, UnitFigures};
use super::Outcome;
use crate::operator_options::{ChosenOperator, OperatorOptions};
use crate::options::{AnswerOptions, NumberFormat};
use crate::output::{OutputFile, OutputFolder};
use crate::progress;
use crate::terminal;

/// Area and speed of operators, by synthesis, placement and routing
///
/// Measures the very netlists that verify compares with the golden model: the digests are the
/// same. On a Lattice ECP5 (Yosys, then nextpnr-ecp5 with some seeds; speed grade 6) the operator
/// stands between two layers of registers on each side, which are not counted; the LUT4 figure is
/// nextpnr's, with two look-up tables for each carry cell. On a Xilinx 7 series device Yosys counts
/// LUT6; in standard cells abc gives area (kGE: thousands of two-input NAND gates) and delay.
/// `make tools` installs all of it, at pinned versions. What was measured before, with the same
/// tools, comes from a cache.
#[derive(Args, Debug)]
#[command(after_help = "Examples: stepwell area --unit float_add\n          \
                  stepwell area --unit float_mul,float_cmp --format e5f10 --latency 1 --seeds 1\n          \
                  stepwell area --unit float_add --policy full --flags --latency 1 --wide-luts")]
pub struct Arguments {
    /// An operator (float_add, ...), or several: repeat the option, or put commas between
    #[arg(
        long,
        value_name = "UNIT",
        value_delimiter = ',',
        required_unless_present = "table"
    )]
    unit: Vec<String>,

    /// Number format: eXfY with X exponent and Y fraction bits, e7f16 unless told; of a fixed-point
    /// operator qI.F or uqI.F
    #[arg(long, value_name = "FORMAT")]
    format: Option<NumberFormat>,

    #[command(flatten)]
    operator: OperatorOptions,

    /// Placements on the ECP5, with seeds 1 to N: the clock is their median
    #[arg(long, value_name = "N", default_value_t = Flow::DEFAULT.seeds,
        value_parser = clap::value_parser!(u32).range(1..=99))]
    seeds: u32,

    /// Without Yosys's -nowidelut: functions of five to seven inputs out of LUT4 and multiplexers
    #[arg(long)]
    wide_luts: bool,

    /// Measure every operator for which there is a target, and write the table of ours beside the
    /// rivals, Markdown, into this file; takes a quarter of an hour
    #[arg(long, value_name = "FILE", conflicts_with_all = ["unit", "format", "wide_luts",
        "rounding", "policy", "flags",
        "latency", "multiplier", "radix", "result_format", "b_format", "overflow"])]
    table: Option<PathBuf>,

    /// Folder for area.csv and area.json, made if missing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// Measures the units.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let start = Instant::now();
    let flow = Flow {
        seeds: arguments.seeds,
        wide_luts: arguments.wide_luts,
        no_dsp: false,
    };
    let subjects: Vec<(ChosenOperator, Flow)> = match arguments.table {
        Some(_) => table::subjects(flow)?,
        None => {
            let units = arguments.unit.iter();
            let chosen = units.map(|unit| {
                if unit.starts_with("traverse") {
                    bail!("--unit {unit}: area is measured of operators, such as float_add");
                }
                Ok((arguments.operator.choose(unit, arguments.format)?, flow))
            });
            chosen.collect::<anyhow::Result<_>>()?
        }
    };
    if subjects.is_empty() {
        bail!("--unit names no operator: nothing would be measured");
    }
    let folder = arguments.output.as_deref().map(OutputFolder::prepare);
    let folder = folder.transpose()?;
    let table_file = arguments.table.as_deref().map(OutputFile::prepare);
    let table_file = table_file.transpose()?;
    let tools = Tools::find()?;

    let steps = subjects.iter().map(|(_, flow)| flow.steps()).sum();
    let bar = progress::bar(steps, "steps");
    let mut units = Vec::new();
    for (chosen, flow) in &subjects {
        let core = chosen.configuration.build(chosen.latency);
        let figures = measure(&core, *flow, &tools, &|| bar.inc(1))
            .with_context(|| core.name.clone())
            .inspect_err(|_| bar.finish_and_clear())?;
        let unit_digest = netlist_digest(&stream_unit(&core));
        let digests = (unit_digest, netlist_digest(&core));
        units.push(UnitFigures::new(
            chosen,
            *flow,
            digests,
            figures,
            &tools.versions,
        ));
    }
    bar.finish_and_clear();
    let report = Report::new(units, start.elapsed());

    if let Some(folder) = folder {
        folder.publish(|folder| report.write(folder))?;
    }
    if let Some(file) = table_file {
        let text = table::markdown(&report, flow.seeds, &tools.versions)?;
        file.publish(|out| out.write_all(text.as_bytes()))?;
    }
    let text = if arguments.answer.json {
        report.json()?
    } else {
        report.text()
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(Outcome::Agreed)
}
