//! `stepwell wavediff`: where two waveforms part.

use std::path::PathBuf;

use clap::Args;

use hdl_gen::wave::{CycleNumbers, DiffOptions, SideOptions, diff_files};

use super::Outcome;
use crate::options::AnswerOptions;
use crate::summary::json;
use crate::terminal;

/// First divergence of two waveforms (VCD), decoded
///
/// Pairs signals by name, skips reset, and on a difference names cycle, time, unit and signal,
/// both values as bits and decoded, their distance in units in the last place, and whether the
/// signal's own inputs agreed, which makes it a first cause. Exit code 1 says that they differ.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: stepwell verify scenes/small.toml --sim embedded --vcd 0:99 -o out/small && \
                  stepwell wavediff out/small/golden.vcd out/small/hardware.vcd"
)]
pub struct Arguments {
    /// What must be: the golden model's waveform
    #[arg(value_name = "GOLDEN.vcd")]
    golden: PathBuf,

    /// What is: a simulator's waveform
    #[arg(value_name = "OTHER.vcd")]
    other: PathBuf,

    /// Scope of the golden file that holds the design, where it is not found by itself
    #[arg(long, value_name = "SCOPE")]
    golden_scope: Option<String>,

    /// Scope of the other file that holds the design, such as TOP
    #[arg(long, value_name = "SCOPE")]
    other_scope: Option<String>,

    /// Number of the cycle that the first rising edge of the golden file begins; by its time unless
    /// told
    #[arg(long, value_name = "CYCLE")]
    golden_first_cycle: Option<u64>,

    /// The same of the other file: 0 of an emitted testbench's
    #[arg(long, value_name = "CYCLE")]
    other_first_cycle: Option<u64>,

    /// Take bits that are x in the other file for agreeing: registers without reset, before they are
    /// first written, in a simulator that knows x
    #[arg(long)]
    excuse_unknown: bool,

    /// Diverging signals to show of the first divergent cycle
    #[arg(long, value_name = "N", default_value_t = 10)]
    signals: usize,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// Compares the waveforms.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let side = |scope, first: Option<u64>| SideOptions {
        scope,
        cycles: first.map_or(CycleNumbers::ByTime, CycleNumbers::FromFirstEdge),
    };
    let options = DiffOptions {
        golden: side(arguments.golden_scope, arguments.golden_first_cycle),
        other: side(arguments.other_scope, arguments.other_first_cycle),
        signals_shown: arguments.signals,
        excuse_other_unknown: arguments.excuse_unknown,
        ..DiffOptions::default()
    };
    let report = diff_files(&arguments.golden, &arguments.other, &options)?;
    let text = if arguments.answer.json {
        json(&report)?
    } else {
        report.to_string()
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(if report.agreed {
        Outcome::Agreed
    } else {
        Outcome::Disagreed
    })
}
