//! Square root.

use rtl_model::float::{Policy, Rounding};

use super::OperatorConfiguration;
use super::round::{
    Answer, Small, Tail, Unrounded, exponent_constant, exponent_width, needs_tail, round,
};
use super::unpack::{classify, fields, is_signalling, normalise};
use crate::netlist::{Builder, Wire};

/// The square root of `a`: non-restoring digit recurrence in radix 2, a row of one adder for each
/// bit of the root, each two places longer than the one before it by one bit.
pub(super) fn square_root(builder: &mut Builder, configuration: OperatorConfiguration) -> Answer {
    // Whatever is rounded is positive: down is toward zero.
    let configuration = match configuration.rounding {
        Rounding::Down => OperatorConfiguration {
            rounding: Rounding::TowardZero,
            ..configuration
        },
        _ => configuration,
    };
    let OperatorConfiguration {
        format,
        rounding,
        policy,
        has_flags,
        ..
    } = configuration;
    let fraction_bits = format.fraction_bits;
    let bias = i64::from(format.exponent_bias());
    let largest = i64::try_from(format.exponent_all_ones() - 1).expect("11 bits at most");
    let smallest = match policy {
        Policy::Flush => 1,
        Policy::Full => 1 - i64::from(fraction_bits),
    };
    let sum_range = smallest + bias..=largest + bias;
    let exponent_range = (smallest + bias) >> 1..=(largest + bias) >> 1;
    let sum_bits = exponent_width(format, &sum_range);
    let exponent_bits = exponent_width(format, &exponent_range).max(sum_bits - 1);
    builder.localparam(
        "SUM_BITS",
        sum_bits.into(),
        "twice the root's exponent, with the bias twice",
    );

    let a_i = builder.input("a_i", format.width());
    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");

    builder.section("special cases");
    let a_is = classify(builder, policy, &a, "a");
    let nonzero = builder.not(a_is.is_zero);
    let below_zero = builder.and(a.sign, nonzero);
    builder.name(below_zero, "below_zero");
    let is_nan = builder.or(a_is.is_nan, below_zero);
    builder.name(is_nan, "is_nan");
    let is_invalid = has_flags.then(|| {
        let is_number = builder.not(a_is.is_nan);
        let undefined = builder.and(below_zero, is_number);
        builder.name(undefined, "undefined");
        let a_is_signalling = is_signalling(builder, &a, a_is.is_nan, "a");
        builder.or(undefined, a_is_signalling)
    });

    let (exponent, fraction) = match policy {
        Policy::Flush => (builder.zero_extend(a.exponent, sum_bits), a.fraction),
        Policy::Full => {
            builder.section("normalise a subnormal operand");
            let normalised = normalise(builder, &a, a_is.exponent_nonzero, sum_bits, "a");
            (normalised.exponent, normalised.fraction)
        }
    };

    builder.section("halve the exponent: an odd one leaves its two to the radicand");
    let bias_word = exponent_constant(builder, bias, sum_bits);
    let sum = builder.add(exponent, bias_word);
    builder.name(sum, "exponent_and_bias");
    let is_odd = builder.bit(sum, 0);
    builder.name(is_odd, "exponent_is_odd");
    let halved = builder.slice(sum, sum_bits - 1, 1);
    let exponent = if *exponent_range.start() < 0 {
        builder.sign_extend(halved, exponent_bits)
    } else {
        builder.zero_extend(halved, exponent_bits)
    };
    builder.name(exponent, "root_exponent");
    let adjustment = builder.constant(0, exponent_bits);
    // Between 1 and 4: two bits before the point.
    let zero = builder.constant(0, 1);
    let one = builder.constant(1, 1);
    let from_odd = builder.concat(&[one, fraction, zero]);
    let from_even = builder.concat(&[zero, one, fraction]);
    let radicand = builder.mux(is_odd, from_odd, from_even);
    builder.name(radicand, "radicand");

    // A root is never a tie: with one bit more than the significand, and that bit a one, its square
    // would be longer than the radicand.
    let has_guard = rounding == Rounding::NearestEven;
    let reaches_below = *exponent_range.start() < 1;
    let has_remainder = has_flags
        || !matches!(rounding, Rounding::NearestEven | Rounding::TowardZero)
        || (has_guard && policy == Policy::Full && reaches_below);
    let rows = fraction_bits + u32::from(has_guard);
    let recurrence = root_of(builder, radicand, rows);
    let fraction = builder.concat(&recurrence.digits[1..=fraction_bits as usize]);
    builder.name(fraction, "root_fraction");
    let tail = needs_tail(configuration).then(|| {
        let inexact = has_remainder.then(|| remainder_nonzero(builder, &recurrence));
        match recurrence.digits.get(fraction_bits as usize + 1) {
            Some(&guard) => Tail {
                guard,
                sticky: inexact,
            },
            None => Tail {
                guard: inexact.expect("a tail without guard bit tells what is inexact"),
                sticky: None,
            },
        }
    });

    round(
        builder,
        configuration,
        &Unrounded {
            sign: a.sign,
            exponent,
            adjustment,
            exponent_range,
            fraction,
            tail,
            is_nan: Some(is_nan),
            is_infinity: Some(a_is.is_infinity),
            is_zero: Some(a_is.is_zero),
            is_invalid,
            divides_by_zero: None,
            small: Small::Normalised,
            early_bounds: None,
        },
    )
}

