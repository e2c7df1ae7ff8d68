//! How long an operation takes, in the model by which pipelines are cut.
//!
//! The unit is an eighth of a level of four-input look-up tables with its routing. The figures are
//! those of an FPGA with carry chains (a chain advances about eight bits in the time of a level);
//! they need only rank the places of a cut, not predict nanoseconds: that is nextpnr's task.

use crate::netlist::{Module, Operation, Wire};

/// A time in eighths of a look-up table level.
pub type Delay = u32;

/// One level.
pub const LEVEL: Delay = 8;

/// Levels of a tree that joins four words at each node.
fn tree_levels(inputs: u32) -> Delay {
    let mut levels = 0;
    let mut reach = 1_u64;
    while reach < u64::from(inputs) {
        reach *= 4;
        levels += 1;
    }
    levels
}

/// The bits it takes to count to `count - 1`.
fn index_bits(count: u32) -> u32 {
    u32::BITS - count.saturating_sub(1).leading_zeros()
}

/// What is only a way of reading wires: it takes neither time nor area, and is never registered.
pub(super) fn is_wiring(operation: &Operation) -> bool {
    matches!(
        operation,
        Operation::Constant(_)
            | Operation::Slice { .. }
            | Operation::Concat(_)
            | Operation::SignExtend(_)
    )
}

/// The delay of one node.
pub fn delay(module: &Module, wire: Wire) -> Delay {
    let node = module.node(wire);
    let width = |wire: Wire| module.width(wire);
    let is_constant = |wire: Wire| matches!(module.node(wire).operation, Operation::Constant(_));
    match &node.operation {
        // An inverter is part of the table behind it.
        Operation::Input
        | Operation::Constant(_)
        | Operation::Not(_)
        | Operation::Slice { .. }
        | Operation::Concat(_)
        | Operation::SignExtend(_)
        | Operation::Register { .. }
        | Operation::InstanceOutput { .. } => 0,
        // Distributed memory is made of look-up tables, and has selectors behind them.
        Operation::MemoryRead { address, .. } => LEVEL * tree_levels(1 << width(*address).min(16)),
        // Two gates of two inputs mostly share a table.
        Operation::And(..) | Operation::Or(..) | Operation::Xor(..) => LEVEL / 2,
        Operation::Mux {
            when_one,
            when_zero,
            ..
        } => {
            // With a constant it is a gate.
            if is_constant(*when_one) || is_constant(*when_zero) {
                LEVEL / 2
            } else {
                LEVEL
            }
        }
        // Into the chain, along it, out of it.
        Operation::Add(..) | Operation::Subtract(..) => LEVEL + node.width,
        Operation::LessThan(a, _) => LEVEL + width(*a),
        Operation::Equal(a, _) => LEVEL * tree_levels(2 * width(*a)),
        Operation::AnyBit(a) | Operation::AllBits(a) => LEVEL * tree_levels(width(*a)),
        // One row of selectors a bit of the amount, as long as a row can still move anything.
        Operation::ShiftLeft(a, amount) | Operation::ShiftRight(a, amount) => {
            LEVEL * width(*amount).min(1 + index_bits(width(*a)))
        }
        // A hard multiplier, or a tree of compressors and an adder.
        Operation::Multiply(a, b) | Operation::MultiplySigned(a, b) => {
            LEVEL * (2 + index_bits(width(*a).min(width(*b))))
        }
    }
}

/// The longest path from an input or register to an output or register.
pub fn longest_path(module: &Module) -> Delay {
    let mut arrival = vec![0; module.nodes.len()];
    let mut longest = 0;
    for (index, node) in module.nodes.iter().enumerate() {
        let is_start = matches!(
            node.operation,
            Operation::Register { .. } | Operation::InstanceOutput { .. }
        );
        if !is_start {
            let latest = node
                .operation
                .operands()
                .iter()
                .map(|w| arrival[w.index()])
                .max();
            let own = delay(module, Wire(u32::try_from(index).expect("a node's index")));
            arrival[index] = latest.unwrap_or(0) + own;
        }
        longest = longest.max(arrival[index]);
    }
    longest
}
