//! A fingerprint of a netlist, so that a report of area can say that it speaks of the very netlist
//! that was verified.

use std::collections::HashMap;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::netlist::{Module, Operation};
use crate::operators::CORE_INSTANCE;
use crate::units::STEP_INSTANCE;

/// Bytes of the SHA-256 that are shown: 64 bits tell any two of our netlists apart.
const SHOWN_BYTES: usize = 8;

/// Sixteen hexadecimal digits of the SHA-256 of a design's structure: operations, widths, names,
/// connections, latency and ports of every module. Comments, sections and the meaning of bits
/// change nothing.
pub fn netlist_digest(top: &Arc<Module>) -> String {
    let mut known = HashMap::new();
    let digest = module_digest(top, &mut known);
    digest[..SHOWN_BYTES]
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// The digest of the pipelined operator or step within a stream unit: its area is measured without
/// the handshakes and, of a step, without the registers that delay its height and its address for them.
/// None of any other module.
pub fn core_digest(unit: &Arc<Module>) -> Option<String> {
    let only = |module: &Arc<Module>, name: &str| match module.instances.as_slice() {
        [only] if only.name == name => Some(only.module.clone()),
        _ => None,
    };
    let core = only(unit, CORE_INSTANCE)?;
    Some(netlist_digest(&only(&core, STEP_INSTANCE).unwrap_or(core)))
}

type Known = HashMap<*const Module, [u8; 32]>;

fn module_digest(module: &Arc<Module>, known: &mut Known) -> [u8; 32] {
    if let Some(digest) = known.get(&Arc::as_ptr(module)) {
        return *digest;
    }
    let mut hash = Canonical(Sha256::new());
    hash.text(&module.name);
    hash.number(u64::from(module.latency));
    hash.number(module.nodes.len() as u64);
    for node in &module.nodes {
        hash.number(u64::from(node.width));
        hash.text(node.name.as_deref().unwrap_or_default());
        hash.operation(&node.operation);
    }
    hash.number(module.inputs.len() as u64);
    for &input in &module.inputs {
        hash.number(u64::from(input.0));
    }
    hash.number(module.outputs.len() as u64);
    for (name, wire) in &module.outputs {
        hash.text(name);
        hash.number(u64::from(wire.0));
    }
    // A module without memories keeps the digest it had before there were any.
    for memory in &module.memories {
        hash.text(&memory.name);
        hash.number(u64::from(memory.words));
        hash.number(u64::from(memory.width));
        if memory.in_block {
            hash.text("block");
        }
        for wire in memory.write.iter().flat_map(|write| write.operands()) {
            hash.number(u64::from(wire.0));
        }
    }
    hash.number(module.instances.len() as u64);
    for instance in &module.instances {
        hash.text(&instance.name);
        hash.0.update(module_digest(&instance.module, known));
        for &input in &instance.inputs {
            hash.number(u64::from(input.0));
        }
    }
    let digest = hash.0.finalize().into();
    known.insert(Arc::as_ptr(module), digest);
    digest
}

/// Writes every item with its length or in a fixed one, so that no two structures read the same.
struct Canonical(Sha256);

impl Canonical {
    fn number(&mut self, value: u64) {
        self.0.update(value.to_le_bytes());
    }

    fn optional(&mut self, value: Option<u64>) {
        self.number(u64::from(value.is_some()));
        self.number(value.unwrap_or_default());
    }

    fn text(&mut self, text: &str) {
        self.number(text.len() as u64);
        self.0.update(text);
    }

    fn operation(&mut self, operation: &Operation) {
        let (name, literals): (&str, [Option<u64>; 2]) = match operation {
            Operation::Input => ("input", [None, None]),
            Operation::Constant(value) => ("constant", [Some(*value), None]),
            Operation::Not(_) => ("not", [None, None]),
            Operation::And(..) => ("and", [None, None]),
            Operation::Or(..) => ("or", [None, None]),
            Operation::Xor(..) => ("xor", [None, None]),
            Operation::Add(..) => ("add", [None, None]),
            Operation::Subtract(..) => ("subtract", [None, None]),
            Operation::Multiply(..) => ("multiply", [None, None]),
            Operation::MultiplySigned(..) => ("multiply_signed", [None, None]),
            Operation::ShiftLeft(..) => ("shift_left", [None, None]),
            Operation::ShiftRight(..) => ("shift_right", [None, None]),
            Operation::Equal(..) => ("equal", [None, None]),
            Operation::LessThan(..) => ("less_than", [None, None]),
            Operation::Mux { .. } => ("mux", [None, None]),
            Operation::Concat(_) => ("concat", [None, None]),
            Operation::Slice { low, .. } => ("slice", [Some(u64::from(*low)), None]),
            Operation::SignExtend(_) => ("sign_extend", [None, None]),
            Operation::AnyBit(_) => ("any_bit", [None, None]),
            Operation::AllBits(_) => ("all_bits", [None, None]),
            // Whether there is an enable follows from the number of operands.
            Operation::Register { reset, .. } => ("register", [*reset, None]),
            Operation::MemoryRead { memory, .. } => ("read", [Some(u64::from(memory.0)), None]),
            Operation::InstanceOutput { instance, output } => {
                ("output", [Some(*instance as u64), Some(*output as u64)])
            }
        };
        self.text(name);
        literals
            .into_iter()
            .for_each(|literal| self.optional(literal));
        let operands = operation.operands();
        self.number(operands.len() as u64);
        for operand in operands {
            self.number(u64::from(operand.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::netlist::Builder;
    use crate::operators::{FloatOperator, OperatorConfiguration, stream_unit};
    use rtl_model::float::Rounding;

    fn adder(name: &str, comment: &str, constant: u64) -> Arc<Module> {
        let mut b = Builder::new("adder");
        b.describe(comment);
        let a = b.input("a_i", 8);
        let one = b.constant(constant, 8);
        let sum = b.add(a, one);
        b.name(sum, name);
        b.output("sum_o", sum);
        b.finish()
    }

    fn user_of(inner: &Arc<Module>) -> Arc<Module> {
        let mut b = Builder::new("user");
        let a = b.input("a_i", 8);
        let outputs = b.instance("adder", inner, &[a]);
        b.output("sum_o", outputs[0]);
        b.finish()
    }

    #[test]
    fn comments_change_nothing_and_structure_everything() {
        let base = netlist_digest(&adder("sum", "one", 1));
        assert_eq!(base.len(), 16);
        assert_eq!(base, netlist_digest(&adder("sum", "another", 1)));
        assert_ne!(base, netlist_digest(&adder("sum", "one", 2)));
        assert_ne!(base, netlist_digest(&adder("total", "one", 1)));
    }

    #[test]
    fn the_core_of_a_stream_unit_is_found() {
        let format = "e4f3".parse().unwrap();
        let core =
            OperatorConfiguration::new(FloatOperator::Compare, format, Rounding::NearestEven)
                .build(1);
        let unit = stream_unit(&core);
        assert_eq!(core_digest(&unit), Some(netlist_digest(&core)));
        assert_ne!(netlist_digest(&unit), netlist_digest(&core));
        assert_eq!(core_digest(&core), None);
        assert_eq!(core_digest(&user_of(&user_of(&adder("sum", "", 1)))), None);
    }

    #[test]
    fn a_change_far_down_changes_the_top() {
        let one = netlist_digest(&user_of(&adder("sum", "", 1)));
        assert_eq!(one, netlist_digest(&user_of(&adder("sum", "x", 1))));
        assert_ne!(one, netlist_digest(&user_of(&adder("sum", "", 3))));
    }
}
