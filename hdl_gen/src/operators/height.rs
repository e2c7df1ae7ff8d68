//! The operators of the traverse unit that no other float unit has.

use rtl_model::float::Policy;

use super::OperatorConfiguration;
use super::round::exponent_width;
use super::shift::leading_zeros;
use super::unpack::{effective_exponent, fields, magnitude};
use crate::netlist::{Builder, Wire};

/// The operand's magnitude bits plus `ulps`, as an integer: so many floats further up.
pub(super) fn ulps_up(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    ulps: u32,
) -> Wire {
    let OperatorConfiguration { format, policy, .. } = configuration;
    let magnitude_bits = format.width() - 1;
    // One bit above, so that the sum does not wrap.
    let sum_bits = 1 + magnitude_bits.max(u32::BITS - ulps.leading_zeros());
    builder.localparam(
        "SUM_BITS",
        sum_bits.into(),
        "the magnitude or the step, whichever is wider, and a carry",
    );
    let a_i = builder.input("a_i", format.width());
    builder.section("unpack");
    let a_exponent = builder.slice(a_i, format.width() - 2, format.fraction_bits);
    builder.name(a_exponent, "a_exponent");
    let a_magnitude = magnitude(builder, format, a_i, "a");
    let infinity = builder.constant(format.infinity(), magnitude_bits);
    let is_nan = builder.less_than(infinity, a_magnitude);
    builder.name(is_nan, "a_is_nan");

    builder.section("add");
    let start = match policy {
        Policy::Flush => {
            let a_is_normal = builder.any_bit(a_exponent);
            builder.name(a_is_normal, "a_is_normal");
            let kept = builder.sign_extend(a_is_normal, magnitude_bits);
            let flushed = builder.and(a_magnitude, kept);
            builder.name(flushed, "flushed_magnitude")
        }
        Policy::Full => a_magnitude,
    };
    let start = builder.zero_extend(start, sum_bits);
    let step = builder.constant(ulps.into(), sum_bits);
    let sum = builder.add(start, step);
    builder.name(sum, "stepped_magnitude");

    builder.section("saturate");
    let limit = builder.constant(format.infinity(), sum_bits);
    let in_range = builder.less_than(sum, limit);
    builder.name(in_range, "in_range");
    let mut result = builder.slice(sum, magnitude_bits - 1, 0);
    if policy == Policy::Flush {
        // A sum with an empty exponent is no number of a format without subnormals.
        let above_fraction = builder.slice(sum, sum_bits - 1, format.fraction_bits);
        let is_normal = builder.any_bit(above_fraction);
        builder.name(is_normal, "sum_is_normal");
        let zero = builder.constant(0, magnitude_bits);
        result = builder.mux(is_normal, result, zero);
        builder.name(result, "flushed_sum");
    }
    let result = builder.mux(in_range, result, infinity);
    let quiet_nan = builder.constant(format.quiet_nan(), magnitude_bits);
    let result = builder.mux(is_nan, quiet_nan, result);
    builder.name(result, "result_magnitude");
    let positive = builder.constant(0, 1);
    builder.concat(&[positive, result])
}

