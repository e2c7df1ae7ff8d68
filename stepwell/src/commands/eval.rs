//! `stepwell eval`: the golden arithmetic as a filter.

mod fixed;

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Instant;

use anyhow::{anyhow, bail};
use clap::Args;
use serde::Serialize;

use rtl_model::fixed::{FixedFormat, FixedFormatError, FixedOperation};
use rtl_model::float::{
    Comparison, Flags, FloatFormat, Operation, Policy, Relation, Rounding, SUPPORTED_FORMATS,
    UnknownFloatFormat, Word,
};

use fixed::FixedOptions;

use super::Outcome;
use crate::operand_lines::{MOST_OPERANDS, OperandLines, OperandSource, Operands};
use crate::options::AnswerOptions;
use crate::output::OutputFile;
use crate::summary::{json, table};
use crate::{progress, terminal};

/// The golden arithmetic as a filter: operands in, results and flags out
///
/// Operands are hexadecimal words, two a line: the second may be left out, and is ignored, where the
/// operator has one operand; fused_multiply_add has three. Out come, line by line in the same order,
/// the operands again, the result and the flags, all in hexadecimal with as many digits as their
/// widths ask for: the line style of Berkeley TestFloat, whose bits the flags have: 01 inexact, 02
/// underflow, 04 overflow, 08 divide by zero, 10 invalid.
///
/// docs/numerics.md has every corner case of every operator on floats, docs/fixed_point.md on
/// fixed-point numbers.
#[derive(Args, Debug)]
#[command(after_help = after_help())]
pub struct Arguments {
    /// Operator
    #[arg(long, value_name = "OPERATOR")]
    op: String,

    /// Number format: eXfY with X exponent and Y fraction bits, or one of the names below; or fixed
    /// point, qI.F or uqI.F
    #[arg(long, value_name = "FORMAT", default_value = "e7f16")]
    format: EvaluatedFormat,

    /// Rounding: rne to nearest even, rtz toward zero, rup up, rdn down. Operators that do not round
    /// answer alike under all
    #[arg(long, value_name = "ROUNDING", default_value = "rne")]
    rounding: Rounding,

    /// Subnormal numbers: flush reads and writes them as zeros, full has them as in IEEE 754
    #[arg(long, value_name = "POLICY", default_value = "flush")]
    policy: Policy,

    #[command(flatten)]
    fixed: FixedOptions,

    /// Operand file; - reads standard input
    #[arg(long, value_name = "FILE")]
    operands: OperandSource,

    /// Result file, standard output unless told; it appears whole or not at all
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    answer: AnswerOptions,
}

/// What is at the end of the help: every operator and every named format, from their lists.
fn after_help() -> String {
    let plain = Operation::PLAIN.map(|operation| operation.to_string());
    let aliases = Operation::ALIASES.map(|(name, operation)| format!("{name} = {operation}"));
    let mut text = format!(
        "Operators:\n  {}\n  to_X, to_X_exact, from_X  X an integer format, such as i32 or u8; \
         inexact only if exact\n  to_X, from_X              X a float format\n  R_{}, \
         R_{}    R one of {}\n  short names: {}\n\nFormats:\n",
        plain.join(" "),
        Comparison::Quiet.name(),
        Comparison::Signalling.name(),
        Relation::ALL.map(Relation::name).join(" "),
        aliases.join(", ")
    );
    for supported in SUPPORTED_FORMATS {
        let name = supported.format.to_string();
        let alias = supported.alias.unwrap_or_default();
        text += &format!("  {name:7} {alias:9} {}\n", supported.purpose);
    }
    let fixed = FixedOperation::plain().map(|operation| operation.to_string());
    text += &format!(
        "  qI.F, uqI.F       fixed point, signed and unsigned; its operators are\n    {}\n    {}\n    \
         to_X and from_X with a float format X\n",
        fixed[..9].join(" "),
        fixed[9..].join(" ")
    );
    text += &format!(
        "  eXfY              any with {} to {} exponent and {} to {} fraction bits\n\n",
        FloatFormat::EXPONENT_BITS.start(),
        FloatFormat::EXPONENT_BITS.end(),
        FloatFormat::FRACTION_BITS.start(),
        FloatFormat::FRACTION_BITS.end()
    );
    text + "Example, one third, and one divided by zero:\n  \
            printf '3F0000 408000\\n3F0000 000000\\n' |\n    \
            stepwell eval --op div --rounding rup --policy full --operands -"
}

