//! Multiplication.

use rtl_model::float::{FloatFormat, Policy, Rounding};

use super::OperatorConfiguration;
use super::early_exponent::{EarlyExponent, round_to_nearest};
use super::pack::inexact;
use super::product_alignment::{align, alignment};
use super::round::{
    Answer, Small, Tail, Unrounded, exponent_constant, exponent_width, gathered, needs_tail, round,
};
use super::significand_product::significand_product;
use super::unpack::{classify, effective_exponent, fields, is_signalling};
use crate::netlist::{Builder, Wire};

/// The exponent is known before the product is, and with it nearly all that can become of a result
/// that is rounded to nearest and flushed. A directed rounding's largest finite number and the
/// flags would need too much of what is known only after the rounding.
fn has_early_exponent(configuration: OperatorConfiguration) -> bool {
    configuration.rounding == Rounding::NearestEven
        && configuration.policy == Policy::Flush
        && !configuration.has_flags
}

/// The sum of two biased exponents, less the bias, which is a power of two less one: one chain with
/// a carry in, and its upper bits less one.
fn biased_sum(builder: &mut Builder, format: FloatFormat, a: Wire, b: Wire) -> Wire {
    let field_bits = format.exponent_bits;
    let one = builder.constant(1, 1);
    let zero = builder.constant(0, 1);
    let [a, b] = [a, b].map(|field| builder.concat(&[zero, field, one]));
    let sum = builder.add(a, b);
    let sum = builder.slice(sum, field_bits + 1, 1);
    builder.name(sum, "exponents_and_one");
    let low = builder.slice(sum, field_bits - 2, 0);
    let middle = builder.bit(sum, field_bits - 1);
    let top = builder.bit(sum, field_bits);
    let lower = builder.not(middle);
    let differ = builder.xor(top, middle);
    let upper = builder.not(differ);
    let either = builder.or(top, middle);
    let negative = builder.not(either);
    builder.concat(&[negative, upper, lower, low])
}

/// The lower bits of a word, with zeros in front where it has not as many.
fn resized(builder: &mut Builder, word: Wire, width: u32) -> Wire {
    match builder.width(word) {
        narrow if narrow < width => builder.zero_extend(word, width),
        _ => builder.slice(word, width - 1, 0),
    }
}

