//! Moving a sum's leading one to the top, and what that does to the exponent.

use super::shift::leading_zeros;
use crate::netlist::{Builder, Wire};

/// A sum with its leading one at the top.
pub(super) struct NormalisedSum {
    /// Its upper bits, the leading one first.
    pub word: Wire,
    /// The exponent, but for the adjustment: see [`super::round::Unrounded`].
    pub exponent: Wire,
    /// One more, less the places moved.
    pub adjustment: Wire,
    /// Was there a one?
    pub any: Wire,
    /// The places it moved.
    pub places: Wire,
}

/// Leading zeros are first counted in fours, all at once, then by twos and ones while they are
/// shifted out: that takes a quarter of the logic of a full count.
///
/// A one at the top has the exponent `exponent` + 1. Of the normalised word the upper `kept` bits
/// are made.
pub(super) fn normalise_sum(
    builder: &mut Builder,
    sum: Wire,
    exponent: Wire,
    exponent_bits: u32,
    kept: u32,
) -> NormalisedSum {
    let width = builder.width(sum);
    let groups: Vec<Wire> = (0..width)
        .rev()
        .step_by(4)
        .map(|high| {
            let group = builder.slice(sum, high, high.saturating_sub(3));
            builder.any_bit(group)
        })
        .collect();
    let groups = builder.concat(&groups);
    builder.name(groups, "sum_any_of_four");
    let fours = leading_zeros(builder, groups, "sum_fours");
    let count_bits = builder.width(fours.count);
    let mut word = sum;
    for bit in (0..count_bits).rev() {
        let select = builder.bit(fours.count, bit);
        let step = 4 << bit;
        word = moved_up(builder, word, select, step, bit + 1 == count_bits, width);
        builder.name(word, format!("sum_after_{step}"));
    }
    let top_two = builder.slice(word, width - 1, width - 2);
    let any_of_two = builder.any_bit(top_two);
    let by_two = builder.not(any_of_two);
    builder.name(by_two, "sum_by_2");
    word = moved_up(builder, word, by_two, 2, false, kept + 1);
    builder.name(word, "sum_after_2");
    let top = builder.width(word) - 1;
    let reached = builder.bit(word, top);
    let by_one = builder.not(reached);
    builder.name(by_one, "sum_by_1");
    word = moved_up(builder, word, by_one, 1, false, kept);
    builder.name(word, "normalised_sum");

    // 1 - (4 fours + 2 by_two + by_one) = -4 (fours + by_two) + (2 by_two + 1 - by_one), and
    // -(fours + 1) is the complement: bits side by side, no addition.
    let negated = negated(builder, fours.count);
    let complement = builder.not(fours.count);
    let one = builder.constant(1, 1);
    let complement = builder.concat(&[one, complement]);
    let upper = builder.mux(by_two, complement, negated);
    builder.name(upper, "exponent_adjustment_fours");
    let adjustment = builder.concat(&[upper, by_two, reached]);
    let adjustment = if builder.width(adjustment) > exponent_bits {
        // The exponents of a small format may span fewer bits than the count's three parts do.
        builder.slice(adjustment, exponent_bits - 1, 0)
    } else {
        builder.sign_extend(adjustment, exponent_bits)
    };
    builder.name(adjustment, "exponent_adjustment");
    let places = builder.concat(&[fours.count, by_two, by_one]);
    builder.name(places, "places_moved");
    NormalisedSum {
        word,
        exponent: builder.zero_extend(exponent, exponent_bits),
        adjustment,
        any: fours.any,
        places,
    }
}

/// The upper `kept` bits of `word`, or of `word << step` where `select`. If it `is_first`, the upper
/// `step` bits are known to be zeros then.
fn moved_up(
    builder: &mut Builder,
    word: Wire,
    select: Wire,
    step: u32,
    is_first: bool,
    kept: u32,
) -> Wire {
    let width = builder.width(word);
    let lowest = width - kept.min(width);
    let high = builder.slice(word, width - 1, step.max(lowest));
    let low = builder.slice(word, width - 1 - step, lowest.saturating_sub(step));
    let mut parts = vec![builder.mux(select, low, high)];
    // What has moved leaves zeros behind, also where the first step reaches beyond itself.
    let left = if is_first {
        step.min(width - step)
    } else {
        step
    };
    if left.max(lowest) < step {
        parts.push(builder.slice(word, step - 1, left.max(lowest)));
    }
    if lowest < left {
        let remaining = builder.slice(word, left - 1, lowest);
        let zeros = builder.constant(0, left - lowest);
        parts.push(builder.mux(select, zeros, remaining));
    }
    builder.concat(&parts)
}

/// `-count`, one bit wider. By gates: a carry chain of so few bits takes longer.
fn negated(builder: &mut Builder, count: Wire) -> Wire {
    let width = builder.width(count);
    let mut bits = Vec::new();
    let mut any = builder.bit(count, 0);
    bits.push(any);
    for place in 1..width {
        let bit = builder.bit(count, place);
        bits.push(builder.xor(bit, any));
        any = builder.or(any, bit);
    }
    bits.push(any);
    bits.reverse();
    let negated = builder.concat(&bits);
    builder.name(negated, "sum_fours_negated")
}

/// Moves the leading one to the top, but not so far that the exponent falls below 1: a sum for
/// which that is not far enough stays with exponent 0 and is a subnormal number.
///
/// A one at the top has the exponent `exponent` + 1; `exponent` is at least 1.
pub(super) fn normalise_down_to(
    builder: &mut Builder,
    sum: Wire,
    exponent: Wire,
    exponent_bits: u32,
) -> NormalisedSum {
    let width = builder.width(sum);
    let any = builder.any_bit(sum);
    builder.name(any, "sum_nonzero");
    // A one in the place that exponent 1 has in the sum ends the count there.
    let top = builder.constant(1 << (width - 1), width);
    let last_place = builder.shift_right(top, exponent);
    builder.name(last_place, "place_of_exponent_1");
    let counted = builder.or(sum, last_place);
    builder.name(counted, "sum_or_last_place");
    let zeros = leading_zeros(builder, counted, "counted");
    let word = builder.shift_left(sum, zeros.count);
    builder.name(word, "normalised_sum");
    let wide_exponent = builder.zero_extend(exponent, exponent_bits);
    // The count is at most the exponent, whatever the bits that its width would allow.
    let count_bits = builder.width(zeros.count).min(exponent_bits);
    let count = builder.slice(zeros.count, count_bits - 1, 0);
    let wide_count = builder.zero_extend(count, exponent_bits);
    let remaining = builder.subtract(wide_exponent, wide_count);
    builder.name(remaining, "remaining_exponent");
    let reached = builder.bit(word, width - 1);
    builder.name(reached, "leading_one_at_top");
    let adjustment = builder.zero_extend(reached, exponent_bits);
    NormalisedSum {
        word,
        exponent: remaining,
        adjustment,
        any,
        places: zeros.count,
    }
}
