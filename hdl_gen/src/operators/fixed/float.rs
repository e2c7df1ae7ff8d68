//! Between fixed point and floats.

use rtl_model::fixed::Overflow;
use rtl_model::float::{FloatFormat, Policy};

use super::super::round::{
    Small, Tail, Unrounded, exponent_constant, exponent_width, needs_tail, round,
};
use super::super::shift::{leading_zeros, shift_right};
use super::super::unpack::{classify, effective_exponent, fields};
use super::super::{FloatOperator, OperatorConfiguration};
use super::fit::{Rounded, Special, fit};
use super::quotient::sign_and_magnitude;
use super::round::{Beyond, SignMagnitude, round_magnitude};
use super::{Answer, FixedConfiguration, operand};
use crate::netlist::{Builder, Meaning, Wire};

/// Where a float's significand is aligned.
#[derive(Clone, Copy)]
struct Window {
    /// The exponent of the word's first bit, where a significand stands before it is moved right.
    top_exponent: i64,
    /// Bits of the word: down to a guard bit behind the result's last place, and no fewer than the
    /// significand has.
    bits: u32,
    /// Bits of the word down to the result's last place.
    kept_bits: u32,
}

fn window(configuration: FixedConfiguration, source: FloatFormat, policy: Policy) -> Window {
    let result = configuration.result;
    let bias = i64::from(source.exponent_bias());
    let fraction_bits = i64::from(source.fraction_bits);
    let largest = i64::try_from(source.exponent_all_ones()).expect("11 bits at most") - 1 - bias;
    // What is larger than the result's first bit saturates. To be wrapped it is moved to where it
    // belongs, from above the word's kept bits on.
    let mut top_exponent = i64::from(result.integer_bits) - 1;
    if configuration.overflow == Overflow::Wrap {
        top_exponent = (top_exponent + 1 + fraction_bits).min(largest.max(top_exponent));
    }
    // A subnormal number has no one before its point: its exponent does not say how large it is.
    if policy == Policy::Full {
        top_exponent = top_exponent.max(1 - bias);
    }
    let kept_bits = top_exponent + 1 + i64::from(result.fraction_bits);
    let kept_bits = u32::try_from(kept_bits).expect("at least the result's own");
    Window {
        top_exponent,
        bits: (kept_bits + 1).max(source.fraction_bits + 1),
        kept_bits,
    }
}

/// Bits of the widest word of the conversion from a float.
pub(super) fn widest_word(
    configuration: FixedConfiguration,
    source: FloatFormat,
    policy: Policy,
) -> u32 {
    let window = window(configuration, source, policy);
    window.bits.max(window.kept_bits + 2)
}

/// The float `a` as a fixed-point number.
pub(super) fn from_float(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    source: FloatFormat,
    policy: Policy,
) -> Answer {
    let window = window(configuration, source, policy);
    builder.localparam(
        "WINDOW_BITS",
        window.bits.into(),
        "the significand or, if that is more, all that is kept and a guard bit",
    );
    // The exponent field of a significand that stands at the top of the word.
    let top_field = window.top_exponent + i64::from(source.exponent_bias());
    let difference_bits = 1 + source
        .exponent_bits
        .max(u64::BITS - top_field.unsigned_abs().leading_zeros());
    builder.localparam(
        "DIFFERENCE_BITS",
        difference_bits.into(),
        "a two's complement distance between the exponent and the word's first bit",
    );
    let a_i = builder.input("a_i", source.width());
    builder.mean(a_i, Meaning::Float(source));

    builder.section("unpack");
    let a = fields(builder, source, a_i, "a");
    let a_is = classify(builder, policy, &a, "a");
    let (hidden, exponent) = match policy {
        Policy::Flush => (builder.constant(1, 1), a.exponent),
        Policy::Full => (
            a_is.exponent_nonzero,
            effective_exponent(builder, &a, a_is.exponent_nonzero, "a"),
        ),
    };
    let padding = window.bits - source.fraction_bits - 1;
    let mut significand = vec![hidden, a.fraction];
    if padding > 0 {
        significand.push(builder.constant(0, padding));
    }
    let significand = builder.concat(&significand);

    builder.section("align the point");
    let top = exponent_constant(builder, top_field, difference_bits);
    let exponent = builder.zero_extend(exponent, difference_bits);
    let difference = builder.subtract(top, exponent);
    builder.name(difference, "shift_difference");
    let above = builder.bit(difference, difference_bits - 1);
    builder.name(above, "above_window");
    let amount = builder.slice(difference, difference_bits - 2, 0);
    let shifted = shift_right(builder, significand, amount, padding, "significand");
    // What is above is beyond the range; wrapped, its low bits are zeros.
    let mut is_gone = builder.or(a_is.is_zero, above);
    let mut is_inexact = shifted.lost;
    if let Some(out_of_reach) = shifted.out_of_reach {
        is_gone = builder.or(is_gone, out_of_reach);
        is_inexact = builder.or(is_inexact, out_of_reach);
    }
    builder.name(is_gone, "is_gone");
    let nothing = builder.constant(0, window.bits);
    let aligned = builder.mux(is_gone, nothing, shifted.word);
    builder.name(aligned, "aligned");
    let kept = builder.slice(aligned, window.bits - 1, window.bits - window.kept_bits);
    builder.name(kept, "kept_magnitude");
    let below_bits = window.bits - window.kept_bits;
    let guard = builder.bit(aligned, below_bits - 1);
    builder.name(guard, "guard_bit");
    let nothing_below = builder.or(a_is.is_zero, above);
    let something_below = builder.not(nothing_below);
    let mut sticky = builder.and(is_inexact, something_below);
    if below_bits > 1 {
        let below_guard = builder.slice(aligned, below_bits - 2, 0);
        let below_guard = builder.any_bit(below_guard);
        sticky = builder.or(sticky, below_guard);
    }
    builder.name(sticky, "sticky_bit");

    let rounded = round_magnitude(
        builder,
        configuration,
        &SignMagnitude {
            sign: Some(a.sign),
            kept,
            guard: Some(guard),
            sticky: Some(sticky),
        },
    );
    let is_invalid = builder.or(a_is.is_infinity, a_is.is_nan);
    builder.name(is_invalid, "invalid");
    fit(
        builder,
        configuration,
        &Rounded {
            beyond: Some(Beyond {
                is_beyond: above,
                negative: Some(a.sign),
            }),
            special: Some(Special {
                to_end: a_is.is_infinity,
                negative: Some(a.sign),
                to_zero: Some(a_is.is_nan),
                divides_by_zero: None,
                is_invalid: Some(is_invalid),
            }),
            ..rounded
        },
    )
}

