//! `stepwell`: the command line of the bench. It reads files and options, calls the libraries and
//! says what they found; it computes nothing itself.
//!
//! Exit codes: 0 all agreed, 1 something disagreed, 2 it could not run.

mod commands;
mod machine;
mod numbers;
mod operand_lines;
mod operator_options;
mod options;
mod output;
mod progress;
mod rays;
mod summary;
mod terminal;
mod units;

use std::error::Error;
use std::process::ExitCode;

use clap::Parser;
use clap::error::{ContextKind, ErrorKind};

use commands::{Command, Outcome};

/// A bench for designing a displacement-mapping traverse unit: a bit-accurate golden model, its
/// Verilog, and proof that they agree.
#[derive(Parser)]
#[command(
    version,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 all agreed, 1 something disagreed, 2 it could not run.\n\n\
                  Example:\n  stepwell render scenes/first.toml -o out/first"
)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let command_line = match CommandLine::try_parse() {
        Ok(command_line) => command_line,
        Err(error) => return refuse(&error),
    };
    match command_line.command.run() {
        Ok(Outcome::Agreed) => ExitCode::SUCCESS,
        Ok(Outcome::Disagreed) => ExitCode::from(1),
        Err(error) => {
            terminal::complain(&format!("{error:#}"));
            ExitCode::from(2)
        }
    }
}

/// Says what is wrong with the command line, or gives the help that was asked for. A value that is
/// refused gets one line, as everything does that is found wrong later; for the rest clap's own
/// words are the customary ones.
fn refuse(error: &clap::Error) -> ExitCode {
    let option = error.get(ContextKind::InvalidArg);
    if let (ErrorKind::ValueValidation, Some(option), Some(cause)) =
        (error.kind(), option, error.source())
    {
        // clap has the option as `--name <VALUE>`.
        let option = option.to_string();
        let name = option.split(' ').next().unwrap_or_default();
        terminal::complain(&format!("{name}: {cause}"));
    } else {
        // Nobody can be told if even this fails.
        let _ = error.print();
    }
    ExitCode::from(error.exit_code() as u8)
}
