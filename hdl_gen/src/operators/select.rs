//! The smaller and the larger of two floats.

use rtl_model::float::Policy;

use super::OperatorConfiguration;
use super::compare::invalid_alone;
use super::round::Answer;
use super::unpack::{Fields, fields, is_nan, is_signalling, magnitude};
use crate::netlist::Builder;

/// Which of the two.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Extreme {
    /// The smaller.
    Minimum,
    /// The larger.
    Maximum,
}

/// `minimumNumber` or `maximumNumber` of IEEE 754-2019, 9.6: -0 is below +0, a number goes before a
/// NaN, and the result is canonical.
pub(super) fn extreme(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    which: Extreme,
) -> Answer {
    let format = configuration.format;
    let a_i = builder.input("a_i", format.width());
    let b_i = builder.input("b_i", format.width());
    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let b = fields(builder, format, b_i, "b");
    let a_is_nan = is_nan(builder, &a, "a");
    let b_is_nan = is_nan(builder, &b, "b");
    let a_magnitude = magnitude(builder, format, a_i, "a");
    let b_magnitude = magnitude(builder, format, b_i, "b");

    builder.section("order");
    // Zeros and subnormal patterns need no care: what is equal to the policy comes out the same.
    let a_is_nearer_zero = builder.less_than(a_magnitude, b_magnitude);
    builder.name(a_is_nearer_zero, "a_is_nearer_zero");
    let of_equal_signs = builder.xor(a_is_nearer_zero, a.sign);
    let signs_differ = builder.xor(a.sign, b.sign);
    builder.name(signs_differ, "signs_differ");
    let a_is_below = builder.mux(signs_differ, a.sign, of_equal_signs);
    builder.name(a_is_below, "a_is_below");
    let takes_a = match which {
        Extreme::Minimum => a_is_below,
        Extreme::Maximum => builder.not(a_is_below),
    };
    let a_is_number = builder.not(a_is_nan);
    let takes_a = builder.and(takes_a, a_is_number);
    let takes_a = builder.or(takes_a, b_is_nan);
    builder.name(takes_a, "takes_a");

    builder.section("select, made canonical");
    let chosen = builder.mux(takes_a, a_i, b_i);
    builder.name(chosen, "chosen");
    let fraction_bits = format.fraction_bits;
    let Fields {
        sign,
        exponent,
        mut fraction,
    } = fields(builder, format, chosen, "chosen");
    if configuration.policy == Policy::Flush {
        let is_normal = builder.any_bit(exponent);
        builder.name(is_normal, "chosen_is_normal");
        let keep = builder.sign_extend(is_normal, fraction_bits);
        fraction = builder.and(fraction, keep);
    }
    let both_are_nan = builder.and(a_is_nan, b_is_nan);
    builder.name(both_are_nan, "both_are_nan");
    let quiet = builder.constant(format.quiet_nan() & format.fraction_mask(), fraction_bits);
    let fraction = builder.mux(both_are_nan, quiet, fraction);
    builder.name(fraction, "result_fraction");
    let is_number = builder.not(both_are_nan);
    let sign = builder.and(sign, is_number);
    builder.name(sign, "result_sign");
    let result = builder.concat(&[sign, exponent, fraction]);
    let flags = configuration.has_flags.then(|| {
        builder.section("flags");
        let a_is_signalling = is_signalling(builder, &a, a_is_nan, "a");
        let b_is_signalling = is_signalling(builder, &b, b_is_nan, "b");
        let invalid = builder.or(a_is_signalling, b_is_signalling);
        invalid_alone(builder, invalid)
    });
    Answer { result, flags }
}
