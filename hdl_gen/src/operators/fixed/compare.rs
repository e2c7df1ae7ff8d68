//! Comparison.

use super::align::{common, extended};
use super::{FixedConfiguration, operand};
use crate::netlist::Builder;

/// The relations of `a` to `b`, their points in one place.
pub(super) fn compare(builder: &mut Builder, configuration: FixedConfiguration) {
    let FixedConfiguration { a, b, .. } = configuration;
    let common = common(a, b);
    let bits = common.width();
    builder.localparam(
        "ALIGNED_BITS",
        bits.into(),
        "either operand with its point in one place",
    );
    let a_i = operand(builder, "a_i", a);
    let b_i = operand(builder, "b_i", b);
    builder.section("align the points");
    let mut aligned = [(a_i, a, "a_aligned"), (b_i, b, "b_aligned")].map(|(wire, format, name)| {
        let aligned = extended(builder, wire, format, common.fraction_bits, bits);
        builder.name(aligned, name)
    });
    builder.section("compare");
    if common.signed {
        // With their signs inverted two's complement words are ordered as unsigned ones.
        aligned = [(aligned[0], "a_order"), (aligned[1], "b_order")].map(|(word, name)| {
            let sign = builder.bit(word, bits - 1);
            let inverted = builder.not(sign);
            let order = if bits > 1 {
                let rest = builder.slice(word, bits - 2, 0);
                builder.concat(&[inverted, rest])
            } else {
                inverted
            };
            builder.name(order, name)
        });
    }
    let [a, b] = aligned;
    let less_than = builder.less_than(a, b);
    builder.name(less_than, "less_than");
    let equal = builder.equal(a, b);
    builder.name(equal, "equal");
    let less_equal = builder.or(less_than, equal);
    builder.output("less_than_o", less_than);
    builder.output("less_equal_o", less_equal);
    builder.output("equal_o", equal);
}