/// `a * b`: the full product of the significands, normalised by at most one place.
pub(super) fn multiply(builder: &mut Builder, configuration: OperatorConfiguration) -> Answer {
    let OperatorConfiguration {
        format,
        policy,
        has_flags,
        structure,
        ..
    } = configuration;
    let fraction_bits = format.fraction_bits;
    let significand_bits = fraction_bits + 1;
    let product_bits = 2 * significand_bits;
    builder.localparam(
        "PRODUCT_BITS",
        product_bits.into(),
        "two significands of the hidden bit and the fraction",
    );
    let bias = i64::from(format.exponent_bias());
    let largest_field = i64::try_from(format.exponent_all_ones() - 1).expect("11 bits at most");
    // Where subnormal numbers are full the exponent ends at 0, and they are encoded.
    let smallest = match policy {
        Policy::Flush => 2 - bias,
        Policy::Full => 0,
    };
    let exponent_range = smallest..=2 * largest_field - bias + 1;
    let exponent_word_bits = exponent_width(format, &exponent_range);
    builder.localparam(
        "EXPONENT_BITS",
        exponent_word_bits.into(),
        match policy {
            Policy::Flush => {
                "a two's complement exponent from the smallest squared to the largest squared"
            }
            Policy::Full => {
                "an exponent from that of subnormal numbers to that of the largest squared"
            }
        },
    );

    let a_i = builder.input("a_i", format.width());
    let b_i = builder.input("b_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let b = fields(builder, format, b_i, "b");
    builder.section("special cases");
    let a_is = classify(builder, policy, &a, "a");
    let b_is = classify(builder, policy, &b, "b");
    let sign = builder.xor(a.sign, b.sign);
    builder.name(sign, "product_sign");
    let is_zero = builder.or(a_is.is_zero, b_is.is_zero);
    builder.name(is_zero, "is_zero");
    let is_infinity = builder.or(a_is.is_infinity, b_is.is_infinity);
    builder.name(is_infinity, "is_infinity");
    let any_nan = builder.or(a_is.is_nan, b_is.is_nan);
    builder.name(any_nan, "any_is_nan");
    let zero_by_infinity = builder.and(is_zero, is_infinity);
    builder.name(zero_by_infinity, "zero_by_infinity");
    let is_nan = builder.or(any_nan, zero_by_infinity);
    builder.name(is_nan, "is_nan");
    let is_invalid = has_flags.then(|| {
        let a_is_signalling = is_signalling(builder, &a, a_is.is_nan, "a");
        let b_is_signalling = is_signalling(builder, &b, b_is.is_nan, "b");
        let any_is_signalling = builder.or(a_is_signalling, b_is_signalling);
        builder.or(zero_by_infinity, any_is_signalling)
    });

    builder.section("multiply the significands, add the exponents");
    let (a_hidden, b_hidden) = match policy {
        Policy::Flush => (builder.constant(1, 1), builder.constant(1, 1)),
        Policy::Full => (a_is.exponent_nonzero, b_is.exponent_nonzero),
    };
    let a_significand = builder.concat(&[a_hidden, a.fraction]);
    builder.name(a_significand, "multiplicand");
    let b_significand = builder.concat(&[b_hidden, b.fraction]);
    builder.name(b_significand, "multiplier");
    let product = significand_product(builder, structure.multiplier, a_significand, b_significand);
    if policy == Policy::Full {
        let a_exponent = effective_exponent(builder, &a, a_hidden, "a");
        let b_exponent = effective_exponent(builder, &b, b_hidden, "b");
        let sum = biased_sum(builder, format, a_exponent, b_exponent);
        builder.name(sum, "exponent_sum");
        builder.section("place the product: left for a subnormal operand, right for a result");
        let alignment = alignment(builder, format, [&a, &b], [a_hidden, b_hidden], sum);
        let aligned = align(
            builder,
            format,
            configuration.rounding,
            sign,
            product,
            &alignment,
        );
        let exponent = resized(builder, aligned.exponent, exponent_word_bits);
        let adjustment = builder.zero_extend(aligned.increment, exponent_word_bits);
        let tail = needs_tail(configuration).then_some(Tail {
            guard: aligned.guard,
            sticky: Some(aligned.sticky),
        });
        let underflow = has_flags.then(|| {
            let inexact = inexact(builder, tail);
            builder.and(aligned.is_tiny, inexact)
        });
        return round(
            builder,
            configuration,
            &Unrounded {
                sign,
                exponent,
                adjustment,
                exponent_range,
                fraction: aligned.fraction,
                tail,
                is_nan: Some(is_nan),
                is_infinity: Some(is_infinity),
                is_zero: Some(is_zero),
                is_invalid,
                divides_by_zero: None,
                small: Small::Encoded { underflow },
                early_bounds: None,
            },
        );
    }
    let exponent = if has_early_exponent(configuration) {
        biased_sum(builder, format, a.exponent, b.exponent)
    } else {
        let a_wide = builder.zero_extend(a.exponent, exponent_word_bits);
        let b_wide = builder.zero_extend(b.exponent, exponent_word_bits);
        builder.add(a_wide, b_wide)
    };
    builder.name(exponent, "exponent_sum");

    builder.section("normalise: the product is below 4");
    let reaches_two = builder.bit(product, product_bits - 1);
    builder.name(reaches_two, "product_reaches_two");
    let fraction_at_two = builder.slice(product, product_bits - 2, significand_bits);
    let fraction_at_one = builder.slice(product, product_bits - 3, significand_bits - 1);
    let fraction = builder.mux(reaches_two, fraction_at_two, fraction_at_one);
    builder.name(fraction, "product_fraction");
    let guard_at_two = builder.bit(product, fraction_bits);
    let guard_at_one = builder.bit(product, fraction_bits - 1);
    let guard = builder.mux(reaches_two, guard_at_two, guard_at_one);
    builder.name(guard, "guard_bit");
    // The guard bit of a product below two is below the guard bit of one that is not.
    let below_either = builder.slice(product, fraction_bits - 2, 0);
    let below_either = gathered(builder, below_either, "product_below_guard");

    if has_early_exponent(configuration) {
        let last_at_two = builder.bit(product, fraction_bits + 1);
        let odd_or_below = builder.or(last_at_two, guard_at_one);
        let odd_or_sticky = builder.mux(reaches_two, odd_or_below, guard_at_two);
        builder.name(odd_or_sticky, "odd_or_sticky");
        let result = round_to_nearest(
            builder,
            format,
            &EarlyExponent {
                sign,
                exponent,
                increment: reaches_two,
                fraction,
                guard,
                sticky: below_either,
                odd_or_sticky,
                is_nan,
                is_infinity,
                is_zero,
            },
        );
        return Answer {
            result,
            flags: None,
        };
    }
    let adjustment_at_two = exponent_constant(builder, 1 - bias, exponent_word_bits);
    let adjustment_at_one = exponent_constant(builder, -bias, exponent_word_bits);
    let adjustment = builder.mux(reaches_two, adjustment_at_two, adjustment_at_one);
    builder.name(adjustment, "exponent_adjustment");
    let tail = needs_tail(configuration).then(|| {
        let below_at_two = builder.and(reaches_two, guard_at_one);
        let sticky = builder.concat(&[below_at_two, below_either]);
        builder.name(sticky, "sticky_bits");
        Tail {
            guard,
            sticky: Some(sticky),
        }
    });
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
            is_infinity: Some(is_infinity),
            is_zero: Some(is_zero),
            is_invalid,
            divides_by_zero: None,
            small: Small::Normalised,
            early_bounds: None,
        },
    )
}