/// The formats that there is arithmetic of.
#[derive(Clone, Copy, Debug)]
enum EvaluatedFormat {
    /// A float.
    Float(FloatFormat),
    /// Fixed point.
    Fixed(FixedFormat),
}

impl FromStr for EvaluatedFormat {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.parse() {
            Ok(format) => Ok(EvaluatedFormat::Fixed(format)),
            Err(FixedFormatError::Unknown { .. }) => {
                let format = text.parse().map(EvaluatedFormat::Float);
                format.map_err(|problem: UnknownFloatFormat| {
                    format!("{problem}; or fixed point, qI.F or uqI.F, such as q12.20")
                })
            }
            Err(problem) => Err(problem.to_string()),
        }
    }
}

impl fmt::Display for EvaluatedFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EvaluatedFormat::Float(format) => write!(f, "{format}"),
            EvaluatedFormat::Fixed(format) => write!(f, "{format}"),
        }
    }
}

/// An operator with all that its answers depend on.
struct Evaluator {
    operand_widths: Vec<u32>,
    result_width: u32,
    /// The result of these operands, and its flags.
    evaluate: Box<dyn Fn([u64; MOST_OPERANDS]) -> (u64, Flags)>,
}

impl Arguments {
    fn evaluator(&self) -> anyhow::Result<Evaluator> {
        match self.format {
            EvaluatedFormat::Fixed(format) => {
                self.fixed
                    .evaluator(&self.op, format, self.policy, self.rounding)
            }
            EvaluatedFormat::Float(format) => {
                self.fixed.refuse()?;
                let operation: Operation =
                    self.op.parse().map_err(|error| anyhow!("--op: {error}"))?;
                let arithmetic = format.arithmetic(self.policy, self.rounding);
                let operands = operation.operands(format);
                Ok(Evaluator {
                    operand_widths: operands.into_iter().map(Word::width).collect(),
                    result_width: operation.result(format).width(),
                    evaluate: Box::new(move |operands| {
                        let answer = operation.evaluate(arithmetic, operands);
                        (answer.bits, answer.flags)
                    }),
                })
            }
        }
    }
}

/// Lines, and how many of them raised each flag.
#[derive(Debug, Default)]
struct Counts {
    lines: u64,
    raised: [u64; Flags::ALL.len()],
}

/// Evaluates the operands.
pub fn run(arguments: Arguments) -> anyhow::Result<Outcome> {
    let output = arguments
        .output
        .as_deref()
        .filter(|path| *path != Path::new("-"));
    if arguments.answer.json && output.is_none() {
        bail!("--json takes standard output for the summary: give the results a file with -o");
    }
    let evaluator = arguments.evaluator()?;
    let mut lines = arguments.operands.open(&evaluator.operand_widths)?;
    let Some(path) = output else {
        let mut problem = None;
        terminal::answer(|output| {
            write_results(&evaluator, &mut lines, output, &|_| {}, &mut problem).map(|_| ())
        })?;
        return problem.map_or(Ok(Outcome::Agreed), Err);
    };
    let file = OutputFile::prepare(path)?;
    let bar = progress::bar(lines.bytes(), "bytes");
    let start = Instant::now();
    let mut problem = None;
    let mut counts = Counts::default();
    let published = file.publish(|output| {
        let advance = |bytes| bar.inc(bytes);
        counts = write_results(&evaluator, &mut lines, output, &advance, &mut problem)?;
        match problem {
            None => Ok(()),
            // Nothing is published; the reason is told below.
            Some(_) => Err(io::Error::other("bad operands")),
        }
    });
    bar.finish_and_clear();
    if let Some(problem) = problem {
        return Err(problem);
    }
    published?;
    let summary = Summary::new(&arguments, path, &counts, start.elapsed().as_secs_f64());
    let text = if arguments.answer.json {
        json(&summary)?
    } else {
        summary.table()
    };
    terminal::answer(|output| output.write_all(text.as_bytes()))?;
    Ok(Outcome::Agreed)
}

/// Bytes between two signs of life.
const REPORT_EVERY: u64 = 1 << 20;

