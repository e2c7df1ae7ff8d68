//! Addition and subtraction.

use rtl_model::float::{FloatFormat, Policy, Rounding};

use super::OperatorConfiguration;
use super::normalise::{normalise_down_to, normalise_sum};
use super::round::{
    Answer, EarlyBounds, Small, Tail, Unrounded, exponent_width, needs_tail, round,
};
use super::shift::{rows, shift_right};
use super::unpack::{
    Fields, effective_exponent, exponent_nonzero, fields, is_signalling, is_special, magnitude,
};
use crate::netlist::{Builder, Wire};

/// Bits below the smaller significand that are kept exactly when it is aligned: guard and round.
/// One bit of cancellation moves the round bit into the guard's place; after more than one the
/// operands were at most one place apart and nothing lies below these bits.
const ALIGNED_BITS_BELOW: u32 = 2;

/// `a + b`, or `a - b` where `subtract`: one path, the smaller magnitude aligned to the larger.
pub(super) fn add(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    subtract: bool,
) -> Answer {
    let OperatorConfiguration {
        format,
        rounding,
        policy,
        ..
    } = configuration;
    let fraction_bits = format.fraction_bits;
    let aligned_bits = 1 + fraction_bits + ALIGNED_BITS_BELOW;
    builder.localparam(
        "ALIGNED_BITS",
        aligned_bits.into(),
        "the hidden bit, the fraction, guard and round; all below is one sticky bit",
    );
    let sum_bits = aligned_bits + 2;
    builder.localparam(
        "SUM_BITS",
        sum_bits.into(),
        "the aligned bits, a carry above and the sticky bit below",
    );
    let largest_field = i64::try_from(format.exponent_all_ones() - 1).expect("11 bits at most");
    // The sum is below 4 times the larger operand's hidden bit. It cancels down to its last bit, or
    // to exponent 0 where that is encoded.
    let (smallest, reason) = match policy {
        Policy::Flush => (
            2 - i64::from(sum_bits),
            "a two's complement exponent from full cancellation of the smallest to a carry of the largest",
        ),
        Policy::Full => (
            0,
            "the exponent field, and a bit for two carries of the largest",
        ),
    };
    let exponent_range = smallest..=largest_field + 1;
    let exponent_word_bits = exponent_width(format, &exponent_range);
    builder.localparam("EXPONENT_BITS", exponent_word_bits.into(), reason);

    let a_i = builder.input("a_i", format.width());
    let b_i = builder.input("b_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let mut b = fields(builder, format, b_i, "b");
    if subtract {
        b.sign = builder.not(b.sign);
        builder.name(b.sign, "addend_sign");
    }
    let effective_subtraction = builder.xor(a.sign, b.sign);
    builder.name(effective_subtraction, "effective_subtraction");
    let a_exponent_nonzero = exponent_nonzero(builder, &a, "a");
    let b_exponent_nonzero = exponent_nonzero(builder, &b, "b");

    builder.section("order by magnitude");
    let a_magnitude = magnitude(builder, format, a_i, "a");
    let b_magnitude = magnitude(builder, format, b_i, "b");
    let a_wide = builder.zero_extend(a_magnitude, format.width());
    let b_wide = builder.zero_extend(b_magnitude, format.width());
    let difference = builder.subtract(a_wide, b_wide);
    builder.name(difference, "magnitude_difference");
    let b_is_larger = builder.bit(difference, format.width() - 1);
    builder.name(b_is_larger, "b_is_larger");
    let larger_sign = builder.mux(b_is_larger, b.sign, a.sign);
    builder.name(larger_sign, "larger_sign");
    let larger_exponent = builder.mux(b_is_larger, b.exponent, a.exponent);
    builder.name(larger_exponent, "larger_exponent");
    let larger_fraction = builder.mux(b_is_larger, b.fraction, a.fraction);
    builder.name(larger_fraction, "larger_fraction");
    let smaller_fraction = builder.mux(b_is_larger, a.fraction, b.fraction);
    builder.name(smaller_fraction, "smaller_fraction");
    // What has exponent field 0 is never larger than what has another.
    let smaller_exponent_nonzero = builder.and(a_exponent_nonzero, b_exponent_nonzero);
    builder.name(smaller_exponent_nonzero, "smaller_exponent_nonzero");
    let larger_exponent_nonzero = builder.or(a_exponent_nonzero, b_exponent_nonzero);
    builder.name(larger_exponent_nonzero, "larger_exponent_nonzero");

    builder.section("align the smaller to the larger");
    let distance = match policy {
        Policy::Flush => distance_by_magnitudes(
            builder,
            format,
            aligned_bits,
            &a,
            &b,
            difference,
            b_is_larger,
        ),
        Policy::Full => {
            let a_exponent = effective_exponent(builder, &a, a_exponent_nonzero, "a");
            let b_exponent = effective_exponent(builder, &b, b_exponent_nonzero, "b");
            // Both differences beside the comparison are faster than one behind it.
            let a_minus_b = builder.subtract(a_exponent, b_exponent);
            builder.name(a_minus_b, "exponent_a_minus_b");
            let b_minus_a = builder.subtract(b_exponent, a_exponent);
            builder.name(b_minus_a, "exponent_b_minus_a");
            let distance = builder.mux(b_is_larger, b_minus_a, a_minus_b);
            builder.name(distance, "exponent_distance")
        }
    };
    let smaller_hidden = match policy {
        Policy::Flush => builder.constant(1, 1),
        Policy::Full => smaller_exponent_nonzero,
    };
    let below = builder.constant(0, ALIGNED_BITS_BELOW);
    let addend = builder.concat(&[smaller_hidden, smaller_fraction, below]);
    let aligned = shift_right(builder, addend, distance, ALIGNED_BITS_BELOW, "addend");
    let smaller_is_nonzero = match policy {
        Policy::Flush => smaller_exponent_nonzero,
        Policy::Full => {
            let fraction_nonzero = builder.any_bit(smaller_fraction);
            builder.or(smaller_exponent_nonzero, fraction_nonzero)
        }
    };
    builder.name(smaller_is_nonzero, "smaller_is_nonzero");
    // A flushed zero is treated as one that is out of reach and leaves nothing behind.
    let mut is_gone = (policy == Policy::Flush).then(|| builder.not(smaller_is_nonzero));
    let mut is_inexact = aligned.lost;
    if let Some(out_of_reach) = aligned.out_of_reach {
        is_gone = Some(match is_gone {
            Some(is_zero) => builder.or(is_zero, out_of_reach),
            None => out_of_reach,
        });
        is_inexact = builder.or(is_inexact, out_of_reach);
    }
    let mut aligned = aligned.word;
    if let Some(is_gone) = is_gone {
        builder.name(is_gone, "addend_is_gone");
        let nothing = builder.constant(0, aligned_bits);
        aligned = builder.mux(is_gone, nothing, aligned);
    }
    builder.name(aligned, "addend_aligned");
    builder.name(is_inexact, "addend_is_inexact");
    let sticky_bit = builder.and(is_inexact, smaller_is_nonzero);
    builder.name(sticky_bit, "sticky_bit");

    builder.section("add the significands");
    // The lowest place holds the sticky bit and lets the complement's carry in: a subtraction
    // carries there unless the sticky bit borrows it, and the sticky bit remains as the sum's.
    let larger_hidden = match policy {
        Policy::Flush => builder.constant(1, 1),
        Policy::Full => larger_exponent_nonzero,
    };
    let zero = builder.constant(0, 1);
    let larger_significand = builder.concat(&[
        zero,
        larger_hidden,
        larger_fraction,
        below,
        effective_subtraction,
    ]);
    let addend_significand = builder.concat(&[zero, aligned, sticky_bit]);
    let complement = builder.sign_extend(effective_subtraction, sum_bits);
    let addend_significand = builder.xor(addend_significand, complement);
    builder.name(addend_significand, "addend_complemented");
    let significand_sum = builder.add(larger_significand, addend_significand);
    builder.name(significand_sum, "significand_sum");

    builder.section("normalise");
    // The sticky bit stays where it is: it is 0 where the sum moves by two places or more.
    let sticky_bit = builder.bit(significand_sum, 0);
    let exact_sum = builder.slice(significand_sum, sum_bits - 1, 1);
    let kept = 1 + fraction_bits + if needs_tail(configuration) { 3 } else { 0 };
    let normalised = match policy {
        Policy::Flush => normalise_sum(
            builder,
            exact_sum,
            larger_exponent,
            exponent_word_bits,
            kept,
        ),
        Policy::Full => {
            let exponent_zero = builder.not(larger_exponent_nonzero);
            let exponent_low = builder.bit(larger_exponent, 0);
            let exponent_low = builder.or(exponent_low, exponent_zero);
            let exponent_high = builder.slice(larger_exponent, format.exponent_bits - 1, 1);
            let exponent = builder.concat(&[exponent_high, exponent_low]);
            builder.name(exponent, "larger_effective_exponent");
            normalise_down_to(builder, exact_sum, exponent, exponent_word_bits)
        }
    };
    let early_bounds = (policy == Policy::Flush).then(|| {
        // A sum has at most one more bit than is kept where it carries, so that it does not carry
        // again when rounded: it overflows only from the largest exponent, and by one.
        let highest = builder.constant(format.exponent_all_ones() - 1, format.exponent_bits);
        let is_highest = builder.equal(larger_exponent, highest);
        builder.name(is_highest, "larger_is_highest");
        let top_two = builder.slice(exact_sum, sum_bits - 2, sum_bits - 3);
        let stays_up = builder.any_bit(top_two);
        builder.name(stays_up, "sum_keeps_exponent");
        let may_overflow = builder.and(is_highest, stays_up);
        builder.name(may_overflow, "may_overflow");
        // A sum of normal numbers is a multiple of the last bit of the smallest: below that one it
        // is exact.
        let places_bits = builder.width(normalised.places).max(format.exponent_bits);
        let places = builder.zero_extend(normalised.places, places_bits);
        let exponent = builder.zero_extend(larger_exponent, places_bits);
        let underflow = builder.less_than(exponent, places);
        EarlyBounds {
            may_overflow,
            underflow: builder.name(underflow, "underflow"),
        }
    });
    let top = builder.width(normalised.word) - 1;
    let fraction = builder.slice(normalised.word, top - 1, top - fraction_bits);
    builder.name(fraction, "sum_fraction");
    let tail = needs_tail(configuration).then(|| {
        let guard = builder.bit(normalised.word, 2);
        builder.name(guard, "guard_bit");
        let below_guard = builder.slice(normalised.word, 1, 0);
        let below_guard = builder.concat(&[below_guard, sticky_bit]);
        let sticky = builder.any_bit(below_guard);
        builder.name(sticky, "sum_sticky_bit");
        Tail {
            guard,
            sticky: Some(sticky),
        }
    });

    builder.section("special cases");
    let mut is_zero = builder.not(normalised.any);
    builder.name(is_zero, "sum_is_zero");
    if policy == Policy::Flush {
        let both_are_zero = builder.not(larger_exponent_nonzero);
        is_zero = builder.or(both_are_zero, is_zero);
        builder.name(is_zero, "is_zero");
    }
    let cancelled = builder.and(is_zero, effective_subtraction);
    builder.name(cancelled, "cancelled");
    // An exact zero of operands of different signs is +0, or -0 where the rounding is down.
    let sign = if rounding == Rounding::Down {
        builder.or(larger_sign, cancelled)
    } else {
        let not_cancelled = builder.not(cancelled);
        builder.and(larger_sign, not_cancelled)
    };
    builder.name(sign, "sum_sign");
    // Infinities and NaNs are the largest magnitudes, and the NaNs the larger of these.
    let a_is_special = is_special(builder, &a, "a");
    let b_is_special = is_special(builder, &b, "b");
    let either_is_special = builder.or(a_is_special, b_is_special);
    builder.name(either_is_special, "is_special");
    let both_are_special = builder.and(a_is_special, b_is_special);
    builder.name(both_are_special, "both_are_special");
    let both_differ = builder.and(both_are_special, effective_subtraction);
    builder.name(both_differ, "specials_differ_in_sign");
    let fraction_nonzero = builder.any_bit(larger_fraction);
    builder.name(fraction_nonzero, "larger_fraction_nonzero");
    let no_number = builder.or(fraction_nonzero, both_differ);
    builder.name(no_number, "no_number");
    let is_nan = builder.and(either_is_special, no_number);
    builder.name(is_nan, "is_nan");
    let is_invalid = configuration.has_flags.then(|| {
        // With two infinities neither is a NaN.
        let fraction_zero = builder.not(fraction_nonzero);
        let infinities_differ = builder.and(both_differ, fraction_zero);
        builder.name(infinities_differ, "infinities_differ");
        let mut signals = |operand: &Fields, is_special, name| {
            let fraction_nonzero = builder.any_bit(operand.fraction);
            builder.name(fraction_nonzero, format!("{name}_fraction_nonzero"));
            let is_nan = builder.and(is_special, fraction_nonzero);
            is_signalling(builder, operand, is_nan, name)
        };
        let a_signals = signals(&a, a_is_special, "a");
        let b_signals = signals(&b, b_is_special, "b");
        let any_signals = builder.or(a_signals, b_signals);
        builder.or(any_signals, infinities_differ)
    });

    round(
        builder,
        configuration,
        &Unrounded {
            sign,
            exponent: normalised.exponent,
            adjustment: normalised.adjustment,
            exponent_range,
            fraction,
            tail,
            is_nan: Some(is_nan),
            is_infinity: Some(either_is_special),
            is_zero: Some(is_zero),
            is_invalid,
            divides_by_zero: None,
            small: match policy {
                Policy::Flush => Small::Normalised,
                // A sum of numbers is a multiple of the smallest: below the normal ones it is exact.
                Policy::Full => Small::Encoded { underflow: None },
            },
            early_bounds,
        },
    )
}

/// The distance of the exponents, from the difference of the magnitudes, whose upper bits are the
/// difference of the exponents but for a borrow from the fractions. Where `b` is larger their
/// complement is one short of the distance if there was no borrow, else they are if there was one;
/// the lowest bit tells, for it must be the parity of the exponents.
fn distance_by_magnitudes(
    builder: &mut Builder,
    format: FloatFormat,
    aligned_bits: u32,
    a: &Fields,
    b: &Fields,
    difference: Wire,
    b_is_larger: Wire,
) -> Wire {
    let (exponent_bits, fraction_bits) = (format.exponent_bits, format.fraction_bits);
    let upper = builder.slice(difference, format.width() - 2, fraction_bits);
    let complement = builder.sign_extend(b_is_larger, exponent_bits);
    let nearly = builder.xor(upper, complement);
    builder.name(nearly, "distance_or_one_less");
    let a_low = builder.bit(a.exponent, 0);
    let b_low = builder.bit(b.exponent, 0);
    let parity = builder.xor(a_low, b_low);
    builder.name(parity, "distance_is_odd");
    let is_even = builder.not(parity);
    let top_row = rows(aligned_bits) - 1;
    // Carries by gates: a chain of so few bits takes longer.
    let low = builder.bit(nearly, 0);
    let mut carry = builder.and(low, is_even);
    let mut bits = vec![parity];
    for place in 1..exponent_bits {
        builder.name(carry, format!("distance_carry_{place}"));
        let bit = builder.bit(nearly, place);
        bits.push(if place < top_row {
            builder.xor(bit, carry)
        } else {
            // Where both are set the distance is out of reach, whatever the bit.
            builder.or(bit, carry)
        });
        carry = builder.and(carry, bit);
    }
    bits.reverse();
    let distance = builder.concat(&bits);
    builder.name(distance, "exponent_distance")
}
