//! Every operation with its name, so that it can be chosen at run time.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::{Answer, Comparison, FloatArithmetic, FloatFormat, IntegerFormat, Relation};

/// An operation of [`FloatArithmetic`]; its name is that of the method, followed by what its
/// operands do not tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// `add`: a + b.
    Add,
    /// `sub`: a - b.
    Subtract,
    /// `mul`: a * b.
    Multiply,
    /// `div`: a / b.
    Divide,
    /// `sqrt`: the square root of a.
    SquareRoot,
    /// `fused_multiply_add`: a * b + c, rounded once.
    FusedMultiplyAdd,
    /// `min`: `minimumNumber` of a and b.
    Minimum,
    /// `max`: `maximumNumber` of a and b.
    Maximum,
    /// Such as `less_than_quiet`: 1 where a stands in this relation to b, else 0.
    Compare(Relation, Comparison),
    /// `round_to_integral`: a rounded to an integer, as a float.
    RoundToIntegral,
    /// `round_to_integral_exact`: the same, inexact where that is not a.
    RoundToIntegralExact,
    /// `floor`: the largest integer not above a, as a float.
    Floor,
    /// Such as `to_i32`: a rounded to an integer, saturating.
    ToInteger(IntegerFormat),
    /// Such as `to_i32_exact`: the same, inexact where that is not a.
    ToIntegerExact(IntegerFormat),
    /// Such as `from_u32`: the float of an integer.
    FromInteger(IntegerFormat),
    /// Such as `to_e8f23`: a in another format.
    ToFloat(FloatFormat),
    /// Such as `from_e8f23`: a in another format than its own.
    FromFloat(FloatFormat),
}

/// What a word of an operation stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Word {
    /// A float.
    Float(FloatFormat),
    /// An integer.
    Integer(IntegerFormat),
    /// 0 or 1.
    Truth,
}

impl Word {
    /// Its bits.
    pub const fn width(self) -> u32 {
        match self {
            Word::Float(format) => format.width(),
            Word::Integer(format) => format.bits,
            Word::Truth => 1,
        }
    }
}

/// Why a text names no operation.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "unknown operator `{0}`: there are {plain}, to_X, to_X_exact and from_X with an integer format \
     X such as i32 or u8, to_X and from_X with a float format X such as e8f23, and R_quiet and \
     R_signalling with a relation R: {relations}",
    plain = Operation::PLAIN.map(|operation| operation.to_string()).join(", "),
    relations = Relation::ALL.map(Relation::name).join(", ")
)]
pub struct UnknownOperation(pub String);

impl Operation {
    /// Those without a parameter, in the order of the documentation.
    pub const PLAIN: [Operation; 11] = [
        Operation::Add,
        Operation::Subtract,
        Operation::Multiply,
        Operation::Divide,
        Operation::SquareRoot,
        Operation::FusedMultiplyAdd,
        Operation::Minimum,
        Operation::Maximum,
        Operation::RoundToIntegral,
        Operation::RoundToIntegralExact,
        Operation::Floor,
    ];

