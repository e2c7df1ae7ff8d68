//! Division and the reciprocal: non-restoring digit recurrence in radix 2.

use rtl_model::fixed::{FixedFormat, Overflow};
use rtl_model::float::Rounding;

use super::fit::{Rounded, Special, fit};
use super::round::{Beyond, SignMagnitude, round_magnitude};
use super::{Answer, FixedConfiguration, FixedOperator, operand};
use crate::netlist::{Builder, Wire};

/// How the recurrence is laid out.
///
/// The quotient of the words is an integer of the places that the result keeps, if the dividend is
/// moved left by `moved` first. Of that dividend the first bits, which only tell whether the
/// quotient is beyond the range, are the first remainder, and each row takes one more.
#[derive(Clone, Copy)]
struct Layout {
    /// Places the dividend is moved left by; below zero: right.
    moved: i64,
    /// Bits of the moved dividend.
    dividend_bits: u32,
    /// Digits of the quotient, the guard bit's among them.
    rows: u32,
    /// Is the last digit a guard bit? Only rounding to nearest needs more than the sticky bit.
    has_guard: bool,
    /// Bits of the quotient that the result can hold.
    kept_bits: u32,
}

/// The layout of `a / b`.
fn layout(configuration: FixedConfiguration, a: FixedFormat, b: FixedFormat) -> Layout {
    let result = configuration.result;
    let has_guard = configuration.rounding == Rounding::NearestEven;
    let places = result.fraction_bits + u32::from(has_guard) + b.fraction_bits;
    let moved = i64::from(places) - i64::from(a.fraction_bits);
    // A dividend that is moved out as a whole leaves one zero.
    let dividend_bits = (i64::from(a.width()) + moved).max(1);
    let dividend_bits = u32::try_from(dividend_bits).expect("a few hundred at most");
    let kept_bits = result.width();
    let digits = kept_bits + u32::from(has_guard);
    Layout {
        moved,
        dividend_bits,
        rows: match configuration.overflow {
            Overflow::Saturate => dividend_bits.min(digits),
            // The low bits of a quotient that is beyond the range need every digit before them.
            Overflow::Wrap => dividend_bits,
        },
        has_guard,
        kept_bits,
    }
}

/// The format of the dividend 1.
const ONE: FixedFormat = FixedFormat::uq(1, 0);

/// The widest word of a division, or of a reciprocal.
pub(super) fn widest_word(configuration: FixedConfiguration) -> u32 {
    let (a, b) = match configuration.operator {
        FixedOperator::Reciprocal => (ONE, configuration.a),
        _ => (configuration.a, configuration.b),
    };
    let layout = layout(configuration, a, b);
    let first_remainder = layout.dividend_bits - layout.rows;
    first_remainder.max(b.width() + 2).max(layout.kept_bits + 2)
}

/// A number's sign and magnitude.
pub(super) struct Operand {
    format: FixedFormat,
    /// None where it has none.
    pub negative: Option<Wire>,
    /// As many bits as the number has.
    pub magnitude: Wire,
}

/// Takes a number apart.
pub(super) fn sign_and_magnitude(
    builder: &mut Builder,
    word: Wire,
    format: FixedFormat,
    name: &str,
) -> Operand {
    if !format.signed {
        return Operand {
            format,
            negative: None,
            magnitude: word,
        };
    }
    let width = format.width();
    let negative = builder.bit(word, width - 1);
    builder.name(negative, format!("{name}_negative"));
    let signs = builder.sign_extend(negative, width);
    let complemented = builder.xor(word, signs);
    let carry = builder.zero_extend(negative, width);
    let magnitude = builder.add(complemented, carry);
    builder.name(magnitude, format!("{name}_magnitude"));
    Operand {
        format,
        negative: Some(negative),
        magnitude,
    }
}

/// `a / b`.
pub(super) fn divide(builder: &mut Builder, configuration: FixedConfiguration) -> Answer {
    let a_i = operand(builder, "a_i", configuration.a);
    let b_i = operand(builder, "b_i", configuration.b);
    builder.section("signs and magnitudes");
    let dividend = sign_and_magnitude(builder, a_i, configuration.a, "a");
    let divisor = sign_and_magnitude(builder, b_i, configuration.b, "b");
    quotient(builder, configuration, &dividend, &divisor)
}

