//! Multiplication.

use rtl_model::fixed::FixedFormat;

use super::super::Multiplier;
use super::super::significand_product::significand_product;
use super::round::{Exact, round};
use super::{Answer, FixedConfiguration, operand};
use crate::netlist::{Builder, Wire};

/// Bits of the exact product of two numbers.
pub(super) fn width(a: FixedFormat, b: FixedFormat) -> u32 {
    a.width() + b.width()
}

/// Bits of the widest word of a multiplication.
pub(super) fn widest_word(configuration: FixedConfiguration) -> u32 {
    let FixedConfiguration { a, b, .. } = configuration;
    let is_odd = configuration.multiplier == Multiplier::Logic && b.width() % 2 == 1;
    width(a, b) + u32::from(is_odd)
}

/// The product of two words read as unsigned.
fn unsigned_product(builder: &mut Builder, multiplier: Multiplier, a: Wire, b: Wire) -> Wire {
    let bits = builder.width(a) + builder.width(b);
    if multiplier == Multiplier::Dsp {
        return builder.multiply(a, b);
    }
    // Rows take two bits each; the last of an odd number of them would be taken for a one.
    let even = builder.width(b).next_multiple_of(2);
    let b = builder.zero_extend(b, even);
    let product = significand_product(builder, multiplier, a, b);
    builder.slice(product, bits - 1, 0)
}

/// `a * b`: the product of the words read as unsigned, corrected for their signs.
pub(super) fn multiply(builder: &mut Builder, configuration: FixedConfiguration) -> Answer {
    let FixedConfiguration { a, b, .. } = configuration;
    builder.localparam(
        "PRODUCT_BITS",
        width(a, b).into(),
        "as many as both operands have: the product is exact",
    );
    let a_i = operand(builder, "a_i", a);
    let b_i = operand(builder, "b_i", b);
    builder.section("multiply");
    let mut product = unsigned_product(builder, configuration.multiplier, a_i, b_i);
    builder.name(product, "unsigned_product");
    // The first bit of a two's complement word weighs minus what it weighs in an unsigned one: the
    // product is too large by the other operand, moved above the word, twice.
    if a.signed {
        product = corrected(builder, product, (a_i, b_i), "a");
    }
    if b.signed {
        product = corrected(builder, product, (b_i, a_i), "b");
    }
    builder.name(product, "exact_product");
    round(
        builder,
        configuration,
        &Exact::new(
            product,
            a.signed || b.signed,
            a.fraction_bits + b.fraction_bits,
        ),
    )
}

/// Takes the other operand from the product's upper part where this one is negative.
fn corrected(
    builder: &mut Builder,
    product: Wire,
    (operand, other): (Wire, Wire),
    name: &str,
) -> Wire {
    let (bits, own) = (builder.width(product), builder.width(operand));
    let negative = builder.bit(operand, own - 1);
    let negative = builder.sign_extend(negative, bits - own);
    let excess = builder.and(other, negative);
    builder.name(excess, format!("excess_of_{name}_sign"));
    let upper = builder.slice(product, bits - 1, own);
    let upper = builder.subtract(upper, excess);
    builder.name(upper, format!("upper_less_{name}_excess"));
    let lower = builder.slice(product, own - 1, 0);
    builder.concat(&[upper, lower])
}
