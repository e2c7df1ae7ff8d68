//! From the rounded exponent and fraction to the float: overflow, underflow, special results, flags.

use rtl_model::float::{Policy, Rounding};

use super::OperatorConfiguration;
use super::round::{Answer, Small, Tail, Unrounded};
use crate::netlist::{Builder, Wire};

/// What the exponent after rounding says of a finite result, where its range allows it.
struct Bounds {
    /// It is above the largest finite number.
    overflow: Option<Wire>,
    /// It is below the smallest normal number and flushed.
    underflow: Option<Wire>,
}

/// Selects the result and raises the flags.
pub(super) fn pack(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    exact: &Unrounded,
    rounded: Wire,
) -> Answer {
    builder.section("pack: overflow, underflow, special results");
    let bounds = bounds(builder, configuration, exact, rounded);
    let result = select(builder, configuration, exact, rounded, &bounds);
    let flags = configuration.has_flags.then(|| {
        builder.section("flags");
        flags(builder, exact, &bounds)
    });
    Answer { result, flags }
}

/// The or of the wires there are.
fn any_of(builder: &mut Builder, wires: impl IntoIterator<Item = Option<Wire>>) -> Option<Wire> {
    let wires: Vec<Wire> = wires.into_iter().flatten().collect();
    wires.into_iter().reduce(|a, b| builder.or(a, b))
}

/// The first wire where the second, if there is one, is 0.
fn unless(builder: &mut Builder, wire: Wire, not: Option<Wire>) -> Wire {
    match not {
        Some(not) => {
            let otherwise = builder.not(not);
            builder.and(wire, otherwise)
        }
        None => wire,
    }
}

/// Overflow and underflow, by the exponent after rounding: first rounded, then flushed.
fn bounds(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    exact: &Unrounded,
    rounded: Wire,
) -> Bounds {
    let format = configuration.format;
    let (exponent_bits, fraction_bits) = (format.exponent_bits, format.fraction_bits);
    if let Some(early) = exact.early_bounds {
        let last_bit = builder.bit(rounded, fraction_bits);
        let overflow = builder.and(early.may_overflow, last_bit);
        return Bounds {
            overflow: Some(builder.name(overflow, "overflow")),
            underflow: Some(early.underflow),
        };
    }
    let top = builder.width(rounded) - 1;
    let all_ones = i64::try_from(format.exponent_all_ones()).expect("11 exponent bits at most");
    let is_signed = *exact.exponent_range.start() < 0;
    let negative = is_signed.then(|| builder.bit(rounded, top));
    let overflow = (exact.exponent_range.end() + 1 >= all_ones).then(|| {
        let field = builder.slice(rounded, exponent_bits + fraction_bits - 1, fraction_bits);
        let mut overflow = builder.all_bits(field);
        let above = top + 1 - exponent_bits - fraction_bits - u32::from(is_signed);
        if above > 0 {
            let beyond = top - u32::from(is_signed);
            let beyond = builder.slice(rounded, beyond, beyond + 1 - above);
            let beyond = builder.any_bit(beyond);
            overflow = builder.or(overflow, beyond);
        }
        let overflow = unless(builder, overflow, negative);
        builder.name(overflow, "overflow")
    });
    let flushes = configuration.policy == Policy::Flush && *exact.exponent_range.start() < 1;
    let underflow = flushes.then(|| {
        let exponent = builder.slice(rounded, top - u32::from(is_signed), fraction_bits);
        let exponent_nonzero = builder.any_bit(exponent);
        let mut underflow = builder.not(exponent_nonzero);
        if let Some(negative) = negative {
            underflow = builder.or(negative, underflow);
        }
        builder.name(underflow, "underflow")
    });
    Bounds {
        overflow,
        underflow,
    }
}

/// The overflows that end at the largest finite number and not at infinity, and those that do
/// (IEEE 754-2019, section 7.4).
fn overflow_by_sign(
    builder: &mut Builder,
    rounding: Rounding,
    sign: Wire,
    overflow: Wire,
) -> (Option<Wire>, Option<Wire>) {
    let (to_largest, to_infinity) = match rounding {
        Rounding::NearestEven => return (None, Some(overflow)),
        Rounding::TowardZero => return (Some(overflow), None),
        Rounding::Up => (sign, builder.not(sign)),
        Rounding::Down => (builder.not(sign), sign),
    };
    let to_largest = builder.and(overflow, to_largest);
    let to_infinity = builder.and(overflow, to_infinity);
    (Some(to_largest), Some(to_infinity))
}

