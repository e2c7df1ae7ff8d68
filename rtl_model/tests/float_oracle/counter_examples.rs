//! Cases that were found wrong once, or that are easily got wrong, read from files.

use std::fs;
use std::path::Path;

use rtl_model::float::{Flags, FloatFormat, Operation};

use super::operands::Case;

/// A case with what must come out, and what is said about it.
pub struct CounterExample {
    pub name: String,
    pub operation: Operation,
    pub format: FloatFormat,
    pub case: Case,
    pub answer: (u64, Flags),
}

/// All examples of the files of a folder. A line is
/// `NAME OPERATOR FORMAT ROUNDING POLICY OPERANDS... RESULT FLAGS`; `#` starts a comment.
pub fn read(folder: &Path) -> Vec<CounterExample> {
    let mut paths: Vec<_> = fs::read_dir(folder)
        .unwrap_or_else(|problem| panic!("{}: {problem}", folder.display()))
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    let mut examples = Vec::new();
    for path in paths {
        let text = fs::read_to_string(&path).expect("a text file");
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default();
            if !line.trim().is_empty() {
                examples.push(
                    example(line).unwrap_or_else(|problem| {
                        panic!("{}: {problem} in `{line}`", path.display())
                    }),
                );
            }
        }
    }
    examples
}

fn example(line: &str) -> Result<CounterExample, String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [name, operation, format, rounding, policy, ref rest @ ..] = words[..] else {
        return Err("too few words".to_owned());
    };
    let operation: Operation = operation.parse().map_err(|error| format!("{error}"))?;
    let format: FloatFormat = format.parse().map_err(|error| format!("{error}"))?;
    let numbers: Vec<u64> = rest
        .iter()
        .map(|word| u64::from_str_radix(word, 16).map_err(|error| error.to_string()))
        .collect::<Result<_, _>>()?;
    let operand_count = operation.operands(format).len();
    if numbers.len() != operand_count + 2 {
        return Err(format!("{} hexadecimal words", numbers.len()));
    }
    let mut operands = [0; 3];
    operands[..operand_count].copy_from_slice(&numbers[..operand_count]);
    Ok(CounterExample {
        name: name.to_owned(),
        operation,
        format,
        case: Case {
            policy: policy.parse()?,
            rounding: rounding.parse()?,
            operands,
        },
        answer: (
            numbers[operand_count],
            Flags::from_bits(numbers[operand_count + 1] as u8),
        ),
    })
}
