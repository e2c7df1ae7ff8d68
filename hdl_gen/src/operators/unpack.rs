//! Taking a float operand apart: fields and special cases.

use rtl_model::float::{FloatFormat, Policy};

use super::shift::leading_zeros;
use crate::netlist::{Builder, Wire};

/// The three fields of an operand.
pub(super) struct Fields {
    /// One bit.
    pub sign: Wire,
    /// The biased exponent.
    pub exponent: Wire,
    /// The bits after the binary point; the one before it is implied.
    pub fraction: Wire,
}

/// Cuts an operand into its fields, named after the operand.
pub(super) fn fields(
    builder: &mut Builder,
    format: FloatFormat,
    operand: Wire,
    name: &str,
) -> Fields {
    let (width, fraction_bits) = (format.width(), format.fraction_bits);
    let sign = builder.bit(operand, width - 1);
    let exponent = builder.slice(operand, width - 2, fraction_bits);
    let fraction = builder.slice(operand, fraction_bits - 1, 0);
    Fields {
        sign: builder.name(sign, format!("{name}_sign")),
        exponent: builder.name(exponent, format!("{name}_exponent")),
        fraction: builder.name(fraction, format!("{name}_fraction")),
    }
}

/// Has it an exponent field other than 0? What has not is a zero under the policy flush, and a zero
/// or a subnormal number under full.
pub(super) fn exponent_nonzero(builder: &mut Builder, operand: &Fields, name: &str) -> Wire {
    let exponent_nonzero = builder.any_bit(operand.exponent);
    builder.name(exponent_nonzero, format!("{name}_exponent_nonzero"))
}

/// Is it a zero of either sign? Under the flush policy every operand with exponent field 0 is.
pub(super) fn is_zero(builder: &mut Builder, operand: &Fields, name: &str) -> Wire {
    let exponent_nonzero = exponent_nonzero(builder, operand, name);
    let is_zero = builder.not(exponent_nonzero);
    builder.name(is_zero, format!("{name}_is_zero"))
}

/// Is it infinite or NaN?
pub(super) fn is_special(builder: &mut Builder, operand: &Fields, name: &str) -> Wire {
    let is_special = builder.all_bits(operand.exponent);
    builder.name(is_special, format!("{name}_is_special"))
}

/// What an operand is when it is no ordinary number.
pub(super) struct Class {
    /// Has it an exponent field other than 0, so that a one stands before its point?
    pub exponent_nonzero: Wire,
    pub is_zero: Wire,
    pub is_infinity: Wire,
    pub is_nan: Wire,
}

/// All special cases of an operand. What has exponent field 0 is a zero where subnormal numbers are
/// flushed, and where they are full if its fraction is 0, too.
pub(super) fn classify(
    builder: &mut Builder,
    policy: Policy,
    operand: &Fields,
    name: &str,
) -> Class {
    let exponent_nonzero = exponent_nonzero(builder, operand, name);
    let is_special = is_special(builder, operand, name);
    let fraction_nonzero = builder.any_bit(operand.fraction);
    builder.name(fraction_nonzero, format!("{name}_fraction_nonzero"));
    let nonzero = match policy {
        Policy::Flush => exponent_nonzero,
        Policy::Full => builder.or(exponent_nonzero, fraction_nonzero),
    };
    let is_zero = builder.not(nonzero);
    let is_nan = builder.and(is_special, fraction_nonzero);
    let fraction_zero = builder.not(fraction_nonzero);
    let is_infinity = builder.and(is_special, fraction_zero);
    Class {
        exponent_nonzero,
        is_zero: builder.name(is_zero, format!("{name}_is_zero")),
        is_infinity: builder.name(is_infinity, format!("{name}_is_infinity")),
        is_nan: builder.name(is_nan, format!("{name}_is_nan")),
    }
}

/// Is this NaN a signalling one: does its fraction begin with 0?
pub(super) fn is_signalling(
    builder: &mut Builder,
    operand: &Fields,
    is_nan: Wire,
    name: &str,
) -> Wire {
    let top = builder.width(operand.fraction) - 1;
    let quiet = builder.bit(operand.fraction, top);
    let not_quiet = builder.not(quiet);
    let is_signalling = builder.and(is_nan, not_quiet);
    builder.name(is_signalling, format!("{name}_is_signalling"))
}

/// The exponent field, but 1 where it is 0: the exponent that a subnormal number's bits have.
pub(super) fn effective_exponent(
    builder: &mut Builder,
    operand: &Fields,
    exponent_nonzero: Wire,
    name: &str,
) -> Wire {
    let top = builder.width(operand.exponent) - 1;
    let high = builder.slice(operand.exponent, top, 1);
    let low = builder.bit(operand.exponent, 0);
    let exponent_zero = builder.not(exponent_nonzero);
    let low = builder.or(low, exponent_zero);
    let exponent = builder.concat(&[high, low]);
    builder.name(exponent, format!("{name}_effective_exponent"))
}

/// A nonzero operand with a one before its point.
pub(super) struct Normalised {
    /// The biased exponent, below 1 for a subnormal number: two's complement in as many bits as
    /// asked for.
    pub exponent: Wire,
    /// The bits after the one.
    pub fraction: Wire,
}

/// Moves a subnormal operand's leading one before the point, and its exponent down by as much.
pub(super) fn normalise(
    builder: &mut Builder,
    operand: &Fields,
    exponent_nonzero: Wire,
    exponent_bits: u32,
    name: &str,
) -> Normalised {
    let significand = builder.concat(&[exponent_nonzero, operand.fraction]);
    builder.name(significand, format!("{name}_significand"));
    let zeros = leading_zeros(builder, significand, name);
    let fraction = builder.shift_left(operand.fraction, zeros.count);
    builder.name(fraction, format!("{name}_normalised_fraction"));
    let field = effective_exponent(builder, operand, exponent_nonzero, name);
    let field = builder.zero_extend(field, exponent_bits);
    let count = builder.zero_extend(zeros.count, exponent_bits);
    let exponent = builder.subtract(field, count);
    builder.name(exponent, format!("{name}_normalised_exponent"));
    Normalised { exponent, fraction }
}

/// Is it NaN?
pub(super) fn is_nan(builder: &mut Builder, operand: &Fields, name: &str) -> Wire {
    let is_special = is_special(builder, operand, name);
    let fraction_nonzero = builder.any_bit(operand.fraction);
    builder.name(fraction_nonzero, format!("{name}_fraction_nonzero"));
    let is_nan = builder.and(is_special, fraction_nonzero);
    builder.name(is_nan, format!("{name}_is_nan"))
}

/// Exponent and fraction together: ordered as unsigned integers they are ordered as magnitudes.
pub(super) fn magnitude(
    builder: &mut Builder,
    format: FloatFormat,
    operand: Wire,
    name: &str,
) -> Wire {
    let magnitude = builder.slice(operand, format.width() - 2, 0);
    builder.name(magnitude, format!("{name}_magnitude"))
}
