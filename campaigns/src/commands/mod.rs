//! The subcommands, and what they have in common.

mod formal;
mod frames;
mod hardware;
mod machines;
mod routes;
mod small_worlds;
mod softfloat;
mod walks;

use std::io::{self, ErrorKind, Write};
use std::path::PathBuf;
use std::process;

use anyhow::{Context, bail};
use campaigns::record::{Provenance, record};
use campaigns::row::Row;
use campaigns::tier::Tier;
use clap::{Args, Subcommand};
use rtl_model::float::{FloatFormat, Policy, Rounding};
use serde::Serialize;

/// What can be run.
#[derive(Subcommand)]
pub enum Command {
    /// The golden arithmetic against Berkeley SoftFloat, results and flags
    Softfloat(softfloat::Softfloat),
    /// The golden arithmetic by integers on bits against that by `f64`, rounded once
    Routes(routes::Routes),
    /// Hardware operators under Verilator against the golden arithmetic
    Hardware(hardware::Hardware),
    /// Exact fixed-point walks against a walk of the texels one by one
    Walks(walks::Walks),
    /// Hardware operators proven equal to plain specifications by a SAT solver
    Formal(formal::Formal),
    /// Every ray of small formats through every small map, by every method, against the exact hit
    SmallWorlds(small_worlds::SmallWorlds),
    /// Whole frames of every traversal that promises not to miss against the exact reference
    Frames(frames::Frames),
    /// Whole machines on whole frames, every signal in every cycle, under Verilator
    Machines(machines::Machines),
}

impl Command {
    /// Runs it: did all agree?
    pub fn run(self) -> anyhow::Result<bool> {
        match self {
            Command::Softfloat(command) => command.run(),
            Command::Routes(command) => command.run(),
            Command::Hardware(command) => command.run(),
            Command::Walks(command) => command.run(),
            Command::Formal(command) => command.run(),
            Command::SmallWorlds(command) => command.run(),
            Command::Frames(command) => command.run(),
            Command::Machines(command) => command.run(),
        }
    }
}

/// What every campaign of operators takes.
#[derive(Args)]
pub struct Common {
    #[command(flatten)]
    run: Run,
    /// Only this operator, such as add; may be given several times
    #[arg(long)]
    operator: Vec<String>,
    /// Only this format, such as e7f16; may be given several times
    #[arg(long)]
    format: Vec<FloatFormat>,
    /// Only this rounding: rne, rtz, rup or rdn; may be given several times
    #[arg(long)]
    rounding: Vec<Rounding>,
    /// Only this policy: flush or full
    #[arg(long)]
    policy: Option<Policy>,
}

impl Common {
    /// Is this operator wanted?
    fn wants_operator(&self, name: &str) -> bool {
        self.operator.is_empty() || self.operator.iter().any(|own| own == name)
    }

    fn wants_format(&self, format: FloatFormat) -> bool {
        self.format.is_empty() || self.format.contains(&format)
    }

    fn wants_policy(&self, policy: Policy) -> bool {
        self.policy.is_none_or(|own| own == policy)
    }

    /// The roundings wanted, in the order of the documentation.
    fn roundings(&self) -> Vec<Rounding> {
        let wanted =
            |rounding: &Rounding| self.rounding.is_empty() || self.rounding.contains(rounding);
        Rounding::ALL.into_iter().filter(wanted).collect()
    }
}

/// What every campaign takes: how much, how fast, and where the result goes.
#[derive(Args)]
pub struct Run {
    /// How much is tried
    #[arg(long, value_enum, default_value_t = Tier::Quick)]
    tier: Tier,
    /// Threads; 0 is one a core
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// The result as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Put the result into this file's table
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
}

impl Run {
    /// Runs in as many threads as were asked for.
    fn in_threads<T: Send>(&self, run: impl FnOnce() -> T + Send) -> anyhow::Result<T> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build();
        Ok(pool.context("no threads")?.install(run))
    }

    /// Shows a row as soon as it is there, and puts it into the record: a campaign that is stopped
    /// keeps what it has found.
    fn finish(&self, row: &Row) -> anyhow::Result<()> {
        self.show(row)?;
        if let Some(path) = &self.record {
            record(path, std::slice::from_ref(row), &provenance(self.tier))?;
        }
        Ok(())
    }

    /// Shows a row, where the result is not JSON.
    fn show(&self, row: &Row) -> anyhow::Result<()> {
        if !self.json {
            let mut output = io::stdout().lock();
            let shown = writeln!(output, "{}", row.line()).and_then(|()| {
                row.first
                    .iter()
                    .try_for_each(|line| writeln!(output, "    {line}"))
            });
            if let Err(problem) = shown
                && problem.kind() != ErrorKind::BrokenPipe
            {
                return Err(problem).context("standard output: cannot be written");
            }
        }
        Ok(())
    }

    /// The end of a campaign: something was compared, and did all agree?
    fn conclude(&self, campaign: &str, rows: &[Row]) -> anyhow::Result<bool> {
        let cases: u64 = rows.iter().map(|row| row.cases).sum();
        if cases == 0 {
            bail!(
                "{campaign}: nothing was compared; no operator, format and policy fits the options"
            );
        }
        let differences: u64 = rows.iter().map(|row| row.differences).sum();
        let summary = Summary {
            schema: "stepwell-campaigns/1",
            campaign,
            tier: self.tier.to_string(),
            version: version(),
            date: today(),
            cases,
            differences,
            seconds: rows.iter().map(|row| row.seconds).sum(),
            rows,
        };
        let mut output = io::stdout().lock();
        let shown = if self.json {
            let text = serde_json::to_string_pretty(&summary).context("JSON")?;
            writeln!(output, "{text}")
        } else {
            writeln!(
                output,
                "{campaign}: {differences} of {cases} cases differ, in {:.1} s",
                summary.seconds
            )
        };
        match shown {
            Err(problem) if problem.kind() != ErrorKind::BrokenPipe => {
                Err(problem).context("standard output: cannot be written")
            }
            _ => Ok(differences == 0),
        }
    }
}

/// The result as JSON.
#[derive(Serialize)]
struct Summary<'a> {
    schema: &'static str,
    campaign: &'a str,
    tier: String,
    version: String,
    date: String,
    cases: u64,
    differences: u64,
    seconds: f64,
    rows: &'a [Row],
}

/// When and with what this is run.
fn provenance(tier: Tier) -> Provenance {
    Provenance {
        tier,
        date: today(),
        version: version(),
    }
}

/// Today, `YYYY-MM-DD`, in universal time.
fn today() -> String {
    let seconds = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .map_or(0, |since| since.as_secs());
    // Days to a date of the Gregorian calendar, by eras of 400 years that begin in March.
    let days = seconds / 86_400 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 {
        shifted_month + 3
    } else {
        shifted_month - 9
    };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
}

/// The version and, in a checkout, the commit.
fn version() -> String {
    let git = process::Command::new("git")
        .args(["describe", "--always", "--dirty"])
        .output();
    let commit = git.ok().filter(|output| output.status.success());
    let commit = commit.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    match commit {
        Some(commit) if !commit.is_empty() => format!("{} {commit}", env!("CARGO_PKG_VERSION")),
        _ => env!("CARGO_PKG_VERSION").to_owned(),
    }
}

/// Names of roundings, for a row.
fn names_of(roundings: &[Rounding]) -> String {
    let names: Vec<&str> = roundings.iter().map(|rounding| rounding.name()).collect();
    names.join(" ")
}
