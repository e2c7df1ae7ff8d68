//! From one float format to another.

use rtl_model::float::{FloatFormat, Policy};

use super::OperatorConfiguration;
use super::round::{
    Answer, Small, Tail, Unrounded, exponent_constant, exponent_width, gathered, needs_tail, round,
};
use super::unpack::{classify, fields, is_signalling, normalise};
use crate::netlist::Builder;

/// `a` as a float of the target format: another bias, another length, the rounder.
pub(super) fn convert(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    target: FloatFormat,
) -> Answer {
    let OperatorConfiguration {
        format: source,
        policy,
        has_flags,
        ..
    } = configuration;
    let largest = i64::try_from(source.exponent_all_ones() - 1).expect("11 bits at most");
    let smallest = match policy {
        Policy::Flush => 1,
        Policy::Full => 1 - i64::from(source.fraction_bits),
    };
    let change = i64::from(target.exponent_bias()) - i64::from(source.exponent_bias());
    let exponent_range = smallest + change..=largest + change;
    // A source's field is a word of it, too.
    let exponent_bits =
        exponent_width(target, &exponent_range).max(exponent_width(source, &(smallest..=largest)));
    builder.localparam(
        "EXPONENT_BITS",
        exponent_bits.into(),
        "the exponent of any operand, with either bias",
    );
    let a_i = builder.input("a_i", source.width());
    builder.section("unpack");
    let a = fields(builder, source, a_i, "a");
    let a_is = classify(builder, policy, &a, "a");
    let is_invalid = has_flags.then(|| is_signalling(builder, &a, a_is.is_nan, "a"));
    let (exponent, fraction) = match policy {
        Policy::Flush => (builder.zero_extend(a.exponent, exponent_bits), a.fraction),
        Policy::Full => {
            builder.section("normalise a subnormal operand");
            let normalised = normalise(builder, &a, a_is.exponent_nonzero, exponent_bits, "a");
            (normalised.exponent, normalised.fraction)
        }
    };

    builder.section("change bias and length");
    let adjustment = exponent_constant(builder, change, exponent_bits);
    let (have, want) = (source.fraction_bits, target.fraction_bits);
    let target_configuration = OperatorConfiguration {
        format: target,
        ..configuration
    };
    let (fraction, tail) = if want >= have {
        let fraction = if want > have {
            let zeros = builder.constant(0, want - have);
            builder.concat(&[fraction, zeros])
        } else {
            fraction
        };
        (fraction, None)
    } else {
        let below = have - want;
        let kept = builder.slice(fraction, have - 1, below);
        builder.name(kept, "kept_fraction");
        let tail = needs_tail(target_configuration).then(|| {
            let guard = builder.bit(fraction, below - 1);
            builder.name(guard, "guard_bit");
            let sticky = (below > 1).then(|| {
                let below_guard = builder.slice(fraction, below - 2, 0);
                gathered(builder, below_guard, "sticky_bits")
            });
            Tail {
                guard,
                sticky: Some(sticky.unwrap_or_else(|| builder.constant(0, 1))),
            }
        });
        (kept, tail)
    };

    round(
        builder,
        target_configuration,
        &Unrounded {
            sign: a.sign,
            exponent,
            adjustment,
            exponent_range,
            fraction,
            tail,
            is_nan: Some(a_is.is_nan),
            is_infinity: Some(a_is.is_infinity),
            is_zero: Some(a_is.is_zero),
            is_invalid,
            divides_by_zero: None,
            small: Small::Normalised,
            early_bounds: None,
        },
    )
}
