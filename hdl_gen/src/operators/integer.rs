//! Between floats and integers, and rounding a float to one.

use rtl_model::float::{FloatFormat, Policy, Rounding};

use super::OperatorConfiguration;
use super::round::{
    Answer, Small, Tail, Unrounded, exponent_constant, exponent_width, needs_tail, round,
};
use super::shift::{leading_zeros, shift_right};
use super::unpack::{classify, fields, is_special, is_zero, magnitude};
use crate::netlist::{Builder, Wire};

/// `value * 2^exponent`, both two's complement: leading zeros, one shift, the rounder.
pub(super) fn from_integer(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    value_bits: u32,
    exponent_bits: u32,
) -> Answer {
    let format = configuration.format;
    let fraction_bits = format.fraction_bits;
    let count_bits = u32::BITS - (value_bits - 1).leading_zeros();
    // The count of leading zeros may be as large as its bits allow where the value is zero, but
    // then the result is a zero whatever the exponent.
    let largest_exponent = (1_i64 << (exponent_bits - 1)) - 1;
    let top_place = i64::from(value_bits) - 1;
    let bias = i64::from(format.exponent_bias());
    let exponent_range = bias - largest_exponent - 1..=bias + top_place + largest_exponent;
    let exponent_word_bits = exponent_width(format, &exponent_range)
        .max(exponent_bits + 1)
        .max(count_bits + 1);
    builder.localparam(
        "EXPONENT_BITS",
        exponent_word_bits.into(),
        "the biased exponent of any nonzero result",
    );
    let value = builder.input("value_i", value_bits);
    builder.mean(value, crate::netlist::Meaning::Signed);
    let exponent_i = builder.input("exponent_i", exponent_bits);
    builder.mean(exponent_i, crate::netlist::Meaning::Signed);

    builder.section("magnitude of the value");
    let sign = builder.bit(value, value_bits - 1);
    builder.name(sign, "value_sign");
    let signs = builder.sign_extend(sign, value_bits);
    let complemented = builder.xor(value, signs);
    builder.name(complemented, "value_complemented");
    let carry = builder.zero_extend(sign, value_bits);
    let value_magnitude = builder.add(complemented, carry);
    builder.name(value_magnitude, "value_magnitude");

    builder.section("normalise");
    let zeros = leading_zeros(builder, value_magnitude, "value");
    let value_below = builder.slice(value_magnitude, value_bits - 2, 0);
    let normalised = builder.shift_left(value_below, zeros.count);
    builder.name(normalised, "normalised_value");
    let is_zero = builder.not(zeros.any);
    builder.name(is_zero, "is_zero");
    let below_bits = value_bits - 1;
    let fraction = if below_bits >= fraction_bits {
        builder.slice(normalised, below_bits - 1, below_bits - fraction_bits)
    } else {
        let zeros = builder.constant(0, fraction_bits - below_bits);
        builder.concat(&[normalised, zeros])
    };
    builder.name(fraction, "value_fraction");
    let tail = (needs_tail(configuration) && below_bits > fraction_bits).then(|| {
        let guard_place = below_bits - fraction_bits - 1;
        let guard = builder.bit(normalised, guard_place);
        builder.name(guard, "guard_bit");
        let sticky = if guard_place > 0 {
            let below_guard = builder.slice(normalised, guard_place - 1, 0);
            builder.any_bit(below_guard)
        } else {
            builder.constant(0, 1)
        };
        builder.name(sticky, "sticky_bit");
        Tail {
            guard,
            sticky: Some(sticky),
        }
    });

    builder.section("exponent");
    let wide_exponent = builder.sign_extend(exponent_i, exponent_word_bits);
    let wide_count = builder.zero_extend(zeros.count, exponent_word_bits);
    let exponent = builder.subtract(wide_exponent, wide_count);
    builder.name(exponent, "scaled_exponent");
    let adjustment = exponent_constant(builder, bias + top_place, exponent_word_bits);

    round(
        builder,
        configuration,
        &Unrounded {
            sign,
            exponent,
            adjustment,
            exponent_range,
            fraction,
            tail,
            is_nan: None,
            is_infinity: None,
            is_zero: Some(is_zero),
            is_invalid: None,
            divides_by_zero: None,
            small: Small::Normalised,
        },
    )
}