/// `1 / a`.
pub(super) fn reciprocal(builder: &mut Builder, configuration: FixedConfiguration) -> Answer {
    let a_i = operand(builder, "a_i", configuration.a);
    builder.section("sign and magnitude");
    let divisor = sign_and_magnitude(builder, a_i, configuration.a, "a");
    let one = builder.constant(1, 1);
    let dividend = Operand {
        format: ONE,
        negative: None,
        magnitude: one,
    };
    quotient(builder, configuration, &dividend, &divisor)
}

/// The quotient of two numbers, rounded.
fn quotient(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    dividend: &Operand,
    divisor: &Operand,
) -> Answer {
    let layout = layout(configuration, dividend.format, divisor.format);
    builder.localparam(
        "QUOTIENT_BITS",
        layout.rows.into(),
        if layout.has_guard {
            "one row each: down to the result's last place, and a guard bit"
        } else {
            "one row each: down to the result's last place"
        },
    );
    builder.section("special cases");
    let divisor_nonzero = builder.any_bit(divisor.magnitude);
    let divisor_zero = builder.not(divisor_nonzero);
    builder.name(divisor_zero, "divisor_is_zero");
    // A reciprocal's dividend is 1.
    let is_division = configuration.operator == FixedOperator::Divide;
    let undefined = is_division.then(|| {
        let dividend_nonzero = builder.any_bit(dividend.magnitude);
        let dividend_zero = builder.not(dividend_nonzero);
        let undefined = builder.and(divisor_zero, dividend_zero);
        builder.name(undefined, "undefined")
    });
    let divides_by_zero = match undefined {
        Some(undefined) => {
            let defined = builder.not(undefined);
            let divides_by_zero = builder.and(divisor_zero, defined);
            builder.name(divides_by_zero, "divides_by_zero")
        }
        None => divisor_zero,
    };
    let sign = match (dividend.negative, divisor.negative) {
        (Some(a), Some(b)) => {
            let sign = builder.xor(a, b);
            Some(builder.name(sign, "quotient_negative"))
        }
        (a, b) => a.or(b),
    };

    let recurrence = rows(builder, layout, dividend.magnitude, divisor.magnitude);
    let digits = recurrence.digits.len() - usize::from(layout.has_guard);
    let (kept, guard) = recurrence.digits.split_at(digits);
    // Digits above the result's are there only where it wraps.
    let above = kept.len().saturating_sub(layout.kept_bits as usize);
    let (above, kept) = kept.split_at(above);
    let kept = if kept.is_empty() {
        builder.constant(0, 1)
    } else {
        builder.concat(kept)
    };
    builder.name(kept, "quotient");
    let is_beyond = match recurrence.beyond {
        Some(beyond) => Some(beyond),
        None if above.is_empty() => None,
        None => {
            let above = builder.concat(above);
            let above = builder.any_bit(above);
            Some(builder.name(above, "quotient_beyond"))
        }
    };
    let asks_sticky = configuration.has_flags || configuration.rounding != Rounding::TowardZero;
    let sticky = asks_sticky.then(|| {
        builder.section("is there a remainder?");
        let remainder = remainder_nonzero(builder, &recurrence);
        // What the dividend lost when it was moved right.
        let sticky = match u32::try_from(-layout.moved) {
            Ok(lost) if lost > 0 => {
                let lost = lost.min(builder.width(dividend.magnitude));
                let lost = builder.slice(dividend.magnitude, lost - 1, 0);
                let lost = builder.any_bit(lost);
                builder.or(remainder, lost)
            }
            _ => remainder,
        };
        builder.name(sticky, "sticky_bit")
    });
    let rounded = round_magnitude(
        builder,
        configuration,
        &SignMagnitude {
            sign,
            kept,
            guard: guard.first().copied(),
            sticky,
        },
    );
    fit(
        builder,
        configuration,
        &Rounded {
            beyond: is_beyond.map(|is_beyond| Beyond {
                is_beyond,
                negative: sign,
            }),
            special: Some(Special {
                to_end: divisor_zero,
                // The sign of a zero divisor is not negative, so that is the dividend's.
                negative: sign,
                to_zero: undefined,
                divides_by_zero: Some(divides_by_zero),
                is_invalid: undefined,
            }),
            ..rounded
        },
    )
}

/// What the rows leave behind.
struct Recurrence {
    /// The quotient's bits, the first the highest.
    digits: Vec<Wire>,
    /// The last partial remainder, in two's complement.
    remainder: Wire,
    /// The divisor in as many bits.
    divisor: Wire,
    /// Is the quotient beyond the digits?
    beyond: Option<Wire>,
}

