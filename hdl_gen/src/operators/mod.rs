//! Float operators as netlists: unpack, exact raw result, one rounder.
//!
//! The structure is that of Berkeley HardFloat (Hauser): every operator forms a result that is
//! exact but for a sticky bit, and the rounder that all share makes a float of it. The operators
//! know nothing of the golden arithmetic in `rtl_model::float`: the two are compared in the tests.
//!
//! Numbers follow the flush policy: a subnormal operand is a zero of its sign; a result is rounded
//! as if the exponent had no lower end and becomes a zero of its sign if it is then below the
//! smallest normal number. Every NaN result is [`FloatFormat::quiet_nan`].
//!
//! An [`OperatorConfiguration`] gives any of them in any latency; [`stream_unit`] puts a `valid`/`ready`
//! handshake around one.

mod add;
mod any;
mod compare;
mod configuration;
mod denormalise;
mod divide;
mod early_exponent;
mod fixed;
mod golden;
mod height;
mod integer;
mod multiply;
mod normalise;
mod pack;
mod product_alignment;
mod round;
mod shift;
mod significand_product;
mod stream;
mod unpack;

use rtl_model::float::FloatFormat;

use crate::netlist::{Builder, Meaning, Wire};

pub use any::AnyOperator;
pub use configuration::{Multiplier, OperatorConfiguration, Radix, Structure};
pub use fixed::{FixedConfiguration, FixedOperator};
pub(crate) use stream::CORE_INSTANCE;
pub use stream::stream_unit;

/// The widest fraction the operators take: a product of two significands must fit a word.
pub const MAX_FRACTION_BITS: u32 = 31;

/// What an operator computes, with the parameters that are neither format nor rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FloatOperator {
    /// `result_o = a_i + b_i`
    Add,
    /// `result_o = a_i - b_i`
    Subtract,
    /// `result_o = a_i * b_i`
    Multiply,
    /// `result_o = a_i / b_i`
    Divide,
    /// All relations of `a_i` to `b_i`: `less_than_o`, `less_equal_o`, `equal_o`, `unordered_o`.
    Compare,
    /// `result_o = a_i < b_i`, false where either is NaN.
    LessThan,
    /// `result_o = a_i <= b_i`, false where either is NaN.
    LessEqual,
    /// `result_o = value_i * 2^exponent_i`, both two's complement.
    FromInteger {
        /// Bits of `value_i`, 2 to 64.
        value_bits: u32,
        /// Bits of `exponent_i`, 1 to 16.
        exponent_bits: u32,
    },
    /// `result_o` = `a_i` as a two's complement integer, saturated; 0 for NaN.
    ToInteger {
        /// Bits of `result_o`, 2 to 63.
        bits: u32,
    },
    /// `result_o` = the largest integer not above `a_i`, as a float.
    Floor,
    /// `result_o` = the float `ulps` patterns above `a_i`, which must not be negative (its sign is
    /// not looked at): infinity where there is none, zero where that is a subnormal pattern, the
    /// quiet NaN of a NaN.
    UlpsUp {
        /// The distance in units in the last place.
        ulps: u32,
    },
    /// `result_o` = the power of two below which every multiple of the weight of `a_i`'s last
    /// nonzero significand bit is representable; infinity for zero, infinity and NaN, and where it
    /// is out of range.
    ExactBelow,
    /// `result_o` = `1 - height_i / (2^bits - 1)` rounded toward zero.
    DepthFromHeight {
        /// Bits of `height_i`: 8 or 16 (any from 2 to 32 works).
        bits: u32,
    },
}

