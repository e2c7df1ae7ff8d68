//! Addition and subtraction.

use rtl_model::float::Rounding;

use super::OperatorConfiguration;
use super::round::{
    Answer, Small, Tail, Unrounded, exponent_constant, exponent_width, needs_tail, round,
};
use super::shift::{leading_zeros, shift_right};
use super::unpack::{fields, is_special, is_zero, magnitude};
use crate::netlist::Builder;

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
        format, rounding, ..
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
    // The sum is below 4 times the larger operand's hidden bit, and cancels down to its last bit.
    let largest_field = i64::try_from(format.exponent_all_ones() - 1).expect("11 bits at most");
    let exponent_range = 2 - i64::from(sum_bits)..=largest_field + 1;
    let exponent_word_bits = exponent_width(format, &exponent_range);
    builder.localparam(
        "EXPONENT_BITS",
        exponent_word_bits.into(),
        "a two's complement exponent from full cancellation of the smallest to a carry of the largest",
    );

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
    let a_is_zero = is_zero(builder, &a, "a");
    let b_is_zero = is_zero(builder, &b, "b");

    builder.section("order by magnitude");
    let a_magnitude = magnitude(builder, format, a_i, "a");
    let b_magnitude = magnitude(builder, format, b_i, "b");
    let b_is_larger = builder.less_than(a_magnitude, b_magnitude);
    builder.name(b_is_larger, "b_is_larger");
    let larger_sign = builder.mux(b_is_larger, b.sign, a.sign);
    builder.name(larger_sign, "larger_sign");
    let larger_exponent = builder.mux(b_is_larger, b.exponent, a.exponent);
    builder.name(larger_exponent, "larger_exponent");
    let larger_fraction = builder.mux(b_is_larger, b.fraction, a.fraction);
    builder.name(larger_fraction, "larger_fraction");
    let smaller_fraction = builder.mux(b_is_larger, a.fraction, b.fraction);
    builder.name(smaller_fraction, "smaller_fraction");
    // Complemented here and not at the adder: this selector has an input to spare, and ones are as
    // good as zeros to shift in.
    let complement = builder.sign_extend(effective_subtraction, fraction_bits);
    let addend_fraction = builder.xor(smaller_fraction, complement);
    builder.name(addend_fraction, "addend_fraction");
    // A zero operand is always the smaller one.
    let smaller_is_zero = builder.or(a_is_zero, b_is_zero);
    builder.name(smaller_is_zero, "smaller_is_zero");
    let both_are_zero = builder.and(a_is_zero, b_is_zero);
    builder.name(both_are_zero, "both_are_zero");

    builder.section("align the smaller to the larger");
    // Both differences beside the comparison are faster than one behind it.
    let a_minus_b = builder.subtract(a.exponent, b.exponent);
    builder.name(a_minus_b, "exponent_a_minus_b");
    let b_minus_a = builder.subtract(b.exponent, a.exponent);
    builder.name(b_minus_a, "exponent_b_minus_a");
    let exponent_difference = builder.mux(b_is_larger, b_minus_a, a_minus_b);
    builder.name(exponent_difference, "exponent_difference");
    let hidden = builder.not(effective_subtraction); // a one, complemented
    let below = builder.sign_extend(effective_subtraction, ALIGNED_BITS_BELOW);
    let addend = builder.concat(&[hidden, addend_fraction, below]);
    let aligned = shift_right(
        builder,
        addend,
        exponent_difference,
        effective_subtraction,
        ALIGNED_BITS_BELOW,
        "addend",
    );
    // A zero is treated as one that is out of reach and leaves nothing behind.
    let mut is_gone = smaller_is_zero;
    let mut is_inexact = aligned.lost;
    if let Some(out_of_reach) = aligned.out_of_reach {
        is_gone = builder.or(is_gone, out_of_reach);
        is_inexact = builder.or(is_inexact, out_of_reach);
    }
    builder.name(is_gone, "addend_is_gone");
    builder.name(is_inexact, "addend_is_inexact");
    let nothing = builder.sign_extend(effective_subtraction, aligned_bits);
    let aligned = builder.mux(is_gone, nothing, aligned.word);
    builder.name(aligned, "addend_aligned");
    let smaller_is_nonzero = builder.not(smaller_is_zero);
    let sticky_bit = builder.and(is_inexact, smaller_is_nonzero);
    builder.name(sticky_bit, "sticky_bit");

    builder.section("add the significands");
    // The lowest place holds the sticky bit and lets the complement's carry in: a subtraction
    // carries there unless the sticky bit borrows it, and the sticky bit remains as the sum's.
    let zero = builder.constant(0, 1);
    let hidden = builder.constant(1, 1);
    let below = builder.constant(0, ALIGNED_BITS_BELOW);
    let larger_significand =
        builder.concat(&[zero, hidden, larger_fraction, below, effective_subtraction]);
    let sticky_place = builder.xor(sticky_bit, effective_subtraction);
    builder.name(sticky_place, "sticky_place");
    let addend_significand = builder.concat(&[effective_subtraction, aligned, sticky_place]);
    let significand_sum = builder.add(larger_significand, addend_significand);
    builder.name(significand_sum, "significand_sum");

    builder.section("normalise");
    let zeros = leading_zeros(builder, significand_sum, "sum");
    // The leading one itself is not needed any more.
    let sum_below = builder.slice(significand_sum, sum_bits - 2, 0);
    let normalised_sum = builder.shift_left(sum_below, zeros.count);
    builder.name(normalised_sum, "normalised_sum");
    let wide_exponent = builder.zero_extend(larger_exponent, exponent_word_bits);
    let wide_count = builder.zero_extend(zeros.count, exponent_word_bits);
    let exponent = builder.subtract(wide_exponent, wide_count);
    builder.name(exponent, "sum_exponent");
    // A carry out leaves no leading zero, and is one place above the larger operand's one.
    let adjustment = exponent_constant(builder, 1, exponent_word_bits);
    let fraction_low = sum_bits - 1 - fraction_bits;
    let fraction = builder.slice(normalised_sum, sum_bits - 2, fraction_low);
    builder.name(fraction, "sum_fraction");
    let tail = needs_tail(configuration).then(|| {
        let guard = builder.bit(normalised_sum, fraction_low - 1);
        builder.name(guard, "guard_bit");
        let below_guard = builder.slice(normalised_sum, fraction_low - 2, 0);
        let sticky = builder.any_bit(below_guard);
        builder.name(sticky, "sum_sticky_bit");
        Tail {
            guard,
            sticky: Some(sticky),
        }
    });

    builder.section("special cases");
    let sum_is_zero = builder.not(zeros.any);
    builder.name(sum_is_zero, "sum_is_zero");
    let is_zero = builder.or(both_are_zero, sum_is_zero);
    builder.name(is_zero, "is_zero");
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
    let is_special = builder.or(a_is_special, b_is_special);
    builder.name(is_special, "is_special");
    let both_are_special = builder.and(a_is_special, b_is_special);
    builder.name(both_are_special, "both_are_special");
    let infinities_differ = builder.and(both_are_special, effective_subtraction);
    builder.name(infinities_differ, "infinities_differ");
    let fraction_nonzero = builder.any_bit(larger_fraction);
    builder.name(fraction_nonzero, "larger_fraction_nonzero");
    let invalid = builder.or(fraction_nonzero, infinities_differ);
    builder.name(invalid, "invalid");
    let is_nan = builder.and(is_special, invalid);
    builder.name(is_nan, "is_nan");

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
            is_nan: Some(is_nan),
            is_infinity: Some(is_special),
            is_zero: Some(is_zero),
            is_invalid: None,
            divides_by_zero: None,
            small: Small::Normalised,
        },
    )
}
