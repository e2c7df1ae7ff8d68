//! The one rounder: from a sign, an exponent and a normalised significand to the float.

use std::ops::RangeInclusive;

use rtl_model::float::{FloatFormat, Rounding};

use crate::netlist::{Builder, Wire};

/// The bits of an exact result below the last fraction bit.
pub(super) struct Tail {
    /// The first of them: half a unit in the last place.
    pub guard: Wire,
    /// Is any further one set? None where that changes nothing: rounding to nearest a result that
    /// is never a tie, or a directed rounding whose guard bit already says that it is inexact.
    pub sticky: Option<Wire>,
}

/// A result before it is rounded and packed.
pub(super) struct Unrounded {
    /// The result's sign, of a zero too.
    pub sign: Wire,
    /// The biased exponent, or part of it: a two's complement word of [`exponent_width`] bits.
    pub exponent: Wire,
    /// What is still to be added to it, in as many bits. The rounder's incrementer does it on the
    /// way, which costs nothing: its second operand is otherwise zero at these bits.
    pub adjustment: Wire,
    /// Where the sum of the two lies when no exception holds, before rounding.
    pub exponent_range: RangeInclusive<i64>,
    /// The fraction of the normalised significand.
    pub fraction: Wire,
    /// What is below it; none where the result is exact or the rounding does not look.
    pub tail: Option<Tail>,
    /// The result is the NaN, whatever else holds.
    pub is_nan: Option<Wire>,
    /// Else it is an infinity.
    pub is_infinity: Option<Wire>,
    /// Else it is a zero.
    pub is_zero: Option<Wire>,
}

/// Does this rounding look below the last fraction bit?
pub(super) fn needs_tail(rounding: Rounding) -> bool {
    rounding != Rounding::TowardZero
}

/// Bits of the exponent word that holds the whole range and the carry of the rounding: two's
/// complement where the range goes below zero.
pub(super) fn exponent_width(format: FloatFormat, range: &RangeInclusive<i64>) -> u32 {
    let bits_of = |value: i64| u64::BITS - value.unsigned_abs().leading_zeros();
    let highest = bits_of(range.end() + 1).max(format.exponent_bits);
    if *range.start() >= 0 {
        highest
    } else {
        1 + highest.max(bits_of(range.start() + 1))
    }
}

/// A value of the exponent word.
pub(super) fn exponent_constant(builder: &mut Builder, value: i64, width: u32) -> Wire {
    let mask = u64::MAX >> (u64::BITS - width);
    builder.constant(value.cast_unsigned() & mask, width)
}

/// Rounds, packs and selects the special results: the last sections of an operator.
pub(super) fn round(
    builder: &mut Builder,
    format: FloatFormat,
    rounding: Rounding,
    exact: &Unrounded,
) -> Wire {
    builder.section("round: one addition on exponent and fraction side by side");
    let rounded = increment(builder, format, rounding, exact);
    pack(builder, format, rounding, exact, rounded)
}

/// Exponent and fraction, adjusted and rounded in one addition: a fraction of all ones rounded up
/// carries into the exponent and leaves a fraction of zeros, which is the right float.
fn increment(
    builder: &mut Builder,
    format: FloatFormat,
    rounding: Rounding,
    exact: &Unrounded,
) -> Wire {
    let round_up = exact
        .tail
        .as_ref()
        .and_then(|tail| round_up(builder, rounding, exact, tail));
    let rounded = if let Some(round_up) = round_up {
        let packed = builder.concat(&[exact.exponent, exact.fraction]);
        let below_exponent = builder.zero_extend(round_up, format.fraction_bits);
        let increment = builder.concat(&[exact.adjustment, below_exponent]);
        builder.add(packed, increment)
    } else {
        let exponent = builder.add(exact.exponent, exact.adjustment);
        builder.name(exponent, "result_exponent");
        builder.concat(&[exponent, exact.fraction])
    };
    builder.name(rounded, "rounded")
}

/// Does the magnitude go to the next larger one? None where it never does.
fn round_up(
    builder: &mut Builder,
    rounding: Rounding,
    exact: &Unrounded,
    tail: &Tail,
) -> Option<Wire> {
    let round_up = match rounding {
        Rounding::TowardZero => return None,
        Rounding::NearestEven => {
            // Above one half, or at one half with an odd last bit.
            if let Some(sticky) = tail.sticky {
                let last_bit = builder.bit(exact.fraction, 0);
                let odd_or_above = builder.or(sticky, last_bit);
                builder.name(odd_or_above, "odd_or_above");
                builder.and(tail.guard, odd_or_above)
            } else {
                tail.guard
            }
        }
        Rounding::Up | Rounding::Down => {
            let inexact = match tail.sticky {
                Some(sticky) => builder.or(tail.guard, sticky),
                None => tail.guard,
            };
            let away = match rounding {
                Rounding::Up => builder.not(exact.sign),
                _ => exact.sign,
            };
            builder.and(inexact, away)
        }
    };
    Some(builder.name(round_up, "round_up"))
}

