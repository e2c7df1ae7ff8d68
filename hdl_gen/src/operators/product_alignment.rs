//! The product of significands with subnormal operands and results: one shifter behind it.

use rtl_model::float::{FloatFormat, Rounding};

use super::shift::{leading_zeros, rows};
use super::unpack::Fields;
use crate::netlist::{Builder, Wire};

/// A product as it is encoded: where the exponent is 0, without a one before the point.
pub(super) struct AlignedProduct {
    /// The exponent but for the increment: 0 or more.
    pub exponent: Wire,
    /// Does the product reach the upper of the two places it can begin at, and so the next exponent?
    pub increment: Wire,
    /// The fraction.
    pub fraction: Wire,
    /// The bit after it.
    pub guard: Wire,
    /// Whether anything is after that, in several bits.
    pub sticky: Wire,
    /// Is the result below the smallest normal number, also when rounded with no lower end to the
    /// exponent?
    pub is_tiny: Wire,
}

/// What the shifter is to do, known while the significands are multiplied.
pub(super) struct Alignment {
    /// The exponent but for the increment: 0 or more.
    exponent: Wire,
    /// Is it 0?
    exponent_is_zero: Wire,
    /// Places to the right, counted from the farthest left.
    right: Wire,
}

/// Where the product must go: to the left by the leading zeros of the subnormal operand, as far as
/// the exponent allows, and to the right where the exponent is below 0. Of two subnormal operands
/// the product is below the normal numbers whatever their zeros.
///
/// `sum` is the biased sum of the operands' effective exponents, in two's complement; the bits say
/// which exponent fields are not 0.
pub(super) fn alignment(
    builder: &mut Builder,
    format: FloatFormat,
    [a, b]: [&Fields; 2],
    [a_nonzero, b_nonzero]: [Wire; 2],
    sum: Wire,
) -> Alignment {
    let fraction_bits = format.fraction_bits;
    let bits = builder.width(sum);
    let both_normal = builder.and(a_nonzero, b_nonzero);
    let subnormal_fraction = builder.mux(a_nonzero, b.fraction, a.fraction);
    let counted = builder.concat(&[both_normal, subnormal_fraction]);
    builder.name(counted, "subnormal_significand");
    let zeros = leading_zeros(builder, counted, "subnormal").count;
    // The count of a zero operand has no meaning; its product is 0 in any place.
    let wide = bits.max(builder.width(zeros) + 2);
    let sum = builder.sign_extend(sum, wide);
    let wide_zeros = builder.zero_extend(zeros, wide);
    let remaining = builder.subtract(sum, wide_zeros);
    builder.name(remaining, "exponent_after_zeros");
    let is_limited = builder.bit(remaining, wide - 1);
    builder.name(is_limited, "exponent_limits_shift");
    let none = builder.constant(0, wide);
    let exponent = builder.mux(is_limited, none, remaining);
    builder.name(exponent, "aligned_exponent");
    let any = builder.any_bit(remaining);
    let is_zero = builder.not(any);
    let exponent_is_zero = builder.or(is_limited, is_zero);
    builder.name(exponent_is_zero, "aligned_exponent_is_zero");
    // Both subtractions beside the comparison are faster than one behind it.
    let farthest = builder.constant(fraction_bits.into(), wide);
    let right_by_exponent = builder.subtract(farthest, sum);
    builder.name(right_by_exponent, "right_by_exponent");
    let right_by_zeros = builder.subtract(farthest, wide_zeros);
    builder.name(right_by_zeros, "right_by_zeros");
    let right = builder.mux(is_limited, right_by_exponent, right_by_zeros);
    builder.name(right, "right_shift");
    // The farthest that the rows can move takes everything out; beyond it is no farther.
    let amount_bits = rows(2 * fraction_bits + 3).min(wide - 1);
    let mut right = builder.slice(right, amount_bits - 1, 0);
    if amount_bits < wide - 1 {
        let beyond = builder.slice(right_by_exponent, wide - 2, amount_bits);
        let beyond = builder.any_bit(beyond);
        let is_gone = builder.and(beyond, is_limited);
        builder.name(is_gone, "product_is_gone");
        let farthest = builder.sign_extend(is_gone, amount_bits);
        right = builder.or(right, farthest);
        builder.name(right, "right_shift_bounded");
    }
    Alignment {
        exponent,
        exponent_is_zero,
        right,
    }
}

