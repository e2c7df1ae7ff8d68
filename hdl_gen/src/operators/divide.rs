//! Division.

use rtl_model::float::{Policy, Rounding};

use super::configuration::{OperatorConfiguration, Radix};
use super::round::{Answer, Small, Tail, Unrounded, exponent_constant, exponent_width, round};
use super::unpack::{Class, classify, fields, is_signalling, normalise};
use crate::netlist::{Builder, Wire};

/// `a / b`: non-restoring digit recurrence, one or two bits of the quotient a row.
pub(super) fn divide(builder: &mut Builder, configuration: OperatorConfiguration) -> Answer {
    let OperatorConfiguration {
        format,
        rounding,
        policy,
        has_flags,
        structure,
        ..
    } = configuration;
    let fraction_bits = format.fraction_bits;
    let bias = i64::from(format.exponent_bias());
    let largest = i64::try_from(format.exponent_all_ones() - 1).expect("11 bits at most");
    let smallest = match policy {
        Policy::Flush => 1,
        Policy::Full => 1 - i64::from(fraction_bits),
    };
    let exponent_range = smallest - largest + bias - 1..=largest - smallest + bias;
    let exponent_word_bits = exponent_width(format, &exponent_range);
    builder.localparam(
        "EXPONENT_BITS",
        exponent_word_bits.into(),
        "a two's complement exponent from smallest by largest to largest by smallest",
    );

    let a_i = builder.input("a_i", format.width());
    let b_i = builder.input("b_i", format.width());

    builder.section("unpack");
    let a = fields(builder, format, a_i, "a");
    let b = fields(builder, format, b_i, "b");

    builder.section("special cases");
    let a_is = classify(builder, policy, &a, "a");
    let b_is = classify(builder, policy, &b, "b");
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
    let is_invalid = has_flags.then(|| {
        let a_is_signalling = is_signalling(builder, &a, a_is.is_nan, "a");
        let b_is_signalling = is_signalling(builder, &b, b_is.is_nan, "b");
        let any_is_signalling = builder.or(a_is_signalling, b_is_signalling);
        builder.or(undefined, any_is_signalling)
    });
    let divides_by_zero = has_flags.then(|| {
        let a_is_other = builder.concat(&[a_is.is_zero, a_is.is_infinity, a_is.is_nan]);
        let a_is_other = builder.any_bit(a_is_other);
        let a_is_ordinary = builder.not(a_is_other);
        builder.and(a_is_ordinary, b_is.is_zero)
    });

    let (a, b) = match policy {
        Policy::Flush => {
            let a_wide = builder.zero_extend(a.exponent, exponent_word_bits);
            let b_wide = builder.zero_extend(b.exponent, exponent_word_bits);
            ((a_wide, a.fraction), (b_wide, b.fraction))
        }
        Policy::Full => {
            builder.section("normalise subnormal operands");
            let mut normalised = |operand, class: &Class, name| {
                let exponent_nonzero = class.exponent_nonzero;
                let normalised =
                    normalise(builder, operand, exponent_nonzero, exponent_word_bits, name);
                (normalised.exponent, normalised.fraction)
            };
            (normalised(&a, &a_is, "a"), normalised(&b, &b_is, "b"))
        }
    };
    let (a_exponent, a_fraction) = a;
    let (b_exponent, b_fraction) = b;

    builder.section("compare the significands: a quotient below one begins one place later");
    let one = builder.constant(1, 1);
    let zero = builder.constant(0, 1);
    let dividend_at_one = builder.concat(&[zero, a_fraction]);
    let divisor_at_one = builder.concat(&[zero, b_fraction]);
    let remainder_at_one = builder.subtract(dividend_at_one, divisor_at_one);
    builder.name(remainder_at_one, "remainder_at_one");
    let below_one = builder.bit(remainder_at_one, fraction_bits);
    builder.name(below_one, "quotient_below_one");
    let dividend_below_one = builder.concat(&[a_fraction, zero]);
    let divisor = builder.concat(&[one, b_fraction]);
    builder.name(divisor, "divisor");
    let remainder_below_one = builder.subtract(dividend_below_one, divisor);
    builder.name(remainder_below_one, "remainder_below_one");
    let first_remainder = builder.mux(below_one, remainder_below_one, remainder_at_one);
    builder.name(first_remainder, "first_remainder");

    builder.section("subtract the exponents");
    let exponent = builder.subtract(a_exponent, b_exponent);
    builder.name(exponent, "exponent_difference");
    let adjustment_at_one = exponent_constant(builder, bias, exponent_word_bits);
    let adjustment_below_one = exponent_constant(builder, bias - 1, exponent_word_bits);
    let adjustment = builder.mux(below_one, adjustment_below_one, adjustment_at_one);
    builder.name(adjustment, "exponent_adjustment");

    // A quotient of two significands is never a tie: with one bit more than they have, and that bit
    // a one, it times the divisor's odd part would be longer than the dividend is. So to round to
    // nearest is to add half a unit and truncate. Half a unit of the quotient is half the divisor
    // behind the dividend, and its bits come in one a row, for nothing: no guard bit, no remainder,
    // no addition at the end. It cannot carry out of the significand either, since a quotient below
    // two is below it by more than a unit or ends in it. That does not tell what is inexact, nor
    // round in a place further up, as a subnormal result wants it.
    let truncates = rounding == Rounding::TowardZero && !has_flags;
    let to_nearest = rounding == Rounding::NearestEven;
    let adds_half = to_nearest && !has_flags && policy == Policy::Flush;
    let has_guard = to_nearest && !adds_half;
    let recurrence = divide_significands(
        builder,
        structure.radix,
        first_remainder,
        divisor,
        adds_half,
        fraction_bits + u32::from(has_guard),
    );

    let fraction = builder.concat(&recurrence.digits[..fraction_bits as usize]);
    builder.name(fraction, "quotient_fraction");
    let tail = (!truncates && !adds_half).then(|| {
        let inexact = remainder_nonzero(builder, &recurrence);
        // Away from a tie, and where only inexact or not is asked, one bit is all.
        match recurrence.digits.get(fraction_bits as usize) {
            Some(&guard) => Tail {
                guard,
                sticky: Some(inexact),
            },
            None => Tail {
                guard: inexact,
                sticky: None,
            },
        }
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
            is_invalid,
            divides_by_zero,
            small: Small::Normalised,
            early_bounds: None,
        },
    )
}

