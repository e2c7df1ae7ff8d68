//! Fields and special operands of fixed-point operators.

use rtl_model::fixed::FixedFormat;

use super::field::{Field, FieldFormat, Role};
use super::operators::special_floats;
use crate::netlist::Meaning;
use crate::operators::{FixedConfiguration, FixedOperator};

/// The fields of an operator: its ports, as its module declares them.
pub(super) fn fields(choice: FixedConfiguration) -> Vec<Field> {
    let module = choice.build(0);
    let is_shift = matches!(
        choice.operator,
        FixedOperator::ShiftLeft { .. } | FixedOperator::ShiftRight { .. }
    );
    let input = |&wire: &_| {
        let node = module.node(wire);
        let name = node.name.as_deref().expect("an input has a name");
        let meaning = match name {
            "b_i" if is_shift => "places to shift by",
            "b_i" => "second operand",
            _ => "operand",
        };
        let format = FieldFormat::of_port(node.meaning, node.width);
        Field::new(name, Role::Input, node.width, format, meaning)
    };
    let output = |(name, wire): &(String, _)| {
        let node = module.node(*wire);
        let meaning = match (name.as_str(), choice.operator) {
            ("less_than_o", _) => "a_i < b_i",
            ("less_equal_o", _) => "a_i <= b_i",
            ("equal_o", _) => "a_i = b_i",
            ("flags_o", _) => "invalid, divide by zero, overflow, underflow, inexact",
            (_, FixedOperator::Add) => "a_i + b_i",
            (_, FixedOperator::Subtract) => "a_i - b_i",
            (_, FixedOperator::Multiply) => "a_i * b_i",
            (_, FixedOperator::Divide) => "a_i / b_i",
            (_, FixedOperator::Reciprocal) => "1 / a_i",
            (_, FixedOperator::Negate) => "-a_i",
            (_, FixedOperator::ShiftLeft { .. }) => "a_i * 2^b_i",
            (_, FixedOperator::ShiftRight { .. }) => "a_i / 2^b_i",
            (_, FixedOperator::FromFloat { .. }) => "a_i in fixed point; 0 for NaN",
            (_, FixedOperator::ToFloat { .. }) => "a_i as a float",
            (_, FixedOperator::Convert | FixedOperator::Compare) => "a_i in this format",
        };
        let format = FieldFormat::of_port(node.meaning, node.width);
        Field::new(name, Role::Output, node.width, format, meaning)
    };
    let inputs = module.inputs.iter().map(input);
    inputs.chain(module.outputs.iter().map(output)).collect()
}

/// Words at which an operator changes its ways, of each operand.
pub(super) fn specials(choice: FixedConfiguration) -> Vec<Vec<u64>> {
    let operands = choice.operands().into_iter();
    let special = operands.map(|operand| match operand {
        Meaning::Float(format) => special_floats(format),
        Meaning::Fixed(format) => special_words(format),
        Meaning::Bits | Meaning::Signed => unreachable!("operands are numbers"),
    });
    special.collect()
}

/// Zero, one unit on either side, one, the ends of the range and the words beside them.
fn special_words(format: FixedFormat) -> Vec<u64> {
    let mask = format.value_mask();
    let one = 1_u64.checked_shl(format.fraction_bits).unwrap_or(0);
    let (least, most) = (format.min(), format.max());
    let mut words: Vec<u64> = [0, 1, one, least, most]
        .into_iter()
        .flat_map(|word| [word.wrapping_sub(1), word, word.wrapping_add(1)])
        .map(|word| word & mask)
        .collect();
    words.sort_unstable();
    words.dedup();
    words
}
