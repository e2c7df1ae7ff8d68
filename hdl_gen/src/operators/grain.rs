//! How fine a number is: its exponent plus the zeros at the end of its significand.

use rtl_model::float::FloatFormat;

use super::shift::leading_zeros;
use super::unpack::{fields, is_special, is_zero};
use crate::netlist::{Builder, Wire};

/// The power of two below which multiples of the operand's last nonzero bit are representable:
/// one exponent above the operand's, and one more for each zero at its fraction's end.
pub(super) fn exact_below(builder: &mut Builder, format: FloatFormat) -> Wire {
    let fraction_bits = format.fraction_bits;
    let zero_count_bits = u32::BITS - fraction_bits.leading_zeros();
    let sum_bits = 1 + format.exponent_bits.max(zero_count_bits);
    builder.localparam(
        "SUM_BITS",
        sum_bits.into(),
        "an exponent or a count of fraction bits, whichever is wider, and a carry",
    );
    let a_i = builder.input("a_i", format.width());
    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let a_is_zero = is_zero(builder, &a, "a");
    let a_is_special = is_special(builder, &a, "a");

    builder.section("zeros at the fraction's end");
    // The implied one stands behind the fraction's mirror image: a fraction of zeros has F.
    let mut mirrored: Vec<Wire> = (0..fraction_bits).map(|bit| builder.bit(a.fraction, bit)).collect();
    mirrored.push(builder.constant(1, 1));
    let mirrored = builder.concat(&mirrored);
    builder.name(mirrored, "mirrored_significand");
    let zeros = leading_zeros(builder, mirrored, "mirrored");

    builder.section("exponent");
    let exponent = builder.zero_extend(a.exponent, sum_bits);
    let zeros = builder.zero_extend(zeros.count, sum_bits);
    let sum = builder.add(exponent, zeros);
    let one = builder.constant(1, sum_bits);
    let limit = builder.add(sum, one);
    builder.name(limit, "limit_exponent");
    let all_ones = builder.constant(format.exponent_all_ones(), sum_bits);
    let in_range = builder.less_than(limit, all_ones);
    builder.name(in_range, "in_range");

    builder.section("special cases");
    let no_limit = builder.or(a_is_zero, a_is_special);
    let limited = builder.not(no_limit);
    let finite = builder.and(limited, in_range);
    let limit = builder.slice(limit, format.exponent_bits - 1, 0);
    let infinite = builder.constant(format.exponent_all_ones(), format.exponent_bits);
    let exponent = builder.mux(finite, limit, infinite);
    let positive = builder.constant(0, 1);
    let fraction = builder.constant(0, fraction_bits);
    builder.concat(&[positive, exponent, fraction])
}
