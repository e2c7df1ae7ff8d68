//! Between floats and integers.

use rtl_model::float::{IntegerFormat, Policy, Rounding};

use super::OperatorConfiguration;
use super::round::{
    Answer, Small, Tail, Unrounded, exponent_constant, exponent_width, gathered, needs_tail, round,
};
use super::shift::{leading_zeros, shift_right};
use super::unpack::{classify, effective_exponent, fields};
use crate::netlist::{Builder, Meaning, Wire};

/// `a * 2^b`, or `a` where there is no `b`: leading zeros, one shift, the rounder. The exponent b is
/// in two's complement.
pub(super) fn from_integer(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    source: IntegerFormat,
    exponent_bits: Option<u32>,
) -> Answer {
    let format = configuration.format;
    let value_bits = source.bits;
    let fraction_bits = format.fraction_bits;
    let count_bits = u32::BITS - (value_bits - 1).leading_zeros();
    // The count of leading zeros may be as large as its bits allow where the value is zero, but
    // then the result is a zero whatever the exponent.
    let largest_exponent = exponent_bits.map_or(0, |bits| (1_i64 << (bits - 1)) - 1);
    let smallest_exponent = exponent_bits.map_or(0, |bits| -(1_i64 << (bits - 1)));
    let top_place = i64::from(value_bits) - 1;
    let bias = i64::from(format.exponent_bias());
    let exponent_range = bias + smallest_exponent..=bias + top_place + largest_exponent;
    let exponent_word_bits = exponent_width(format, &exponent_range)
        .max(exponent_bits.unwrap_or(0) + 1)
        .max(count_bits + 1);
    builder.localparam(
        "EXPONENT_BITS",
        exponent_word_bits.into(),
        "the biased exponent of any nonzero result",
    );
    let a_i = builder.input("a_i", value_bits);
    if source.signed {
        builder.mean(a_i, Meaning::Signed);
    }
    let b_i = exponent_bits.map(|bits| {
        let b_i = builder.input("b_i", bits);
        builder.mean(b_i, Meaning::Signed)
    });

    let (sign, a_magnitude) = if source.signed {
        builder.section("magnitude of the value");
        let sign = builder.bit(a_i, value_bits - 1);
        builder.name(sign, "a_sign");
        let signs = builder.sign_extend(sign, value_bits);
        let complemented = builder.xor(a_i, signs);
        builder.name(complemented, "a_complemented");
        let carry = builder.zero_extend(sign, value_bits);
        let a_magnitude = builder.add(complemented, carry);
        (sign, builder.name(a_magnitude, "a_magnitude"))
    } else {
        (builder.constant(0, 1), a_i)
    };

    builder.section("normalise");
    let zeros = leading_zeros(builder, a_magnitude, "a");
    let below_top = builder.slice(a_magnitude, value_bits - 2, 0);
    let normalised = builder.shift_left(below_top, zeros.count);
    builder.name(normalised, "a_normalised");
    let is_zero = builder.not(zeros.any);
    builder.name(is_zero, "is_zero");
    let below_bits = value_bits - 1;
    let fraction = if below_bits >= fraction_bits {
        builder.slice(normalised, below_bits - 1, below_bits - fraction_bits)
    } else {
        let zeros = builder.constant(0, fraction_bits - below_bits);
        builder.concat(&[normalised, zeros])
    };
    builder.name(fraction, "a_fraction");
    let tail = (needs_tail(configuration) && below_bits > fraction_bits).then(|| {
        let guard_place = below_bits - fraction_bits - 1;
        let guard = builder.bit(normalised, guard_place);
        builder.name(guard, "guard_bit");
        let sticky = if guard_place > 0 {
            let below_guard = builder.slice(normalised, guard_place - 1, 0);
            gathered(builder, below_guard, "sticky_bits")
        } else {
            builder.constant(0, 1)
        };
        Tail {
            guard,
            sticky: Some(sticky),
        }
    });

    builder.section("exponent");
    let wide_count = builder.zero_extend(zeros.count, exponent_word_bits);
    let (exponent, adjustment) = match b_i {
        Some(b_i) => {
            let wide_exponent = builder.sign_extend(b_i, exponent_word_bits);
            let exponent = builder.subtract(wide_exponent, wide_count);
            (exponent, bias + top_place)
        }
        // Minus the count is its complement plus one.
        None => (builder.not(wide_count), bias + top_place + 1),
    };
    builder.name(exponent, "scaled_exponent");
    let adjustment = exponent_constant(builder, adjustment, exponent_word_bits);

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
            early_bounds: None,
        },
    )
}

