//! Two operands with their points in one place.

use rtl_model::fixed::FixedFormat;

use crate::netlist::{Builder, Wire};

/// Words that hold the numbers of two formats.
#[derive(Clone, Copy)]
pub(super) struct Common {
    /// Two's complement, as soon as one of the formats is.
    pub signed: bool,
    pub integer_bits: u32,
    pub fraction_bits: u32,
}

impl Common {
    pub(super) fn width(self) -> u32 {
        self.integer_bits + self.fraction_bits
    }
}

/// The narrowest of them.
pub(super) fn common(a: FixedFormat, b: FixedFormat) -> Common {
    let signed = a.signed || b.signed;
    // An unsigned number is a two's complement one with a zero in front.
    let integer_bits =
        |format: FixedFormat| format.integer_bits + u32::from(signed != format.signed);
    Common {
        signed,
        integer_bits: integer_bits(a).max(integer_bits(b)),
        fraction_bits: a.fraction_bits.max(b.fraction_bits),
    }
}

/// An operand with zeros behind, up to so many fraction bits, and in front extended by its sign, or
/// by zeros, to a width.
pub(super) fn extended(
    builder: &mut Builder,
    operand: Wire,
    format: FixedFormat,
    fraction_bits: u32,
    width: u32,
) -> Wire {
    let mut word = operand;
    if fraction_bits > format.fraction_bits {
        let zeros = builder.constant(0, fraction_bits - format.fraction_bits);
        word = builder.concat(&[word, zeros]);
    }
    if format.signed {
        builder.sign_extend(word, width)
    } else {
        builder.zero_extend(word, width)
    }
}
