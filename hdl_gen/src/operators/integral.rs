//! Rounding a float to an integer that is a float.

use rtl_model::float::{Policy, Rounding};

use super::OperatorConfiguration;
use super::integer::rounds_up;
use super::round::Answer;
use super::unpack::{classify, fields, is_signalling, magnitude};
use crate::netlist::{Builder, Wire};

/// The integer that `a` rounds to, as a float: the fraction bits below the binary point are
/// cleared, and where it rounds away from zero the magnitude grows by one. With `tells_inexact` the
/// flag inexact says whether that is `a` itself.
pub(super) fn round_to_integral(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    rounding: Rounding,
    tells_inexact: bool,
) -> Answer {
    let OperatorConfiguration {
        format,
        policy,
        has_flags,
        ..
    } = configuration;
    let (exponent_bits, fraction_bits) = (format.exponent_bits, format.fraction_bits);
    let magnitude_bits = exponent_bits + fraction_bits;
    let bias = u64::try_from(format.exponent_bias()).expect("a positive bias");
    let a_i = builder.input("a_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let a_magnitude = magnitude(builder, format, a_i, "a");
    let a_is = classify(builder, policy, &a, "a");
    let a_is_special = builder.or(a_is.is_infinity, a_is.is_nan);
    builder.name(a_is_special, "a_has_no_fraction");

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

    builder.section("round");
    let zero_bit = builder.constant(0, 1);
    let (guard, sticky, last_bit) = if rounding == Rounding::NearestEven {
        // The place of one half is the first below the point, that of one the last above it.
        let upper = builder.slice(below_point, fraction_bits - 1, 1);
        let below_half = builder.concat(&[zero_bit, upper]);
        builder.name(below_half, "below_half");
        let sticky_bits = builder.and(fractional, below_half);
        let sticky = builder.any_bit(sticky_bits);
        builder.name(sticky, "sticky_bit");
        let not_below_half = builder.not(below_half);
        let guard_bits = builder.and(fractional, not_below_half);
        let guard = builder.any_bit(guard_bits);
        builder.name(guard, "guard_bit");
        let hidden = builder.constant(1, 1);
        let significand = builder.concat(&[hidden, a.fraction]);
        let not_below_point = builder.not(below_point);
        let at_or_above = builder.concat(&[hidden, not_below_point]);
        let one_moved = builder.concat(&[below_point, hidden]);
        let place_of_one = builder.and(at_or_above, one_moved);
        builder.name(place_of_one, "place_of_one");
        let last_bits = builder.and(significand, place_of_one);
        let last_bit = builder.any_bit(last_bits);
        builder.name(last_bit, "last_bit");
        (guard, sticky, last_bit)
    } else {
        let has_fraction = builder.any_bit(fractional);
        builder.name(has_fraction, "has_fraction");
        (has_fraction, zero_bit, zero_bit)
    };
    let grows = rounds_up(builder, rounding, a.sign, last_bit, guard, sticky);
    // With all bits below the point set, one more carries into the integer's last place; the carry
    // runs into the exponent where that is right.
    let no_exponent = builder.constant(0, exponent_bits);
    let wide_below_point = builder.concat(&[no_exponent, below_point]);
    let filled = builder.or(a_magnitude, wide_below_point);
    builder.name(filled, "filled_magnitude");
    let increment = builder.zero_extend(grows, magnitude_bits);
    let carried = builder.add(filled, increment);
    builder.name(carried, "carried");
    // Where nothing was added the filled bits are cleared, where it was they already are.
    let keep = builder.not(wide_below_point);
    let integer = builder.and(carried, keep);
    builder.name(integer, "integer_magnitude");

    builder.section("below one: zero or one");
    let nonzero = builder.not(a_is.is_zero);
    builder.name(nonzero, "a_is_nonzero");
    let becomes_one = match rounding {
        Rounding::TowardZero => zero_bit,
        Rounding::NearestEven => above_half(builder, configuration, &a.exponent, &a.fraction, bias),
        Rounding::Up => {
            let positive = builder.not(a.sign);
            builder.and(positive, nonzero)
        }
        Rounding::Down => builder.and(a.sign, nonzero),
    };
    builder.name(becomes_one, "becomes_one");
    let one = builder.constant(format.one(), magnitude_bits);
    let zero = builder.constant(0, magnitude_bits);
    let small = builder.mux(becomes_one, one, zero);
    builder.name(small, "result_below_one");

    builder.section("special cases");
    let result = builder.mux(below_one, small, integer);
    builder.name(result, "finite_magnitude");
    let result_is_finite = result;
    let result = builder.mux(a_is_special, a_magnitude, result);
    let quiet_nan = builder.constant(format.quiet_nan(), magnitude_bits);
    let result = builder.mux(a_is.is_nan, quiet_nan, result);
    builder.name(result, "result_magnitude");
    let is_number = builder.not(a_is.is_nan);
    let sign = builder.and(a.sign, is_number);
    builder.name(sign, "result_sign");
    let result = builder.concat(&[sign, result]);

    let flags = has_flags.then(|| {
        builder.section("flags");
        let invalid = is_signalling(builder, &a, a_is.is_nan, "a");
        let finite = builder.not(a_is_special);
        // Only where fractions reach below the point in the largest numbers.
        let overflow = if u64::from(fraction_bits) > bias {
            let field = builder.slice(result_is_finite, magnitude_bits - 1, fraction_bits);
            let all_ones = builder.all_bits(field);
            builder.and(all_ones, finite)
        } else {
            zero_bit
        };
        let inexact = if tells_inexact {
            let fraction = builder.or(guard, sticky);
            let inexact = builder.mux(below_one, nonzero, fraction);
            builder.and(inexact, finite)
        } else {
            overflow
        };
        let none = builder.constant(0, 1);
        let flags = builder.concat(&[invalid, none, overflow, none, inexact]);
        builder.name(flags, "flags")
    });
    Answer { result, flags }
}

/// Is a magnitude below one above one half? At one half it rounds to the even zero.
fn above_half(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    exponent: &Wire,
    fraction: &Wire,
    bias: u64,
) -> Wire {
    let exponent_bits = builder.width(*exponent);
    if bias == 1 {
        // Everything below one is subnormal, its first fraction bit one half.
        if configuration.policy == Policy::Flush {
            return builder.constant(0, 1);
        }
        let top = builder.width(*fraction) - 1;
        let half = builder.bit(*fraction, top);
        let below = builder.slice(*fraction, top - 1, 0);
        let more = builder.any_bit(below);
        return builder.and(half, more);
    }
    let field = builder.constant(bias - 1, exponent_bits);
    let reaches_half = builder.equal(*exponent, field);
    let more = builder.any_bit(*fraction);
    builder.and(reaches_half, more)
}
