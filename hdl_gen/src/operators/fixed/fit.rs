//! From a rounded result to the word of its format: saturated, or wrapped; and the flags.

use rtl_model::fixed::Overflow;

use super::round::Beyond;
use super::{Answer, FixedConfiguration};
use crate::netlist::{Builder, Wire};

/// A result that has no place behind the result format's last one.
pub(super) struct Rounded {
    /// Two's complement where `signed`.
    pub word: Wire,
    pub signed: bool,
    /// Bits of the word behind the point, at most as many as the result has.
    pub fraction_bits: u32,
    /// Was something rounded off? None where that cannot be, or nobody asks.
    pub inexact: Option<Wire>,
    /// The result is one that the word cannot hold.
    pub beyond: Option<Beyond>,
    /// There is no exact result.
    pub special: Option<Special>,
}

/// Where there is no exact result: neither rounded nor wrapped.
#[derive(Clone, Copy)]
pub(super) struct Special {
    /// The result is the end of the range.
    pub to_end: Wire,
    /// On which side; None where nothing is negative.
    pub negative: Option<Wire>,
    /// The result is zero, whatever else holds. None where that cannot be.
    pub to_zero: Option<Wire>,
    /// The flag; None where it is never raised.
    pub divides_by_zero: Option<Wire>,
    /// The flag; None where it is never raised.
    pub is_invalid: Option<Wire>,
}

impl Rounded {
    /// An exact one that the word holds.
    pub(super) fn new(word: Wire, signed: bool, fraction_bits: u32) -> Rounded {
        Rounded {
            word,
            signed,
            fraction_bits,
            inexact: None,
            beyond: None,
            special: None,
        }
    }
}

/// Looks at the range, after the rounding.
pub(super) fn fit(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    rounded: &Rounded,
) -> Answer {
    let format = configuration.result;
    builder.section(match configuration.overflow {
        Overflow::Saturate => "saturate",
        Overflow::Wrap => "wrap: the low bits are the result",
    });
    // Places that the word lacks at the end are zeros of the result, and do not take part.
    let zeros = format.fraction_bits - rounded.fraction_bits;
    let bits = format.width().saturating_sub(zeros);
    let overflow = overflow(builder, configuration, rounded, bits);
    let value = low_part(builder, rounded, bits, zeros);
    let special = rounded.special;
    let to_end = match (configuration.overflow, overflow, special) {
        (Overflow::Saturate, Some(overflow), Some(special)) => {
            Some(builder.or(overflow, special.to_end))
        }
        (Overflow::Saturate, Some(overflow), None) => Some(overflow),
        (_, _, special) => special.map(|special| special.to_end),
    };
    let mut result = value;
    if let Some(to_end) = to_end {
        builder.name(to_end, "to_end_of_range");
        let top = builder.width(rounded.word) - 1;
        let own_sign = rounded.signed.then(|| builder.bit(rounded.word, top));
        let mut negative = match rounded.beyond {
            Some(beyond) => beyond.negative,
            None => own_sign,
        };
        if let Some(special) = special {
            negative = special.negative;
        }
        result = ended(builder, configuration, value, to_end, negative);
    }
    if let Some(to_zero) = special.and_then(|special| special.to_zero) {
        let keep = builder.not(to_zero);
        let keep = builder.sign_extend(keep, format.width());
        result = builder.and(result, keep);
    }
    let flags = configuration
        .has_flags
        .then(|| flags(builder, rounded, overflow));
    Answer { result, flags }
}