/// The state of the recurrence after its last row.
struct Recurrence {
    /// The root's bits, the one before the point first.
    digits: Vec<Wire>,
    /// The last partial remainder, in two's complement.
    remainder: Wire,
}

/// The rows. With Q the root so far as an integer and R what is left of the radicand, a row takes
/// two more bits of it and tries `4 R - (4 Q + 1)`; a negative remainder is not restored, the next
/// row adds `4 Q + 3` instead. As either, in two's complement, ends in two ones, what is added is Q
/// or its complement before them, and no carry comes in.
fn root_of(builder: &mut Builder, radicand: Wire, rows: u32) -> Recurrence {
    builder.section("extract the root");
    let radicand_bits = builder.width(radicand);
    // The first bit of the root is a one, and leaves 0, 1 or 2.
    let top = builder.slice(radicand, radicand_bits - 1, radicand_bits - 2);
    let zero = builder.constant(0, 1);
    let one = builder.constant(1, 1);
    let low = builder.bit(top, 0);
    let high = builder.bit(top, 1);
    let not_low = builder.not(low);
    let both = builder.and(low, high);
    let mut remainder = builder.concat(&[zero, both, not_low]);
    builder.name(remainder, "remainder_0");
    let mut digits = vec![one];
    for row in 1..=rows {
        // Two places of the radicand, of which those past its end are zeros.
        let place = |offset: u32| {
            let below_top = 2 * row + offset;
            (below_top < radicand_bits).then(|| radicand_bits - 1 - below_top)
        };
        let (first, second) = (place(0), place(1));
        let subtracts = (row > 1).then(|| *digits.last().expect("the row before left a digit"));
        let root = builder.concat(&digits);
        let addend = match subtracts {
            None => {
                let root = builder.not(root);
                builder.concat(&[one, root])
            }
            Some(subtracts) => {
                let root = builder.concat(&[zero, root]);
                let complement = builder.sign_extend(subtracts, row + 1);
                builder.xor(root, complement)
            }
        };
        builder.name(addend, format!("addend_{row}"));
        let kept = builder.slice(remainder, row, 0);
        remainder = match first {
            None => {
                let sum = builder.add(kept, addend);
                builder.concat(&[sum, one, one])
            }
            Some(first) => {
                let first = builder.bit(radicand, first);
                let second = match second {
                    Some(second) => builder.bit(radicand, second),
                    None => zero,
                };
                let moved = builder.concat(&[kept, first, second]);
                let addend = builder.concat(&[addend, one, one]);
                builder.add(moved, addend)
            }
        };
        builder.name(remainder, format!("remainder_{row}"));
        let negative = builder.bit(remainder, row + 2);
        let digit = builder.not(negative);
        digits.push(builder.name(digit, format!("root_bit_{row}")));
    }
    Recurrence { digits, remainder }
}

/// Is the root inexact? A negative last remainder is restored first, by `2 Q + 1`.
fn remainder_nonzero(builder: &mut Builder, recurrence: &Recurrence) -> Wire {
    let bits = builder.width(recurrence.remainder);
    let root = builder.concat(&recurrence.digits);
    let one = builder.constant(1, 1);
    let correction = builder.concat(&[root, one]);
    let correction = builder.zero_extend(correction, bits);
    let negative = builder.bit(recurrence.remainder, bits - 1);
    let negative = builder.sign_extend(negative, bits);
    let correction = builder.and(correction, negative);
    let restored = builder.add(recurrence.remainder, correction);
    builder.name(restored, "final_remainder");
    let nonzero = builder.any_bit(restored);
    builder.name(nonzero, "remainder_nonzero")
}