/// The state of the recurrence between two rows.
struct Recurrence {
    /// The quotient's bits behind the point, the first first.
    digits: Vec<Wire>,
    /// The partial remainder, in two's complement.
    remainder: Wire,
    /// Is it not negative? None where that is always so.
    nonnegative: Option<Wire>,
    /// The divisor's significand in as many bits.
    divisor: Wire,
}

/// The rows. A row's remainder is what a restoring divider would get by its trial subtraction: a
/// negative one is not restored, the next row adds the divisor where it would have subtracted it
/// (`2 (r + d) - d = 2 r + d`). So a quotient bit is 1 where the remainder is not negative.
///
/// A row of radix 4 has both outcomes of a second such step ready when the first one's sign is
/// known: `4 r -+ d` and `4 r -+ 3 d`, three carry chains side by side in the time of one.
fn divide_significands(
    builder: &mut Builder,
    radix: Radix,
    first_remainder: Wire,
    divisor: Wire,
    half_a_unit: bool,
    digits: u32,
) -> Recurrence {
    builder.section("divide the significands");
    let significand_bits = builder.width(divisor);
    let remainder_bits = significand_bits + 1;
    builder.localparam(
        "REMAINDER_BITS",
        remainder_bits.into(),
        "a partial remainder lies between minus and plus the divisor's significand",
    );
    let mut state = Recurrence {
        digits: Vec::new(),
        remainder: builder.zero_extend(first_remainder, remainder_bits),
        nonnegative: None,
        divisor: builder.zero_extend(divisor, remainder_bits),
    };
    let singles = rows_of_one_bit(radix, digits);
    let triple = (singles < digits).then(|| {
        let zero = builder.constant(0, 1);
        let doubled = builder.concat(&[divisor, zero]);
        let triple = builder.add(doubled, state.divisor);
        builder.name(triple, "divisor_tripled")
    });
    let mut incoming: Vec<Option<Wire>> = (1..=digits)
        .rev()
        .map(|row| half_a_unit.then(|| builder.bit(divisor, significand_bits - row)))
        .collect();
    // The rows of one bit stand before the last of two: the first of two needs no selection of what
    // it adds and the last none of a remainder, so these cost little more than two of one bit.
    let last_pair = if triple.is_some() { 2 } else { 0 };
    while let Some(first) = incoming.pop() {
        let left = u32::try_from(incoming.len()).expect("as many as digits") + 1;
        let is_single = (last_pair + 1..=last_pair + singles).contains(&left);
        match (triple, incoming.last().copied()) {
            (Some(triple), Some(second)) if !is_single => {
                incoming.pop();
                state.row_of_radix_4(builder, triple, [first, second]);
            }
            _ => state.row_of_radix_2(builder, first),
        }
    }
    state
}

/// How many bits of a quotient come one a row.
fn rows_of_one_bit(radix: Radix, digits: u32) -> u32 {
    let wanted = match radix {
        Radix::Two => return digits,
        Radix::Four => 0,
        Radix::Mixed => digits / 4,
    };
    wanted + (digits - wanted) % 2
}

