//! What an operator must answer, by the golden arithmetic. For comparisons only: no operator is
//! built with it.

use super::{FloatOperator, OperatorConfiguration};
use rtl_model::float::{FloatFormat, Rounding};

impl FloatOperator {
    /// Widths of its operands, in the order of its input ports.
    pub fn operand_widths(self, format: FloatFormat) -> Vec<u32> {
        let width = format.width();
        match self {
            FloatOperator::Add
            | FloatOperator::Subtract
            | FloatOperator::Multiply
            | FloatOperator::Divide
            | FloatOperator::Compare
            | FloatOperator::LessThan
            | FloatOperator::LessEqual => vec![width, width],
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => {
                vec![value_bits, exponent_bits]
            }
            FloatOperator::ToInteger { .. }
            | FloatOperator::Floor
            | FloatOperator::UlpsUp { .. }
            | FloatOperator::ExactBelow => vec![width],
            FloatOperator::DepthFromHeight { bits } => vec![bits],
        }
    }

    /// Appends the golden results to `results`, in the order of its output ports. Operands are the
    /// bits of its input ports.
    pub fn golden_results(
        self,
        format: FloatFormat,
        rounding: Rounding,
        operands: &[u64],
        results: &mut Vec<u64>,
    ) {
        let a = operands[0];
        let b = operands.get(1).copied().unwrap_or(0);
        let result = match self {
            FloatOperator::Add => format.add(rounding, a, b),
            FloatOperator::Subtract => format.sub(rounding, a, b),
            FloatOperator::Multiply => format.mul(rounding, a, b),
            FloatOperator::Divide => format.div(rounding, a, b),
            FloatOperator::LessThan => format.less_than(a, b).into(),
            FloatOperator::LessEqual => format.less_equal(a, b).into(),
            FloatOperator::Compare => {
                results.push(format.less_than(a, b).into());
                results.push(format.less_equal(a, b).into());
                results.push(format.equal(a, b).into());
                format.compare(a, b).is_none().into()
            }
            FloatOperator::FromInteger {
                value_bits,
                exponent_bits,
            } => format.from_integer(
                rounding,
                sign_extended(a, value_bits),
                sign_extended(b, exponent_bits),
            ),
            FloatOperator::ToInteger { bits } => {
                let integer = match format.to_integer(rounding, a) {
                    Ok(integer) => integer,
                    Err(problem) => problem.saturated(),
                };
                let largest = (1_i64 << (bits - 1)) - 1;
                integer.clamp(-largest - 1, largest) as u64 & (u64::MAX >> (64 - bits))
            }
            FloatOperator::Floor => format.floor(a),
            FloatOperator::UlpsUp { ulps } => format.ulps_up(a, ulps),
            FloatOperator::ExactBelow => format.exact_below(a),
            FloatOperator::DepthFromHeight { bits } => format.depth_from_height(a, bits),
        };
        results.push(result);
    }
}

impl OperatorConfiguration {
    /// Appends the golden results to `results`, in the order of its output ports. Operands are the
    /// bits of its input ports.
    pub fn golden_results(self, operands: &[u64], results: &mut Vec<u64>) {
        self.operator
            .golden_results(self.format, self.rounding, operands, results);
    }
}

fn sign_extended(word: u64, bits: u32) -> i64 {
    (word << (64 - bits)) as i64 >> (64 - bits)
}
