//! The one rounder: from a sign, an exponent and a normalised significand to the float and its flags.

use std::ops::RangeInclusive;

use rtl_model::float::{FloatFormat, Policy, Rounding};

use super::OperatorConfiguration;
use super::denormalise::denormalise;
use super::pack::pack;
use crate::netlist::{Builder, Wire};

/// The bits of an exact result below the last fraction bit.
#[derive(Clone, Copy)]
pub(super) struct Tail {
    /// The first of them: half a unit in the last place.
    pub guard: Wire,
    /// Is any further one set? A word of any width, of which any bit says so: the adder of the
    /// rounding gathers a few of them faster than look-up tables do. None where that changes
    /// nothing: rounding to nearest a result that is never a tie, or a directed rounding whose
    /// guard bit already says that it is inexact. With flags or subnormal results a result that is
    /// never a tie needs it, too.
    pub sticky: Option<Wire>,
}

/// How a result below the smallest normal number comes to the rounder.
#[derive(Clone, Copy)]
pub(super) enum Small {
    /// Normalised, its exponent below 1: the rounder flushes it, or denormalises it where subnormal
    /// numbers are full.
    Normalised,
    /// As it is encoded: with exponent 0, and a fraction without a one before the point. Only where
    /// subnormal numbers are full.
    Encoded {
        /// Is it, rounded with no lower end to the exponent, still below the smallest normal
        /// number, and inexact? None where such results are exact. Read only with flags.
        underflow: Option<Wire>,
    },
}

/// What an operator knows of both ends of the range before it rounds: it spares the rounder the look
/// at the exponent behind its addition.
#[derive(Clone, Copy)]
pub(super) struct EarlyBounds {
    /// Rounded, the exponent is that of the largest finite number or one more, and the last bit of
    /// it tells whether the result overflows.
    pub may_overflow: Wire,
    /// The result is below the smallest normal number, and exact but for being flushed.
    pub underflow: Wire,
}

/// A result before it is rounded and packed.
#[derive(Clone)]
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
    /// What is below it; none where the result is exact or nobody looks ([`needs_tail`]).
    pub tail: Option<Tail>,
    /// The result is the NaN, whatever else holds.
    pub is_nan: Option<Wire>,
    /// Else it is an infinity, exactly.
    pub is_infinity: Option<Wire>,
    /// Else it is a zero, exactly.
    pub is_zero: Option<Wire>,
    /// The flag: an operand is a signalling NaN, or no result makes sense. Read only with flags.
    pub is_invalid: Option<Wire>,
    /// The flag: an infinity of finite operands is exact. Read only with flags.
    pub divides_by_zero: Option<Wire>,
    /// What an exponent below 1 stands for.
    pub small: Small,
    /// Where overflow and underflow are known early; else the rounded exponent is asked.
    pub early_bounds: Option<EarlyBounds>,
}

/// An operator's answer.
#[derive(Clone, Copy)]
pub(super) struct Answer {
    /// The float.
    pub result: Wire,
    /// The five flags, where the operator has them.
    pub flags: Option<Wire>,
}

/// Does anybody look below the last fraction bit: the rounding, or the flag that tells inexact?
pub(super) fn needs_tail(configuration: OperatorConfiguration) -> bool {
    configuration.rounding != Rounding::TowardZero || configuration.has_flags
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

/// One bit for every four of a word, set where one of theirs is: what one level of look-up tables
/// makes of a sticky word, for the rounding's adder to gather the rest.
pub(super) fn gathered(builder: &mut Builder, word: Wire, name: &str) -> Wire {
    let width = builder.width(word);
    let groups: Vec<Wire> = (0..width)
        .step_by(4)
        .map(|low| {
            let group = builder.slice(word, (low + 3).min(width - 1), low);
            builder.any_bit(group)
        })
        .rev()
        .collect();
    let groups = builder.concat(&groups);
    builder.name(groups, name)
}

/// Rounds, packs and selects the special results: the last sections of an operator.
pub(super) fn round(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    exact: &Unrounded,
) -> Answer {
    let reaches_below = *exact.exponent_range.start() < 1;
    let is_normalised = matches!(exact.small, Small::Normalised);
    let denormalised;
    let exact = if configuration.policy == Policy::Full && reaches_below && is_normalised {
        denormalised = denormalise(builder, configuration, exact);
        &denormalised
    } else {
        exact
    };
    builder.section("round: one addition on exponent and fraction side by side");
    let rounded = increment(builder, configuration.rounding, exact);
    pack(builder, configuration, exact, rounded)
}

/// Exponent and fraction, adjusted and rounded in one addition: a fraction of all ones rounded up
/// carries into the exponent and leaves a fraction of zeros, which is the right float.
///
/// Whether to round up is found by the same carry chain, below the fraction. A place that holds a
/// bit and a one carries if the bit is set or a carry comes in; the guard's place, with a zero
/// beside it, carries if it is set and a carry comes in. So to nearest the chain begins with the
/// last bit, gathers the sticky bits, and passes the guard if there was any: above one half, or at
/// one half with an odd last bit. Away from zero it gathers the guard with the rest.
fn increment(builder: &mut Builder, rounding: Rounding, exact: &Unrounded) -> Wire {
    let fraction_bits = builder.width(exact.fraction);
    let tail = exact.tail.filter(|_| rounding != Rounding::TowardZero);
    let Some(tail) = tail else {
        let exponent = builder.add(exact.exponent, exact.adjustment);
        builder.name(exponent, "result_exponent");
        let rounded = builder.concat(&[exponent, exact.fraction]);
        return builder.name(rounded, "rounded");
    };
    let mut below = vec![tail.guard];
    below.extend(tail.sticky);
    let increment = match rounding {
        Rounding::NearestEven => {
            if let Some(sticky) = tail.sticky {
                below.push(builder.bit(exact.fraction, 0));
                let zero = builder.constant(0, 1);
                let gathering = 1 + builder.width(sticky);
                let ones = builder.constant(u64::MAX >> (64 - gathering), gathering);
                builder.concat(&[zero, ones])
            } else {
                builder.constant(1, 1)
            }
        }
        _ => {
            let away = match rounding {
                Rounding::Up => builder.not(exact.sign),
                _ => exact.sign,
            };
            builder.name(away, "away_from_zero");
            let gathering = 1 + tail.sticky.map_or(0, |sticky| builder.width(sticky));
            builder.sign_extend(away, gathering)
        }
    };
    let zeros = builder.constant(0, fraction_bits);
    let increment = builder.concat(&[exact.adjustment, zeros, increment]);
    builder.name(increment, "rounding_increment");
    let mut unrounded = vec![exact.exponent, exact.fraction];
    unrounded.extend(below);
    let unrounded = builder.concat(&unrounded);
    builder.name(unrounded, "unrounded");
    let sum = builder.add(unrounded, increment);
    builder.name(sum, "rounding_sum");
    let bits = builder.width(sum);
    let kept = builder.width(exact.exponent) + fraction_bits;
    let rounded = builder.slice(sum, bits - 1, bits - kept);
    builder.name(rounded, "rounded")
}
