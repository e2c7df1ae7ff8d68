//! Results below the smallest normal number, made subnormal: where the policy is full.

use rtl_model::float::Rounding;

use super::OperatorConfiguration;
use super::round::{Small, Tail, Unrounded, exponent_width, needs_tail};
use super::shift::shift_right;
use crate::netlist::{Builder, Wire};

/// The result with an exponent field of 0 where its exponent is below 1, and its significand moved
/// down to the weight of that field: what it loses on the way goes to its tail.
pub(super) fn denormalise(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    exact: &Unrounded,
) -> Unrounded {
    let fraction_bits = configuration.format.fraction_bits;
    builder.section("denormalise: the exponent ends at 1, the significand gives way");
    let total = builder.add(exact.exponent, exact.adjustment);
    builder.name(total, "normalised_exponent");
    let total_bits = builder.width(total);
    let exponent_nonzero = builder.any_bit(total);
    let exponent_is_zero = builder.not(exponent_nonzero);
    builder.name(exponent_is_zero, "exponent_is_zero");
    let mut is_subnormal = exponent_is_zero;
    if *exact.exponent_range.start() < 0 {
        let negative = builder.bit(total, total_bits - 1);
        is_subnormal = builder.or(negative, exponent_is_zero);
    }
    builder.name(is_subnormal, "is_subnormal");
    // Modulo 2^EXPONENT_BITS; without meaning, and not used, for an exponent of 1 or more.
    let one = builder.constant(1, total_bits);
    let distance = builder.subtract(one, total);
    builder.name(distance, "distance_to_subnormal");
    let zero = builder.constant(0, total_bits);
    let amount = builder.mux(is_subnormal, distance, zero);
    builder.name(amount, "denormal_shift");

    let hidden = builder.constant(1, 1);
    let guard = match exact.tail {
        Some(tail) => tail.guard,
        None => builder.constant(0, 1),
    };
    let significand = builder.concat(&[hidden, exact.fraction, guard]);
    let shifted = shift_right(builder, significand, amount, 0, "denormal");
    let (mut word, mut lost) = (shifted.word, shifted.lost);
    if let Some(out_of_reach) = shifted.out_of_reach {
        let nothing = builder.constant(0, fraction_bits + 2);
        word = builder.mux(out_of_reach, nothing, word);
        lost = builder.or(lost, out_of_reach);
    }
    builder.name(word, "denormal_significand");
    builder.name(lost, "lost_by_denormalising");
    let fraction = builder.slice(word, fraction_bits, 1);
    let exponent_range = 0..=*exact.exponent_range.end();
    let exponent_bits = exponent_width(configuration.format, &exponent_range);
    let field = builder.mux(is_subnormal, zero, total);
    let exponent = builder.slice(field, exponent_bits - 1, 0);
    builder.name(exponent, "denormal_exponent");

    let tail = needs_tail(configuration).then(|| {
        let below = exact.tail.and_then(|tail| tail.sticky);
        let sticky = match below {
            Some(below) => builder.concat(&[below, lost]),
            None => lost,
        };
        Tail {
            guard: builder.bit(word, 0),
            sticky: Some(sticky),
        }
    });
    let underflow = configuration.has_flags.then(|| {
        let rounds_up = rounds_ones_up(builder, configuration.rounding, exact);
        underflow(
            builder,
            exact,
            is_subnormal,
            exponent_is_zero,
            rounds_up,
            tail,
        )
    });
    Unrounded {
        exponent,
        adjustment: builder.constant(0, exponent_bits),
        exponent_range,
        fraction,
        tail,
        small: Small::Encoded { underflow },
        early_bounds: None,
        ..exact.clone()
    }
}

/// Is the magnitude rounded up if its fraction is all ones, in the place it has with no lower end
/// to the exponent? None where it never is. To nearest even the guard bit alone decides then.
fn rounds_ones_up(builder: &mut Builder, rounding: Rounding, exact: &Unrounded) -> Option<Wire> {
    let tail = exact.tail?;
    let away = match rounding {
        Rounding::TowardZero => return None,
        Rounding::NearestEven => return Some(tail.guard),
        Rounding::Up => builder.not(exact.sign),
        Rounding::Down => exact.sign,
    };
    let mut inexact = tail.guard;
    if let Some(sticky) = tail.sticky {
        let sticky = builder.any_bit(sticky);
        inexact = builder.or(inexact, sticky);
    }
    Some(builder.and(inexact, away))
}

/// Inexact, and below the smallest normal number also after rounding with no lower end to the
/// exponent: that is, with an exponent below 1, except just below 1 where it is rounded up to it.
fn underflow(
    builder: &mut Builder,
    exact: &Unrounded,
    is_subnormal: Wire,
    exponent_is_zero: Wire,
    rounds_up: Option<Wire>,
    tail: Option<Tail>,
) -> Wire {
    let mut is_tiny = is_subnormal;
    if let Some(rounds_up) = rounds_up {
        let all_ones = builder.all_bits(exact.fraction);
        let carries = builder.and(all_ones, rounds_up);
        let becomes_normal = builder.and(exponent_is_zero, carries);
        builder.name(becomes_normal, "becomes_normal");
        let stays_below = builder.not(becomes_normal);
        is_tiny = builder.and(is_subnormal, stays_below);
    }
    builder.name(is_tiny, "is_tiny");
    let inexact = super::pack::inexact(builder, tail);
    builder.and(is_tiny, inexact)
}
