//! The commands, one a file.

mod area;
mod corpus;
mod emit;
mod eval;
mod hard;
mod paper;
mod plan;
mod render;
mod trace;
mod vectors;
mod verify;
mod wave;
mod wavediff;

use clap::Subcommand;

/// How a command that ran came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All is as it must be: exit code 0.
    Agreed,
    /// Something differs from what it must be, or a walk found no hit: exit code 1.
    Disagreed,
}

#[derive(Subcommand)]
pub enum Command {
    Render(render::Arguments),
    Trace(trace::Arguments),
    Eval(eval::Arguments),
    Emit(emit::Arguments),
    Verify(verify::Arguments),
    Wavediff(wavediff::Arguments),
    Wave(wave::Arguments),
    Area(area::Arguments),
    Paper(paper::Arguments),
    Plan(plan::Arguments),
    Hard(hard::Arguments),
    Vectors(vectors::Arguments),
    Corpus(corpus::Arguments),
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// Whatever kept it from running, as one message: exit code 2.
    pub fn run(self) -> anyhow::Result<Outcome> {
        match self {
            Command::Render(arguments) => render::run(arguments),
            Command::Trace(arguments) => trace::run(arguments),
            Command::Eval(arguments) => eval::run(arguments),
            Command::Emit(arguments) => emit::run(arguments),
            Command::Corpus(arguments) => corpus::run(arguments),
            Command::Vectors(arguments) => vectors::run(arguments),
            Command::Verify(arguments) => verify::run(arguments),
            Command::Wavediff(arguments) => wavediff::run(arguments),
            Command::Wave(arguments) => wave::run(arguments),
            Command::Area(arguments) => area::run(arguments),
            Command::Paper(arguments) => paper::run(arguments),
            Command::Plan(arguments) => plan::run(arguments),
            Command::Hard(arguments) => hard::run(arguments),
        }
    }
}
