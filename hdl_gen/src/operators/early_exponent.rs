//! Rounding to nearest where the exponent is known long before the significand.

use rtl_model::float::FloatFormat;

use crate::netlist::{Builder, Wire};

/// A normalised result before it is rounded: exponent and special cases come early, the
/// significand late.
pub(super) struct EarlyExponent {
    /// The result's sign, of a zero too.
    pub sign: Wire,
    /// The biased exponent in two's complement, but for the increment.
    pub exponent: Wire,
    /// Is the exponent one more? Late. A fraction that is rounded up to the next power of two has
    /// none.
    pub increment: Wire,
    /// The fraction of the normalised significand. Late, as all below.
    pub fraction: Wire,
    /// The bit after the fraction.
    pub guard: Wire,
    /// Is a bit after that set? Several bits, of which each says so.
    pub sticky: Wire,
    /// Is a bit after the guard set, or the last of the fraction? May leave to `sticky` what that
    /// says.
    pub odd_or_sticky: Wire,
    /// The result is the NaN, whatever else holds.
    pub is_nan: Wire,
    /// Else it is an infinity, exactly.
    pub is_infinity: Wire,
    /// Else it is a zero, exactly.
    pub is_zero: Wire,
}

/// Rounds and packs for the policy flush. What the exponent alone decides is put in its place
/// before the rounding's addition, and nothing but the last bits of a NaN follows it: an exponent
/// that may become too large, or not too small, becomes so by that addition itself.
pub(super) fn round_to_nearest(
    builder: &mut Builder,
    format: FloatFormat,
    exact: &EarlyExponent,
) -> Wire {
    let (exponent_bits, fraction_bits) = (format.exponent_bits, format.fraction_bits);
    builder.section("what the exponent alone decides");
    let width = builder.width(exact.exponent);
    let negative = builder.bit(exact.exponent, width - 1);
    let field = builder.slice(exact.exponent, exponent_bits - 1, 0);
    let above = builder.slice(exact.exponent, width - 2, exponent_bits);
    let above_nonzero = builder.any_bit(above);
    let field_is_ones = builder.all_bits(field);
    let not_negative = builder.not(negative);
    let reaches_ones = builder.or(field_is_ones, above_nonzero);
    let overflow = builder.and(not_negative, reaches_ones);
    builder.name(overflow, "certain_overflow");
    let is_number = builder.not(exact.is_zero);
    let overflow = builder.and(overflow, is_number);
    let mut is_ones = builder.or(exact.is_nan, exact.is_infinity);
    is_ones = builder.or(is_ones, overflow);
    builder.name(is_ones, "exponent_is_ones");
    let mut is_decided = builder.or(is_ones, exact.is_zero);
    is_decided = builder.or(is_decided, negative);
    builder.name(is_decided, "is_decided");
    let decided = builder.sign_extend(is_ones, exponent_bits);
    let field_or_decided = builder.mux(is_decided, decided, field);
    builder.name(field_or_decided, "exponent_or_decided");
    // The two exponents of which the increment decides.
    let nonzero = builder.any_bit(field);
    let is_lowest = builder.not(nonzero);
    builder.name(is_lowest, "just_below_normal");
    let upper = builder.slice(field, exponent_bits - 1, 1);
    let upper_ones = builder.all_bits(upper);
    let lowest_bit = builder.bit(field, 0);
    let even = builder.not(lowest_bit);
    let is_highest = builder.and(upper_ones, even);
    builder.name(is_highest, "just_below_infinity");

    builder.section("round: one addition on exponent and fraction side by side");
    // The place between exponent and fraction carries for the increment or for the fraction, and
    // not at all where the exponent is decided. Below the fraction see `round.rs`.
    let is_open = builder.not(is_decided);
    let increment = builder.and(exact.increment, is_open);
    builder.name(increment, "exponent_increment");
    let unrounded = builder.concat(&[
        field_or_decided,
        increment,
        exact.fraction,
        exact.guard,
        exact.sticky,
        exact.odd_or_sticky,
    ]);
    builder.name(unrounded, "unrounded");
    let no_exponent = builder.constant(0, exponent_bits);
    let no_fraction = builder.constant(0, fraction_bits + 1);
    let gathering = 1 + builder.width(exact.sticky);
    let ones = builder.constant(u64::MAX >> (64 - gathering), gathering);
    let addend = builder.concat(&[no_exponent, is_open, no_fraction, ones]);
    builder.name(addend, "rounding_increment");
    let sum = builder.add(unrounded, addend);
    builder.name(sum, "rounding_sum");
    let fraction_low = gathering + 1;
    let exponent_low = fraction_low + fraction_bits + 1;
    let exponent = builder.slice(sum, exponent_low + exponent_bits - 1, exponent_low);
    builder.name(exponent, "result_exponent_field");

    builder.section("pack: the fraction of zeros, infinities and NaNs");
    // Where the fraction carries into the next power of two it is zero anyway.
    let stays = builder.not(exact.increment);
    let flushed = builder.and(is_lowest, stays);
    let overflows = builder.and(is_highest, exact.increment);
    let mut is_zero = builder.or(flushed, overflows);
    is_zero = builder.or(is_zero, is_decided);
    builder.name(is_zero, "fraction_is_zero");
    let top = builder.bit(sum, fraction_low + fraction_bits - 1);
    let top = builder.mux(is_zero, exact.is_nan, top);
    let low = builder.slice(sum, fraction_low + fraction_bits - 2, fraction_low);
    let zeros = builder.constant(0, fraction_bits - 1);
    let low = builder.mux(is_zero, zeros, low);
    let is_number = builder.not(exact.is_nan);
    let sign = builder.and(exact.sign, is_number);
    builder.name(sign, "result_sign");
    builder.concat(&[sign, exponent, top, low])
}