/// Overflow and underflow by the rounded exponent, then the special results.
fn pack(
    builder: &mut Builder,
    format: FloatFormat,
    rounding: Rounding,
    exact: &Unrounded,
    rounded: Wire,
) -> Wire {
    let (exponent_bits, fraction_bits) = (format.exponent_bits, format.fraction_bits);
    let magnitude_bits = exponent_bits + fraction_bits;
    let top = builder.width(rounded) - 1;
    let all_ones = i64::try_from(format.exponent_all_ones()).expect("11 exponent bits at most");
    let is_signed = *exact.exponent_range.start() < 0;
    let negative = is_signed.then(|| builder.bit(rounded, top));

    builder.section("pack: overflow, underflow, special results");
    let mut magnitude = builder.slice(rounded, magnitude_bits - 1, 0);
    if exact.exponent_range.end() + 1 >= all_ones {
        let field = builder.slice(rounded, magnitude_bits - 1, fraction_bits);
        let mut overflow = builder.all_bits(field);
        let above = top + 1 - magnitude_bits - u32::from(is_signed);
        if above > 0 {
            let beyond = builder.slice(rounded, magnitude_bits + above - 1, magnitude_bits);
            let beyond = builder.any_bit(beyond);
            overflow = builder.or(overflow, beyond);
        }
        if let Some(negative) = negative {
            let not_negative = builder.not(negative);
            overflow = builder.and(overflow, not_negative);
        }
        builder.name(overflow, "overflow");
        let pattern = overflow_pattern(builder, format, rounding, exact.sign);
        magnitude = builder.mux(overflow, pattern, magnitude);
        builder.name(magnitude, "bounded_magnitude");
    }

    let mut zero_causes = Vec::from_iter(exact.is_zero);
    if *exact.exponent_range.start() < 1 {
        // Rounded first, then flushed: the exponent tested is the one after the rounding.
        let exponent = builder.slice(rounded, top - u32::from(is_signed), fraction_bits);
        let exponent_nonzero = builder.any_bit(exponent);
        let mut underflow = builder.not(exponent_nonzero);
        if let Some(negative) = negative {
            underflow = builder.or(negative, underflow);
        }
        zero_causes.push(builder.name(underflow, "underflow"));
    }
    if let Some(becomes_zero) = zero_causes.into_iter().reduce(|a, b| builder.or(a, b)) {
        builder.name(becomes_zero, "becomes_zero");
        let zero = builder.constant(0, magnitude_bits);
        magnitude = builder.mux(becomes_zero, zero, magnitude);
        builder.name(magnitude, "flushed_magnitude");
    }
    if let Some(is_infinity) = exact.is_infinity {
        let infinity = builder.constant(format.infinity(), magnitude_bits);
        magnitude = builder.mux(is_infinity, infinity, magnitude);
        builder.name(magnitude, "number_magnitude");
    }
    let mut sign = exact.sign;
    if let Some(is_nan) = exact.is_nan {
        let quiet_nan = builder.constant(format.quiet_nan(), magnitude_bits);
        magnitude = builder.mux(is_nan, quiet_nan, magnitude);
        let is_number = builder.not(is_nan);
        sign = builder.and(sign, is_number);
        builder.name(sign, "result_sign");
    }
    builder.name(magnitude, "result_magnitude");
    builder.concat(&[sign, magnitude])
}

/// What a finite result beyond the largest finite number becomes: infinity, or that number where
/// the rounding is toward it (IEEE 754-2019, section 7.4).
fn overflow_pattern(
    builder: &mut Builder,
    format: FloatFormat,
    rounding: Rounding,
    sign: Wire,
) -> Wire {
    let magnitude_bits = format.width() - 1;
    let infinity = builder.constant(format.infinity(), magnitude_bits);
    if rounding == Rounding::NearestEven {
        return infinity;
    }
    let max_finite = builder.constant(format.max_finite(), magnitude_bits);
    match rounding {
        Rounding::Up => builder.mux(sign, max_finite, infinity),
        Rounding::Down => builder.mux(sign, infinity, max_finite),
        _ => max_finite,
    }
}