/// Why an operator does not exist in a format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnsupportedOperator {
    /// The significands are too wide.
    #[error(
        "{operator} in {format}: {} fraction bits are too many for its words; use at most {MAX_FRACTION_BITS}",
        format.fraction_bits
    )]
    FractionTooWide {
        /// The operator's name.
        operator: &'static str,
        /// The format asked for.
        format: FloatFormat,
    },
    /// A word of it is wider than the netlist has.
    #[error(
        "{operator}: its {word} would have {width} bits; 64 are the most: use narrower formats"
    )]
    WordTooWide {
        /// The operator's name.
        operator: &'static str,
        /// Which word.
        word: &'static str,
        /// Its bits.
        width: u32,
    },
    /// A width of the operator's own is out of range.
    #[error("{operator}: {parameter} of {width} bits; use {least} to {most}")]
    WidthOutOfRange {
        /// The operator's name.
        operator: &'static str,
        /// The parameter's name.
        parameter: &'static str,
        /// Its value.
        width: u32,
        /// The least allowed.
        least: u32,
        /// The most allowed.
        most: u32,
    },
}

impl FloatOperator {
    /// The operator's name, with which its module's name begins.
    pub const fn name(self) -> &'static str {
        match self {
            FloatOperator::Add => "float_add",
            FloatOperator::Subtract => "float_sub",
            FloatOperator::Multiply => "float_mul",
            FloatOperator::Divide => "float_div",
            FloatOperator::Compare => "float_cmp",
            FloatOperator::LessThan => "float_less_than",
            FloatOperator::LessEqual => "float_less_equal",
            FloatOperator::FromInteger { .. } => "float_from_integer",
            FloatOperator::ToInteger { .. } => "float_to_integer",
            FloatOperator::Floor => "float_floor",
            FloatOperator::UlpsUp { .. } => "float_ulps_up",
            FloatOperator::ExactBelow => "float_exact_below",
            FloatOperator::DepthFromHeight { .. } => "depth_from_height",
        }
    }

    /// Does its result depend on the rounding?
    pub const fn rounds(self) -> bool {
        matches!(
            self,
            FloatOperator::Add
                | FloatOperator::Subtract
                | FloatOperator::Multiply
                | FloatOperator::Divide
                | FloatOperator::FromInteger { .. }
                | FloatOperator::ToInteger { .. }
        )
    }

    /// The parameters of its own, as they stand in its module's name; empty where it has none.
    fn parameters(self) -> String {
        match self {
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => format!("_v{value_bits}x{exponent_bits}"),
            FloatOperator::ToInteger { bits } => format!("_i{bits}"),
            FloatOperator::UlpsUp { ulps } => format!("_u{ulps}"),
            FloatOperator::DepthFromHeight { bits } => format!("_h{bits}"),
            _ => String::new(),
        }
    }

    /// Can it be built in this format?
    ///
    /// # Errors
    /// If a word of it would be wider than 64 bits, or a parameter is out of its range.
    pub fn check(self, format: FloatFormat) -> Result<(), UnsupportedOperator> {
        let operator = self.name();
        let in_range = |parameter, width: u32, least, most| {
            if (least..=most).contains(&width) {
                Ok(())
            } else {
                Err(UnsupportedOperator::WidthOutOfRange {
                    operator,
                    parameter,
                    width,
                    least,
                    most,
                })
            }
        };
        match self {
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => {
                in_range("value_bits", value_bits, 2, 64)?;
                in_range("exponent_bits", exponent_bits, 1, 16)?;
            }
            FloatOperator::ToInteger { bits } => in_range("bits", bits, 2, 63)?,
            FloatOperator::DepthFromHeight { bits } => in_range("bits", bits, 2, 32)?,
            _ => {}
        }
        if format.fraction_bits > MAX_FRACTION_BITS {
            return Err(UnsupportedOperator::FractionTooWide { operator, format });
        }
        Ok(())
    }

    /// The golden function whose results it must give.
    const fn golden(self) -> &'static str {
        match self {
            FloatOperator::Add => "add",
            FloatOperator::Subtract => "sub",
            FloatOperator::Multiply => "mul",
            FloatOperator::Divide => "div",
            FloatOperator::Compare => "compare",
            FloatOperator::LessThan => "less_than",
            FloatOperator::LessEqual => "less_equal",
            FloatOperator::FromInteger { .. } => "from_integer",
            FloatOperator::ToInteger { .. } => "to_integer",
            FloatOperator::Floor => "floor",
            FloatOperator::UlpsUp { .. } => "ulps_up",
            FloatOperator::ExactBelow => "exact_below",
            FloatOperator::DepthFromHeight { .. } => "depth_from_height",
        }
    }

    /// The formula of the header comment.
    fn formula(self) -> String {
        match self {
            FloatOperator::Add => "result_o = a_i + b_i".to_owned(),
            FloatOperator::Subtract => "result_o = a_i - b_i".to_owned(),
            FloatOperator::Multiply => "result_o = a_i * b_i".to_owned(),
            FloatOperator::Divide => "result_o = a_i / b_i".to_owned(),
            FloatOperator::Compare => {
                "relations of a_i to b_i; unordered_o where either is NaN".to_owned()
            }
            FloatOperator::LessThan => "result_o = a_i < b_i; 0 where either is NaN".to_owned(),
            FloatOperator::LessEqual => "result_o = a_i <= b_i; 0 where either is NaN".to_owned(),
            FloatOperator::FromInteger { .. } => {
                "result_o = value_i * 2^exponent_i, both two's complement".to_owned()
            }
            FloatOperator::ToInteger { .. } => {
                "result_o = a_i as a two's complement integer, saturated; 0 for NaN".to_owned()
            }
            FloatOperator::Floor => "result_o = the largest integer not above a_i".to_owned(),
            FloatOperator::UlpsUp { ulps } => {
                format!("result_o = a_i moved up by {ulps} units in the last place; a_i >= 0")
            }
            FloatOperator::ExactBelow => {
                "result_o = below this power of two differences with a_i are exact".to_owned()
            }
            FloatOperator::DepthFromHeight { bits } => {
                format!("result_o = 1 - height_i / (2^{bits} - 1), rounded toward zero")
            }
        }
    }
}

