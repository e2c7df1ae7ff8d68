//! The files of a corpus.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use rtl_model::float::{
    Comparison, Flags, FloatFormat, IntegerFormat, Operation, Policy, Relation, Rounding, Word,
};

use super::manifest::{CorpusColumn, CorpusFile, CorpusManifest};
use super::operands::operand_lines;
use crate::vectors::VectorError;

/// What a corpus is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CorpusPlan {
    /// The format of the arithmetic.
    pub format: FloatFormat,
    /// The seed of what is random.
    pub seed: u64,
    /// Lines of each file of an operator that computes.
    pub lines: usize,
    /// Lines of each file of the others: comparisons and conversions.
    pub lines_of_others: usize,
}

impl CorpusPlan {
    /// The plan of the committed corpus, for a format.
    pub fn for_format(format: FloatFormat) -> CorpusPlan {
        CorpusPlan {
            format,
            seed: 1,
            lines: 1500,
            lines_of_others: 500,
        }
    }

    /// The operators, in the order of the files.
    pub fn operations(self) -> Vec<Operation> {
        let other = if self.format == FloatFormat::SINGLE {
            FloatFormat::E7F16
        } else {
            FloatFormat::SINGLE
        };
        let mut operations = COMPUTING.to_vec();
        operations.extend([Operation::Minimum, Operation::Maximum]);
        for comparison in Comparison::ALL {
            operations.extend(
                [Relation::Equal, Relation::LessThan, Relation::LessEqual]
                    .map(|relation| Operation::Compare(relation, comparison)),
            );
        }
        operations.extend([
            Operation::Compare(Relation::Unordered, Comparison::Quiet),
            Operation::RoundToIntegral,
            Operation::RoundToIntegralExact,
            Operation::ToIntegerExact(IntegerFormat::I32),
            Operation::ToIntegerExact(IntegerFormat::U32),
            Operation::FromInteger(IntegerFormat::I32),
            Operation::FromInteger(IntegerFormat::U32),
            Operation::ToFloat(other),
            Operation::FromFloat(other),
        ]);
        operations
    }
}

const COMPUTING: [Operation; 6] = [
    Operation::Add,
    Operation::Subtract,
    Operation::Multiply,
    Operation::Divide,
    Operation::SquareRoot,
    Operation::FusedMultiplyAdd,
];

/// Writes the corpus to a folder that exists.
///
/// # Errors
/// If a file cannot be written.
pub fn write_corpus(plan: &CorpusPlan, folder: &Path) -> Result<CorpusManifest, VectorError> {
    let mut manifest = CorpusManifest {
        schema: CorpusManifest::SCHEMA.to_owned(),
        tool: format!("stepwell {}", env!("CARGO_PKG_VERSION")),
        seed: plan.seed,
        files: Vec::new(),
    };
    for operation in plan.operations() {
        let lines = if COMPUTING.contains(&operation) {
            plan.lines
        } else {
            plan.lines_of_others
        };
        let operands = operand_lines(operation, plan.format, lines, plan.seed);
        let roundings = if operation.rounds() {
            &Rounding::ALL[..]
        } else {
            &Rounding::ALL[..1]
        };
        for policy in Policy::ALL {
            for &rounding in roundings {
                let (file, text) = file(operation, plan.format, policy, rounding, &operands);
                write(folder, &file.file, &text)?;
                manifest.files.push(file);
            }
        }
    }
    let mut text = serde_json::to_string_pretty(&manifest).expect("text, numbers and lists");
    text.push('\n');
    write(folder, CorpusManifest::FILE, &text)?;
    Ok(manifest)
}

fn write(folder: &Path, name: &str, text: &str) -> Result<(), VectorError> {
    let path = folder.join(name);
    fs::write(&path, text).map_err(|problem| VectorError::Write { path, problem })
}

/// A file's entry, and its text.
fn file(
    operation: Operation,
    format: FloatFormat,
    policy: Policy,
    rounding: Rounding,
    operands: &[[u64; 3]],
) -> (CorpusFile, String) {
    let words = operation.operands(format);
    let mut columns: Vec<CorpusColumn> = words
        .iter()
        .zip(["a", "b", "c"])
        .map(|(&word, name)| column(name, word))
        .collect();
    columns.push(column("result", operation.result(format)));
    let digits: Vec<usize> = columns
        .iter()
        .map(|column| column.width.div_ceil(4) as usize)
        .collect();
    let arithmetic = format.arithmetic(policy, rounding);
    let mut text = String::new();
    for &line in operands {
        let answer = operation.evaluate(arithmetic, line);
        let numbers = line[..words.len()].iter().chain([&answer.bits]);
        for (number, &digits) in numbers.zip(&digits) {
            write!(text, "{number:0digits$X} ").expect("memory");
        }
        writeln!(text, "{:02X}", answer.flags.bits()).expect("memory");
    }
    columns.push(CorpusColumn {
        name: "flags".to_owned(),
        format: "flags".to_owned(),
        width: Flags::WIDTH,
    });
    let rounds = operation.rounds();
    let name = if rounds {
        format!("{operation}_{rounding}_{policy}.txt")
    } else {
        format!("{operation}_{policy}.txt")
    };
    let entry = CorpusFile {
        file: name,
        operator: operation.to_string(),
        format: format.to_string(),
        rounding: rounding.to_string(),
        rounds,
        policy: policy.to_string(),
        columns,
        lines: operands.len() as u64,
        sha256: super::file_digest(&text),
    };
    (entry, text)
}

fn column(name: &str, word: Word) -> CorpusColumn {
    CorpusColumn {
        name: name.to_owned(),
        format: match word {
            Word::Float(format) => format.to_string(),
            Word::Integer(format) => format.to_string(),
            Word::Truth => "truth".to_owned(),
        },
        width: word.width(),
    }
}