/// `1 - height / (2^bits - 1)` toward zero. With k the complement of the height, the depth is
/// `k / (2^bits - 1)`, which written in binary is the word k repeated for ever behind the point:
/// the significand is that pattern from its first one on, and nothing is ever divided or added.
pub(super) fn depth(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    bits: u32,
) -> Wire {
    let OperatorConfiguration { format, policy, .. } = configuration;
    let fraction_bits = format.fraction_bits;
    let magnitude_bits = format.width() - 1;
    let height = builder.input("a_i", bits);

    builder.section("normalise the complement");
    let complement = builder.not(height);
    builder.name(complement, "depth_numerator");
    let zeros = leading_zeros(builder, complement, "numerator");
    let normalised = builder.shift_left(complement, zeros.count);
    builder.name(normalised, "normalised_numerator");

    builder.section("repeat it");
    // The leading zeros that were shifted out come back at the bottom: the pattern is periodic.
    let below_one = builder.slice(normalised, bits - 2, 0);
    let mut pattern = vec![below_one];
    let mut pattern_bits = bits - 1;
    while pattern_bits < fraction_bits {
        pattern.push(normalised);
        pattern_bits += bits;
    }
    let pattern = builder.concat(&pattern);
    let fraction = builder.slice(pattern, pattern_bits - 1, pattern_bits - fraction_bits);
    builder.name(fraction, "depth_fraction");

    builder.section("exponent");
    // A depth whose first bit behind the point is 1 is at least one half.
    let half = i64::from(format.exponent_bias()) - 1;
    let lowest = half - i64::from(bits - 1);
    let exponent_word_bits = exponent_width(format, &(lowest..=half));
    let half_field = builder.constant(half.cast_unsigned(), exponent_word_bits);
    let wide_count = builder.zero_extend(zeros.count, exponent_word_bits);
    let word = builder.subtract(half_field, wide_count);
    builder.name(word, "depth_exponent");
    let exponent = builder.slice(word, format.exponent_bits - 1, 0);

    builder.section("special cases");
    let mut magnitude = builder.concat(&[exponent, fraction]);
    let is_one = builder.all_bits(complement);
    builder.name(is_one, "is_one");
    let one_magnitude = builder.constant(format.one(), magnitude_bits);
    magnitude = builder.mux(is_one, one_magnitude, magnitude);
    let mut nonzero = zeros.any;
    if lowest < 1 {
        // Below the smallest normal number the depth is flushed, or a subnormal number.
        let least = i64::try_from(format.exponent_all_ones()).expect("11 exponent bits at most");
        debug_assert!(half < least);
        let is_normal = if lowest < 0 {
            let negative = builder.bit(word, exponent_word_bits - 1);
            let not_negative = builder.not(negative);
            let any = builder.any_bit(exponent);
            builder.and(any, not_negative)
        } else {
            builder.any_bit(exponent)
        };
        match policy {
            Policy::Flush => {
                let kept = builder.or(is_normal, is_one);
                nonzero = builder.and(nonzero, kept);
            }
            Policy::Full => {
                let one = builder.constant(1, exponent_word_bits);
                let distance = builder.subtract(one, word);
                builder.name(distance, "distance_to_subnormal");
                let hidden = builder.constant(1, 1);
                let significand = builder.concat(&[hidden, fraction]);
                let moved = builder.shift_right(significand, distance);
                builder.name(moved, "subnormal_significand");
                let moved = builder.slice(moved, fraction_bits - 1, 0);
                let subnormal = builder.zero_extend(moved, magnitude_bits);
                let below_one = builder.mux(is_normal, magnitude, subnormal);
                magnitude = builder.mux(is_one, one_magnitude, below_one);
            }
        }
    }
    let zero = builder.constant(0, magnitude_bits);
    magnitude = builder.mux(nonzero, magnitude, zero);
    builder.name(magnitude, "result_magnitude");
    let positive = builder.constant(0, 1);
    builder.concat(&[positive, magnitude])
}

/// The exponent, plus one, plus the zeros at the fraction's end, as a power of two.
pub(super) fn exact_below(builder: &mut Builder, configuration: OperatorConfiguration) -> Wire {
    let OperatorConfiguration { format, policy, .. } = configuration;
    let (exponent_bits, fraction_bits) = (format.exponent_bits, format.fraction_bits);
    let a_i = builder.input("a_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let exponent_nonzero = builder.any_bit(a.exponent);
    builder.name(exponent_nonzero, "a_exponent_nonzero");
    let (a_exponent, hidden, a_is_nonzero) = match policy {
        Policy::Flush => (a.exponent, builder.constant(1, 1), exponent_nonzero),
        Policy::Full => {
            let exponent = effective_exponent(builder, &a, exponent_nonzero, "a");
            let fraction_nonzero = builder.any_bit(a.fraction);
            let nonzero = builder.or(exponent_nonzero, fraction_nonzero);
            (exponent, exponent_nonzero, nonzero)
        }
    };

    builder.section("count the zeros at the fraction's end");
    // Mirrored, so that the last bit leads; the hidden bit ends the count, and the zero in front
    // adds the one.
    let mut mirrored = vec![builder.constant(0, 1)];
    mirrored.extend((0..fraction_bits).map(|place| builder.bit(a_i, place)));
    mirrored.push(hidden);
    let mirrored = builder.concat(&mirrored);
    builder.name(mirrored, "mirrored_significand");
    let zeros = leading_zeros(builder, mirrored, "mirrored");

    builder.section("add them to the exponent");
    let count_bits = builder.width(zeros.count);
    let sum_bits = 1 + exponent_bits.max(count_bits);
    let wide_exponent = builder.zero_extend(a_exponent, sum_bits);
    let wide_count = builder.zero_extend(zeros.count, sum_bits);
    let sum = builder.add(wide_exponent, wide_count);
    builder.name(sum, "limit_exponent");
    let all_ones = builder.constant(format.exponent_all_ones(), sum_bits);
    let below_infinity = builder.less_than(sum, all_ones);
    builder.name(below_infinity, "below_infinity");
    // An infinity or NaN has an exponent past the range already: the count is at least one.
    let in_range = builder.and(below_infinity, a_is_nonzero);
    builder.name(in_range, "in_range");
    let exponent = builder.slice(sum, exponent_bits - 1, 0);
    let infinite = builder.constant(format.exponent_all_ones(), exponent_bits);
    let exponent = builder.mux(in_range, exponent, infinite);
    builder.name(exponent, "result_exponent");
    let positive = builder.constant(0, 1);
    let fraction = builder.constant(0, fraction_bits);
    builder.concat(&[positive, exponent, fraction])
}
