//! Comparisons (IEEE 754-2019, section 5.11): zeros of both signs are equal, NaN is unordered.

use rtl_model::float::Policy;

use super::OperatorConfiguration;
use super::round::Answer;
use super::unpack::{Fields, fields, is_nan, is_signalling, is_zero, magnitude};
use crate::netlist::{Builder, Wire};

/// Which order is asked.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// `a < b`
    LessThan,
    /// `a <= b`
    LessEqual,
}

/// What every comparison starts from.
struct Operands {
    a: Fields,
    b: Fields,
    a_magnitude: Wire,
    b_magnitude: Wire,
    a_is_nan: Wire,
    b_is_nan: Wire,
    signs_differ: Wire,
    both_are_zero: Wire,
    unordered: Wire,
}

fn operands(builder: &mut Builder, configuration: OperatorConfiguration) -> Operands {
    let format = configuration.format;
    let a_i = builder.input("a_i", format.width());
    let b_i = builder.input("b_i", format.width());
    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let b = fields(builder, format, b_i, "b");
    let a_magnitude = magnitude(builder, format, a_i, "a");
    let b_magnitude = magnitude(builder, format, b_i, "b");
    let both_are_zero = match configuration.policy {
        Policy::Flush => {
            // Only two zeros need care: a subnormal pattern is below every normal one anyway.
            let a_is_zero = is_zero(builder, &a, "a");
            let b_is_zero = is_zero(builder, &b, "b");
            builder.and(a_is_zero, b_is_zero)
        }
        Policy::Full => {
            let either = builder.or(a_magnitude, b_magnitude);
            let nonzero = builder.any_bit(either);
            builder.not(nonzero)
        }
    };
    builder.name(both_are_zero, "both_are_zero");
    let a_is_nan = is_nan(builder, &a, "a");
    let b_is_nan = is_nan(builder, &b, "b");
    let unordered = builder.or(a_is_nan, b_is_nan);
    builder.name(unordered, "unordered");
    let signs_differ = builder.xor(a.sign, b.sign);
    builder.name(signs_differ, "signs_differ");
    Operands {
        a,
        b,
        a_magnitude,
        b_magnitude,
        a_is_nan,
        b_is_nan,
        signs_differ,
        both_are_zero,
        unordered,
    }
}

/// The order by sign and magnitude, zeros and NaNs aside. Of two negative operands the larger
/// magnitude is the smaller number; one comparator serves both signs, since
/// `b < a = !(a <= b)` and `a <= b = 2 a < 2 b + 1`.
fn ordered(builder: &mut Builder, operands: &Operands, order: Order) -> Wire {
    let negative = operands.a.sign;
    let allows_equal = match order {
        Order::LessThan => negative,
        Order::LessEqual => builder.not(negative),
    };
    let zero = builder.constant(0, 1);
    let a_doubled = builder.concat(&[operands.a_magnitude, zero]);
    let b_doubled = builder.concat(&[operands.b_magnitude, allows_equal]);
    let magnitude_below = builder.less_than(a_doubled, b_doubled);
    builder.name(magnitude_below, "magnitude_below");
    let of_equal_signs = builder.xor(magnitude_below, negative);
    let ordered = builder.mux(operands.signs_differ, negative, of_equal_signs);
    builder.name(ordered, "ordered_by_sign")
}

/// The flag invalid: raised by a signalling NaN, and by any where the comparison signals.
fn flags(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    operands: &Operands,
    signals: bool,
) -> Option<Wire> {
    configuration.has_flags.then(|| {
        builder.section("flags");
        let invalid = if signals {
            operands.unordered
        } else {
            let a_is_signalling = is_signalling(builder, &operands.a, operands.a_is_nan, "a");
            let b_is_signalling = is_signalling(builder, &operands.b, operands.b_is_nan, "b");
            builder.or(a_is_signalling, b_is_signalling)
        };
        invalid_alone(builder, invalid)
    })
}

/// The flags of an operator that raises none but invalid.
pub(super) fn invalid_alone(builder: &mut Builder, invalid: Wire) -> Wire {
    let others = builder.constant(0, 4);
    let flags = builder.concat(&[invalid, others]);
    builder.name(flags, "flags")
}

/// `a < b` or `a <= b`, false where either is NaN, which is invalid: one comparator.
pub(super) fn less(
    builder: &mut Builder,
    configuration: OperatorConfiguration,
    order: Order,
) -> Answer {
    let operands = operands(builder, configuration);
    builder.section("compare");
    let ordered = ordered(builder, &operands, order);
    let when_ordered = match order {
        Order::LessThan => {
            let not_both_zero = builder.not(operands.both_are_zero);
            builder.and(ordered, not_both_zero)
        }
        Order::LessEqual => builder.or(ordered, operands.both_are_zero),
    };
    let is_ordered = builder.not(operands.unordered);
    let result = builder.and(when_ordered, is_ordered);
    builder.name(result, "result");
    let flags = flags(builder, configuration, &operands, true);
    Answer { result, flags }
}

/// All four relations; drives the output ports. The other predicates of the standard are a gate
/// away, as `docs/numerics.md` lists them.
pub(super) fn compare(builder: &mut Builder, configuration: OperatorConfiguration, signals: bool) {
    let operands = operands(builder, configuration);
    builder.section("compare");
    let is_ordered = builder.not(operands.unordered);
    let same_magnitude = builder.equal(operands.a_magnitude, operands.b_magnitude);
    builder.name(same_magnitude, "same_magnitude");
    let same_sign = builder.not(operands.signs_differ);
    let same_bits = builder.and(same_magnitude, same_sign);
    let equal_numbers = builder.or(same_bits, operands.both_are_zero);
    builder.name(equal_numbers, "equal_numbers");
    let equal = builder.and(is_ordered, equal_numbers);
    builder.name(equal, "equal");
    let below = ordered(builder, &operands, Order::LessThan);
    let not_both_zero = builder.not(operands.both_are_zero);
    let below = builder.and(below, not_both_zero);
    let less_than = builder.and(is_ordered, below);
    builder.name(less_than, "less_than");
    let less_equal = builder.or(less_than, equal);
    builder.name(less_equal, "less_equal");
    let flags = flags(builder, configuration, &operands, signals);
    builder.output("less_than_o", less_than);
    builder.output("less_equal_o", less_equal);
    builder.output("equal_o", equal);
    builder.output("unordered_o", operands.unordered);
    if let Some(flags) = flags {
        builder.output("flags_o", flags);
    }
}