/// The integer nearest in the direction of the rounding, two's complement, saturated; 0 for NaN.
pub(super) fn to_integer(
    builder: &mut Builder,
    format: FloatFormat,
    rounding: Rounding,
    bits: u32,
) -> Wire {
    let fraction_bits = format.fraction_bits;
    let magnitude_bits = bits - 1;
    // Wide enough for every integer bit and the guard bit, and for the significand itself.
    let word_bits = bits.max(fraction_bits + 1);
    builder.localparam(
        "WORD_BITS",
        word_bits.into(),
        "the magnitude and a guard bit, or the significand if that is wider",
    );
    // The exponent field of a significand that stands at the top of the word.
    let top_field = i64::from(format.exponent_bias()) + i64::from(magnitude_bits) - 1;
    let difference_bits = 1 + format
        .exponent_bits
        .max(u64::BITS - top_field.unsigned_abs().leading_zeros());
    builder.localparam(
        "DIFFERENCE_BITS",
        difference_bits.into(),
        "a two's complement distance between the exponent and that of the largest integers",
    );
    let a_i = builder.input("a_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let a_is = classify(builder, Policy::Flush, &a, "a");
    let hidden = builder.constant(1, 1);
    let padding = word_bits - fraction_bits - 1;
    let significand = if padding > 0 {
        let zeros = builder.constant(0, padding);
        builder.concat(&[hidden, a.fraction, zeros])
    } else {
        builder.concat(&[hidden, a.fraction])
    };

    builder.section("align: ones at the bottom of the magnitude");
    let top = exponent_constant(builder, top_field, difference_bits);
    let wide_exponent = builder.zero_extend(a.exponent, difference_bits);
    let difference = builder.subtract(top, wide_exponent);
    builder.name(difference, "shift_difference");
    let too_large = builder.bit(difference, difference_bits - 1);
    builder.name(too_large, "too_large");
    let amount = builder.slice(difference, difference_bits - 2, 0);
    let shifted = shift_right(builder, significand, amount, padding, "significand");
    let mut is_gone = a_is.is_zero;
    let mut is_inexact = shifted.lost;
    if let Some(out_of_reach) = shifted.out_of_reach {
        is_gone = builder.or(is_gone, out_of_reach);
        is_inexact = builder.or(is_inexact, out_of_reach);
    }
    builder.name(is_gone, "is_gone");
    builder.name(is_inexact, "is_inexact");
    let nothing = builder.constant(0, word_bits);
    let aligned = builder.mux(is_gone, nothing, shifted.word);
    builder.name(aligned, "aligned");

    builder.section("round");
    let integer = builder.slice(aligned, word_bits - 1, word_bits - magnitude_bits);
    builder.name(integer, "integer_magnitude");
    let below_bits = word_bits - magnitude_bits;
    let guard = builder.bit(aligned, below_bits - 1);
    builder.name(guard, "guard_bit");
    let is_nonzero = builder.not(a_is.is_zero);
    let mut sticky = builder.and(is_inexact, is_nonzero);
    if below_bits > 1 {
        let below_guard = builder.slice(aligned, below_bits - 2, 0);
        let below_guard = builder.any_bit(below_guard);
        builder.name(below_guard, "below_guard");
        sticky = builder.or(sticky, below_guard);
    }
    builder.name(sticky, "sticky_bit");
    let round_up = match rounding {
        Rounding::TowardZero => builder.constant(0, 1),
        Rounding::NearestEven => {
            let last_bit = builder.bit(integer, 0);
            let odd_or_above = builder.or(sticky, last_bit);
            builder.name(odd_or_above, "odd_or_above");
            builder.and(guard, odd_or_above)
        }
        Rounding::Up | Rounding::Down => {
            let inexact = builder.or(guard, sticky);
            let away = match rounding {
                Rounding::Up => builder.not(a.sign),
                _ => a.sign,
            };
            builder.and(inexact, away)
        }
    };
    // One incrementer rounds and negates: -(m + r) is the complement of m, plus 1 - r.
    let wide = builder.zero_extend(integer, bits);
    let signs = builder.sign_extend(a.sign, bits);
    let complemented = builder.xor(wide, signs);
    builder.name(complemented, "integer_complemented");
    let carry = builder.xor(a.sign, round_up);
    builder.name(carry, "increment");
    let carry = builder.zero_extend(carry, bits);
    let signed_integer = builder.add(complemented, carry);
    builder.name(signed_integer, "signed_integer");

    builder.section("saturate");
    // A positive magnitude rounded up to 2^(bits - 1) shows as a negative result.
    let negative = builder.bit(signed_integer, bits - 1);
    let positive = builder.not(a.sign);
    let wrapped = builder.and(negative, positive);
    builder.name(wrapped, "wrapped");
    let saturates = builder.or(too_large, a_is.is_infinity);
    builder.name(saturates, "beyond_range");
    let saturates = builder.or(saturates, wrapped);
    builder.name(saturates, "saturates");
    let lowest = builder.constant(1 << (bits - 1), bits);
    let highest = builder.constant((1 << (bits - 1)) - 1, bits);
    let limit = builder.mux(a.sign, lowest, highest);
    builder.name(limit, "limit");
    let number = builder.mux(saturates, limit, signed_integer);
    builder.name(number, "saturated");
    let zero = builder.constant(0, bits);
    let result = builder.mux(a_is.is_nan, zero, number);
    builder.mean(result, crate::netlist::Meaning::Signed);
    builder.name(result, "result")
}

/// The largest integer not above the operand, as a float: the fraction bits below the binary point
/// are cleared, and of a negative number that had any the magnitude grows by one.
pub(super) fn floor(builder: &mut Builder, format: FloatFormat) -> Wire {
    let (exponent_bits, fraction_bits) = (format.exponent_bits, format.fraction_bits);
    let magnitude_bits = exponent_bits + fraction_bits;
    let bias = u64::try_from(format.exponent_bias()).expect("a positive bias");
    let a_i = builder.input("a_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let a_magnitude = magnitude(builder, format, a_i, "a");
    let a_is_zero = is_zero(builder, &a, "a");
    let a_is_special = is_special(builder, &a, "a");
    let fraction_nonzero = builder.any_bit(a.fraction);
    let a_is_nan = builder.and(a_is_special, fraction_nonzero);
    builder.name(a_is_nan, "a_is_nan");

    builder.section("the bits below the binary point");
    let one = builder.constant(bias, exponent_bits);
    let below_one = builder.less_than(a.exponent, one);
    builder.name(below_one, "below_one");
    // All ones moved right once for every place of the exponent above that of one.
    let places = builder.subtract(a.exponent, one);
    builder.name(places, "places_above_one");
    let ones = builder.constant(format.fraction_mask(), fraction_bits);
    let below_point = builder.shift_right(ones, places);
    builder.name(below_point, "below_point");
    let fractional = builder.and(a.fraction, below_point);
    builder.name(fractional, "fractional_bits");
    let has_fraction = builder.any_bit(fractional);
    builder.name(has_fraction, "has_fraction");

    builder.section("clear them, away from zero where negative");
    let moves_down = builder.and(a.sign, has_fraction);
    builder.name(moves_down, "moves_down");
    // With all of them set, one more carries into the integer's last place; the carry runs into
    // the exponent where that is right.
    let no_exponent = builder.constant(0, exponent_bits);
    let wide_below_point = builder.concat(&[no_exponent, below_point]);
    let filled = builder.or(a_magnitude, wide_below_point);
    builder.name(filled, "filled_magnitude");
    let increment = builder.zero_extend(moves_down, magnitude_bits);
    let carried = builder.add(filled, increment);
    builder.name(carried, "carried");
    // Where nothing was added the filled bits are cleared, where it was they already are.
    let keep = builder.not(wide_below_point);
    let integer = builder.and(carried, keep);
    builder.name(integer, "integer_magnitude");

    builder.section("special cases");
    // Between -1 and 0 the result is -1; between 0 and 1 it is a zero of the operand's sign.
    let is_nonzero = builder.not(a_is_zero);
    builder.name(is_nonzero, "a_is_nonzero");
    let is_minus_one = builder.and(a.sign, is_nonzero);
    builder.name(is_minus_one, "is_minus_one");
    let one = builder.constant(format.one(), magnitude_bits);
    let zero = builder.constant(0, magnitude_bits);
    let small = builder.mux(is_minus_one, one, zero);
    builder.name(small, "result_below_one");
    let result = builder.mux(below_one, small, integer);
    let result = builder.mux(a_is_special, a_magnitude, result);
    let quiet_nan = builder.constant(format.quiet_nan(), magnitude_bits);
    let result = builder.mux(a_is_nan, quiet_nan, result);
    builder.name(result, "result_magnitude");
    let is_number = builder.not(a_is_nan);
    let sign = builder.and(a.sign, is_number);
    builder.name(sign, "result_sign");
    builder.concat(&[sign, result])
}