/// Ports and logic.
fn build(builder: &mut Builder, configuration: OperatorConfiguration) {
    let OperatorConfiguration {
        operator,
        format,
        rounding,
        ..
    } = configuration;
    let float = |answer| (answer, Meaning::Float(format));
    let exact = |result| round::Answer {
        result,
        flags: None,
    };
    let (answer, meaning) = match operator {
        FloatOperator::Add => float(add::add(builder, configuration, false)),
        FloatOperator::Subtract => float(add::add(builder, configuration, true)),
        FloatOperator::Multiply => float(multiply::multiply(builder, configuration)),
        FloatOperator::Divide => float(divide::divide(builder, configuration)),
        FloatOperator::Compare => {
            compare::compare(builder, format);
            mark_float_inputs(builder, format);
            return;
        }
        FloatOperator::LessThan => (
            exact(compare::less(builder, format, compare::Order::LessThan)),
            Meaning::Bits,
        ),
        FloatOperator::LessEqual => (
            exact(compare::less(builder, format, compare::Order::LessEqual)),
            Meaning::Bits,
        ),
        FloatOperator::FromInteger {
            value_bits,
            exponent_bits,
        } => float(integer::from_integer(
            builder,
            configuration,
            value_bits,
            exponent_bits,
        )),
        FloatOperator::ToInteger { bits } => (
            exact(integer::to_integer(builder, format, rounding, bits)),
            Meaning::Signed,
        ),
        FloatOperator::Floor => float(exact(integer::floor(builder, format))),
        FloatOperator::UlpsUp { ulps } => float(exact(height::ulps_up(builder, format, ulps))),
        FloatOperator::ExactBelow => float(exact(height::exact_below(builder, format))),
        FloatOperator::DepthFromHeight { bits } => {
            float(exact(height::depth(builder, format, bits)))
        }
    };
    builder.name(answer.result, "result");
    builder.mean(answer.result, meaning);
    builder.output("result_o", answer.result);
    if let Some(flags) = answer.flags {
        builder.output("flags_o", flags);
    }
    mark_float_inputs(builder, format);
}

/// Marks the operands `a_i` and `b_i`, where there are such, as floats for waveforms.
fn mark_float_inputs(builder: &mut Builder, format: FloatFormat) {
    for name in ["a_i", "b_i"] {
        let operand: Option<Wire> = builder.module().input(name);
        if let Some(operand) = operand {
            builder.mean(operand, Meaning::Float(format));
        }
    }
}
