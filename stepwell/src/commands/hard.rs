//! `stepwell hard`: the corpus of hard cases against every method and format.

mod report;

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use clap::Args;
use rayon::prelude::*;

use rtl_model::hard::{HardCase, HardFamily, PreparedCase};
use rtl_model::judge::JudgeError;
use rtl_model::scene::{Crossing, Method, WalkFormat};
use rtl_model::walker::WalkerError;

use self::report::{Answers, Report};
use super::Outcome;
use crate::options::{AnswerOptions, ThreadOptions};
use crate::output::OutputFolder;
use crate::summary::json;
use crate::{progress, terminal};

/// The corpus of hard cases against every method and number format
///
/// A case is a small map and rays on which traversals go wrong; its file says why, where it comes
/// from, and what must be hit in exact arithmetic. A ray is judged by the exact hit of the ray as
/// the format holds it. What is promised: exact and fixed point hit the very texel; a float never
/// hits later than that, nor hangs, but may hit a texel that the ray only just misses; f64 always
/// ends, and may lose a tie to rounding. relief, pom and dig promise nothing, nor does a crossing by
/// an offset: they are shown for comparison. The pixels that dig asks for are as those of a camera far
/// above: a ray is the middle of a block of 4 x 4, with a texel from one pixel to the next.
///
/// Exit code 1 says that a promise is broken.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  stepwell hard --method oh,relief --format e7f16,exact")]
pub struct Arguments {
    /// Folder of the cases
    #[arg(long, value_name = "DIR", default_value = "vectors/hard")]
    corpus: PathBuf,

    /// Only this case, or several: repeat the option, or put commas between
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    case: Vec<String>,

    /// Only cases of this family, such as re-entry, or of several
    #[arg(long, value_name = "FAMILY", value_delimiter = ',')]
    family: Vec<HardFamily>,

    /// Only this traversal, such as oh or block, or several, such as oh,block
    #[arg(long, value_name = "METHOD", value_delimiter = ',')]
    method: Vec<Method>,

    /// Only this number format: eXfY, f64, exact, fixed or qI.F, or several
    #[arg(long, value_name = "FORMAT", value_delimiter = ',')]
    format: Vec<WalkFormat>,

    /// How borders are crossed: index, or offset:X with X texels beyond the border (published, for
    /// comparison)
    #[arg(long, value_name = "CROSSING", default_value = "index")]
    crossing: Crossing,

    /// Show every ray that does not hit the very texel, with what it should hit and what it does
    #[arg(long)]
    rays: bool,

    /// Folder for hard.csv and hard.json, made if missing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadOptions,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// Formats that are tried unless others are asked for.
const FORMATS: [&str; 6] = ["e7f16", "e8f23", "e5f10", "f64", "exact", "fixed"];

impl Arguments {
    fn cases(&self) -> anyhow::Result<Vec<HardCase>> {
        let mut cases = HardCase::load_folder(&self.corpus)?;
        if let Some(name) = self
            .case
            .iter()
            .find(|name| cases.iter().all(|case| case.name != **name))
        {
            bail!(
                "--case {name}: {} has no such case; the files there are named after them",
                self.corpus.display()
            );
        }
        cases.retain(|case| {
            let is_named = self.case.is_empty() || self.case.contains(&case.name);
            is_named && (self.family.is_empty() || self.family.contains(&case.family))
        });
        if cases.is_empty() {
            bail!("--case and --family: no case is of both; leave one out");
        }
        Ok(cases)
    }

    /// All methods, those of fixed point alone and all numbers of levels that `multi-level-down` goes
    /// among them, or those asked for.
    fn methods(&self) -> Vec<Method> {
        if !self.method.is_empty() {
            return self.method.clone();
        }
        let all = Method::ALL.into_iter().chain(Method::FIXED_ONLY);
        all.flat_map(|method| match method {
            Method::MultiLevelDown(_) => (1..=Method::MOST_LEVELS_DOWN)
                .map(Method::MultiLevelDown)
                .collect(),
            other => vec![other],
        })
        .collect()
    }

    fn formats(&self) -> anyhow::Result<Vec<WalkFormat>> {
        if !self.format.is_empty() {
            return Ok(self.format.clone());
        }
        let formats = FORMATS.iter().map(|name| name.parse());
        Ok(formats.collect::<Result<_, _>>()?)
    }
}

/// Runs the cases.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let folder = arguments.output.as_deref().map(OutputFolder::prepare);
    let folder = folder.transpose()?;
    let cases = arguments.cases()?;
    let (methods, formats) = (arguments.methods(), arguments.formats()?);
    let tasks: Vec<(WalkFormat, &HardCase)> = formats
        .iter()
        .flat_map(|&format| cases.iter().map(move |case| (format, case)))
        .collect();

    let bar = progress::bar(tasks.len() as u64, "cases");
    let start = Instant::now();
    let answers = arguments.threads.run(|| {
        let answers = tasks.par_iter().map(|&(format, case)| {
            let answers = answers(case, format, &methods, arguments.crossing);
            bar.inc(1);
            answers.with_context(|| format!("hard case {} in {format}", case.name))
        });
        answers.collect::<anyhow::Result<Vec<_>>>()
    })?;
    let seconds = start.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let answers = answers?;

    let report = Report::new(
        &cases,
        &methods,
        &formats,
        arguments.crossing,
        &answers,
        seconds,
    );
    if report.rays() == 0 {
        bail!(
            "nothing was compared: no method here walks in these formats by crossing {}\n{}",
            arguments.crossing,
            report.reasons()
        );
    }
    if let Some(folder) = folder {
        folder.publish(|folder| report.write(folder))?;
    }
    let text = if arguments.answer.json {
        json(&report)?
    } else {
        let mut text = report.table();
        if arguments.rays {
            text += &report.wrong_rays(&cases, &answers);
        }
        text
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(if report.defects() == 0 {
        Outcome::Agreed
    } else {
        Outcome::Disagreed
    })
}

/// What each method answers for a case in a format; where it has no answer, why.
fn answers(
    case: &HardCase,
    format: WalkFormat,
    methods: &[Method],
    crossing: Crossing,
) -> anyhow::Result<Answers> {
    let prepared = match PreparedCase::new(case, format) {
        Err(JudgeError::Walk(WalkerError::Unsupported { why, .. })) => {
            return Ok(methods.iter().map(|_| Err(why)).collect());
        }
        prepared => prepared?,
    };
    let assess = |&method| match prepared.assess(method, crossing) {
        Err(JudgeError::Walk(WalkerError::Unsupported { why, .. })) => Ok(Err(why)),
        assessment => Ok(Ok(assessment?)),
    };
    methods.iter().map(assess).collect()
}