/// Bits of the widest word of the conversion to a float: of the rounding's addition, exponent,
/// fraction and what is below.
pub(super) fn widest_sum(configuration: FixedConfiguration, target: FloatFormat) -> u32 {
    let below = configuration.a.width().saturating_sub(target.fraction_bits);
    let count_bits = u32::BITS - configuration.a.width().leading_zeros();
    target.exponent_bits.max(count_bits) + 3 + target.fraction_bits + below.min(2)
}

/// The fixed-point number `a` as a float: leading zeros, one shift, the floats' rounder.
pub(super) fn to_float(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    target: FloatFormat,
    policy: Policy,
) -> Answer {
    let a = configuration.a;
    let fraction_bits = target.fraction_bits;
    // Counting zeros takes two bits at least.
    let value_bits = a.width().max(2);
    let count_bits = u32::BITS - (value_bits - 1).leading_zeros();
    let bias = i64::from(target.exponent_bias());
    // The biased exponents of the word's last place and of its first.
    let lowest = bias - i64::from(a.fraction_bits);
    let highest = lowest + i64::from(value_bits) - 1;
    let exponent_range = lowest..=highest;
    let exponent_bits = exponent_width(target, &exponent_range).max(count_bits + 1);
    builder.localparam(
        "EXPONENT_BITS",
        exponent_bits.into(),
        "the biased exponent of any nonzero result",
    );
    let a_i = operand(builder, "a_i", a);
    builder.section("sign and magnitude");
    let number = sign_and_magnitude(builder, a_i, a, "a");
    let magnitude: Wire = builder.zero_extend(number.magnitude, value_bits);
    let sign = match number.negative {
        Some(negative) => negative,
        None => builder.constant(0, 1),
    };

    builder.section("normalise");
    let zeros = leading_zeros(builder, magnitude, "magnitude");
    let is_zero = builder.not(zeros.any);
    builder.name(is_zero, "is_zero");
    let below_one = builder.slice(magnitude, value_bits - 2, 0);
    let normalised = builder.shift_left(below_one, zeros.count);
    builder.name(normalised, "normalised");
    let below_bits = value_bits - 1;
    let fraction = if below_bits >= fraction_bits {
        builder.slice(normalised, below_bits - 1, below_bits - fraction_bits)
    } else {
        let zeros = builder.constant(0, fraction_bits - below_bits);
        builder.concat(&[normalised, zeros])
    };
    builder.name(fraction, "fraction");

    let rounder = OperatorConfiguration {
        policy,
        has_flags: configuration.has_flags,
        ..OperatorConfiguration::new(
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits: 1,
            },
            target,
            configuration.rounding,
        )
    };
    let asks_below = needs_tail(rounder) || policy == Policy::Full;
    let tail = (asks_below && below_bits > fraction_bits).then(|| {
        let guard_place = below_bits - fraction_bits - 1;
        let guard = builder.bit(normalised, guard_place);
        builder.name(guard, "guard_bit");
        let sticky = if guard_place > 0 {
            let below_guard = builder.slice(normalised, guard_place - 1, 0);
            let sticky = builder.any_bit(below_guard);
            builder.name(sticky, "sticky_bit")
        } else {
            builder.constant(0, 1)
        };
        Tail {
            guard,
            sticky: Some(sticky),
        }
    });

    builder.section("exponent: that of the word's first place, less the leading zeros");
    let count = builder.zero_extend(zeros.count, exponent_bits);
    // -n - 1, without an adder.
    let exponent = builder.not(count);
    builder.name(exponent, "minus_zeros");
    let adjustment = exponent_constant(builder, highest + 1, exponent_bits);
    round(
        builder,
        rounder,
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