/// A line for each line, up to a bad one, whose `problem` is told.
fn write_results(
    evaluator: &Evaluator,
    lines: &mut OperandLines<'_>,
    output: &mut dyn Write,
    advance: &dyn Fn(u64),
    problem: &mut Option<anyhow::Error>,
) -> io::Result<Counts> {
    let mut counts = Counts::default();
    let mut raised = [0_u64; 1 << Flags::WIDTH];
    let mut text = Vec::new();
    let mut unreported = 0;
    let has_one_operand = evaluator.operand_widths.len() == 1;
    loop {
        let (Operands { words, ignored }, bytes) = match lines.next() {
            Ok(Some(line)) => line,
            Ok(None) => break,
            Err(error) => {
                *problem = Some(error);
                break;
            }
        };
        let (result, flags) = (evaluator.evaluate)(words);
        text.clear();
        for (&word, &width) in words.iter().zip(&evaluator.operand_widths) {
            push_word(&mut text, word, width.div_ceil(4));
        }
        if let (true, Some(word)) = (has_one_operand, ignored) {
            let digits = evaluator.operand_widths[0].div_ceil(4);
            push_word(&mut text, word, digits.max(significant_digits(word)));
        }
        push_word(&mut text, result, evaluator.result_width.div_ceil(4));
        push_word(&mut text, flags.bits().into(), 2);
        if let Some(last) = text.last_mut() {
            *last = b'\n';
        }
        output.write_all(&text)?;
        counts.lines += 1;
        raised[usize::from(flags.bits())] += 1;
        unreported += bytes;
        if unreported >= REPORT_EVERY {
            advance(unreported);
            unreported = 0;
        }
    }
    for (bits, times) in raised.into_iter().enumerate() {
        for (count, (flag, _)) in counts.raised.iter_mut().zip(Flags::ALL) {
            if Flags::from_bits(bits as u8).contains(flag) {
                *count += times;
            }
        }
    }
    Ok(counts)
}

fn significant_digits(word: u64) -> u32 {
    (u64::BITS - word.leading_zeros()).div_ceil(4)
}

/// A word in so many digits, and a space.
fn push_word(text: &mut Vec<u8>, word: u64, digits: u32) {
    for place in (0..digits).rev() {
        let digit = (word >> (4 * place) & 0xf) as usize;
        text.push(b"0123456789ABCDEF"[digit]);
    }
    text.push(b' ');
}

/// The JSON of an evaluation. As in every summary of this program, what does not apply is null.
#[derive(Serialize)]
struct Summary {
    schema: &'static str,
    operator: String,
    format: String,
    rounding: &'static str,
    policy: &'static str,
    result_format: Option<String>,
    overflow: Option<&'static str>,
    operations: u64,
    raised: Raised,
    operands_file: String,
    results_file: PathBuf,
    seconds: f64,
    method: Option<String>,
    rays: Option<u64>,
    guards: Option<u64>,
    simulator: Option<String>,
    mismatches: Option<u64>,
    cycles: Option<u64>,
    signals_compared: Option<u64>,
    cycles_compared: Option<u64>,
}

/// How many operations raised each flag.
#[derive(Serialize)]
struct Raised {
    inexact: u64,
    underflow: u64,
    overflow: u64,
    divide_by_zero: u64,
    invalid: u64,
}

impl Summary {
    fn new(arguments: &Arguments, results: &Path, counts: &Counts, seconds: f64) -> Summary {
        let [inexact, underflow, overflow, divide_by_zero, invalid] = counts.raised;
        Summary {
            schema: "stepwell-eval-1",
            operator: arguments.op.clone(),
            format: arguments.format.to_string(),
            rounding: arguments.rounding.name(),
            policy: arguments.policy.name(),
            result_format: arguments.fixed.result_format().map(|it| it.to_string()),
            overflow: match arguments.format {
                EvaluatedFormat::Float(_) => None,
                EvaluatedFormat::Fixed(_) => Some(arguments.fixed.overflow().name()),
            },
            operations: counts.lines,
            raised: Raised {
                inexact,
                underflow,
                overflow,
                divide_by_zero,
                invalid,
            },
            operands_file: arguments.operands.to_string(),
            results_file: results.to_owned(),
            seconds,
            method: None,
            rays: None,
            guards: None,
            simulator: None,
            mismatches: None,
            cycles: None,
            signals_compared: None,
            cycles_compared: None,
        }
    }

    fn table(&self) -> String {
        let raised = &self.raised;
        table(&[
            ("operator", format!("{} {}", self.operator, self.format)),
            ("rounding", self.rounding.to_owned()),
            ("policy", self.policy.to_owned()),
            (
                "operations",
                format!("{} of {}", self.operations, self.operands_file),
            ),
            ("inexact", raised.inexact.to_string()),
            ("underflow", raised.underflow.to_string()),
            ("overflow", raised.overflow.to_string()),
            ("divide by zero", raised.divide_by_zero.to_string()),
            ("invalid", raised.invalid.to_string()),
            ("seconds", format!("{:.3}", self.seconds)),
            ("results", self.results_file.display().to_string()),
        ])
    }
}
