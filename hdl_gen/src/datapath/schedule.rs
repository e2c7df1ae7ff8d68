//! In which pipeline stage each operation of a datapath stands.

use super::record::Recording;
use super::signal::{RecordedOperation, SignalId};
use serde::{Deserialize, Serialize};

/// Cycles of each pipelined operator. Everything else (selection, integer and bit logic, sign
/// changes, the step up by units in the last place) is combinational within its stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct OperatorLatencies {
    /// Float adder and subtractor.
    pub adder: u32,
    /// Float multiplier.
    pub multiplier: u32,
    /// Float divider.
    pub divider: u32,
    /// Float comparator.
    pub comparator: u32,
    /// Integer to float, height to depth.
    pub conversion: u32,
}

impl OperatorLatencies {
    /// The budget of the 2013 hardware paper (section 4.2): adder and divider two cycles,
    /// multiplier and comparator one; conversions, of which it does not speak, one.
    pub const PAPER: OperatorLatencies = OperatorLatencies {
        adder: 2,
        multiplier: 1,
        divider: 2,
        comparator: 1,
        conversion: 1,
    };

    /// Cycles of an operation.
    pub fn of(&self, operation: &RecordedOperation) -> u32 {
        use RecordedOperation::*;
        match operation {
            Add(..) | Sub(..) => self.adder,
            Mul(..) => self.multiplier,
            Div(..) => self.divider,
            LessThan(..) | LessEqual(..) => self.comparator,
            FromInteger(..) | DepthFromHeight(..) => self.conversion,
            _ => 0,
        }
    }
}

/// Where everything stands in time. Stage s is the logic behind the s-th rank of registers.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// The stage in which each signal is there; constants are there in every stage: `None`.
    pub available: Vec<Option<u32>>,
    /// The last stage in which each signal is read, by an operation or an output; `None` for a
    /// signal that no output depends on: it is not built.
    pub last_read: Vec<Option<u32>>,
    /// The stage in which the outputs appear: the datapath's latency in cycles.
    pub last_stage: u32,
}

impl Schedule {
    /// The stage in which an operation reads its operands; 0 if all of them are constants.
    pub fn read_stage(&self, operation: &RecordedOperation) -> u32 {
        let available = |id: &SignalId| self.available[id.index()];
        operation.operands().iter().filter_map(available).max().unwrap_or(0)
    }
}

/// As soon as possible: every operation starts in the first stage in which its operands are there.
pub fn schedule(recording: &Recording, latencies: &OperatorLatencies) -> Schedule {
    let count = recording.signals.len();
    let mut schedule =
        Schedule { available: vec![None; count], last_read: vec![None; count], last_stage: 0 };
    for (index, signal) in recording.signals.iter().enumerate() {
        schedule.available[index] = match signal.operation {
            RecordedOperation::Input { stage } => Some(stage),
            ref constant if constant.is_constant() => None,
            ref operation => Some(schedule.read_stage(operation) + latencies.of(operation)),
        };
    }
    let available = |id: SignalId| schedule.available[id.index()].unwrap_or(0);
    let together = recording.outputs.iter().filter(|output| !output.early);
    schedule.last_stage = together.map(|output| available(output.signal)).max().unwrap_or(0);
    let mut last_read: Vec<Option<u32>> = vec![None; count];
    for output in &recording.outputs {
        let stage = if output.early { available(output.signal) } else { schedule.last_stage };
        let read = &mut last_read[output.signal.index()];
        *read = (*read).max(Some(stage));
    }
    for index in (0..count).rev() {
        if last_read[index].is_none() {
            continue;
        }
        let operation = &recording.signals[index].operation;
        let stage = schedule.read_stage(operation);
        for operand in operation.operands() {
            let read = &mut last_read[operand.index()];
            *read = (*read).max(Some(stage));
        }
    }
    schedule.last_read = last_read;
    schedule
}