/// The float. Zeros of the fraction are selected last, with nothing behind: where a register
/// follows, its synchronous reset does that without a look-up table.
fn select(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    exact: &Unrounded,
    rounded: Wire,
    bounds: &Bounds,
) -> Wire {
    let format = configuration.format;
    let (exponent_bits, fraction_bits) = (format.exponent_bits, format.fraction_bits);
    let mut exponent = builder.slice(rounded, exponent_bits + fraction_bits - 1, fraction_bits);
    let mut fraction = builder.slice(rounded, fraction_bits - 1, 0);
    let (to_largest, to_infinity) = match bounds.overflow {
        Some(overflow) => overflow_by_sign(builder, configuration.rounding, exact.sign, overflow),
        None => (None, None),
    };
    if let Some(to_largest) = to_largest {
        builder.name(to_largest, "becomes_largest");
        let largest_exponent = builder.constant(format.exponent_all_ones() - 1, exponent_bits);
        exponent = builder.mux(to_largest, largest_exponent, exponent);
        let ones = builder.constant(u64::MAX >> (64 - fraction_bits), fraction_bits);
        fraction = builder.mux(to_largest, ones, fraction);
    }

    let becomes_zero = any_of(builder, [exact.is_zero, bounds.underflow]);
    if let Some(becomes_zero) = becomes_zero {
        builder.name(becomes_zero, "becomes_zero");
        let zero = builder.constant(0, exponent_bits);
        exponent = builder.mux(becomes_zero, zero, exponent);
    }
    // An overflow that is known by its last bit has all ones for its exponent; else, where an
    // operand is zero, the exponent is none.
    let (overflow_to_ones, overflow_of_ones) = match exact.early_bounds {
        Some(_) => (None, to_infinity),
        None => {
            let to_infinity = to_infinity.map(|wire| unless(builder, wire, exact.is_zero));
            (to_infinity, None)
        }
    };
    let exponent_is_ones = any_of(builder, [exact.is_nan, exact.is_infinity, overflow_to_ones]);
    if let Some(exponent_is_ones) = exponent_is_ones {
        builder.name(exponent_is_ones, "exponent_is_ones");
        let ones = builder.constant(format.exponent_all_ones(), exponent_bits);
        exponent = builder.mux(exponent_is_ones, ones, exponent);
    }
    builder.name(exponent, "result_exponent_field");
    let zeros = [becomes_zero, exponent_is_ones, overflow_of_ones];
    if let Some(is_zero) = any_of(builder, zeros) {
        builder.name(is_zero, "fraction_is_zero");
        let low_bits = fraction_bits - 1;
        // Only the canonical NaN has a fraction that is neither the rounded one nor zero.
        let top = builder.bit(fraction, low_bits);
        let nan_top = match exact.is_nan {
            Some(is_nan) => is_nan,
            None => builder.constant(0, 1),
        };
        let top = builder.mux(is_zero, nan_top, top);
        let low = builder.slice(fraction, low_bits - 1, 0);
        let low = if overflow_of_ones.is_some() {
            // By gates: the way to a synchronous reset would be the longest.
            let stays = builder.not(is_zero);
            let stays = builder.sign_extend(stays, low_bits);
            builder.and(low, stays)
        } else {
            let zeros = builder.constant(0, low_bits);
            builder.mux(is_zero, zeros, low)
        };
        fraction = builder.concat(&[top, low]);
    }
    builder.name(fraction, "result_fraction");
    let sign = unless(builder, exact.sign, exact.is_nan);
    builder.name(sign, "result_sign");
    builder.concat(&[sign, exponent, fraction])
}

/// Is anything below the last fraction bit?
pub(super) fn inexact(builder: &mut Builder, tail: Option<Tail>) -> Wire {
    let Some(tail) = tail else {
        return builder.constant(0, 1);
    };
    match tail.sticky {
        Some(sticky) => {
            let below = builder.concat(&[tail.guard, sticky]);
            builder.any_bit(below)
        }
        None => tail.guard,
    }
}

/// The five flags in their order.
fn flags(builder: &mut Builder, exact: &Unrounded, bounds: &Bounds) -> Wire {
    let none = builder.constant(0, 1);
    // The exact results that no exponent tells of.
    let is_exact = any_of(builder, [exact.is_nan, exact.is_infinity, exact.is_zero]);
    if let Some(is_exact) = is_exact {
        builder.name(is_exact, "result_is_exact");
    }
    let overflow = bounds.overflow.map(|wire| unless(builder, wire, is_exact));
    let flushed = bounds.underflow.map(|wire| unless(builder, wire, is_exact));
    let underflow = match exact.small {
        Small::Encoded { underflow } => underflow.map(|wire| unless(builder, wire, is_exact)),
        Small::Normalised => flushed,
    };
    let inexact = inexact(builder, exact.tail);
    let inexact = unless(builder, inexact, is_exact);
    let inexact = any_of(builder, [Some(inexact), overflow, flushed]);
    let flags = [
        ("is_invalid", exact.is_invalid),
        ("divides_by_zero", exact.divides_by_zero),
        ("raises_overflow", overflow),
        ("raises_underflow", underflow),
        ("raises_inexact", inexact),
    ];
    let flags = flags.map(|(name, flag)| match flag {
        Some(flag) => builder.name(flag, name),
        None => none,
    });
    let flags = builder.concat(&flags);
    builder.name(flags, "flags")
}
