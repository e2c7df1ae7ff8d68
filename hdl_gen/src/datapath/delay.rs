//! How long a recorded operation takes within its stage, by the estimates of [`crate::pipeline`]:
//! eighths of a look-up table level on an FPGA with carry chains.

use super::record::Recording;
use super::signal::{RecordedOperation, SignalId};

/// A time in eighths of a look-up table level.
pub type Delay = u32;

/// One level.
const LEVEL: Delay = 8;

/// Levels of a tree of four-input tables over so many bits.
fn tree(bits: u32) -> Delay {
    let (mut levels, mut reach) = (0, 1_u64);
    while reach < u64::from(bits) {
        reach *= 4;
        levels += 1;
    }
    LEVEL * levels
}

/// The delay of an operation that needs no cycle of its own.
pub(super) fn delay(recording: &Recording, id: SignalId) -> Delay {
    use RecordedOperation::*;
    let width = |id| recording.width(id);
    let constant = |id| match recording.signal(id).operation {
        Constant(value) => Some(value),
        _ => None,
    };
    match recording.signal(id).operation {
        // Into the chain, along it, out of it.
        IntAdd(a, b) | IntSub(a, b) => match constant(b).or(constant(a)) {
            Some(0) => 0,
            _ => LEVEL + width(id).min(width(a).max(width(b)) + 1),
        },
        // A sign is only looked at.
        IntLessThan(_, b) if constant(b) == Some(0) => 0,
        IntLessThan(a, b) => LEVEL + width(a).max(width(b)),
        IntEqual(a, b) if constant(a).or(constant(b)).is_some() => tree(width(a).max(width(b))),
        IntEqual(a, b) => tree(2 * width(a).max(width(b))),
        And(..) | Or(..) | IntXor(..) | IntComplementIf(..) => LEVEL / 2,
        Select(_, a, b) => match constant(a).or(constant(b)) {
            Some(_) => LEVEL / 2,
            None => LEVEL,
        },
        IntShiftLeft(_, amount, bits) | IntShiftRight(_, amount, bits) => match constant(amount) {
            Some(_) => 0,
            None => LEVEL * bits,
        },
        IntBitLength(a) => 2 * tree(width(a)),
        IsZero(a) => tree(width(a)),
        UlpsUp(a, _) => LEVEL + width(a),
        IntMul(a, b) => LEVEL * (2 + (u32::BITS - width(a).min(width(b)).leading_zeros())),
        // Wires, gates that the table behind takes in, and what has cycles of its own.
        _ => 0,
    }
}
