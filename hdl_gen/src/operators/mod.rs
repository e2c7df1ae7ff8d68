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
mod convert;
mod denormalise;
mod divide;
mod early_exponent;
mod fixed;
mod golden;
mod height;
mod integer;
mod integral;
mod multiply;
mod normalise;
mod pack;
mod product_alignment;
mod round;
mod select;
mod shift;
mod significand_product;
mod square_root;
mod stream;
mod unpack;

use rtl_model::float::{Flags, FloatFormat, IntegerFormat, Rounding};

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
    /// `result_o` = the square root of `a_i`.
    SquareRoot,
    /// `result_o` = the smaller of `a_i` and `b_i`; the other where one is NaN.
    Minimum,
    /// `result_o` = the larger of `a_i` and `b_i`; the other where one is NaN.
    Maximum,
    /// All relations of `a_i` to `b_i`: `less_than_o`, `less_equal_o`, `equal_o`, `unordered_o`.
    /// Its flags are those of the quiet predicates: only a signalling NaN is invalid.
    Compare,
    /// The same relations, with the flags of the signalling predicates: any NaN is invalid.
    CompareSignalling,
    /// `result_o = a_i < b_i`, false where either is NaN; its flags signal.
    LessThan,
    /// `result_o = a_i <= b_i`, false where either is NaN; its flags signal.
    LessEqual,
    /// `result_o = a_i * 2^b_i`, both two's complement.
    FromInteger {
        /// Bits of `a_i`, 2 to 64.
        value_bits: u32,
        /// Bits of `b_i`, 1 to 16.
        exponent_bits: u32,
    },
    /// `result_o = a_i`, which is a two's complement integer.
    FromSigned {
        /// Bits of `a_i`, 2 to 64.
        bits: u32,
    },
    /// `result_o = a_i`, which is an unsigned integer.
    FromUnsigned {
        /// Bits of `a_i`, 2 to 64.
        bits: u32,
    },
    /// `result_o` = `a_i` as a two's complement integer, saturated; 0 for NaN.
    ToInteger {
        /// Bits of `result_o`, 2 to 63.
        bits: u32,
    },
    /// `result_o` = `a_i` as an unsigned integer, saturated; 0 for NaN.
    ToUnsigned {
        /// Bits of `result_o`, 2 to 63.
        bits: u32,
    },
    /// `result_o` = `a_i` as a float of another format.
    Convert {
        /// The format of `result_o`.
        target: FloatFormat,
    },
    /// `result_o` = the integer that `a_i` rounds to, as a float; the flag inexact says whether it
    /// is another number.
    RoundToIntegral,
    /// `result_o` = the largest integer not above `a_i`, as a float; never inexact.
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
    /// `result_o` = `1 - a_i / (2^bits - 1)` rounded toward zero.
    DepthFromHeight {
        /// Bits of `a_i`: 8 or 16 (any from 2 to 32 works).
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
            FloatOperator::SquareRoot => "float_sqrt",
            FloatOperator::Minimum => "float_min",
            FloatOperator::Maximum => "float_max",
            FloatOperator::Compare => "float_cmp",
            FloatOperator::CompareSignalling => "float_cmp_signalling",
            FloatOperator::LessThan => "float_less_than",
            FloatOperator::LessEqual => "float_less_equal",
            FloatOperator::FromInteger { .. } => "float_from_integer",
            FloatOperator::FromSigned { .. } => "float_from_signed",
            FloatOperator::FromUnsigned { .. } => "float_from_unsigned",
            FloatOperator::ToInteger { .. } => "float_to_integer",
            FloatOperator::ToUnsigned { .. } => "float_to_unsigned",
            FloatOperator::Convert { .. } => "float_convert",
            FloatOperator::RoundToIntegral => "float_round_to_integral",
            FloatOperator::Floor => "float_floor",
            FloatOperator::UlpsUp { .. } => "float_ulps_up",
            FloatOperator::ExactBelow => "float_exact_below",
            FloatOperator::DepthFromHeight { .. } => "depth_from_height",
        }
    }

    /// Are its operands floats, and not integers?
    pub const fn takes_floats(self) -> bool {
        !matches!(
            self,
            FloatOperator::FromInteger { .. }
                | FloatOperator::FromSigned { .. }
                | FloatOperator::FromUnsigned { .. }
                | FloatOperator::DepthFromHeight { .. }
        )
    }

    /// Does its result depend on the rounding?
    pub const fn rounds(self) -> bool {
        matches!(
            self,
            FloatOperator::Add
                | FloatOperator::Subtract
                | FloatOperator::Multiply
                | FloatOperator::Divide
                | FloatOperator::SquareRoot
                | FloatOperator::FromInteger { .. }
                | FloatOperator::FromSigned { .. }
                | FloatOperator::FromUnsigned { .. }
                | FloatOperator::ToInteger { .. }
                | FloatOperator::ToUnsigned { .. }
                | FloatOperator::Convert { .. }
                | FloatOperator::RoundToIntegral
        )
    }

    /// The parameters of its own, as they stand in its module's name; empty where it has none.
    fn parameters(self) -> String {
        match self {
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => format!("_v{value_bits}x{exponent_bits}"),
            FloatOperator::ToInteger { bits } | FloatOperator::FromSigned { bits } => {
                format!("_i{bits}")
            }
            FloatOperator::ToUnsigned { bits } | FloatOperator::FromUnsigned { bits } => {
                format!("_u{bits}")
            }
            FloatOperator::Convert { target } => format!("_to_{target}"),
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
            FloatOperator::FromSigned { bits } | FloatOperator::FromUnsigned { bits } => {
                in_range("bits", bits, 2, 64)?;
            }
            FloatOperator::ToInteger { bits } | FloatOperator::ToUnsigned { bits } => {
                in_range("bits", bits, 2, 63)?;
            }
            FloatOperator::Convert { target } if target.fraction_bits > MAX_FRACTION_BITS => {
                let format = target;
                return Err(UnsupportedOperator::FractionTooWide { operator, format });
            }
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
            FloatOperator::SquareRoot => "sqrt",
            FloatOperator::Minimum => "min",
            FloatOperator::Maximum => "max",
            FloatOperator::Compare | FloatOperator::CompareSignalling => "compare",
            FloatOperator::LessThan => "less_than",
            FloatOperator::LessEqual => "less_equal",
            FloatOperator::FromInteger { .. } => "from_scaled_integer",
            FloatOperator::FromSigned { .. } | FloatOperator::FromUnsigned { .. } => "from_integer",
            FloatOperator::ToInteger { .. } | FloatOperator::ToUnsigned { .. } => {
                "to_integer_exact"
            }
            FloatOperator::Convert { .. } => "convert_to",
            FloatOperator::RoundToIntegral => "round_to_integral_exact",
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
            FloatOperator::SquareRoot => "result_o = the square root of a_i".to_owned(),
            FloatOperator::Minimum => {
                "result_o = the smaller of a_i and b_i, the number where one is NaN".to_owned()
            }
            FloatOperator::Maximum => {
                "result_o = the larger of a_i and b_i, the number where one is NaN".to_owned()
            }
            FloatOperator::Compare => {
                "relations of a_i to b_i; unordered_o where either is NaN".to_owned()
            }
            FloatOperator::CompareSignalling => {
                "relations of a_i to b_i; unordered_o where either is NaN, which is invalid"
                    .to_owned()
            }
            FloatOperator::LessThan => "result_o = a_i < b_i; 0 where either is NaN".to_owned(),
            FloatOperator::LessEqual => "result_o = a_i <= b_i; 0 where either is NaN".to_owned(),
            FloatOperator::FromInteger { .. } => {
                "result_o = a_i * 2^b_i, both two's complement".to_owned()
            }
            FloatOperator::FromSigned { .. } => {
                "result_o = a_i, a two's complement integer".to_owned()
            }
            FloatOperator::FromUnsigned { .. } => "result_o = a_i, an unsigned integer".to_owned(),
            FloatOperator::ToInteger { .. } => {
                "result_o = a_i as a two's complement integer, saturated; 0 for NaN".to_owned()
            }
            FloatOperator::ToUnsigned { .. } => {
                "result_o = a_i as an unsigned integer, saturated; 0 for NaN".to_owned()
            }
            FloatOperator::Convert { target } => format!("result_o = a_i in {target}"),
            FloatOperator::RoundToIntegral => {
                "result_o = the integer that a_i rounds to, as a float".to_owned()
            }
            FloatOperator::Floor => "result_o = the largest integer not above a_i".to_owned(),
            FloatOperator::UlpsUp { ulps } => {
                format!("result_o = a_i moved up by {ulps} units in the last place; a_i >= 0")
            }
            FloatOperator::ExactBelow => {
                "result_o = below this power of two differences with a_i are exact".to_owned()
            }
            FloatOperator::DepthFromHeight { bits } => {
                format!("result_o = 1 - a_i / (2^{bits} - 1), rounded toward zero")
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
        has_flags,
        ..
    } = configuration;
    let float = |answer| (answer, Meaning::Float(format));
    // Of operators whose results raise no flag.
    let silent = |builder: &mut Builder, result| round::Answer {
        result,
        flags: has_flags.then(|| builder.constant(0, Flags::WIDTH)),
    };
    let (answer, meaning) = match operator {
        FloatOperator::Add => float(add::add(builder, configuration, false)),
        FloatOperator::Subtract => float(add::add(builder, configuration, true)),
        FloatOperator::Multiply => float(multiply::multiply(builder, configuration)),
        FloatOperator::Divide => float(divide::divide(builder, configuration)),
        FloatOperator::SquareRoot => float(square_root::square_root(builder, configuration)),
        FloatOperator::Minimum => {
            let which = select::Extreme::Minimum;
            float(select::extreme(builder, configuration, which))
        }
        FloatOperator::Maximum => {
            let which = select::Extreme::Maximum;
            float(select::extreme(builder, configuration, which))
        }
        FloatOperator::Compare | FloatOperator::CompareSignalling => {
            let signals = operator == FloatOperator::CompareSignalling;
            compare::compare(builder, configuration, signals);
            mark_float_inputs(builder, configuration);
            return;
        }
        FloatOperator::LessThan => (
            compare::less(builder, configuration, compare::Order::LessThan),
            Meaning::Bits,
        ),
        FloatOperator::LessEqual => (
            compare::less(builder, configuration, compare::Order::LessEqual),
            Meaning::Bits,
        ),
        FloatOperator::FromInteger {
            value_bits,
            exponent_bits,
        } => {
            let source = IntegerFormat::signed(value_bits);
            let exponent_bits = Some(exponent_bits);
            float(integer::from_integer(
                builder,
                configuration,
                source,
                exponent_bits,
            ))
        }
        FloatOperator::FromSigned { bits } => {
            let source = IntegerFormat::signed(bits);
            float(integer::from_integer(builder, configuration, source, None))
        }
        FloatOperator::FromUnsigned { bits } => {
            let source = IntegerFormat::unsigned(bits);
            float(integer::from_integer(builder, configuration, source, None))
        }
        FloatOperator::ToInteger { bits } => {
            let target = IntegerFormat::signed(bits);
            let answer = integer::to_integer(builder, configuration, target);
            (answer, Meaning::Signed)
        }
        FloatOperator::ToUnsigned { bits } => {
            let target = IntegerFormat::unsigned(bits);
            let answer = integer::to_integer(builder, configuration, target);
            (answer, Meaning::Bits)
        }
        FloatOperator::Convert { target } => (
            convert::convert(builder, configuration, target),
            Meaning::Float(target),
        ),
        FloatOperator::RoundToIntegral => float(integral::round_to_integral(
            builder,
            configuration,
            rounding,
            true,
        )),
        FloatOperator::Floor => float(integral::round_to_integral(
            builder,
            configuration,
            Rounding::Down,
            false,
        )),
        FloatOperator::UlpsUp { ulps } => {
            let result = height::ulps_up(builder, configuration, ulps);
            float(silent(builder, result))
        }
        FloatOperator::ExactBelow => {
            let result = height::exact_below(builder, configuration);
            float(silent(builder, result))
        }
        FloatOperator::DepthFromHeight { bits } => {
            let result = height::depth(builder, configuration, bits);
            float(silent(builder, result))
        }
    };
    builder.name(answer.result, "result");
    builder.mean(answer.result, meaning);
    builder.output("result_o", answer.result);
    if let Some(flags) = answer.flags {
        builder.output("flags_o", flags);
    }
    mark_float_inputs(builder, configuration);
}

/// Marks the operands that are floats as such, for waveforms.
fn mark_float_inputs(builder: &mut Builder, configuration: OperatorConfiguration) {
    if !configuration.operator.takes_floats() {
        return;
    }
    for name in ["a_i", "b_i"] {
        let operand: Option<Wire> = builder.module().input(name);
        if let Some(operand) = operand {
            builder.mean(operand, Meaning::Float(configuration.format));
        }
    }
}