impl Recurrence {
    /// One bit of the quotient.
    fn row_of_radix_2(&mut self, builder: &mut Builder, incoming: Option<Wire>) {
        let name = format!("remainder_{}", self.digits.len() + 1);
        let remainder = self.step(builder, self.divisor, &[incoming], false, &name);
        self.advance(builder, remainder);
    }

    /// Two bits of the quotient.
    fn row_of_radix_4(&mut self, builder: &mut Builder, triple: Wire, incoming: [Option<Wire>; 2]) {
        let row = self.digits.len() + 1;
        let name = format!("halfway_{row}");
        let middle = self.step(builder, self.divisor, &incoming[..1], true, &name);
        let same_again = builder.bit(middle, builder.width(middle) - 1);
        builder.name(same_again, format!("same_again_{row}"));
        let digit = match self.nonnegative {
            None => same_again,
            Some(nonnegative) => {
                let differs = builder.xor(same_again, nonnegative);
                builder.not(differs)
            }
        };
        self.digits
            .push(builder.name(digit, format!("quotient_bit_{row}")));
        let name = format!("by_three_{row}");
        let by_three = self.step(builder, triple, &incoming, false, &name);
        let name = format!("by_one_{row}");
        let by_one = self.step(builder, self.divisor, &incoming, false, &name);
        let remainder = builder.mux(same_again, by_three, by_one);
        self.advance(builder, remainder);
    }

    /// Takes a row's remainder, and its sign as a quotient bit.
    fn advance(&mut self, builder: &mut Builder, remainder: Wire) {
        let row = self.digits.len() + 1;
        self.remainder = builder.name(remainder, format!("remainder_{row}"));
        let negative = builder.bit(remainder, builder.width(remainder) - 1);
        let digit = builder.not(negative);
        builder.name(digit, format!("quotient_bit_{row}"));
        self.nonnegative = Some(digit);
        self.digits.push(digit);
    }

    /// The remainder moved up by as many places as bits come in, minus `multiple` where it is not
    /// negative, plus `multiple` where it is. With `relative_sign` the top bit is instead: has the
    /// result the sign of the remainder?
    ///
    /// The last place is done by hand, so that its carry leaves the chain's place for the one that
    /// a subtraction needs. With i coming in, m the multiple's last bit, it holds `i ^ m` either
    /// way; what it carries is i where m is 1, else the one of a subtraction.
    fn step(
        &self,
        builder: &mut Builder,
        multiple: Wire,
        incoming: &[Option<Wire>],
        relative_sign: bool,
        name: &str,
    ) -> Wire {
        let bits = builder.width(self.remainder);
        let places = u32::try_from(incoming.len()).expect("two at most");
        let zero = builder.constant(0, 1);
        let mut moved = vec![builder.slice(self.remainder, bits - 1 - places, 0)];
        moved.extend(incoming.iter().map(|bit| bit.unwrap_or(zero)));
        let Some(subtracts) = self.nonnegative else {
            let moved = builder.concat(&moved);
            let difference = builder.subtract(moved, multiple);
            if !relative_sign {
                return builder.name(difference, name);
            }
            let top = builder.bit(difference, bits - 1);
            let top = builder.not(top);
            let rest = builder.slice(difference, bits - 2, 0);
            return builder.concat(&[top, rest]);
        };
        let last_in = incoming[incoming.len() - 1];
        moved.pop();
        let last_of_multiple = builder.bit(multiple, 0);
        let (last, carry) = match last_in {
            None => {
                let last_is_zero = builder.not(last_of_multiple);
                (last_of_multiple, builder.and(subtracts, last_is_zero))
            }
            Some(last_in) => (
                builder.xor(last_in, last_of_multiple),
                builder.mux(last_of_multiple, last_in, subtracts),
            ),
        };
        builder.name(carry, format!("{name}_carry"));
        builder.name(last, format!("{name}_last"));
        let top = bits - 1 - u32::from(relative_sign);
        let upper = builder.slice(multiple, top, 1);
        let complement = builder.sign_extend(subtracts, top);
        let upper = builder.xor(upper, complement);
        builder.name(upper, format!("{name}_addend"));
        let mut addend = vec![upper, carry];
        if relative_sign {
            addend.insert(0, zero);
        }
        moved.push(carry);
        let moved = builder.concat(&moved);
        let addend = builder.concat(&addend);
        let sum = builder.add(moved, addend);
        builder.name(sum, format!("{name}_sum"));
        let upper = builder.slice(sum, bits - 1, 1);
        let result = builder.concat(&[upper, last]);
        builder.name(result, name)
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
