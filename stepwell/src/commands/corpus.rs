//! `stepwell corpus`: test vectors for anybody's float unit.

use std::path::PathBuf;

use clap::Args;

use hdl_gen::corpus::{CorpusPlan, write_corpus};
use rtl_model::float::FloatFormat;

use super::Outcome;
use crate::output::OutputFolder;
use crate::terminal;

/// Test vectors, with flags, for anybody's float unit: the corpus
///
/// A file an operator, rounding and policy, in the line style of Berkeley TestFloat: operands,
/// result, flags; and a manifest. This is how the committed corpus vectors/fp24 is made, whose
/// README says how to use it.
#[derive(Args, Debug)]
#[command(after_help = "Example: stepwell corpus --format half -o out/half")]
pub struct Arguments {
    /// Number format: eXfY with X exponent and Y fraction bits, or a name that `stepwell eval
    /// --help` lists
    #[arg(long, value_name = "FORMAT", default_value = "e7f16")]
    format: FloatFormat,

    /// Seed of the random operands
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Folder for the files, made if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Writes the corpus.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let folder = OutputFolder::prepare(&arguments.output)?;
    let plan = CorpusPlan {
        seed: arguments.seed,
        ..CorpusPlan::for_format(arguments.format)
    };
    let mut text = String::new();
    folder.publish(|folder| {
        for file in write_corpus(&plan, folder)?.files {
            text += &format!("{:5} lines  {}\n", file.lines, file.file);
        }
        Ok(())
    })?;
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(Outcome::Agreed)
}
