//! `stepwell area`: what units take of a chip, and how fast they are.

mod machine;
mod report;
mod subject;
mod table;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use clap::Args;

use hdl_gen::area::{Flow, Tools, measure};
use hdl_gen::digest::netlist_digest;
use rtl_model::scene::{Crossing, Method};

use self::machine::MeasuredMachine;
use self::report::{Report, UnitFigures};
use self::subject::Subject;
use super::Outcome;
use crate::machine::machine_of;
use crate::operator_options::OperatorOptions;
use crate::options::{AnswerOptions, Latencies, MapOptions, NumberFormat, Replacements, Size};
use crate::output::{OutputFile, OutputFolder};
use crate::progress;
use crate::terminal;

/// Area and speed of a scene's machine, of operators and of traversals' steps, by synthesis, placement and routing
///
/// Measures the very netlists that verify compares with the golden model: the digests are the
/// same. On a Lattice ECP5 (Yosys, then nextpnr-ecp5 with some seeds; speed grade 6) the module
/// stands between two layers of registers on each side, which are not counted; the LUT4 figure is
/// nextpnr's, with two look-up tables for each carry cell. On a Xilinx 7 series device Yosys counts
/// LUT6; in standard cells abc gives area (kGE: thousands of two-input NAND gates) and delay.
/// `make tools` installs all of it, at pinned versions. What was measured before, with the same
/// tools, comes from a cache.
#[derive(Args, Debug)]
#[command(after_help = "Examples: stepwell area --unit float_add\n          \
                  stepwell area --unit float_mul,float_cmp --format e5f10 --latency 1 --seeds 1\n          \
                  stepwell area --unit float_add --policy full --flags --latency 1 --wide-luts\n          \
                  stepwell area --unit traverse_step --method oh,block --format fixed --seeds 1\n          \
                  stepwell area scenes/machine-paper.toml --no-dsp --seeds 1")]
pub struct Arguments {
    /// Scene file (TOML) with a table [machine]: every unit of the machine is measured, and all of
    /// it, and its golden model runs the frame to tell cycles and so pixels a second
    #[arg(value_name = "SCENE", conflicts_with_all = ["unit", "table"])]
    scene: Option<PathBuf>,

    /// An operator (float_add, ...) or traverse_step, or several: repeat the option, or put commas
    /// between
    #[arg(long, value_name = "UNIT", value_delimiter = ',')]
    unit: Vec<String>,

    /// Number format: eXfY with X exponent and Y fraction bits, e7f16 unless told; of a fixed-point
    /// operator qI.F or uqI.F
    #[arg(long, value_name = "FORMAT")]
    format: Option<NumberFormat>,

    /// Of traverse_step: the traversal, oh unless told, or several, such as oh,block
    #[arg(long, value_name = "METHOD", value_delimiter = ',', requires = "unit")]
    method: Vec<Method>,

    /// Of traverse_step: the way borders are crossed, index (unless told) or offset:X
    #[arg(long, value_name = "CROSSING", requires = "unit")]
    crossing: Option<Crossing>,

    #[command(flatten)]
    map: MapOptions,

    #[command(flatten)]
    operator: OperatorOptions,

    /// Placements on the ECP5, with seeds 1 to N: the clock is their median. Of a scene's machine
    /// all of it is placed with so many, its units with one each
    #[arg(long, value_name = "N", default_value_t = Flow::DEFAULT.seeds,
        value_parser = clap::value_parser!(u32).range(1..=99))]
    seeds: u32,

    /// Multiply in look-up tables alone, on both devices: no hard multiplier
    #[arg(long, conflicts_with = "table")]
    no_dsp: bool,

    /// Replace the cycles of the operators of a scene's machine of kind paper: adder, multiplier,
    /// divider, comparator and conversion, such as 2,1,2,1,1, which are the paper's
    #[arg(long, value_name = "CYCLES", requires = "scene")]
    latencies: Option<Latencies>,

    /// Replace the scene's frame, in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", requires = "scene")]
    size: Option<Size>,

    /// Without Yosys's -nowidelut: functions of five to seven inputs out of LUT4 and multiplexers
    #[arg(long)]
    wide_luts: bool,

    /// Measure every operator for which there is a target, and write the table of ours beside the
    /// rivals, Markdown, into this file; takes a quarter of an hour
    #[arg(long, value_name = "FILE", conflicts_with_all = ["unit", "format", "wide_luts",
        "rounding", "policy", "flags",
        "latency", "multiplier", "radix", "result_format", "b_format", "overflow", "map", "method"])]
    table: Option<PathBuf>,

    /// The most minutes that one run of a tool may take: of a whole machine, placement takes most
    #[arg(long, value_name = "MINUTES", default_value_t = 60,
        value_parser = clap::value_parser!(u32).range(1..=10_000))]
    time_limit: u32,

    /// Folder for area.csv and area.json, made if missing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// The name of the unit that is a traversal's step.
