//! `stepwell verify`: the Verilog against the golden model, outputs and registers, every cycle.

pub mod machine;
mod operator;
mod scene;
mod summary;
pub mod unit_map;
pub mod unit_walk;

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

use hdl_gen::verify::SimulatorChoice;

use super::Outcome;
use crate::operator_options::OperatorOptions;
use crate::options::{AnswerOptions, Replacements};

/// The Verilog against the golden model: every output, every register, every cycle
///
/// Emits the hardware of a scene or of one unit, builds it, runs it beside the golden model and
/// compares as both go. Of a scene: all rays of the frame through the traverse unit, every output
/// and every register the model has, in every cycle. Exit code 0: all agreed, and something was
/// compared; 1: something differed; 2: it could not run.
#[derive(Args, Debug)]
#[command(after_help = "Examples: stepwell verify scenes/first.toml\n          \
                  stepwell verify --unit float_add --format e4f3 --sim embedded\n          \
                  stepwell verify scenes/small.toml --plant-fault step.exit_depth_u_s5:3")]
pub struct Arguments {
    /// Scene file (TOML)
    #[arg(
        value_name = "SCENE",
        required_unless_present = "unit",
        conflicts_with = "unit"
    )]
    scene: Option<PathBuf>,

    /// One unit instead of a scene: an operator (float_add, float_sub, float_mul, float_div,
    /// float_cmp, ...), traverse_step, or traverse with random rays
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,

    #[command(flatten)]
    replacements: Replacements,

    /// Simulator: auto (the fastest that is installed), verilator, icarus, embedded
    #[arg(long, value_name = "SIMULATOR", default_value = "auto")]
    sim: SimulatorChoice,

    #[command(flatten)]
    operator: OperatorOptions,

    /// Of a unit: operand sets or random rays to send; small formats are tried on every operand pair
    #[arg(long, value_name = "N", requires = "unit", value_parser = clap::value_parser!(u64).range(1..))]
    vectors: Option<u64>,

    /// Seed of random operands and of the pattern of stalls
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Of a scene with a machine: let senders, receivers and the memory stall at random
    #[arg(long, conflicts_with = "unit")]
    stalls: bool,

    /// Write the waveforms of these cycles, golden.vcd and hardware.vcd, into the output folder
    #[arg(
        long,
        value_name = "FIRST:LAST",
        requires = "output",
        conflicts_with = "unit"
    )]
    vcd: Option<Window>,

    /// Folder for the emitted Verilog and the waveforms, made if missing; nothing is kept unless
    /// told
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Invert a bit of a signal in the hardware, to see that it is found: a path below the unit,
    /// as in step.exit_depth_u_s5:3
    #[arg(long, value_name = "SIGNAL:BIT")]
    plant_fault: Option<Fault>,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// Cycles of a waveform.
#[derive(Clone, Debug)]
struct Window(RangeInclusive<u64>);

impl FromStr for Window {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.split_once(':')
            .and_then(|(first, last)| Some((first.parse().ok()?, last.parse().ok()?)))
            .filter(|(first, last)| first <= last)
            .map(|(first, last)| Window(first..=last))
            .ok_or_else(|| "it is written FIRST:LAST, such as 0:200".to_owned())
    }
}

/// A bit of a signal to be inverted.
#[derive(Clone, Debug)]
struct Fault {
    signal: String,
    bit: u32,
}

impl FromStr for Fault {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.rsplit_once(':')
            .and_then(|(signal, bit)| {
                Some(Fault {
                    signal: signal.to_owned(),
                    bit: bit.parse().ok()?,
                })
            })
            .filter(|fault| !fault.signal.is_empty())
            .ok_or_else(|| "it is written SIGNAL:BIT, such as step.exit_depth_u_s5:3".to_owned())
    }
}

/// Verifies the scene or the unit.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let options = &arguments.operator;
    if arguments.scene.is_none() {
        arguments.replacements.none_of_machines()?;
    }
    match (&arguments.scene, arguments.unit.as_deref()) {
        (Some(scene), _) => {
            options.none_for("a scene")?;
            scene::verify(&arguments, scene)
        }
        (None, Some(unit @ "traverse")) => {
            options.none_for(unit)?;
            scene::verify_random(&arguments)
        }
        (None, Some(unit)) => operator::verify(&arguments, unit),
        (None, None) => anyhow::bail!("a scene file or --unit is needed"),
    }
}
