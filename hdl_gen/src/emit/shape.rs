//! Who reads what in a module, before anything has a text.

use std::collections::{HashMap, HashSet};

use crate::netlist::{Module, Operation, Wire};

/// What the outputs depend on, registers and instances included.
pub(super) fn live_nodes(module: &Module, known: &[Option<u64>]) -> Vec<bool> {
    let mut live = vec![false; module.nodes.len()];
    let mut pending: Vec<Wire> = module.outputs.iter().map(|&(_, wire)| wire).collect();
    while let Some(wire) = pending.pop() {
        if std::mem::replace(&mut live[wire.index()], true) || known[wire.index()].is_some() {
            continue;
        }
        match &module.node(wire).operation {
            Operation::InstanceOutput { instance, .. } => {
                pending.extend(&module.instances[*instance].inputs);
            }
            Operation::MemoryRead { memory, address } => {
                pending.push(*address);
                let write = module.memory(*memory).write;
                pending.extend(write.iter().flat_map(|write| write.operands()));
            }
            operation => pending.extend(operation.operands()),
        }
    }
    live
}

/// Who uses what.
pub(super) struct Shape {
    /// How often a live node is printed.
    pub(super) uses: Vec<u32>,
    users: Vec<Option<Wire>>,
    /// Nodes of which bits are selected.
    pub(super) needs_signal: HashSet<Wire>,
    /// The first register that takes a node.
    pub(super) register_of: HashMap<Wire, Wire>,
    /// The output port that an unnamed node is.
    pub(super) output_of: HashMap<Wire, usize>,
    /// By memory: is it read?
    pub(super) live_memories: Vec<bool>,
    /// By instance: the live nodes of its outputs.
    pub(super) instance_outputs: Vec<HashMap<usize, Wire>>,
}

impl Shape {
    pub(super) fn new(module: &Module, live: &[bool], known: &[Option<u64>]) -> Shape {
        let mut shape = Shape {
            uses: vec![0; live.len()],
            users: vec![None; live.len()],
            needs_signal: HashSet::new(),
            register_of: HashMap::new(),
            output_of: HashMap::new(),
            live_memories: vec![false; module.memories.len()],
            instance_outputs: vec![HashMap::new(); module.instances.len()],
        };
        let mut enables = HashSet::new();
        let live_wires = || (0..live.len()).filter(|&i| live[i]).map(|i| Wire(i as u32));
        for wire in live_wires() {
            let node = module.node(wire);
            if known[wire.index()].is_some() {
                continue;
            }
            match &node.operation {
                Operation::Register {
                    next,
                    enable,
                    reset,
                } => {
                    shape.use_all(next, wire);
                    if let Some(next) = next {
                        shape.register_of.entry(*next).or_insert(wire);
                    }
                    // Registers with the same enable share the line it stands in.
                    let group = (node.section, *enable, reset.is_some());
                    if enables.insert(group) {
                        shape.use_all(enable, wire);
                    }
                    continue;
                }
                Operation::InstanceOutput { instance, output } => {
                    shape.instance_outputs[*instance].insert(*output, wire);
                }
                Operation::Slice { from, .. } | Operation::SignExtend(from) => {
                    shape.needs_signal.insert(*from);
                }
                Operation::MemoryRead { memory, .. } => {
                    shape.live_memories[memory.index()] = true;
                }
                Operation::MultiplySigned(a, b) => shape.needs_signal.extend([*a, *b]),
                _ => {}
            }
            shape.use_all(&node.operation.operands(), wire);
        }
        // No node is the user: an instance is none, nor is a memory.
        let mut outside = Vec::new();
        for (instance, outputs) in module.instances.iter().zip(&shape.instance_outputs) {
            if !outputs.is_empty() {
                outside.extend(&instance.inputs);
            }
        }
        for (memory, &live) in module.memories.iter().zip(&shape.live_memories) {
            if let (true, Some(write)) = (live, memory.write) {
                outside.extend(write.operands());
            }
        }
        for wire in outside {
            shape.uses[wire.index()] += 1;
            shape.users[wire.index()] = None;
        }
        for (index, &(_, wire)) in module.outputs.iter().enumerate() {
            let node = module.node(wire);
            let own = !matches!(node.operation, Operation::Input | Operation::Slice { .. });
            if own && known[wire.index()].is_none() && node.name.is_none() {
                shape.output_of.entry(wire).or_insert(index);
            }
        }
        shape
    }

    fn use_all<'w>(&mut self, wires: impl IntoIterator<Item = &'w Wire>, user: Wire) {
        for &wire in wires {
            self.uses[wire.index()] += 1;
            self.users[wire.index()] = Some(user);
        }
    }

    /// The one node that reads this one, if it is one.
    pub(super) fn only_user(&self, wire: Wire) -> Option<Wire> {
        self.users[wire.index()].filter(|_| self.uses[wire.index()] == 1)
    }
}
