//! What a fixed-point operator must answer, by the golden arithmetic. For comparisons only: no
//! operator is built with it.

use rtl_model::fixed::{Fixed, FixedArithmetic};

use super::{FixedConfiguration, FixedOperator};

impl FixedConfiguration {
    /// Appends the golden results to `results`, in the order of its output ports. Operands are the
    /// bits of its input ports.
    pub fn golden_results(self, operands: &[u64], results: &mut Vec<u64>) {
        let a = Fixed::new(self.a, operands[0]);
        let second = operands.get(1).copied().unwrap_or(0);
        let b = Fixed::new(self.b, second);
        let arithmetic = FixedArithmetic::new(self.result, self.rounding, self.overflow);
        let (result, flags) = match self.operator {
            FixedOperator::Add => arithmetic.add(a, b),
            FixedOperator::Subtract => arithmetic.sub(a, b),
            FixedOperator::Multiply => arithmetic.mul(a, b),
            FixedOperator::Divide => arithmetic.div(a, b),
            FixedOperator::Reciprocal => arithmetic.reciprocal(a),
            FixedOperator::Negate => arithmetic.negate(a),
            FixedOperator::Convert => arithmetic.convert(a),
            FixedOperator::ShiftLeft { .. } => arithmetic.shift_left(a, second as u32),
            FixedOperator::ShiftRight { .. } => arithmetic.shift_right(a, second as u32),
            FixedOperator::FromFloat { source, policy } => {
                arithmetic.from_float(source, policy, operands[0])
            }
            FixedOperator::ToFloat { target, policy } => {
                let answer = a.to_float(target.arithmetic(policy, self.rounding));
                results.push(answer.bits);
                if self.has_flags {
                    results.push(answer.flags.bits().into());
                }
                return;
            }
            FixedOperator::Compare => {
                let order = a.compare(b);
                results.extend([order.is_lt(), order.is_le(), order.is_eq()].map(u64::from));
                return;
            }
        };
        results.push(result.bits);
        if self.has_flags {
            results.push(flags.bits().into());
        }
    }
}