/// Moves the product there, and by one place more where it begins at the lower place and the
/// exponent allows.
pub(super) fn align(
    builder: &mut Builder,
    format: FloatFormat,
    rounding: Rounding,
    sign: Wire,
    product: Wire,
    alignment: &Alignment,
) -> AlignedProduct {
    let fraction_bits = format.fraction_bits;
    // The place above the point, the point's, the fraction and a guard bit; one more is `last`.
    let window_bits = fraction_bits + 2;
    let mut body = product;
    let mut last = builder.constant(0, 1);
    let mut lost = Vec::new();
    for row in (0..builder.width(alignment.right)).rev() {
        let step = 1 << row;
        let select = builder.bit(alignment.right, row);
        // What stands above is zero, or moves by this row.
        let width = builder.width(body);
        let kept = width.min(window_bits + step - 1);
        let mut leaving = vec![last];
        if step > 1 {
            leaving.push(builder.slice(body, (step - 2).min(width - 1), 0));
        }
        let leaving = builder.concat(&leaving);
        let leaving = builder.any_bit(leaving);
        let is_lost = builder.and(select, leaving);
        lost.push(builder.name(is_lost, format!("product_lost_by_{step}")));
        let next_last = if step <= width {
            builder.bit(body, step - 1)
        } else {
            builder.constant(0, 1)
        };
        last = builder.mux(select, next_last, last);
        builder.name(last, format!("product_last_after_{step}"));
        let moved = if step < width {
            let high = builder.slice(body, width - 1, step);
            builder.zero_extend(high, width)
        } else {
            builder.constant(0, width)
        };
        let moved = builder.slice(moved, kept - 1, 0);
        let stays = builder.slice(body, kept - 1, 0);
        body = builder.mux(select, moved, stays);
        builder.name(body, format!("product_after_{step}"));
    }
    let window = builder.concat(&[body, last]);
    builder.name(window, "aligned_product");

    let increment = builder.bit(window, window_bits);
    builder.name(increment, "product_at_upper_place");
    let at_lower = builder.not(increment);
    let has_exponent = builder.not(alignment.exponent_is_zero);
    let one_more = builder.and(at_lower, has_exponent);
    builder.name(one_more, "moves_one_more");
    let at_upper = builder.slice(window, window_bits - 1, 1);
    let below = builder.slice(window, window_bits - 2, 0);
    let placed = builder.mux(one_more, below, at_upper);
    builder.name(placed, "placed_product");
    let fraction = builder.slice(placed, fraction_bits, 1);
    builder.name(fraction, "product_fraction");
    let guard = builder.bit(placed, 0);
    builder.name(guard, "guard_bit");
    let last = builder.bit(window, 0);
    let stays = builder.not(one_more);
    let last_below = builder.and(last, stays);
    let lost = builder.concat(&lost);
    let lost = builder.any_bit(lost);
    builder.name(lost, "product_lost");
    let sticky = builder.concat(&[last_below, lost]);
    builder.name(sticky, "sticky_bits");

    // Just below the normal numbers, and rounded up to them with one bit more than a subnormal
    // number has there: all that bit and the fraction ones, and what follows away from zero.
    let is_subnormal = builder.and(alignment.exponent_is_zero, at_lower);
    builder.name(is_subnormal, "is_subnormal");
    let all_ones = builder.all_bits(placed);
    let rounds_up = match rounding {
        Rounding::TowardZero => None,
        Rounding::NearestEven => Some(last),
        Rounding::Up => {
            let positive = builder.not(sign);
            let inexact = builder.or(last, lost);
            Some(builder.and(positive, inexact))
        }
        Rounding::Down => {
            let inexact = builder.or(last, lost);
            Some(builder.and(sign, inexact))
        }
    };
    let is_tiny = match rounds_up {
        Some(rounds_up) => {
            let becomes_normal = builder.and(all_ones, rounds_up);
            builder.name(becomes_normal, "becomes_normal");
            let stays_tiny = builder.not(becomes_normal);
            builder.and(is_subnormal, stays_tiny)
        }
        None => is_subnormal,
    };
    builder.name(is_tiny, "is_tiny");
    AlignedProduct {
        exponent: alignment.exponent,
        increment,
        fraction,
        guard,
        sticky,
        is_tiny,
    }
}
