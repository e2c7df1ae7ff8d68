//! `stepwell emit`: Verilog, vectors and testbench for anybody's simulator.

mod machine;

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use hdl_gen::digest::{core_digest, netlist_digest};
use hdl_gen::package::{Package, package_operator, package_scene, package_step};
use hdl_gen::units::UnitConfiguration;
use rtl_model::maps::Pyramid;

use super::Outcome;
use super::verify::unit_map::unit_map;
use super::verify::unit_walk::{unit_rays, unit_walk};
use crate::operator_options::OperatorOptions;
use crate::options::{AnswerOptions, Replacements};
use crate::output::OutputFolder;
use crate::summary::{json, netlist_row, table};
use crate::terminal;

/// Verilog, vectors and a self-checking testbench of a scene or of one unit
///
/// The folder gets rtl/ (plain Verilog-2005, one module a file), testbench/ (vectors as $readmemh
/// files, their manifest.json, the testbench) and a FuseSoC core file. Nothing of it needs Rust or
/// this program. Of a scene with a machine, the testbench has the memory behind its AXI4 port.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: stepwell emit scenes/small.toml -o out/emitted && \
                  cd out/emitted/testbench && iverilog -g2005 -o run ../rtl/*.v *.v && vvp -n run"
)]
pub struct Arguments {
    /// Scene file (TOML)
    #[arg(
        value_name = "SCENE",
        required_unless_present = "unit",
        conflicts_with = "unit"
    )]
    scene: Option<PathBuf>,

    /// One unit instead of a scene: an operator (float_add, ...) or traverse_step
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,

    #[command(flatten)]
    replacements: Replacements,

    #[command(flatten)]
    operator: OperatorOptions,

    /// Of a unit: random operand sets beside the special ones, or random rays to take steps from
    #[arg(long, value_name = "N", default_value_t = 1000, requires = "unit")]
    vectors: u64,

    /// Seed of random operands, and of the pattern of stalls
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Of a scene with a machine: let senders, receivers and the memory stall at random
    #[arg(long, conflicts_with = "unit")]
    stalls: bool,

    /// Folder for all of it, made if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    #[command(flatten)]
    answer: AnswerOptions,
}

#[derive(Serialize)]
struct Summary {
    schema: &'static str,
    unit: String,
    modules: Vec<String>,
    netlist_digest: String,
    core_digest: Option<String>,
    testbench: String,
    vectors: usize,
    folder: PathBuf,
}

/// Emits the scene or the unit.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    if arguments.scene.is_none() {
        arguments.replacements.none_of_machines()?;
    }
    let folder = OutputFolder::prepare(&arguments.output)?;
    let mut package = None;
    folder.publish(|folder| {
        package = Some(match (&arguments.scene, arguments.unit.as_deref()) {
            (Some(scene), _) => {
                arguments.operator.none_for("a scene")?;
                let scene = arguments.replacements.load(scene)?;
                match &scene.machine {
                    Some(machine) => {
                        let stalls = arguments.stalls.then_some(arguments.seed as u16);
                        machine::package(&scene, machine, stalls, folder)?
                    }
                    None => package_scene(&scene, folder)?,
                }
            }
            (None, Some(unit @ "traverse_step")) => {
                arguments.operator.none_for(unit)?;
                step(&arguments, folder)?
            }
            (None, Some(unit)) => operator(&arguments, unit, folder)?,
            (None, None) => anyhow::bail!("a scene file or --unit is needed"),
        });
        Ok(())
    })?;
    let Some(package) = package else {
        anyhow::bail!("nothing was emitted");
    };
    let modules = package.top.hierarchy();
    let summary = Summary {
        schema: "stepwell-emit-1",
        unit: package.top.name.clone(),
        modules: modules.iter().map(|module| module.name.clone()).collect(),
        netlist_digest: netlist_digest(&package.top),
        core_digest: core_digest(&package.top),
        testbench: package.testbench,
        vectors: package.vectors,
        folder: arguments.output,
    };
    let text = if arguments.answer.json {
        json(&summary)?
    } else {
        let folder = &summary.folder;
        table(&[
            ("unit", summary.unit.clone()),
            (
                "netlist",
                netlist_row(&summary.netlist_digest, summary.core_digest.as_deref()),
            ),
            (
                "verilog",
                format!(
                    "{} modules in {}",
                    modules.len(),
                    folder.join("rtl").display()
                ),
            ),
            (
                "vectors",
                format!(
                    "{} in {}",
                    summary.vectors,
                    folder.join("testbench").display()
                ),
            ),
            ("testbench", format!("{}.v, beside them", summary.testbench)),
        ])
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(Outcome::Agreed)
}

fn operator(
    arguments: &Arguments,
    name: &str,
    folder: &std::path::Path,
) -> anyhow::Result<Package> {
    let chosen = arguments
        .operator
        .choose(name, arguments.replacements.format)?;
    Ok(package_operator(
        chosen.configuration,
        chosen.latency,
        arguments.vectors,
        arguments.seed,
        folder,
    )?)
}

fn step(arguments: &Arguments, folder: &std::path::Path) -> anyhow::Result<Package> {
    let map = unit_map(&arguments.replacements.map)?;
    let pyramid = Pyramid::new(&map.source.load(map.channel, map.white_is_low)?);
    let walk = unit_walk(&arguments.replacements)?;
    let configuration = UnitConfiguration::of(walk, &pyramid)?;
    let rays = unit_rays(walk, &pyramid, arguments.vectors, arguments.seed)?;
    Ok(package_step(&configuration, &pyramid, &rays, folder)?)
}
