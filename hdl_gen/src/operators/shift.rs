//! The pieces between the exact result and the rounder: counting zeros, shifting with a sticky bit.

use crate::netlist::{Builder, Wire};

/// How many leading zeros a word has, and whether it has a one at all.
pub(super) struct LeadingZeros {
    /// The count, in `ceil(log2(width))` bits; without meaning for a word of zeros.
    pub count: Wire,
    /// Is any bit 1?
    pub any: Wire,
}

/// Counts leading zeros as a balanced tree: each node looks at two neighbouring runs of bits, and
/// its count is that of the upper run, or of the lower one with a 1 in front where the upper run
/// is all zeros. The depth is the logarithm of the width, and the high bits of the count, which a
/// shifter wants first, come out first.
///
/// The signals are `<name>_zeros_<high>_<low>` and `<name>_any_<high>_<low>` for bits high..low;
/// the root's count is `<name>_leading_zeros`. The word has at least 2 bits.
pub(super) fn leading_zeros(builder: &mut Builder, word: Wire, name: &str) -> LeadingZeros {
    let width = builder.width(word);
    assert!(width >= 2, "{name}: leading zeros of one bit");
    let (count, any) = count_run(builder, word, name, width - 1, 0, true);
    LeadingZeros {
        count: count.expect("a word of two bits or more has a count"),
        any,
    }
}

/// The count and the any-bit of bits high..low. A run of one bit has no count.
fn count_run(
    builder: &mut Builder,
    word: Wire,
    name: &str,
    high: u32,
    low: u32,
    is_root: bool,
) -> (Option<Wire>, Wire) {
    let width = high - low + 1;
    if width == 1 {
        return (None, builder.bit(word, low));
    }
    // The upper run is a power of two, so that its count has no gaps and a 1 in front adds it.
    let upper_width = width.next_power_of_two() / 2;
    let middle = high + 1 - upper_width;
    let (upper_count, upper_any) = count_run(builder, word, name, high, middle, false);
    let (lower_count, lower_any) = count_run(builder, word, name, middle - 1, low, false);
    let upper_is_zero = builder.not(upper_any);
    builder.name(upper_is_zero, format!("{name}_none_{high}_{middle}"));
    let count = match upper_count {
        None => upper_is_zero,
        Some(upper_count) => {
            let bits = builder.width(upper_count);
            let lower_count = match lower_count {
                Some(lower_count) => builder.zero_extend(lower_count, bits),
                None => builder.constant(0, bits),
            };
            let rest = builder.mux(upper_any, upper_count, lower_count);
            builder.name(rest, format!("{name}_rest_{high}_{low}"));
            builder.concat(&[upper_is_zero, rest])
        }
    };
    let any = builder.or(upper_any, lower_any);
    if is_root {
        builder.name(count, format!("{name}_leading_zeros"));
        builder.name(any, format!("{name}_nonzero"));
    } else {
        builder.name(count, format!("{name}_zeros_{high}_{low}"));
        builder.name(any, format!("{name}_any_{high}_{low}"));
    }
    (Some(count), any)
}

/// A word moved right, and what was lost on the way.
pub(super) struct Shifted {
    /// The word, as wide as before.
    pub word: Wire,
    /// Was any bit that left it a 1?
    pub lost: Wire,
    /// Is the amount beyond the reach of the rows, so that `word` and `lost` say nothing and the
    /// whole word is gone? None where the amount has no such bits.
    pub out_of_reach: Option<Wire>,
}

/// Rows of a shifter up to the one that, with all before it, can move the whole word out.
pub(super) fn rows(width: u32) -> u32 {
    u32::BITS - (width - 1).leading_zeros()
}

/// Rows that look at the bits they lose. What all later ones lose is found beside them, by fours.
const FINE_ROWS: u32 = 2;

/// Shifts right by `amount`, zeros coming in at the top, in rows of selectors by 1, 2, 4, ...: the
/// low bits of the amount, which are known first, are used first. The first rows look only at the
/// bits they lose; the others lose whole groups of four bits, so that whether one was set is known no
/// later than the word. The lowest `padding` bits of the word are known to be zeros.
pub(super) fn shift_right(
    builder: &mut Builder,
    word: Wire,
    amount: Wire,
    padding: u32,
    name: &str,
) -> Shifted {
    let (width, amount_bits) = (builder.width(word), builder.width(amount));
    let rows = amount_bits.min(rows(width));
    let mut moved = word;
    let mut losses = Vec::new();
    for row in 0..rows {
        if row == FINE_ROWS {
            losses.push(lost_by_fours(builder, moved, amount, rows, name));
        }
        let step = 1 << row;
        let select = builder.bit(amount, row);
        let before = step - 1; // the farthest the rows so far have moved the word
        let lost_from = padding.saturating_sub(before);
        if row < FINE_ROWS && lost_from < step {
            let leaving = builder.slice(moved, step.min(width) - 1, lost_from);
            let any = builder.any_bit(leaving);
            builder.name(any, format!("{name}_leaving_by_{step}"));
            let lost = builder.and(select, any);
            losses.push(builder.name(lost, format!("{name}_lost_by_{step}")));
        }
        let zeros = builder.constant(0, step.min(width));
        let shifted = if step < width {
            let kept = builder.slice(moved, width - 1, step);
            builder.concat(&[zeros, kept])
        } else {
            zeros
        };
        moved = builder.mux(select, shifted, moved);
        builder.name(moved, format!("{name}_after_{step}"));
    }
    let lost = if losses.is_empty() {
        builder.constant(0, 1)
    } else {
        let losses = builder.concat(&losses);
        let lost = builder.any_bit(losses);
        builder.name(lost, format!("{name}_lost"))
    };
    let out_of_reach = (rows < amount_bits).then(|| {
        let high = builder.slice(amount, amount_bits - 1, rows);
        let out_of_reach = builder.any_bit(high);
        builder.name(out_of_reach, format!("{name}_out_of_reach"))
    });
    Shifted {
        word: moved,
        lost,
        out_of_reach,
    }
}

/// Do the rows from [`FINE_ROWS`] on lose a one? They move the word by fours: lost is the group of four
/// below the amount's upper bits, and all before it.
fn lost_by_fours(builder: &mut Builder, word: Wire, amount: Wire, rows: u32, name: &str) -> Wire {
    let width = builder.width(word);
    let groups: Vec<Wire> = (0..width)
        .step_by(4)
        .map(|low| {
            let group = builder.slice(word, (low + 3).min(width - 1), low);
            let any = builder.any_bit(group);
            builder.name(any, format!("{name}_any_from_{low}"))
        })
        .collect();
    // Entry k: is a one in the lowest k groups?
    let mut lost: Vec<Wire> = (0..1 << (rows - FINE_ROWS))
        .map(|count: usize| {
            let below: Vec<Wire> = groups.iter().take(count).rev().copied().collect();
            if below.is_empty() {
                builder.constant(0, 1)
            } else {
                let below = builder.concat(&below);
                builder.any_bit(below)
            }
        })
        .collect();
    for row in FINE_ROWS..rows {
        let select = builder.bit(amount, row);
        lost = lost
            .chunks(2)
            .map(|pair| builder.mux(select, pair[1], pair[0]))
            .collect();
    }
    builder.name(lost[0], format!("{name}_lost_by_fours"))
}