/// Is the word beyond the range of `bits` bits of the result? None where it cannot be.
fn overflow(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    rounded: &Rounded,
    bits: u32,
) -> Option<Wire> {
    if configuration.overflow == Overflow::Wrap && !configuration.has_flags {
        return None;
    }
    let format = configuration.result;
    let own = builder.width(rounded.word);
    // The first bit of the word that may not differ from its sign, or may not be set.
    let lowest = if format.signed { bits - 1 } else { bits };
    let own_overflow = if rounded.signed {
        // Without a place of its own for the sign there is nothing above the result.
        let word = builder.sign_extend(rounded.word, own.max(lowest + 1));
        let upper = builder.slice(word, own.max(lowest + 1) - 1, lowest);
        if !format.signed {
            Some(builder.any_bit(upper))
        } else if builder.width(upper) > 1 {
            let all = builder.all_bits(upper);
            let any = builder.any_bit(upper);
            let not_all = builder.not(all);
            Some(builder.and(any, not_all))
        } else {
            None
        }
    } else if own > lowest {
        let upper = builder.slice(rounded.word, own - 1, lowest);
        Some(builder.any_bit(upper))
    } else {
        None
    };
    let overflow = match (own_overflow, rounded.beyond) {
        (Some(overflow), Some(beyond)) => Some(builder.or(overflow, beyond.is_beyond)),
        (overflow, beyond) => overflow.or(beyond.map(|beyond| beyond.is_beyond)),
    };
    overflow.map(|overflow| builder.name(overflow, "overflow"))
}

/// The result's bits of the word, extended where it has not as many, and zeros behind.
fn low_part(builder: &mut Builder, rounded: &Rounded, bits: u32, zeros: u32) -> Wire {
    let own = builder.width(rounded.word);
    let mut parts = Vec::new();
    if bits > 0 {
        parts.push(if own >= bits {
            builder.slice(rounded.word, bits - 1, 0)
        } else if rounded.signed {
            builder.sign_extend(rounded.word, bits)
        } else {
            builder.zero_extend(rounded.word, bits)
        });
    }
    if zeros > 0 {
        parts.push(builder.constant(0, zeros));
    }
    builder.concat(&parts)
}

/// The value, or the end of the range on the side of the sign.
fn ended(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    value: Wire,
    to_end: Wire,
    negative: Option<Wire>,
) -> Wire {
    let format = configuration.result;
    let width = format.width();
    let ended = match (format.signed, negative) {
        (true, Some(negative)) => {
            let positive = builder.not(negative);
            let end = if width > 1 {
                let rest = builder.sign_extend(positive, width - 1);
                builder.concat(&[negative, rest])
            } else {
                negative
            };
            builder.name(end, "end_of_range");
            builder.mux(to_end, end, value)
        }
        (true, None) => {
            let end = builder.constant(format.max(), width);
            builder.mux(to_end, end, value)
        }
        (false, Some(negative)) => {
            let positive = builder.not(negative);
            let end = builder.sign_extend(positive, width);
            builder.name(end, "end_of_range");
            builder.mux(to_end, end, value)
        }
        // All ones: a gate instead of a selector.
        (false, None) => {
            let ones = builder.sign_extend(to_end, width);
            builder.or(value, ones)
        }
    };
    builder.name(ended, "within_range")
}

/// The five flags, invalid first: inexact is the lowest bit.
fn flags(builder: &mut Builder, rounded: &Rounded, overflow: Option<Wire>) -> Wire {
    builder.section("flags");
    let zero = builder.constant(0, 1);
    let is_special = rounded.special.map(|special| match special.to_zero {
        Some(to_zero) => {
            let is_special = builder.or(special.to_end, to_zero);
            builder.name(is_special, "is_special")
        }
        None => special.to_end,
    });
    let unless_special = |builder: &mut Builder, flag: Option<Wire>| match (flag, is_special) {
        (Some(flag), Some(is_special)) => {
            let otherwise = builder.not(is_special);
            builder.and(flag, otherwise)
        }
        (Some(flag), None) => flag,
        (None, _) => zero,
    };
    let overflow_flag = unless_special(builder, overflow);
    let inexact = match (rounded.inexact, overflow) {
        (Some(inexact), Some(overflow)) => Some(builder.or(inexact, overflow)),
        (inexact, overflow) => inexact.or(overflow),
    };
    let inexact_flag = unless_special(builder, inexact);
    let divides_by_zero = rounded.special.and_then(|special| special.divides_by_zero);
    let is_invalid = rounded.special.and_then(|special| special.is_invalid);
    let flags = builder.concat(&[
        is_invalid.unwrap_or(zero),
        divides_by_zero.unwrap_or(zero),
        overflow_flag,
        zero,
        inexact_flag,
    ]);
    builder.name(flags, "flags")
}
