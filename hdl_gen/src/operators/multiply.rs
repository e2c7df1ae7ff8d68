//! Multiplication.

use rtl_model::float::{FloatFormat, Rounding};

use super::round::{Tail, Unrounded, exponent_constant, exponent_width, needs_tail, round};
use super::unpack::{classify, fields};
use crate::netlist::{Builder, Wire};

/// `a * b`: the full product of the significands, normalised by at most one place.
pub(super) fn multiply(builder: &mut Builder, format: FloatFormat, rounding: Rounding) -> Wire {
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
    let exponent_range = 2 - bias..=2 * largest_field - bias + 1;
    let exponent_word_bits = exponent_width(format, &exponent_range);
    builder.localparam(
        "EXPONENT_BITS",
        exponent_word_bits.into(),
        "a two's complement exponent from the smallest squared to the largest squared",
    );

    let a_i = builder.input("a_i", format.width());
    let b_i = builder.input("b_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let b = fields(builder, format, b_i, "b");
    let one = builder.constant(1, 1);
    let a_significand = builder.concat(&[one, a.fraction]);
    builder.name(a_significand, "a_significand");
    let b_significand = builder.concat(&[one, b.fraction]);
    builder.name(b_significand, "b_significand");

    builder.section("special cases");
    let a_is = classify(builder, &a, "a");
    let b_is = classify(builder, &b, "b");
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

    builder.section("multiply the significands, add the exponents");
    let product = builder.multiply(a_significand, b_significand);
    builder.name(product, "significand_product");
    let a_wide = builder.zero_extend(a.exponent, exponent_word_bits);
    let b_wide = builder.zero_extend(b.exponent, exponent_word_bits);
    let exponent = builder.add(a_wide, b_wide);
    builder.name(exponent, "exponent_sum");

    builder.section("normalise: the product is below 4");
    let reaches_two = builder.bit(product, product_bits - 1);
    builder.name(reaches_two, "product_reaches_two");
    let fraction_at_two = builder.slice(product, product_bits - 2, significand_bits);
    let fraction_at_one = builder.slice(product, product_bits - 3, significand_bits - 1);
    let fraction = builder.mux(reaches_two, fraction_at_two, fraction_at_one);
    builder.name(fraction, "product_fraction");
    let adjustment_at_two = exponent_constant(builder, 1 - bias, exponent_word_bits);
    let adjustment_at_one = exponent_constant(builder, -bias, exponent_word_bits);
    let adjustment = builder.mux(reaches_two, adjustment_at_two, adjustment_at_one);
    builder.name(adjustment, "exponent_adjustment");
    let tail = needs_tail(rounding).then(|| {
        let guard_at_two = builder.bit(product, fraction_bits);
        let guard_at_one = builder.bit(product, fraction_bits - 1);
        let guard = builder.mux(reaches_two, guard_at_two, guard_at_one);
        builder.name(guard, "guard_bit");
        // The guard bit of a product below two is below the guard bit of one that is not.
        let below_either = builder.slice(product, fraction_bits - 2, 0);
        let below_either = builder.any_bit(below_either);
        builder.name(below_either, "product_below_guard");
        let below_at_two = builder.and(reaches_two, guard_at_one);
        let sticky = builder.or(below_either, below_at_two);
        builder.name(sticky, "sticky_bit");
        Tail {
            guard,
            sticky: Some(sticky),
        }
    });

    round(
        builder,
        format,
        rounding,
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
        },
    )
}
