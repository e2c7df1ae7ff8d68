//! Taking a float operand apart: fields and special cases.

use rtl_model::float::FloatFormat;

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

/// Is it a zero of either sign? Under the flush policy every operand with exponent field 0 is.
pub(super) fn is_zero(builder: &mut Builder, operand: &Fields, name: &str) -> Wire {
    let exponent_nonzero = builder.any_bit(operand.exponent);
    builder.name(exponent_nonzero, format!("{name}_exponent_nonzero"));
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
    pub is_zero: Wire,
    pub is_infinity: Wire,
    pub is_nan: Wire,
}

/// All three special cases of an operand.
pub(super) fn classify(builder: &mut Builder, operand: &Fields, name: &str) -> Class {
    let is_zero = is_zero(builder, operand, name);
    let is_special = is_special(builder, operand, name);
    let fraction_nonzero = builder.any_bit(operand.fraction);
    builder.name(fraction_nonzero, format!("{name}_fraction_nonzero"));
    let is_nan = builder.and(is_special, fraction_nonzero);
    let fraction_zero = builder.not(fraction_nonzero);
    let is_infinity = builder.and(is_special, fraction_zero);
    Class {
        is_zero,
        is_infinity: builder.name(is_infinity, format!("{name}_is_infinity")),
        is_nan: builder.name(is_nan, format!("{name}_is_nan")),
    }
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
