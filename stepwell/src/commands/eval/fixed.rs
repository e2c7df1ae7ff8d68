//! Operators on fixed-point numbers.

use anyhow::{anyhow, bail};
use clap::Args;

use rtl_model::fixed::{FixedArithmetic, FixedFormat, FixedOperation, Overflow};
use rtl_model::float::{Policy, Rounding};

use super::{Evaluator, MOST_OPERANDS};

/// Bits of the distance of a shift: enough to move a word out of any other.
const DISTANCE_BITS: u32 = 8;

/// What a fixed-point operator depends on beside the rounding.
#[derive(Args, Debug)]
pub struct FixedOptions {
    /// Of fixed point: the result's format; that of --format unless told
    #[arg(long, value_name = "FORMAT")]
    result_format: Option<FixedFormat>,

    /// Of fixed point: the second operand's format; that of --format unless told
    #[arg(long, value_name = "FORMAT")]
    b_format: Option<FixedFormat>,

    /// Of fixed point: saturate (unless told) or wrap where a result is beyond the range
    #[arg(long, value_name = "OVERFLOW")]
    overflow: Option<Overflow>,
}

impl FixedOptions {
    /// Complains of any that was given: the format is a float's.
    pub fn refuse(&self) -> anyhow::Result<()> {
        let given = [
            ("--result-format", self.result_format.is_some()),
            ("--b-format", self.b_format.is_some()),
            ("--overflow", self.overflow.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) => bail!(
                "{option} is of fixed-point operators: leave it out, or take a fixed-point format, \
                 such as --format q12.20"
            ),
            None => Ok(()),
        }
    }

    /// The result's format, where another one is asked for.
    pub fn result_format(&self) -> Option<FixedFormat> {
        self.result_format
    }

    /// What happens beyond the range.
    pub fn overflow(&self) -> Overflow {
        self.overflow.unwrap_or_default()
    }

    /// The operator of this name on numbers of this format.
    pub fn evaluator(
        &self,
        name: &str,
        format: FixedFormat,
        policy: Policy,
        rounding: Rounding,
    ) -> anyhow::Result<Evaluator> {
        let operation: FixedOperation = name.parse().map_err(|error| anyhow!("--op: {error}"))?;
        let is_shift = matches!(
            operation,
            FixedOperation::ShiftLeft | FixedOperation::ShiftRight
        );
        if self.b_format.is_some() && (is_shift || operation.operands() == 1) {
            bail!("--b-format: {operation} has no second number; leave it out");
        }
        let b_format = self.b_format.unwrap_or(format);
        let result = self.result_format.unwrap_or(format);
        let arithmetic = FixedArithmetic::new(result, rounding, self.overflow());
        let mut operand_widths = vec![format.width()];
        if is_shift {
            operand_widths.push(DISTANCE_BITS);
        } else if operation.operands() == 2 {
            operand_widths.push(b_format.width());
        }
        let result_width = match operation {
            FixedOperation::Compare(_) => 1,
            FixedOperation::ToFloat(target) => target.width(),
            FixedOperation::FromFloat(source) => {
                operand_widths = vec![source.width()];
                result.width()
            }
            _ => result.width(),
        };
        Ok(Evaluator {
            operand_widths,
            result_width,
            evaluate: Box::new(move |[a, b, _]: [u64; MOST_OPERANDS]| {
                let answer = operation.evaluate(arithmetic, policy, (format, b_format), [a, b]);
                (answer.bits, answer.flags)
            }),
        })
    }
}
