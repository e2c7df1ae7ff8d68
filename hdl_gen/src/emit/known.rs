//! Which nodes have a value that is plain to see: they are printed as literals, since lint tools
//! ask what an expression of constants is for.

use crate::netlist::{Module, Node, Operation, Wire};

/// The known value of every node of a module.
pub(super) fn known_values(module: &Module) -> Vec<Option<u64>> {
    let mut known: Vec<Option<u64>> = Vec::with_capacity(module.nodes.len());
    for node in &module.nodes {
        // Only what a register takes may stand behind the node that reads it.
        let of = |wire: Wire| known.get(wire.index()).copied().flatten();
        known.push(decided(module, node, &of).or_else(|| evaluated(module, node, &of)));
    }
    known
}

fn low_bits(width: u32) -> u64 {
    u64::MAX >> (64 - width)
}

fn sign_extended(value: u64, width: u32) -> u64 {
    let above = 64 - width;
    ((value << above) as i64 >> above) as u64
}

/// Results that one operand decides alone.
fn decided(module: &Module, node: &Node, of: &impl Fn(Wire) -> Option<u64>) -> Option<u64> {
    match &node.operation {
        Operation::Equal(a, b) => (a == b).then_some(1),
        Operation::LessThan(a, b) => {
            let never = a == b || of(*a) == Some(low_bits(module.width(*a))) || of(*b) == Some(0);
            never.then_some(0)
        }
        Operation::ShiftLeft(_, amount) | Operation::ShiftRight(_, amount) => {
            let all_out = of(*amount)? >= u64::from(node.width);
            all_out.then_some(0)
        }
        _ => None,
    }
}

/// Results of constants alone.
fn evaluated(module: &Module, node: &Node, of: &impl Fn(Wire) -> Option<u64>) -> Option<u64> {
    let value = match &node.operation {
        Operation::Constant(value) => *value,
        Operation::Not(a) => !of(*a)?,
        Operation::And(a, b) => of(*a)? & of(*b)?,
        Operation::Or(a, b) => of(*a)? | of(*b)?,
        Operation::Xor(a, b) => of(*a)? ^ of(*b)?,
        Operation::Add(a, b) => of(*a)?.wrapping_add(of(*b)?),
        Operation::Subtract(a, b) => of(*a)?.wrapping_sub(of(*b)?),
        Operation::Multiply(a, b) => of(*a)?.wrapping_mul(of(*b)?),
        Operation::MultiplySigned(a, b) => {
            let signed = |wire: Wire| Some(sign_extended(of(wire)?, module.width(wire)));
            signed(*a)?.wrapping_mul(signed(*b)?)
        }
        // Amounts from the width up are decided already.
        Operation::ShiftLeft(a, b) => of(*a)?.checked_shl(of(*b)? as u32)?,
        Operation::ShiftRight(a, b) => of(*a)?.checked_shr(of(*b)? as u32)?,
        Operation::Equal(a, b) => u64::from(of(*a)? == of(*b)?),
        Operation::LessThan(a, b) => u64::from(of(*a)? < of(*b)?),
        Operation::Mux {
            select,
            when_one,
            when_zero,
        } => match of(*select)? {
            0 => of(*when_zero)?,
            _ => of(*when_one)?,
        },
        Operation::Concat(parts) => {
            let mut joined = 0u64;
            for &part in parts {
                let width = module.width(part);
                joined = joined.checked_shl(width).unwrap_or_default() | of(part)?;
            }
            joined
        }
        Operation::Slice { from, low } => of(*from)? >> low,
        Operation::SignExtend(a) => sign_extended(of(*a)?, module.width(*a)),
        Operation::AnyBit(a) => u64::from(of(*a)? != 0),
        Operation::AllBits(a) => u64::from(of(*a)? == low_bits(module.width(*a))),
        Operation::Input
        | Operation::Register { .. }
        | Operation::MemoryRead { .. }
        | Operation::InstanceOutput { .. } => return None,
    };
    Some(value & low_bits(node.width))
}
