//! What a datapath does with words in a few gates, without an operator of its own.

use crate::netlist::{Builder, Wire};
use rtl_model::float::FloatFormat;

fn exponent(builder: &mut Builder, a: Wire, format: FloatFormat) -> Wire {
    builder.slice(a, format.width() - 2, format.fraction_bits)
}

/// Is a float zero (a subnormal reads as one)?
pub(super) fn is_zero(builder: &mut Builder, a: Wire, format: FloatFormat) -> Wire {
    let exponent = exponent(builder, a, format);
    let normal = builder.any_bit(exponent);
    builder.not(normal)
}

/// Is the sign of a float set, and it neither a zero (a subnormal reads as one) nor NaN?
pub(super) fn is_negative(builder: &mut Builder, a: Wire, format: FloatFormat) -> Wire {
    let sign = builder.bit(a, format.width() - 1);
    let exponent = exponent(builder, a, format);
    let normal = builder.any_bit(exponent);
    let all_ones = builder.all_bits(exponent);
    let fraction = builder.slice(a, format.fraction_bits - 1, 0);
    let fraction = builder.any_bit(fraction);
    let nan = builder.and(all_ones, fraction);
    let ordered = builder.not(nan);
    let negative = builder.and(sign, normal);
    builder.and(negative, ordered)
}

/// A float times `2^power`: an adder for the exponent, zero below it, infinity above.
pub(super) fn scale(builder: &mut Builder, a: Wire, power: i32, format: FloatFormat) -> Wire {
    let bits = format.exponent_bits;
    let fraction_bits = format.fraction_bits;
    let sign = builder.bit(a, format.width() - 1);
    let fraction = builder.slice(a, fraction_bits - 1, 0);
    let old = exponent(builder, a, format);
    // Room for the sign of the sum, and for any power.
    let room = bits.max(32 - power.unsigned_abs().leading_zeros()) + 2;
    let old_extended = builder.zero_extend(old, room);
    let mask = u64::MAX >> (64 - room);
    let power = builder.constant(i64::from(power).cast_unsigned() & mask, room);
    let sum = builder.add(old_extended, power);
    let below = builder.bit(sum, room - 1);
    let any = builder.any_bit(sum);
    let none = builder.not(any);
    let too_small = builder.or(below, none);
    let all_ones = builder.constant((1 << bits) - 1, room);
    let in_range = builder.less_than(sum, all_ones);
    let not_in_range = builder.not(in_range);
    let not_below = builder.not(below);
    let too_large = builder.and(not_in_range, not_below);
    let new = builder.slice(sum, bits - 1, 0);
    let scaled = builder.concat(&[sign, new, fraction]);
    let zeros = builder.constant(0, bits + fraction_bits);
    let zero = builder.concat(&[sign, zeros]);
    let infinite = builder.constant(format.infinity(), bits + fraction_bits);
    let infinity = builder.concat(&[sign, infinite]);
    let scaled = builder.mux(too_large, infinity, scaled);
    let scaled = builder.mux(too_small, zero, scaled);
    // Zeros, infinities and NaN stay what they are.
    let normal = builder.any_bit(old);
    let scaled = builder.mux(normal, scaled, zero);
    let special = builder.all_bits(old);
    let has_fraction = builder.any_bit(fraction);
    let nan = builder.constant(format.quiet_nan(), format.width());
    let unchanged = builder.mux(has_fraction, nan, infinity);
    builder.mux(special, unchanged, scaled)
}

/// A two's complement word moved right; its sign moves in.
pub(super) fn shift_right(builder: &mut Builder, a: Wire, amount: Wire) -> Wire {
    let width = builder.width(a);
    let sign = builder.bit(a, width - 1);
    let signs = builder.sign_extend(sign, width);
    let magnitude = builder.xor(a, signs);
    let moved = builder.shift_right(magnitude, amount);
    builder.xor(moved, signs)
}

/// One more than the place of the leading one of a word that is not negative; 0 for 0.
pub(super) fn bit_length(builder: &mut Builder, a: Wire, width: u32) -> Wire {
    let zero = builder.constant(0, width);
    (0..builder.width(a) - 1).fold(zero, |length, place| {
        let bit = builder.bit(a, place);
        let longer = builder.constant(u64::from(place) + 1, width);
        builder.mux(bit, longer, length)
    })
}
