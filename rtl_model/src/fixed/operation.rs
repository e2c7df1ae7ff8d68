//! Every operation with its name, so that it can be chosen at run time.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::{Fixed, FixedArithmetic, FixedFormat};
use crate::float::{Answer, Flags, FloatFormat, Policy, UnknownFloatFormat};

/// The relations of two fixed-point numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FixedRelation {
    /// a < b
    LessThan,
    /// a <= b
    LessEqual,
    /// a = b
    Equal,
    /// a <> b
    NotEqual,
    /// a >= b
    GreaterEqual,
    /// a > b
    GreaterThan,
}

impl FixedRelation {
    /// All six, in the order of the documentation.
    pub const ALL: [FixedRelation; 6] = [
        FixedRelation::LessThan,
        FixedRelation::LessEqual,
        FixedRelation::Equal,
        FixedRelation::NotEqual,
        FixedRelation::GreaterEqual,
        FixedRelation::GreaterThan,
    ];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            FixedRelation::LessThan => "less_than",
            FixedRelation::LessEqual => "less_equal",
            FixedRelation::Equal => "equal",
            FixedRelation::NotEqual => "not_equal",
            FixedRelation::GreaterEqual => "greater_equal",
            FixedRelation::GreaterThan => "greater_than",
        }
    }

    /// Does it hold between numbers of this order?
    pub const fn holds(self, order: Ordering) -> bool {
        match self {
            FixedRelation::LessThan => order.is_lt(),
            FixedRelation::LessEqual => order.is_le(),
            FixedRelation::Equal => order.is_eq(),
            FixedRelation::NotEqual => order.is_ne(),
            FixedRelation::GreaterEqual => order.is_ge(),
            FixedRelation::GreaterThan => order.is_gt(),
        }
    }
}

/// An operation of [`FixedArithmetic`]; its name is that of the method, followed by what its
/// operands do not tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FixedOperation {
    /// `add`: a + b.
    Add,
    /// `sub`: a - b.
    Subtract,
    /// `mul`: a * b.
    Multiply,
    /// `div`: a / b.
    Divide,
    /// `reciprocal`: 1 / a.
    Reciprocal,
    /// `negate`: -a.
    Negate,
    /// `convert`: a in the format of the result.
    Convert,
    /// `shift_left`: a * 2^b; b is an unsigned integer.
    ShiftLeft,
    /// `shift_right`: a / 2^b; b is an unsigned integer.
    ShiftRight,
    /// Such as `less_than`: 1 where a stands in this relation to b, else 0.
    Compare(FixedRelation),
    /// Such as `from_e7f16`: the fixed-point number of a float.
    FromFloat(FloatFormat),
    /// Such as `to_e7f16`: a as a float.
    ToFloat(FloatFormat),
}

/// Why a text names no operation on fixed-point numbers.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "unknown operator `{0}`: of fixed-point numbers there are {plain}, and to_X and from_X with a \
     float format X such as e7f16",
    plain = FixedOperation::plain().map(|operation| operation.to_string()).join(", ")
)]
pub struct UnknownFixedOperation(pub String);

impl FixedOperation {
    /// Those without a parameter, in the order of the documentation.
    pub fn plain() -> [FixedOperation; 15] {
        let [lt, le, eq, ne, ge, gt] = FixedRelation::ALL.map(FixedOperation::Compare);
        [
            FixedOperation::Add,
            FixedOperation::Subtract,
            FixedOperation::Multiply,
            FixedOperation::Divide,
            FixedOperation::Reciprocal,
            FixedOperation::Negate,
            FixedOperation::Convert,
            FixedOperation::ShiftLeft,
            FixedOperation::ShiftRight,
            lt,
            le,
            eq,
            ne,
            ge,
            gt,
        ]
    }