/// The integer nearest in the direction of the rounding, saturated; 0 for NaN.
pub(super) fn to_integer(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    target: IntegerFormat,
) -> Answer {
    let OperatorConfiguration {
        format,
        rounding,
        policy,
        has_flags,
        ..
    } = configuration;
    let bits = target.bits;
    let fraction_bits = format.fraction_bits;
    // Wide enough for every integer bit and the guard bit, and for the significand itself.
    let word_bits = (bits + 1).max(fraction_bits + 1);
    builder.localparam(
        "WORD_BITS",
        word_bits.into(),
        "the magnitude and a guard bit, or the significand if that is wider",
    );
    // The exponent field of a significand that stands at the top of the word.
    let top_field = i64::from(format.exponent_bias()) + i64::from(bits) - 1;
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
    let a_is = classify(builder, policy, &a, "a");
    let (hidden, exponent) = match policy {
        Policy::Flush => (builder.constant(1, 1), a.exponent),
        Policy::Full => {
            let exponent = effective_exponent(builder, &a, a_is.exponent_nonzero, "a");
            (a_is.exponent_nonzero, exponent)
        }
    };
    let padding = word_bits - fraction_bits - 1;
    let significand = if padding > 0 {
        let zeros = builder.constant(0, padding);
        builder.concat(&[hidden, a.fraction, zeros])
    } else {
        builder.concat(&[hidden, a.fraction])
    };
    builder.name(significand, "significand");

    builder.section("align: ones at the bottom of the magnitude");
    let top = exponent_constant(builder, top_field, difference_bits);
    let wide_exponent = builder.zero_extend(exponent, difference_bits);
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
    let integer = builder.slice(aligned, word_bits - 1, word_bits - bits);
    builder.name(integer, "integer_magnitude");
    let below_bits = word_bits - bits;
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
    let last_bit = builder.bit(integer, 0);
    let round_up = rounds_up(builder, rounding, a.sign, last_bit, guard, sticky);
    // One incrementer rounds and negates: -(m + r) is the complement of m, plus 1 - r.
    let wide = builder.zero_extend(integer, bits + 1);
    let signs = builder.sign_extend(a.sign, bits + 1);
    let complemented = builder.xor(wide, signs);
    builder.name(complemented, "integer_complemented");
    let carry = builder.xor(a.sign, round_up);
    builder.name(carry, "increment");
    let carry = builder.zero_extend(carry, bits + 1);
    let signed_integer = builder.add(complemented, carry);
    builder.name(signed_integer, "signed_integer");

    builder.section("saturate");
    // The largest magnitude, rounded up, shows as the most negative word and is out of range, too.
    let above = builder.bit(signed_integer, bits);
    let outside = if target.signed {
        let sign = builder.bit(signed_integer, bits - 1);
        builder.xor(above, sign)
    } else {
        above
    };
    builder.name(outside, "outside_range");
    let saturates = builder.or(too_large, a_is.is_infinity);
    builder.name(saturates, "beyond_word");
    // A zero has an exponent that is not too large.
    let saturates = builder.or(saturates, outside);
    builder.name(saturates, "saturates");
    let (lowest, highest) = match target.signed {
        true => (1 << (bits - 1), (1 << (bits - 1)) - 1),
        false => (0, u64::MAX >> (64 - bits)),
    };
    let lowest = builder.constant(lowest, bits);
    let highest = builder.constant(highest, bits);
    let limit = builder.mux(a.sign, lowest, highest);
    builder.name(limit, "limit");
    let number = builder.slice(signed_integer, bits - 1, 0);
    let number = builder.mux(saturates, limit, number);
    builder.name(number, "saturated");
    let zeros = builder.constant(0, bits);
    let result = builder.mux(a_is.is_nan, zeros, number);
    builder.name(result, "result");
    let flags = has_flags.then(|| {
        builder.section("flags");
        let invalid = builder.or(saturates, a_is.is_nan);
        builder.name(invalid, "is_invalid");
        let inexact = builder.or(guard, sticky);
        let valid = builder.not(invalid);
        let inexact = builder.and(inexact, valid);
        let none = builder.constant(0, 3);
        let flags = builder.concat(&[invalid, none, inexact]);
        builder.name(flags, "flags")
    });
    Answer { result, flags }
}

/// Does rounding to an integer go to the next larger magnitude?
pub(super) fn rounds_up(
    builder: &mut Builder,
    rounding: Rounding,
    sign: Wire,
    last_bit: Wire,
    guard: Wire,
    sticky: Wire,
) -> Wire {
    let inexact = |builder: &mut Builder| builder.or(guard, sticky);
    let round_up = match rounding {
        Rounding::TowardZero => builder.constant(0, 1),
        Rounding::NearestEven => {
            let odd_or_above = builder.or(sticky, last_bit);
            builder.name(odd_or_above, "odd_or_above");
            builder.and(guard, odd_or_above)
        }
        Rounding::Up => {
            let inexact = inexact(builder);
            let positive = builder.not(sign);
            builder.and(inexact, positive)
        }
        Rounding::Down => {
            let inexact = inexact(builder);
            builder.and(inexact, sign)
        }
    };
    builder.name(round_up, "round_up")
}
