//! Named cases, kept for ever: what was once wrong somewhere, or is wrong easily.
//!
//! A line of `named_cases.txt` has a name, the operation, format, policy, rounding, operands in
//! hexadecimal, a colon, the result and the flags.

use std::str::FromStr;

use rtl_model::float::{Answer, Flags, FloatArithmetic, FloatFormat, Operation, Policy, Rounding};

/// The cases' text.
const TEXT: &str = include_str!("../named_cases.txt");

/// An operation on certain operands, and what it must answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedCase {
    /// What it is called.
    pub name: String,
    /// The operation.
    pub operation: Operation,
    /// Its arithmetic.
    pub arithmetic: FloatArithmetic,
    /// Its operands; 0 where there is none.
    pub operands: [u64; 3],
    /// What it must answer.
    pub answer: Answer,
}

/// All named cases, in the order of the file.
///
/// # Errors
/// The first line that cannot be read.
pub fn named_cases() -> Result<Vec<NamedCase>, String> {
    let lines = TEXT
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines
        .map(|line| read(line).ok_or_else(|| format!("named_cases.txt: cannot read `{line}`")))
        .collect()
}

fn read(line: &str) -> Option<NamedCase> {
    let (case, answer) = line.split_once(':')?;
    let mut words = case.split_whitespace();
    let name = words.next()?.to_owned();
    let operation = words.next()?;
    let format = FloatFormat::from_str(words.next()?).ok()?;
    let policy = Policy::from_str(words.next()?).ok()?;
    let rounding = Rounding::from_str(words.next()?).ok()?;
    let operation = Operation::from_str(operation).ok()?;
    let mut operands = [0; 3];
    let count = operation.operands(format).len();
    for operand in operands.iter_mut().take(count) {
        *operand = u64::from_str_radix(words.next()?, 16).ok()?;
    }
    let mut answer = answer.split_whitespace();
    let bits = u64::from_str_radix(answer.next()?, 16).ok()?;
    let flags = u8::from_str_radix(answer.next()?, 16).ok()?;
    Some(NamedCase {
        name,
        operation,
        arithmetic: format.arithmetic(policy, rounding),
        operands,
        answer: Answer {
            bits,
            flags: Flags::from_bits(flags),
        },
    })
    .filter(|_| words.next().is_none() && answer.next().is_none())
}