const STEP: &str = "traverse_step";

impl Arguments {
    /// The scene's machine, with its golden run, which takes a while: it is not done for nothing,
    /// where the tools are missing.
    fn machine(&self, has_tools: bool) -> anyhow::Result<Option<MeasuredMachine>> {
        let Some(path) = &self.scene else {
            return Ok(None);
        };
        self.operator.none_for("a scene")?;
        let replacements = Replacements {
            map: self.map.clone(),
            format: self.format,
            method: None,
            crossing: None,
            camera: None,
            size: self.size,
            latencies: self.latencies,
        };
        let scene = replacements.load(path)?;
        machine_of(&scene)?;
        if !has_tools {
            return Ok(None);
        }
        MeasuredMachine::of(&scene).map(Some)
    }

    /// The operators and steps that are asked for. Nothing that a person says is ignored.
    fn subjects(&self) -> anyhow::Result<Vec<Subject>> {
        let has_step = self.unit.iter().any(|unit| unit == STEP);
        if has_step {
            self.operator.none_for(STEP)?;
        } else {
            for (option, is_given) in [
                ("--method", !self.method.is_empty()),
                ("--crossing", self.crossing.is_some()),
                ("--map", self.map.map.is_some()),
            ] {
                if is_given {
                    bail!("{option} is of steps: name one with --unit {STEP}, or leave it out");
                }
            }
        }
        let mut subjects = Vec::new();
        for unit in &self.unit {
            match unit.as_str() {
                STEP => subjects.extend(Subject::steps(
                    &self.method,
                    self.format,
                    self.crossing,
                    &self.map,
                )?),
                "traverse" => bail!(
                    "--unit traverse: area is measured of operators, such as float_add, and of \
                     traverse_step, the step without its loop"
                ),
                name => {
                    let chosen = self.operator.choose(name, self.format)?;
                    subjects.push(Subject::Operator(chosen));
                }
            }
        }
        Ok(subjects)
    }
}

/// Measures the units.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let start = Instant::now();
    let flow = Flow {
        seeds: arguments.seeds,
        wide_luts: arguments.wide_luts,
        no_dsp: arguments.no_dsp,
    };
    let Arguments {
        unit, table, scene, ..
    } = &arguments;
    if unit.is_empty() && table.is_none() && scene.is_none() {
        bail!(
            "nothing to measure: name a SCENE with a table [machine], such as \
             scenes/machine-paper.toml, or operators and steps with --unit, such as --unit \
             float_add"
        );
    }
    let limit = Duration::from_secs(60 * u64::from(arguments.time_limit));
    let tools = Tools::find().map(|tools| tools.with_time_limit(limit));
    let machine = arguments.machine(tools.is_ok())?;
    let of_flow = |subjects: Vec<Subject>| subjects.into_iter().map(|one| (one, flow)).collect();
    let subjects: Vec<(Subject, Flow)> = match (&arguments.table, &machine) {
        (Some(_), _) => table::subjects(flow)?,
        (None, Some(machine)) => machine.subjects(flow),
        (None, None) => of_flow(arguments.subjects()?),
    };
    if subjects.is_empty() && arguments.scene.is_none() {
        bail!("--unit names nothing: nothing would be measured");
    }
    let folder = arguments.output.as_deref().map(OutputFolder::prepare);
    let folder = folder.transpose()?;
    let table_file = arguments.table.as_deref().map(OutputFile::prepare);
    let table_file = table_file.transpose()?;
    let tools = tools?;

    let steps = subjects.iter().map(|(_, flow)| flow.steps()).sum();
    let bar = progress::bar(steps, "steps");
    let mut units = Vec::new();
    for (subject, flow) in &subjects {
        let core = subject.core();
        bar.set_message(core.name.clone());
        let figures = measure(&core, *flow, &tools, &|| bar.inc(1))
            .with_context(|| core.name.clone())
            .inspect_err(|_| bar.finish_and_clear())?;
        let unit_digest = netlist_digest(&subject.unit(&core));
        let digests = (unit_digest, netlist_digest(&core));
        units.push(UnitFigures::new(
            subject,
            &core,
            *flow,
            digests,
            figures,
            &tools.versions,
        ));
    }
    bar.finish_and_clear();
    let mut report = Report::new(units, start.elapsed());
    report.machine = machine
        .as_ref()
        .and_then(|machine| machine.figures(&report.units));

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
    Ok(match machine.is_none_or(|machine| machine.agrees()) {
        true => Outcome::Agreed,
        false => Outcome::Disagreed,
    })
}
