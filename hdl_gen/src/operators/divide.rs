//! Division.

use rtl_model::float::{Policy, Rounding};

use super::OperatorConfiguration;
use super::round::{Answer, Small, Tail, Unrounded, exponent_constant, exponent_width, round};
use super::unpack::{classify, fields};
use crate::netlist::{Builder, Wire};

/// `a / b`: non-restoring digit recurrence in radix 2, one row of one adder a quotient bit.
pub(super) fn divide(builder: &mut Builder, configuration: OperatorConfiguration) -> Answer {
    let OperatorConfiguration {
        format, rounding, ..
    } = configuration;
    let fraction_bits = format.fraction_bits;
    let bias = i64::from(format.exponent_bias());
    let largest_field = i64::try_from(format.exponent_all_ones() - 1).expect("11 bits at most");
    let exponent_range = bias - largest_field..=largest_field - 1 + bias;
    let exponent_word_bits = exponent_width(format, &exponent_range);
    builder.localparam(
        "EXPONENT_BITS",
        exponent_word_bits.into(),
        "a two's complement exponent from smallest by largest to largest by smallest",
    );
    // A quotient below one begins with its second bit, so there is one more than the significand,
    // and for rounding to nearest a guard bit.
    let quotient_bits = fraction_bits + 2 + u32::from(rounding == Rounding::NearestEven);
    builder.localparam(
        "QUOTIENT_BITS",
        quotient_bits.into(),
        "the significand, a bit for quotients below one, and a guard bit if rounding to nearest",
    );

    let a_i = builder.input("a_i", format.width());
    let b_i = builder.input("b_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let b = fields(builder, format, b_i, "b");

    builder.section("special cases");
    let a_is = classify(builder, Policy::Flush, &a, "a");
    let b_is = classify(builder, Policy::Flush, &b, "b");
    let sign = builder.xor(a.sign, b.sign);
    builder.name(sign, "quotient_sign");
    let is_zero = builder.or(a_is.is_zero, b_is.is_infinity);
    builder.name(is_zero, "is_zero");
    let is_infinity = builder.or(a_is.is_infinity, b_is.is_zero);
    builder.name(is_infinity, "is_infinity");
    let any_nan = builder.or(a_is.is_nan, b_is.is_nan);
    builder.name(any_nan, "any_is_nan");
    // Zero by zero and infinity by infinity call for a zero and for an infinity at once.
    let undefined = builder.and(is_zero, is_infinity);
    builder.name(undefined, "undefined");
    let is_nan = builder.or(any_nan, undefined);
    builder.name(is_nan, "is_nan");

    builder.section("subtract the exponents");
    let a_wide = builder.zero_extend(a.exponent, exponent_word_bits);
    let b_wide = builder.zero_extend(b.exponent, exponent_word_bits);
    let exponent = builder.subtract(a_wide, b_wide);
    builder.name(exponent, "exponent_difference");

    let recurrence = divide_significands(builder, a.fraction, b.fraction, quotient_bits);

    builder.section("normalise: the quotient is above one half");
    let reaches_one = recurrence.digits[0];
    let at_one = builder.concat(&recurrence.digits[1..=fraction_bits as usize]);
    let below_one = builder.concat(&recurrence.digits[2..=fraction_bits as usize + 1]);
    let fraction = builder.mux(reaches_one, at_one, below_one);
    builder.name(fraction, "quotient_fraction");
    let adjustment_at_one = exponent_constant(builder, bias, exponent_word_bits);
    let adjustment_below_one = exponent_constant(builder, bias - 1, exponent_word_bits);
    let adjustment = builder.mux(reaches_one, adjustment_at_one, adjustment_below_one);
    builder.name(adjustment, "exponent_adjustment");
    // A quotient of two significands is never a tie: with one bit more than they have, and that bit
    // a one, it times the divisor's odd part would be longer than the dividend is. So rounding to
    // nearest needs no remainder, and a directed rounding no guard bit: a quotient without
    // remainder fits the significand.
    let tail = match rounding {
        Rounding::TowardZero => None,
        Rounding::NearestEven => {
            let last = recurrence.digits[fraction_bits as usize + 2];
            let last_but_one = recurrence.digits[fraction_bits as usize + 1];
            let guard = builder.mux(reaches_one, last_but_one, last);
            Some(builder.name(guard, "guard_bit"))
        }
        Rounding::Up | Rounding::Down => Some(remainder_nonzero(builder, &recurrence)),
    };
    let tail = tail.map(|guard| Tail {
        guard,
        sticky: None,
    });

    round(
        builder,
        configuration,
        &Unrounded {
            sign,
            exponent,
            adjustment,
            exponent_range,
            fraction,
            tail,
            is_nan: Some(is_nan),
            is_infinity: Some(is_infinity),
            is_zero: Some(is_zero),
            is_invalid: None,
            divides_by_zero: None,
            small: Small::Normalised,
        },
    )
}

/// The state of the recurrence after its last row.
struct Recurrence {
    /// The quotient's bits, the one of weight 1 first.
    digits: Vec<Wire>,
    /// The last partial remainder, in two's complement.
    remainder: Wire,
    /// The divisor's significand in as many bits.
    divisor: Wire,
}

/// The rows. A row's remainder is what a restoring divider would get by its trial subtraction: a
/// negative one is not restored, the next row adds the divisor where it would have subtracted it
/// (`2 (r + d) - d = 2 r + d`). So a quotient bit is 1 where the remainder is not negative. The
/// subtraction's carry comes in at the place that doubling leaves vacant, for nothing.
fn divide_significands(
    builder: &mut Builder,
    a_fraction: Wire,
    b_fraction: Wire,
    quotient_bits: u32,
) -> Recurrence {
    builder.section("divide the significands");
    let remainder_bits = builder.width(a_fraction) + 2;
    builder.localparam(
        "REMAINDER_BITS",
        remainder_bits.into(),
        "a partial remainder lies between minus and plus the divisor's significand",
    );
    let leading = builder.constant(0b01, 2);
    let dividend = builder.concat(&[leading, a_fraction]);
    builder.name(dividend, "dividend");
    let divisor = builder.concat(&[leading, b_fraction]);
    builder.name(divisor, "divisor");
    let mut remainder = builder.subtract(dividend, divisor);
    let mut digits = Vec::new();
    for row in 0..quotient_bits {
        if row > 0 {
            let subtracts = *digits.last().expect("the row before left a digit");
            let kept = builder.slice(remainder, remainder_bits - 2, 0);
            let doubled = builder.concat(&[kept, subtracts]);
            let complement = builder.sign_extend(subtracts, remainder_bits);
            let addend = builder.xor(divisor, complement);
            builder.name(addend, format!("addend_{row}"));
            remainder = builder.add(doubled, addend);
        }
        builder.name(remainder, format!("remainder_{row}"));
        let negative = builder.bit(remainder, remainder_bits - 1);
        let digit = builder.not(negative);
        digits.push(builder.name(digit, format!("quotient_bit_{row}")));
    }
    Recurrence {
        digits,
        remainder,
        divisor,
    }
}

/// Does the division leave a remainder? A negative last remainder is restored first.
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
