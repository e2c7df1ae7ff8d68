//! `stepwell`: the command line of the bench. It reads files and options, calls the libraries and
//! says what they found; it computes nothing itself.
//!
//! Exit codes: 0 all agreed, 1 something disagreed, 2 it could not run.

mod commands;
mod numbers;
mod options;
mod output;
mod progress;
mod rays;
mod summary;
mod terminal;

use std::process::ExitCode;

use clap::Parser;

use commands::{Command, Outcome};

/// A bench for designing a displacement-mapping traverse unit: a bit-accurate golden model, its
/// Verilog, and proof that they agree.
#[derive(Parser)]
#[command(
    version,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 all agreed, 1 something disagreed, 2 it could not run.\n\n\
                  Example: stepwell render scenes/first.toml -o out/first"
)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    match CommandLine::parse().command.run() {
        Ok(Outcome::Agreed) => ExitCode::SUCCESS,
        Ok(Outcome::Disagreed) => ExitCode::from(1),
        Err(error) => {
            terminal::complain(&format!("{error:#}"));
            ExitCode::from(2)
        }
    }
}
