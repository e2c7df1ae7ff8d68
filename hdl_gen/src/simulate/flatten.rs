//! A hierarchy of modules as one list of nodes: ports of instances vanish, since the inside of an
//! instance refers to the very nodes outside that drive it.

use std::sync::Arc;

use super::{Signal, SimulateError};
use crate::netlist::{Meaning, Memory, MemoryId, Module, Operation, Wire};

/// One module in the hierarchy, with the place of its nodes in the flat list.
struct Scope {
    /// Instance names from the top, each followed by a dot; empty for the top.
    prefix: String,
    module: Arc<Module>,
    base: u32,
    /// The place of its first memory among all.
    first_memory: u32,
}

/// What stands in the flat list for a node.
enum Cell {
    /// A port of an instance: the node it is connected to.
    Alias(u32),
    /// The node itself; its operands are relative to its scope.
    Node,
}

/// A named signal before addresses are known: its path and flat node.
pub(super) struct FlatSignal {
    pub(super) path: String,
    pub(super) node: u32,
    pub(super) width: u32,
    pub(super) meaning: Meaning,
}

impl FlatSignal {
    /// The handle of this signal once its address is known.
    pub(super) fn at(&self, address: u32) -> Signal {
        Signal {
            address,
            width: self.width,
            meaning: self.meaning,
        }
    }
}

/// The flat list of all nodes of a hierarchy.
pub(super) struct Flat {
    scopes: Vec<Scope>,
    cells: Vec<Cell>,
    memories: u32,
}

impl Flat {
    pub(super) fn new(top: &Arc<Module>) -> Flat {
        let mut flat = Flat {
            scopes: Vec::new(),
            cells: Vec::new(),
            memories: 0,
        };
        flat.add(top, String::new(), None);
        flat
    }

    /// How many nodes there are.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    fn add(&mut self, module: &Arc<Module>, prefix: String, inputs: Option<&[u32]>) -> u32 {
        let base = self.cells.len() as u32;
        self.cells.extend(module.nodes.iter().map(|_| Cell::Node));
        for (&port, &driver) in module.inputs.iter().zip(inputs.unwrap_or_default()) {
            self.cells[(base + port.0) as usize] = Cell::Alias(driver);
        }
        self.scopes.push(Scope {
            prefix: prefix.clone(),
            module: module.clone(),
            base,
            first_memory: self.memories,
        });
        self.memories += module.memories.len() as u32;
        let bases: Vec<u32> = module
            .instances
            .iter()
            .map(|instance| {
                let drivers: Vec<u32> = instance.inputs.iter().map(|wire| base + wire.0).collect();
                let inside = format!("{prefix}{}.", instance.name);
                self.add(&instance.module, inside, Some(&drivers))
            })
            .collect();
        for (index, node) in module.nodes.iter().enumerate() {
            if let Operation::InstanceOutput { instance, output } = node.operation {
                let driver = module.instances[instance].module.outputs[output].1;
                self.cells[base as usize + index] = Cell::Alias(bases[instance] + driver.0);
            }
        }
        base
    }

    /// The node itself behind a node that may be a port of an instance.
    pub(super) fn resolve(&self, mut node: u32) -> Result<u32, SimulateError> {
        // A chain of ports longer than all nodes together has gone round in a circle.
        for _ in 0..=self.cells.len() {
            match self.cells[node as usize] {
                Cell::Alias(driver) => node = driver,
                Cell::Node => return Ok(node),
            }
        }
        Err(self.combinational_loop(node))
    }

    fn scope(&self, node: u32) -> &Scope {
        // Scopes are added in the order of their bases.
        let after = self.scopes.partition_point(|scope| scope.base <= node);
        &self.scopes[after - 1]
    }

    /// The operation of a node that is no alias, its width, and the base its operands count from.
    pub(super) fn node(&self, node: u32) -> (&Operation, u32, u32) {
        let scope = self.scope(node);
        let inner = &scope.module.nodes[(node - scope.base) as usize];
        (&inner.operation, inner.width, scope.base)
    }

    /// The place among all memories of one that a node reads.
    pub(super) fn memory_place(&self, node: u32, memory: MemoryId) -> u32 {
        self.scope(node).first_memory + memory.0
    }

    /// A memory by its place among all, and the base the wires of its write port count from.
    pub(super) fn memory(&self, place: u32) -> (&Memory, u32) {
        let after = self
            .scopes
            .partition_point(|scope| scope.first_memory <= place);
        // Scopes without memories share their first place with the one that follows them.
        let mut scopes = self.scopes[..after].iter().rev();
        let scope = scopes.find(|scope| !scope.module.memories.is_empty());
        let scope = scope.expect("a memory stands in a scope");
        let index = (place - scope.first_memory) as usize;
        (&scope.module.memories[index], scope.base)
    }

    /// The width of an operand counted from `base`.
    pub(super) fn width(&self, base: u32, wire: Wire) -> u32 {
        self.scope(base + wire.0).module.width(wire)
    }

    /// The error that names a node on a loop.
    pub(super) fn combinational_loop(&self, node: u32) -> SimulateError {
        let scope = self.scope(node);
        let index = node - scope.base;
        let name = match &scope.module.nodes[index as usize].name {
            Some(name) => name.clone(),
            None => format!("n{index}"),
        };
        SimulateError::CombinationalLoop {
            module: scope.module.name.clone(),
            path: format!("{}{name}", scope.prefix),
        }
    }

    /// Every named signal and output port of every instance, in the order of the hierarchy; a
    /// port that is the named signal itself stands once.
    pub(super) fn signals(&self) -> Vec<FlatSignal> {
        let mut signals = Vec::new();
        for scope in &self.scopes {
            let module = &scope.module;
            let mut add = |name: &str, wire: Wire| {
                let node = module.node(wire);
                signals.push(FlatSignal {
                    path: format!("{}{name}", scope.prefix),
                    node: scope.base + wire.0,
                    width: node.width,
                    meaning: node.meaning,
                });
            };
            for (index, node) in module.nodes.iter().enumerate() {
                if let Some(name) = &node.name {
                    add(name, Wire(index as u32));
                }
            }
            for (name, wire) in &module.outputs {
                if module.node(*wire).name.as_ref() != Some(name) {
                    add(name, *wire);
                }
            }
        }
        signals
    }
}
