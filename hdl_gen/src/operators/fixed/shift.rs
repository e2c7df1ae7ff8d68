//! Shifts by an amount that is an operand: rows of selectors by 1, 2, 4, ...

use super::align::extended;
use super::round::{Beyond, Exact, round};
use super::{Answer, FixedConfiguration, FixedOperator, operand};
use crate::netlist::{Builder, Wire};
use rtl_model::fixed::FixedFormat;

/// Bits of the word that a shift moves.
pub(super) fn widest_word(configuration: FixedConfiguration) -> u32 {
    let FixedConfiguration { a, result, .. } = configuration;
    match configuration.operator {
        FixedOperator::ShiftLeft { .. } => {
            // Wide enough that what leaves it on the left is beyond the result's range, and not by a
            // fraction that the rounding may take away: of a two's complement word the most negative
            // number must not be the result's.
            let integer_bits = result.integer_bits + u32::from(a.signed);
            a.integer_bits.max(integer_bits) + a.fraction_bits
        }
        // One place more than the result keeps, as the rounder's guard bit.
        _ => a.integer_bits + a.fraction_bits.max(result.fraction_bits + 1),
    }
}

/// The operands' ports, and their use under names.
fn operands(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    amount_bits: u32,
) -> (Wire, Wire) {
    builder.localparam(
        "SHIFTED_BITS",
        widest_word(configuration).into(),
        match configuration.operator {
            FixedOperator::ShiftLeft { .. } => {
                "the operand and the result's integer bits: what leaves at the top overflows"
            }
            _ => "the operand and the result's fraction bits with a guard bit",
        },
    );
    let a_i = operand(builder, "a_i", configuration.a);
    let b_i = operand(builder, "b_i", FixedFormat::uq(amount_bits, 0));
    (a_i, b_i)
}

/// `a * 2^b`.
pub(super) fn shift_left(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    amount_bits: u32,
) -> Answer {
    let (a_i, b_i) = operands(builder, configuration, amount_bits);
    let a = configuration.a;
    let width = widest_word(configuration);
    builder.section("shift left: what leaves must not differ from the sign");
    let mut word = extended(builder, a_i, a, a.fraction_bits, width);
    builder.name(word, "unshifted");
    let sign = a.signed.then(|| builder.bit(a_i, a.width() - 1));
    let mut causes = Vec::new();
    for row in 0..amount_bits {
        let step = (1 << row).min(width);
        let select = builder.bit(b_i, row);
        let mut leaving = builder.slice(word, width - 1, width - step);
        if let Some(sign) = sign {
            let signs = builder.sign_extend(sign, step);
            leaving = builder.xor(leaving, signs);
        }
        let differs = builder.any_bit(leaving);
        let lost = builder.and(select, differs);
        causes.push(builder.name(lost, format!("lost_by_{}", 1_u32 << row)));
        let zeros = builder.constant(0, step);
        let moved = if step < width {
            let kept = builder.slice(word, width - 1 - step, 0);
            builder.concat(&[kept, zeros])
        } else {
            zeros
        };
        word = builder.mux(select, moved, word);
        builder.name(word, format!("shifted_by_{}", 1_u32 << row));
    }
    if let Some(sign) = sign {
        let top = builder.bit(word, width - 1);
        let differs = builder.xor(top, sign);
        causes.push(builder.name(differs, "sign_lost"));
    }
    let causes = builder.concat(&causes);
    let is_beyond = builder.any_bit(causes);
    builder.name(is_beyond, "shifted_beyond");
    round(
        builder,
        configuration,
        &Exact {
            beyond: Some(Beyond {
                is_beyond,
                negative: sign,
            }),
            ..Exact::new(word, a.signed, a.fraction_bits)
        },
    )
}

/// `a / 2^b`.
pub(super) fn shift_right(
    builder: &mut Builder,
    configuration: FixedConfiguration,
    amount_bits: u32,
) -> Answer {
    let (a_i, b_i) = operands(builder, configuration, amount_bits);
    let a = configuration.a;
    let width = widest_word(configuration);
    let fraction_bits = width - a.integer_bits;
    builder.section("shift right: what leaves is behind the last place");
    let mut word = extended(builder, a_i, a, fraction_bits, width);
    builder.name(word, "unshifted");
    // Bits at the end that are zero whatever the operand.
    let padding = width - a.width();
    let mut losses = Vec::new();
    for row in 0..amount_bits {
        let before = (1 << row) - 1; // the farthest that the rows so far have moved the word
        let step = (1 << row).min(width);
        let select = builder.bit(b_i, row);
        let lost_from = padding.saturating_sub(before);
        if lost_from < step {
            let leaving = builder.slice(word, step - 1, lost_from);
            let any = builder.any_bit(leaving);
            let lost = builder.and(select, any);
            losses.push(builder.name(lost, format!("lost_by_{}", 1_u32 << row)));
        }
        let fill = if a.signed {
            let sign = builder.bit(word, width - 1);
            builder.sign_extend(sign, step)
        } else {
            builder.constant(0, step)
        };
        let moved = if step < width {
            let kept = builder.slice(word, width - 1, step);
            builder.concat(&[fill, kept])
        } else {
            fill
        };
        word = builder.mux(select, moved, word);
        builder.name(word, format!("shifted_by_{}", 1_u32 << row));
    }
    let sticky = (!losses.is_empty()).then(|| {
        let losses = builder.concat(&losses);
        let lost = builder.any_bit(losses);
        builder.name(lost, "shifted_out")
    });
    round(
        builder,
        configuration,
        &Exact {
            sticky,
            ..Exact::new(word, a.signed, fraction_bits)
        },
    )
}
