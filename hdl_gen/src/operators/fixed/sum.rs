//! Addition, subtraction, and what takes one operand as it is: negation, conversion.

use super::align::{common, extended};
use super::round::{Exact, round};
use super::{Answer, FixedConfiguration, operand};
use crate::netlist::Builder;

/// `a + b`, or `a - b` where `subtract`.
pub(super) fn add(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    subtract: bool,
) -> Answer {
    let FixedConfiguration { a, b, .. } = configuration;
    let common = common(a, b);
    let sum_bits = common.width() + 1;
    builder.localparam(
        "SUM_BITS",
        sum_bits.into(),
        "either operand with its point in one place, and a carry",
    );
    let a_i = operand(builder, "a_i", a);
    let b_i = operand(builder, "b_i", b);
    builder.section("align the points");
    let a_aligned = extended(builder, a_i, a, common.fraction_bits, sum_bits);
    builder.name(a_aligned, "a_aligned");
    let b_aligned = extended(builder, b_i, b, common.fraction_bits, sum_bits);
    builder.name(b_aligned, "b_aligned");
    builder.section(if subtract { "subtract" } else { "add" });
    let sum = if subtract {
        builder.subtract(a_aligned, b_aligned)
    } else {
        builder.add(a_aligned, b_aligned)
    };
    builder.name(sum, "exact_sum");
    round(
        builder,
        configuration,
        // A difference of unsigned numbers may be negative.
        &Exact::new(sum, common.signed || subtract, common.fraction_bits),
    )
}

/// `-a`.
pub(super) fn negate(builder: &mut Builder, configuration: FixedConfiguration) -> Answer {
    let a = configuration.a;
    let bits = a.width() + 1;
    builder.localparam(
        "NEGATED_BITS",
        bits.into(),
        "the operand and a sign of its own",
    );
    let a_i = operand(builder, "a_i", a);
    builder.section("negate");
    let wide = extended(builder, a_i, a, a.fraction_bits, bits);
    let zero = builder.constant(0, bits);
    let negated = builder.subtract(zero, wide);
    builder.name(negated, "negated");
    round(
        builder,
        configuration,
        &Exact::new(negated, true, a.fraction_bits),
    )
}

/// `a` in the result's format.
pub(super) fn convert(builder: &mut Builder, configuration: FixedConfiguration) -> Answer {
    let a = configuration.a;
    let a_i = operand(builder, "a_i", a);
    round(
        builder,
        configuration,
        &Exact::new(a_i, a.signed, a.fraction_bits),
    )
}
