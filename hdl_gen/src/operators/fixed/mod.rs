//! Fixed-point operators as netlists: an exact result in as many bits as it takes, rounded, then
//! saturated or wrapped.
//!
//! Each operator forms its exact result, or enough of it and whether anything follows; one rounder
//! that all share cuts it at the result's last place ([`round`]), and one selector looks at the
//! range ([`fit`]). They know nothing of the golden arithmetic in `rtl_model::fixed`: the two are
//! compared in the tests.

mod align;
mod compare;
mod configuration;
mod fit;
mod float;
mod golden;
mod product;
mod quotient;
mod round;
mod shift;
mod sum;

use rtl_model::fixed::FixedFormat;
use rtl_model::float::{FloatFormat, Policy};

use super::UnsupportedOperator;
use super::round::Answer;
use crate::netlist::{Builder, Meaning};

pub use configuration::FixedConfiguration;

/// What a fixed-point operator computes. Operands and result each have a format of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FixedOperator {
    /// `result_o = a_i + b_i`
    Add,
    /// `result_o = a_i - b_i`
    Subtract,
    /// `result_o = a_i * b_i`
    Multiply,
    /// `result_o = a_i / b_i`
    Divide,
    /// `result_o = 1 / a_i`
    Reciprocal,
    /// `result_o = -a_i`
    Negate,
    /// `result_o = a_i`
    Convert,
    /// `result_o = a_i * 2^b_i`
    ShiftLeft {
        /// Bits of `b_i`, an unsigned integer; 1 to 6.
        amount_bits: u32,
    },
    /// `result_o = a_i / 2^b_i`
    ShiftRight {
        /// Bits of `b_i`, an unsigned integer; 1 to 6.
        amount_bits: u32,
    },
    /// The relations of `a_i` to `b_i`: `less_than_o`, `less_equal_o`, `equal_o`; the other three
    /// are these inverted.
    Compare,
    /// `result_o = a_i`, a float
    FromFloat {
        /// The format of `a_i`.
        source: FloatFormat,
        /// How its subnormal patterns are read.
        policy: Policy,
    },
    /// `result_o = a_i`, the result a float
    ToFloat {
        /// The format of `result_o`.
        target: FloatFormat,
        /// What becomes of a result below the smallest normal number.
        policy: Policy,
    },
}

impl FixedOperator {
    /// The operator's name, with which its module's name begins.
    pub const fn name(self) -> &'static str {
        match self {
            FixedOperator::Add => "fixed_add",
            FixedOperator::Subtract => "fixed_sub",
            FixedOperator::Multiply => "fixed_mul",
            FixedOperator::Divide => "fixed_div",
            FixedOperator::Reciprocal => "fixed_reciprocal",
            FixedOperator::Negate => "fixed_negate",
            FixedOperator::Convert => "fixed_convert",
            FixedOperator::ShiftLeft { .. } => "fixed_shift_left",
            FixedOperator::ShiftRight { .. } => "fixed_shift_right",
            FixedOperator::Compare => "fixed_cmp",
            FixedOperator::FromFloat { .. } => "fixed_from_float",
            FixedOperator::ToFloat { .. } => "fixed_to_float",
        }
    }

    /// Has it a number as its result, which is rounded?
    pub const fn rounds(self) -> bool {
        !matches!(self, FixedOperator::Compare)
    }

    /// Is that a fixed-point number, which is saturated or wrapped?
    pub const fn has_fixed_result(self) -> bool {
        !matches!(self, FixedOperator::Compare | FixedOperator::ToFloat { .. })
    }

    /// The golden function whose results it must give.
    const fn golden(self) -> &'static str {
        match self {
            FixedOperator::Add => "FixedArithmetic::add",
            FixedOperator::Subtract => "FixedArithmetic::sub",
            FixedOperator::Multiply => "FixedArithmetic::mul",
            FixedOperator::Divide => "FixedArithmetic::div",
            FixedOperator::Reciprocal => "FixedArithmetic::reciprocal",
            FixedOperator::Negate => "FixedArithmetic::negate",
            FixedOperator::Convert => "FixedArithmetic::convert",
            FixedOperator::ShiftLeft { .. } => "FixedArithmetic::shift_left",
            FixedOperator::ShiftRight { .. } => "FixedArithmetic::shift_right",
            FixedOperator::Compare => "Fixed::compare",
            FixedOperator::FromFloat { .. } => "FixedArithmetic::from_float",
            FixedOperator::ToFloat { .. } => "Fixed::to_float",
        }
    }

    /// The formula of the header comment.
    const fn formula(self) -> &'static str {
        match self {
            FixedOperator::Add => "result_o = a_i + b_i",
            FixedOperator::Subtract => "result_o = a_i - b_i",
            FixedOperator::Multiply => "result_o = a_i * b_i",
            FixedOperator::Divide => "result_o = a_i / b_i",
            FixedOperator::Reciprocal => "result_o = 1 / a_i",
            FixedOperator::Negate => "result_o = -a_i",
            FixedOperator::Convert => "result_o = a_i",
            FixedOperator::FromFloat { .. } => "result_o = a_i, a float; 0 of a NaN",
            FixedOperator::ToFloat { .. } => "result_o = a_i, the result a float",
            FixedOperator::ShiftLeft { .. } => "result_o = a_i * 2^b_i",
            FixedOperator::ShiftRight { .. } => "result_o = a_i / 2^b_i",
            FixedOperator::Compare => "relations of a_i to b_i",
        }
    }
}

/// Ports and logic.
fn build(builder: &mut Builder, configuration: FixedConfiguration) {
    let answer: Answer = match configuration.operator {
        FixedOperator::Add => sum::add(builder, configuration, false),
        FixedOperator::Subtract => sum::add(builder, configuration, true),
        FixedOperator::Negate => sum::negate(builder, configuration),
        FixedOperator::Convert => sum::convert(builder, configuration),
        FixedOperator::Multiply => product::multiply(builder, configuration),
        FixedOperator::Divide => quotient::divide(builder, configuration),
        FixedOperator::Reciprocal => quotient::reciprocal(builder, configuration),
        FixedOperator::ShiftLeft { amount_bits } => {
            shift::shift_left(builder, configuration, amount_bits)
        }
        FixedOperator::ShiftRight { amount_bits } => {
            shift::shift_right(builder, configuration, amount_bits)
        }
        FixedOperator::Compare => {
            compare::compare(builder, configuration);
            return;
        }
        FixedOperator::FromFloat { source, policy } => {
            float::from_float(builder, configuration, source, policy)
        }
        FixedOperator::ToFloat { target, policy } => {
            float::to_float(builder, configuration, target, policy)
        }
    };
    builder.name(answer.result, "result");
    builder.mean(answer.result, configuration.result_meaning());
    builder.output("result_o", answer.result);
    if let Some(flags) = answer.flags {
        builder.output("flags_o", flags);
    }
}

/// An operand's port.
fn operand(builder: &mut Builder, name: &str, format: FixedFormat) -> crate::netlist::Wire {
    let wire = builder.input(name, format.width());
    builder.mean(wire, Meaning::Fixed(format))
}

/// Is a word of this many bits one that the netlist has?
fn word_fits(
    operator: FixedOperator,
    word: &'static str,
    width: u32,
) -> Result<(), UnsupportedOperator> {
    if width <= 64 {
        Ok(())
    } else {
        Err(UnsupportedOperator::WordTooWide {
            operator: operator.name(),
            word,
            width,
        })
    }
}
