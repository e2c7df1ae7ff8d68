//! How many float operators a datapath has.

use super::record::Recording;
use super::signal::RecordedOperation;
use serde::Serialize;

/// The float operators of a datapath, by kind. Wires, gates and integers are not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ElementCounts {
    /// Adders and subtractors of two operands.
    pub adders: u32,
    /// Comparators.
    pub comparators: u32,
    /// Multipliers.
    pub multipliers: u32,
    /// Dividers.
    pub dividers: u32,
    /// Conversions: integer to float, float to integer, height to depth.
    pub conversions: u32,
}

impl ElementCounts {
    /// Those that a recording's outputs depend on: what none depends on is not built.
    pub fn of(recording: &Recording) -> ElementCounts {
        let mut wanted = vec![false; recording.signals.len()];
        for output in &recording.outputs {
            wanted[output.signal.index()] = true;
        }
        let mut counts = ElementCounts::default();
        for index in (0..wanted.len()).rev() {
            if !wanted[index] {
                continue;
            }
            let operation = &recording.signals[index].operation;
            for operand in operation.operands() {
                wanted[operand.index()] = true;
            }
            use RecordedOperation::*;
            match operation {
                Add(..) | Sub(..) => counts.adders += 1,
                LessThan(..) | LessEqual(..) => counts.comparators += 1,
                Mul(..) => counts.multipliers += 1,
                Div(..) => counts.dividers += 1,
                FromInteger(..) | Floor(..) | DepthFromHeight(..) => counts.conversions += 1,
                _ => {}
            }
        }
        counts
    }
}