    /// Shorter names that are read, too: those of Berkeley TestFloat. As there, `lt` and `le` are
    /// signalling comparisons and `eq` a quiet one.
    pub const ALIASES: [(&'static str, Operation); 10] = [
        ("fma", Operation::FusedMultiplyAdd),
        ("mulAdd", Operation::FusedMultiplyAdd),
        ("roundToInt", Operation::RoundToIntegral),
        ("eq", Operation::Compare(Relation::Equal, Comparison::Quiet)),
        (
            "lt",
            Operation::Compare(Relation::LessThan, Comparison::Signalling),
        ),
        (
            "le",
            Operation::Compare(Relation::LessEqual, Comparison::Signalling),
        ),
        (
            "eq_signaling",
            Operation::Compare(Relation::Equal, Comparison::Signalling),
        ),
        (
            "lt_quiet",
            Operation::Compare(Relation::LessThan, Comparison::Quiet),
        ),
        (
            "le_quiet",
            Operation::Compare(Relation::LessEqual, Comparison::Quiet),
        ),
        (
            "unordered",
            Operation::Compare(Relation::Unordered, Comparison::Quiet),
        ),
    ];

    /// What its operands are, in the arithmetic of this format: one, two or three.
    pub fn operands(self, format: FloatFormat) -> Vec<Word> {
        let own = Word::Float(format);
        match self {
            Operation::Add
            | Operation::Subtract
            | Operation::Multiply
            | Operation::Divide
            | Operation::Minimum
            | Operation::Maximum
            | Operation::Compare(..) => vec![own; 2],
            Operation::FusedMultiplyAdd => vec![own; 3],
            Operation::SquareRoot
            | Operation::RoundToIntegral
            | Operation::RoundToIntegralExact
            | Operation::Floor
            | Operation::ToInteger(_)
            | Operation::ToIntegerExact(_)
            | Operation::ToFloat(_) => vec![own],
            Operation::FromInteger(source) => vec![Word::Integer(source)],
            Operation::FromFloat(source) => vec![Word::Float(source)],
        }
    }

    /// What its result is, in the arithmetic of this format.
    pub const fn result(self, format: FloatFormat) -> Word {
        match self {
            Operation::Compare(..) => Word::Truth,
            Operation::ToInteger(target) | Operation::ToIntegerExact(target) => {
                Word::Integer(target)
            }
            Operation::ToFloat(target) => Word::Float(target),
            _ => Word::Float(format),
        }
    }

    /// Does its result depend on the rounding?
    pub const fn rounds(self) -> bool {
        !matches!(
            self,
            Operation::Minimum | Operation::Maximum | Operation::Compare(..) | Operation::Floor
        )
    }

    /// The answer to these operands; those that it does not have are not read.
    #[inline]
    pub const fn evaluate(self, arithmetic: FloatArithmetic, [a, b, c]: [u64; 3]) -> Answer {
        match self {
            Operation::Add => arithmetic.add(a, b),
            Operation::Subtract => arithmetic.sub(a, b),
            Operation::Multiply => arithmetic.mul(a, b),
            Operation::Divide => arithmetic.div(a, b),
            Operation::SquareRoot => arithmetic.sqrt(a),
            Operation::FusedMultiplyAdd => arithmetic.fused_multiply_add(a, b, c),
            Operation::Minimum => arithmetic.min(a, b),
            Operation::Maximum => arithmetic.max(a, b),
            Operation::Compare(relation, comparison) => {
                let (holds, flags) = arithmetic.relation(relation, comparison, a, b);
                Answer {
                    bits: holds as u64,
                    flags,
                }
            }
            Operation::RoundToIntegral => arithmetic.round_to_integral(a),
            Operation::RoundToIntegralExact => arithmetic.round_to_integral_exact(a),
            Operation::Floor => arithmetic.floor(a),
            Operation::ToInteger(target) => arithmetic.to_integer(target, a),
            Operation::ToIntegerExact(target) => arithmetic.to_integer_exact(target, a),
            Operation::FromInteger(source) => arithmetic.from_integer(source, a),
            Operation::ToFloat(target) => arithmetic.convert_to(target, a),
            Operation::FromFloat(source) => source
                .arithmetic(arithmetic.policy, arithmetic.rounding)
                .convert_to(arithmetic.format, a),
        }
    }
}

impl fmt::Display for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Operation::Add => "add",
            Operation::Subtract => "sub",
            Operation::Multiply => "mul",
            Operation::Divide => "div",
            Operation::SquareRoot => "sqrt",
            Operation::FusedMultiplyAdd => "fused_multiply_add",
            Operation::Minimum => "min",
            Operation::Maximum => "max",
            Operation::RoundToIntegral => "round_to_integral",
            Operation::RoundToIntegralExact => "round_to_integral_exact",
            Operation::Floor => "floor",
            Operation::Compare(relation, comparison) => {
                return write!(f, "{relation}_{}", comparison.name());
            }
            Operation::ToInteger(target) => return write!(f, "to_{target}"),
            Operation::ToIntegerExact(target) => return write!(f, "to_{target}_exact"),
            Operation::FromInteger(source) => return write!(f, "from_{source}"),
            Operation::ToFloat(target) => return write!(f, "to_{target}"),
            Operation::FromFloat(source) => return write!(f, "from_{source}"),
        };
        f.write_str(name)
    }
}

impl FromStr for Operation {
    type Err = UnknownOperation;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let plain = Operation::PLAIN
            .into_iter()
            .find(|operation| operation.to_string() == text);
        let comparison = || {
            Comparison::ALL.into_iter().find_map(|comparison| {
                let name = text.strip_suffix(comparison.name())?.strip_suffix('_')?;
                let relation = Relation::ALL.into_iter().find(|one| one.name() == name)?;
                Some(Operation::Compare(relation, comparison))
            })
        };
        let conversion = || {
            if let Some(source) = text.strip_prefix("from_") {
                return match source.parse() {
                    Ok(source) => Some(Operation::FromInteger(source)),
                    Err(_) => source.parse().ok().map(Operation::FromFloat),
                };
            }
            let target = text.strip_prefix("to_")?;
            if let Some(target) = target.strip_suffix("_exact") {
                return target.parse().ok().map(Operation::ToIntegerExact);
            }
            match target.parse() {
                Ok(target) => Some(Operation::ToInteger(target)),
                Err(_) => target.parse().ok().map(Operation::ToFloat),
            }
        };
        let alias = || {
            let found = Operation::ALIASES.iter().find(|(name, _)| *name == text);
            found.map(|&(_, operation)| operation)
        };
        plain
            .or_else(alias)
            .or_else(comparison)
            .or_else(conversion)
            .ok_or_else(|| UnknownOperation(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        let mut all = Operation::PLAIN.to_vec();
        for comparison in Comparison::ALL {
            all.extend(Relation::ALL.map(|relation| Operation::Compare(relation, comparison)));
        }
        for integer in [IntegerFormat::I32, IntegerFormat::unsigned(1)] {
            all.extend([
                Operation::ToInteger(integer),
                Operation::ToIntegerExact(integer),
                Operation::FromInteger(integer),
            ]);
        }
        all.push(Operation::ToFloat(FloatFormat::E4F3));
        all.push(Operation::FromFloat(FloatFormat::E4F3));
        for operation in all {
            assert_eq!(operation.to_string().parse(), Ok(operation));
        }
    }

    #[test]
    fn aliases_are_no_names() {
        for (name, operation) in Operation::ALIASES {
            assert_eq!(name.parse(), Ok(operation));
            assert_ne!(operation.to_string(), name);
        }
    }

    #[test]
    fn an_unknown_name_comes_with_the_known_ones() {
        for text in [
            "",
            "plus",
            "less_than",
            "to_",
            "to_e99f1",
            "from_i32_exact",
            "to_e8f23_exact",
        ] {
            let message = text.parse::<Operation>().unwrap_err().to_string();
            assert!(message.contains("fused_multiply_add"), "{message}");
            assert!(message.contains("not_greater_equal"), "{message}");
        }
    }
}
