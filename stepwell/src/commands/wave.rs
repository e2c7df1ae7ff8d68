//! `stepwell wave`: signals of a waveform as a picture.

use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use serde::Serialize;

use hdl_gen::wave::{Excerpt, excerpt};
use rtl_model::picture::{Wave, Waves, save_png};

use super::Outcome;
use crate::options::AnswerOptions;
use crate::summary::{json, table};
use crate::terminal;

/// Signals of a waveform (VCD) as a picture (PNG)
///
/// One row a signal, one column a cycle: a bit by its level, everything else by its value, as the
/// file says it is meant: a float as a number, plain bits of more than 16 in hexadecimal, others in
/// decimal. Cycles are told by the outermost clk_i.
#[derive(Args, Debug)]
#[command(
    after_help = "Example:\n  stepwell verify scenes/machine-paper.toml --size 32x24 --vcd 0:200 -o out/machine\n  \
                  stepwell wave out/machine/golden.vcd --from 0 --to 60 -o out/machine/waves.png \\\n    \
                  --signals ray_valid_i,ray_ready_o,admits,recirculates,ends,hit_valid_o"
)]
pub struct Arguments {
    /// The waveform
    #[arg(value_name = "FILE.vcd")]
    file: PathBuf,

    /// Signals, uppermost first: full names, or as much of the end as tells one from all others;
    /// repeat the option, or put commas between
    #[arg(
        long,
        value_name = "SIGNAL",
        value_delimiter = ',',
        required = true,
        num_args = 1
    )]
    signals: Vec<String>,

    /// First cycle
    #[arg(long, value_name = "CYCLE", default_value_t = 0)]
    from: u64,

    /// Last cycle
    #[arg(long, value_name = "CYCLE", default_value_t = 59)]
    to: u64,

    /// Columns of pixels for a cycle
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(4..=200))]
    columns: u32,

    /// Above the picture; the file's name unless told
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,

    /// The picture
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// Cycles that a picture shows at most: a wider one is read by nothing.
const MOST_CYCLES: u64 = 2000;

#[derive(Serialize)]
struct Summary {
    schema: &'static str,
    file: PathBuf,
    first_cycle: u64,
    cycles: u64,
    signals: Vec<String>,
    picture: PathBuf,
}

/// Draws the picture.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let (first, last) = (arguments.from, arguments.to);
    if last < first {
        bail!("--to {last}: it is before --from {first}");
    }
    if last - first >= MOST_CYCLES {
        bail!("--from {first} --to {last}: a picture has at most {MOST_CYCLES} cycles");
    }
    let name = arguments.file.display().to_string();
    let file = File::open(&arguments.file).with_context(|| format!("{name}: cannot be read"))?;
    let shown = excerpt(
        &name,
        BufReader::new(file),
        &arguments.signals,
        first..=last,
    )?;
    let title = arguments.title.unwrap_or(name);
    let waves = waves(&shown, title, arguments.columns);
    save_png(&waves.draw(), &arguments.output)?;
    let cycles = shown
        .signals
        .first()
        .map_or(0, |signal| signal.values.len());
    let summary = Summary {
        schema: "stepwell-wave-1",
        file: arguments.file,
        first_cycle: shown.first_cycle,
        cycles: cycles as u64,
        signals: shown
            .signals
            .into_iter()
            .map(|signal| signal.name)
            .collect(),
        picture: arguments.output,
    };
    let text = if arguments.answer.json {
        json(&summary)?
    } else {
        table(&[
            (
                "cycles",
                format!("{} from {} on", summary.cycles, summary.first_cycle),
            ),
            ("signals", summary.signals.len().to_string()),
            ("picture", summary.picture.display().to_string()),
        ])
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(Outcome::Agreed)
}

fn waves(shown: &Excerpt, title: String, cycle_columns: u32) -> Waves {
    let signals = shown.signals.iter().map(|signal| {
        // All are in one design: its name says nothing.
        let (_, name) = signal.name.split_once('.').unwrap_or(("", &signal.name));
        let wave = match signal.width {
            1 => {
                let bits = signal.values.iter();
                Wave::Bit(
                    bits.map(|bit| bit.as_known().map(|bit| bit & 1 == 1))
                        .collect(),
                )
            }
            _ => Wave::Word(signal.texts()),
        };
        (name.to_owned(), wave)
    });
    Waves {
        title,
        first_cycle: shown.first_cycle,
        cycle_columns,
        signals: signals.collect(),
    }
}