/// The rows. A row doubles the remainder, takes the dividend's next bit and subtracts the divisor;
/// a negative remainder is not restored, the next row adds the divisor where it would have
/// subtracted it (`2 (r + d) - d = 2 r + d`). So a digit is 1 where the remainder is not negative.
fn rows(builder: &mut Builder, layout: Layout, dividend: Wire, divisor: Wire) -> Recurrence {
    let bits = builder.width(divisor) + 1;
    builder.localparam(
        "REMAINDER_BITS",
        bits.into(),
        "a remainder between minus the divisor and the divisor, in two's complement",
    );
    builder.section("digit recurrence: add or subtract the divisor, one quotient bit a row");
    let divisor_zero = builder.constant(0, 1);
    let wide_divisor = builder.concat(&[divisor_zero, divisor]);
    // The dividend's bits, the first the highest; None where it is a zero that was moved in.
    let own_bits = i64::from(builder.width(dividend));
    let bit_of = |place: u32| {
        let place = i64::from(layout.dividend_bits - 1 - place) - layout.moved;
        let is_own = (0..own_bits).contains(&place);
        is_own.then(|| u32::try_from(place).expect("a bit of the dividend"))
    };
    let bit = |builder: &mut Builder, place: u32| match bit_of(place) {
        Some(place) => builder.bit(dividend, place),
        None => builder.constant(0, 1),
    };

    let first_bits = layout.dividend_bits - layout.rows;
    let mut remainder = builder.constant(0, bits);
    let mut beyond = None;
    if first_bits > 0 {
        let first: Vec<Wire> = (0..first_bits).map(|place| bit(builder, place)).collect();
        let first = builder.concat(&first);
        builder.name(first, "first_remainder");
        let width = first_bits.max(bits);
        let wide_first = builder.zero_extend(first, width);
        let limit = builder.zero_extend(divisor, width);
        let below = builder.less_than(wide_first, limit);
        let not_below = builder.not(below);
        beyond = Some(builder.name(not_below, "quotient_beyond"));
        // If it is cut here, the quotient is beyond the range anyway.
        remainder = builder.slice(wide_first, bits - 1, 0);
    }
    let mut digits: Vec<Wire> = Vec::new();
    for row in 0..layout.rows {
        let place = first_bits + row;
        let kept = builder.slice(remainder, bits - 2, 0);
        remainder = if let Some(&subtracts) = digits.last() {
            let complement = builder.sign_extend(subtracts, bits);
            let addend = builder.xor(wide_divisor, complement);
            builder.name(addend, format!("addend_{row}"));
            if bit_of(place).is_some() {
                // The subtraction's carry comes in at a place of its own.
                let next = bit(builder, place);
                let doubled = builder.concat(&[kept, next, subtracts]);
                let addend = builder.concat(&[addend, subtracts]);
                let sum = builder.add(doubled, addend);
                builder.name(sum, format!("row_sum_{row}"));
                builder.slice(sum, bits, 1)
            } else {
                // Or at the place that doubling leaves vacant.
                let doubled = builder.concat(&[kept, subtracts]);
                builder.add(doubled, addend)
            }
        } else {
            let next = bit(builder, place);
            let doubled = builder.concat(&[kept, next]);
            builder.subtract(doubled, wide_divisor)
        };
        builder.name(remainder, format!("remainder_{row}"));
        let negative = builder.bit(remainder, bits - 1);
        let digit = builder.not(negative);
        digits.push(builder.name(digit, format!("quotient_bit_{row}")));
    }
    Recurrence {
        digits,
        remainder,
        divisor: wide_divisor,
        beyond,
    }
}

/// Does the division leave a remainder? A negative last one is restored first.
fn remainder_nonzero(builder: &mut Builder, recurrence: &Recurrence) -> Wire {
    let bits = builder.width(recurrence.remainder);
    let negative = builder.bit(recurrence.remainder, bits - 1);
    let negative = builder.sign_extend(negative, bits);
    let correction = builder.and(recurrence.divisor, negative);
    let restored = builder.add(recurrence.remainder, correction);
    builder.name(restored, "final_remainder");
    let nonzero = builder.any_bit(restored);
    builder.name(nonzero, "remainder_nonzero")
}
