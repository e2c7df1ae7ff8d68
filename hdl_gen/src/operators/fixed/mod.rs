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
mod golden;
mod product;
mod quotient;
mod round;
mod shift;
mod sum;

use rtl_model::fixed::FixedFormat;

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
        }
    }

    /// Has it a number as its result, which is rounded and may be beyond the range?
    pub const fn has_result(self) -> bool {
        !matches!(self, FixedOperator::Compare)
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
    };
    builder.name(answer.result, "result");
    builder.mean(answer.result, Meaning::Fixed(configuration.result));
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
