//! Vectors of single operators.

use rtl_model::float::FloatFormat;

use super::field::{Field, FieldFormat, Role};
use super::fixed;
use super::set::VectorSet;
use crate::operators::{AnyOperator, FloatOperator, OperatorConfiguration};
use crate::verify::OperandSets;

/// From this number on every operand set is a random one: the hard ones before are far fewer.
const FIRST_RANDOM_SET: u64 = 1 << 32;

/// Vectors of an operator: every operand where it has at most 8 bits of them; else a small set of
/// special operands, each with each, and then `random` seeded ones, of which every other is hard
/// on purpose (see [`OperandSets`]).
///
/// Fields are named as the ports of the operator's module; expected values are the golden
/// arithmetic's.
///
/// # Panics
/// Where [`AnyOperator::check`] fails.
pub fn operator_vectors(choice: impl Into<AnyOperator>, random: u64, seed: u64) -> VectorSet {
    let choice: AnyOperator = choice.into();
    let mut set = VectorSet::new(match choice {
        AnyOperator::Float(choice) => fields(choice),
        AnyOperator::Fixed(choice) => fixed::fields(choice),
    });
    let widths = choice.operand_widths();
    let mut push = |operands: &[u64]| {
        let mut vector = operands.to_vec();
        choice.golden_results(operands, &mut vector);
        set.push(vector);
    };
    if let [bits @ ..=8] = widths[..] {
        for operand in 0..1 << bits {
            push(&[operand]);
        }
        return set;
    }
    let specials: Vec<Vec<u64>> = match choice {
        AnyOperator::Float(choice) => match choice.operator {
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => vec![
                special_integers(value_bits),
                special_integers(exponent_bits),
            ],
            FloatOperator::FromSigned { bits }
            | FloatOperator::FromUnsigned { bits }
            | FloatOperator::DepthFromHeight { bits } => vec![special_integers(bits)],
            _ => vec![special_floats(choice.format); widths.len()],
        },
        AnyOperator::Fixed(choice) => fixed::specials(choice),
    };
    match &specials[..] {
        [all] => all.iter().for_each(|&a| push(&[a])),
        [first, second] => {
            for &a in first {
                second.iter().for_each(|&b| push(&[a, b]));
            }
        }
        _ => unreachable!("operators have one or two operands"),
    }
    let sets = OperandSets::of_operator(choice, random, seed);
    let mut operands = Vec::new();
    for k in 0..random {
        sets.set(FIRST_RANDOM_SET + k, &mut operands);
        push(&operands);
    }
    set
}

/// The fields of an operator: its ports, as its module declares them.
fn fields(choice: OperatorConfiguration) -> Vec<Field> {
    let OperatorConfiguration {
        operator: kind,
        format,
        ..
    } = choice;
    let module = choice.build(0);
    let input = |&wire: &_| {
        let node = module.node(wire);
        let name = node.name.as_deref().expect("an input has a name");
        let (format, meaning) = match (kind, name) {
            (FloatOperator::FromInteger { .. }, "a_i") => {
                (FieldFormat::Signed, "the integer to be scaled")
            }
            (FloatOperator::FromInteger { .. }, _) => {
                (FieldFormat::Signed, "the power of two it is scaled by")
            }
            (FloatOperator::FromSigned { .. }, _) => (FieldFormat::Signed, "the integer"),
            (FloatOperator::FromUnsigned { .. }, _) => (FieldFormat::Unsigned, "the integer"),
            (FloatOperator::DepthFromHeight { .. }, _) => {
                (FieldFormat::Unsigned, "height: all ones is the top plane")
            }
            (_, "b_i") => (FieldFormat::Float(format), "second operand"),
            (FloatOperator::UlpsUp { .. }, _) => {
                (FieldFormat::Float(format), "operand; its sign is not read")
            }
            (_, _) => (FieldFormat::Float(format), "operand"),
        };
        Field::new(name, Role::Input, node.width, format, meaning)
    };
    let output = |(name, wire): &(String, _)| {
        let node = module.node(*wire);
        let meaning = match (kind, name.as_str()) {
            (_, "flags_o") => "exceptions: invalid, division by zero, overflow, underflow, inexact",
            (_, "less_than_o") => "a_i < b_i",
            (_, "less_equal_o") => "a_i <= b_i",
            (_, "equal_o") => "a_i = b_i; zeros of both signs are equal",
            (_, "unordered_o") => "a_i or b_i is NaN",
            (FloatOperator::Add, _) => "a_i + b_i",
            (FloatOperator::Subtract, _) => "a_i - b_i",
            (FloatOperator::Multiply, _) => "a_i * b_i",
            (FloatOperator::Divide, _) => "a_i / b_i",
            (FloatOperator::LessThan, _) => "a_i < b_i; 0 where either is NaN",
            (FloatOperator::LessEqual, _) => "a_i <= b_i; 0 where either is NaN",
            (FloatOperator::FromInteger { .. }, _) => "a_i * 2^b_i",
            (FloatOperator::FromSigned { .. }, _) => "a_i as a float",
            (FloatOperator::FromUnsigned { .. }, _) => "a_i as a float",
            (FloatOperator::SquareRoot, _) => "the square root of a_i",
            (FloatOperator::Minimum, _) => "the smaller of a_i and b_i; the number beside a NaN",
            (FloatOperator::Maximum, _) => "the larger of a_i and b_i; the number beside a NaN",
            (FloatOperator::Convert { .. }, _) => "a_i in the other format",
            (FloatOperator::RoundToIntegral, _) => "the integer that a_i rounds to",
            (FloatOperator::ToInteger { .. } | FloatOperator::ToUnsigned { .. }, _) => {
                "a_i as an integer, saturated; 0 for NaN"
            }
            (FloatOperator::Floor, _) => "the largest integer not above a_i",
            (FloatOperator::UlpsUp { .. }, _) => {
                "a_i moved up by that many units in the last place"
            }
            (FloatOperator::ExactBelow, _) => "differences with a_i are exact below this",
            (FloatOperator::DepthFromHeight { .. }, _) => "1 - height, rounded toward zero",
            (FloatOperator::Compare | FloatOperator::CompareSignalling, _) => {
                "a relation of a_i and b_i"
            }
        };
        let format = FieldFormat::of_port(node.meaning, node.width);
        Field::new(name, Role::Output, node.width, format, meaning)
    };
    let inputs = module.inputs.iter().map(input);
    inputs.chain(module.outputs.iter().map(output)).collect()
}

/// Patterns at which float operators change their ways, of either sign.
pub(super) fn special_floats(format: FloatFormat) -> Vec<u64> {
    let magnitudes = [
        0,
        format.min_normal() - 1,
        format.min_normal(),
        format.one() - 1,
        format.one(),
        format.one() + 1,
        format.max_finite(),
        format.infinity(),
    ];
    let mut all: Vec<u64> = magnitudes
        .into_iter()
        .flat_map(|magnitude| [magnitude, magnitude | format.sign_bit()])
        .collect();
    // The canonical NaN, and the one that differs from it in every other bit that may differ.
    let other_nan = format.value_mask() ^ (1 << (format.fraction_bits - 1));
    all.extend([format.quiet_nan(), other_nan]);
    all
}

/// Integers at which conversions change their ways.
pub(super) fn special_integers(width: u32) -> Vec<u64> {
    let full = u64::MAX >> (64 - width);
    let half = 1 << (width - 1);
    let mut all = vec![0, 1, 2, 3, half - 1, half, half + 1, full - 1, full];
    all.sort_unstable();
    all.dedup();
    all
}
