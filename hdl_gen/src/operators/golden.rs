//! What an operator must answer, by the golden arithmetic. For comparisons only: no operator is
//! built with it.

use super::{FloatOperator, OperatorConfiguration};
use rtl_model::float::{
    Answer, Comparison, Flags, FloatArithmetic, FloatFormat, IntegerFormat, Relation, Rounding,
};

impl FloatOperator {
    /// Widths of its operands, in the order of its input ports.
    pub fn operand_widths(self, format: FloatFormat) -> Vec<u32> {
        let width = format.width();
        match self {
            FloatOperator::Add
            | FloatOperator::Subtract
            | FloatOperator::Multiply
            | FloatOperator::Divide
            | FloatOperator::Minimum
            | FloatOperator::Maximum
            | FloatOperator::Compare
            | FloatOperator::CompareSignalling
            | FloatOperator::LessThan
            | FloatOperator::LessEqual => vec![width, width],
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => {
                vec![value_bits, exponent_bits]
            }
            FloatOperator::FromSigned { bits } | FloatOperator::FromUnsigned { bits } => vec![bits],
            FloatOperator::SquareRoot
            | FloatOperator::ToInteger { .. }
            | FloatOperator::ToUnsigned { .. }
            | FloatOperator::Convert { .. }
            | FloatOperator::RoundToIntegral
            | FloatOperator::Floor
            | FloatOperator::UlpsUp { .. }
            | FloatOperator::ExactBelow => vec![width],
            FloatOperator::DepthFromHeight { bits } => vec![bits],
        }
    }

    /// Appends the golden results to `results`, in the order of its output ports, of an operator
    /// with the hardware's default policy and no flags. Operands are the bits of its input ports.
    pub fn golden_results(
        self,
        format: FloatFormat,
        rounding: Rounding,
        operands: &[u64],
        results: &mut Vec<u64>,
    ) {
        OperatorConfiguration::new(self, format, rounding).golden_results(operands, results);
    }

    /// Appends the results, and answers with the flags.
    fn evaluate(
        self,
        arithmetic: FloatArithmetic,
        operands: &[u64],
        results: &mut Vec<u64>,
    ) -> Flags {
        let a = operands[0];
        let b = operands.get(1).copied().unwrap_or(0);
        let answer = match self {
            FloatOperator::Add => arithmetic.add(a, b),
            FloatOperator::Subtract => arithmetic.sub(a, b),
            FloatOperator::Multiply => arithmetic.mul(a, b),
            FloatOperator::Divide => arithmetic.div(a, b),
            FloatOperator::SquareRoot => arithmetic.sqrt(a),
            FloatOperator::Minimum => arithmetic.min(a, b),
            FloatOperator::Maximum => arithmetic.max(a, b),
            FloatOperator::LessThan => truth(arithmetic.less_than(Comparison::Signalling, a, b)),
            FloatOperator::LessEqual => truth(arithmetic.less_equal(Comparison::Signalling, a, b)),
            FloatOperator::Compare | FloatOperator::CompareSignalling => {
                let comparison = match self {
                    FloatOperator::Compare => Comparison::Quiet,
                    _ => Comparison::Signalling,
                };
                let (order, flags) = arithmetic.compare(comparison, a, b);
                let relations = [
                    Relation::LessThan,
                    Relation::LessEqual,
                    Relation::Equal,
                    Relation::Unordered,
                ];
                results.extend(relations.map(|relation| u64::from(relation.holds(order))));
                return flags;
            }
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => arithmetic.from_scaled_integer(
                sign_extended(a, value_bits),
                sign_extended(b, exponent_bits),
            ),
            FloatOperator::ToInteger { bits } => {
                arithmetic.to_integer_exact(IntegerFormat::signed(bits), a)
            }
            FloatOperator::ToUnsigned { bits } => {
                arithmetic.to_integer_exact(IntegerFormat::unsigned(bits), a)
            }
            FloatOperator::FromSigned { bits } => {
                arithmetic.from_integer(IntegerFormat::signed(bits), a)
            }
            FloatOperator::FromUnsigned { bits } => {
                arithmetic.from_integer(IntegerFormat::unsigned(bits), a)
            }
            FloatOperator::Convert { target } => arithmetic.convert_to(target, a),
            FloatOperator::RoundToIntegral => arithmetic.round_to_integral_exact(a),
            FloatOperator::Floor => arithmetic.floor(a),
            FloatOperator::UlpsUp { ulps } => without_flags(arithmetic.ulps_up(a, ulps)),
            FloatOperator::ExactBelow => without_flags(arithmetic.exact_below(a)),
            FloatOperator::DepthFromHeight { bits } => {
                without_flags(arithmetic.depth_from_height(a, bits))
            }
        };
        results.push(answer.bits);
        answer.flags
    }
}

impl OperatorConfiguration {
    /// Appends the golden results to `results`, in the order of its output ports: `flags_o`, where
    /// it has that, is the last. Operands are the bits of its input ports.
    ///
    /// The comparator's flags are those of quiet comparisons, the flags of `LessThan` and
    /// `LessEqual` those of signalling ones; a conversion to an integer raises inexact.
    pub fn golden_results(self, operands: &[u64], results: &mut Vec<u64>) {
        let arithmetic = self.format.arithmetic(self.policy, self.rounding);
        let flags = self.operator.evaluate(arithmetic, operands, results);
        if self.has_flags {
            results.push(flags.bits().into());
        }
    }
}

/// The answer of a predicate.
fn truth((holds, flags): (bool, Flags)) -> Answer {
    Answer {
        bits: holds.into(),
        flags,
    }
}

/// The answer of an operator that raises no flag.
fn without_flags(bits: u64) -> Answer {
    Answer {
        bits,
        flags: Flags::NONE,
    }
}

fn sign_extended(word: u64, bits: u32) -> i64 {
    (word << (64 - bits)) as i64 >> (64 - bits)
}