    /// How many operands it has, 1 or 2.
    pub const fn operands(self) -> usize {
        match self {
            FixedOperation::Add
            | FixedOperation::Subtract
            | FixedOperation::Multiply
            | FixedOperation::Divide
            | FixedOperation::ShiftLeft
            | FixedOperation::ShiftRight
            | FixedOperation::Compare(_) => 2,
            FixedOperation::Reciprocal
            | FixedOperation::Negate
            | FixedOperation::Convert
            | FixedOperation::FromFloat(_)
            | FixedOperation::ToFloat(_) => 1,
        }
    }

    /// The answer to these operands, words of the formats `a_format` and `b_format`; the second is
    /// not read where there is none, and is any integer where it is a distance. A comparison and a
    /// conversion to a float do not look at the result's format, and only conversions from and to
    /// floats at the policy.
    pub fn evaluate(
        self,
        arithmetic: FixedArithmetic,
        policy: Policy,
        (a_format, b_format): (FixedFormat, FixedFormat),
        [a_word, b_word]: [u64; 2],
    ) -> Answer {
        let a = Fixed::new(a_format, a_word);
        let b = Fixed::new(b_format, b_word);
        let places = u32::try_from(b_word).unwrap_or(u32::MAX);
        let (result, flags) = match self {
            FixedOperation::Add => arithmetic.add(a, b),
            FixedOperation::Subtract => arithmetic.sub(a, b),
            FixedOperation::Multiply => arithmetic.mul(a, b),
            FixedOperation::Divide => arithmetic.div(a, b),
            FixedOperation::Reciprocal => arithmetic.reciprocal(a),
            FixedOperation::Negate => arithmetic.negate(a),
            FixedOperation::Convert => arithmetic.convert(a),
            FixedOperation::ShiftLeft => arithmetic.shift_left(a, places),
            FixedOperation::ShiftRight => arithmetic.shift_right(a, places),
            FixedOperation::Compare(relation) => {
                return Answer {
                    bits: relation.holds(a.compare(b)).into(),
                    flags: Flags::NONE,
                };
            }
            FixedOperation::FromFloat(source) => arithmetic.from_float(source, policy, a_word),
            FixedOperation::ToFloat(target) => {
                return a.to_float(target.arithmetic(policy, arithmetic.rounding));
            }
        };
        Answer {
            bits: result.bits,
            flags,
        }
    }
}

impl fmt::Display for FixedOperation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FixedOperation::Add => "add",
            FixedOperation::Subtract => "sub",
            FixedOperation::Multiply => "mul",
            FixedOperation::Divide => "div",
            FixedOperation::Reciprocal => "reciprocal",
            FixedOperation::Negate => "negate",
            FixedOperation::Convert => "convert",
            FixedOperation::ShiftLeft => "shift_left",
            FixedOperation::ShiftRight => "shift_right",
            FixedOperation::Compare(relation) => relation.name(),
            FixedOperation::FromFloat(source) => return write!(f, "from_{source}"),
            FixedOperation::ToFloat(target) => return write!(f, "to_{target}"),
        })
    }
}

impl FromStr for FixedOperation {
    type Err = UnknownFixedOperation;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let plain = FixedOperation::plain()
            .into_iter()
            .find(|operation| operation.to_string() == text);
        let conversion = || -> Result<FixedOperation, UnknownFloatFormat> {
            if let Some(source) = text.strip_prefix("from_") {
                source.parse().map(FixedOperation::FromFloat)
            } else {
                let target = text.strip_prefix("to_").unwrap_or_default();
                target.parse().map(FixedOperation::ToFloat)
            }
        };
        match plain {
            Some(operation) => Ok(operation),
            None => conversion().map_err(|_| UnknownFixedOperation(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        let conversions = [
            FixedOperation::FromFloat(FloatFormat::E7F16),
            FixedOperation::ToFloat(FloatFormat::E4F3),
        ];
        for operation in FixedOperation::plain().into_iter().chain(conversions) {
            assert_eq!(operation.to_string().parse(), Ok(operation));
        }
        for text in ["", "plus", "to_", "from_q4.4", "sqrt"] {
            let message = text.parse::<FixedOperation>().unwrap_err().to_string();
            assert!(message.contains("shift_left"), "{message}");
            assert!(message.contains("greater_than"), "{message}");
        }
    }
}
