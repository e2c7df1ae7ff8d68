//! `campaigns`: long runs against independent judges, for those who build the operators.
//!
//! Exit codes: 0 all agreed, 1 something disagreed, 2 it could not run.

mod commands;
mod progress;

use std::process::ExitCode;

use clap::Parser;
use commands::Command;

/// Long runs that hold the arithmetic and the operators against independent judges.
#[derive(Parser)]
#[command(
    version,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 all agreed, 1 something disagreed, 2 it could not run.\n\n\
                  Example:\n  campaigns softfloat --tier quick --operator add"
)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    match CommandLine::parse().command.run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("campaigns: {error:#}");
            ExitCode::from(2)
        }
    }
}
