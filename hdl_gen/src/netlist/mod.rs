//! A module as a graph of words: what the Verilog emitter prints, the embedded simulator runs and
//! the area reports count.
//!
//! Words are unsigned bit vectors of 1 to 64 bits. Operands of one width, results of a stated
//! width, nothing extended or cut silently: a width error is a panic where the netlist is built,
//! not a surprise in a simulator. The clock `clk_i` and the synchronous reset `rst_ni` are implied
//! by the first register that needs them.

mod builder;

pub use builder::{Builder, InstanceAhead};

use std::sync::Arc;

/// A signal of one module: the result of one of its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Wire(pub(crate) u32);

impl Wire {
    /// The node's place in [`Module::nodes`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A memory of one module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MemoryId(pub(crate) u32);

impl MemoryId {
    /// The memory's place in [`Module::memories`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a node computes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Operation {
    /// An input port of the module.
    Input,
    /// A constant.
    Constant(u64),
    /// Every bit inverted.
    Not(Wire),
    /// Bitwise and.
    And(Wire, Wire),
    /// Bitwise or.
    Or(Wire, Wire),
    /// Bitwise exclusive or.
    Xor(Wire, Wire),
    /// Sum modulo 2^width.
    Add(Wire, Wire),
    /// Difference modulo 2^width.
    Subtract(Wire, Wire),
    /// Full product: as wide as both operands together.
    Multiply(Wire, Wire),
    /// Full product of two's complement words, as wide as both operands together.
    MultiplySigned(Wire, Wire),
    /// Shift left by a variable amount; zeros come in.
    ShiftLeft(Wire, Wire),
    /// Shift right by a variable amount; zeros come in.
    ShiftRight(Wire, Wire),
    /// One bit: are the operands equal?
    Equal(Wire, Wire),
    /// One bit: is the first below the second, both unsigned?
    LessThan(Wire, Wire),
    /// One of two words.
    Mux {
        /// One bit.
        select: Wire,
        /// The result where `select` is 1.
        when_one: Wire,
        /// The result where `select` is 0.
        when_zero: Wire,
    },
    /// The operands side by side, the first at the most significant end.
    Concat(Vec<Wire>),
    /// `width` bits of the operand, from bit `low` up.
    Slice {
        /// Where the bits come from.
        from: Wire,
        /// The lowest bit taken.
        low: u32,
    },
    /// The operand with its most significant bit repeated in front.
    SignExtend(Wire),
    /// One bit: is any bit of the operand 1?
    AnyBit(Wire),
    /// One bit: are all bits of the operand 1?
    AllBits(Wire),
    /// A register on the rising edge of `clk_i`.
    Register {
        /// What it takes at the edge; set by [`Builder::connect`].
        next: Option<Wire>,
        /// Takes it only where this bit is 1; always where there is none.
        enable: Option<Wire>,
        /// Its value while `rst_ni` is 0 at an edge; data registers have none.
        reset: Option<u64>,
    },
    /// The word of a memory at an address, as it stands before the clock edge.
    MemoryRead {
        /// The memory.
        memory: MemoryId,
        /// As many bits as tell its words apart.
        address: Wire,
    },
    /// An output of an instance of another module.
    InstanceOutput {
        /// Its place in [`Module::instances`].
        instance: usize,
        /// Its place in the instantiated module's [`Module::outputs`].
        output: usize,
    },
}

impl Operation {
    /// The wires it reads, in the order it is written in; for a register what it takes, then its
    /// enable. An instance's output reads none by itself.
    pub fn operands(&self) -> Vec<Wire> {
        match self {
            Operation::Input | Operation::Constant(_) | Operation::InstanceOutput { .. } => vec![],
            Operation::Not(a)
            | Operation::SignExtend(a)
            | Operation::AnyBit(a)
            | Operation::AllBits(a)
            | Operation::MemoryRead { address: a, .. }
            | Operation::Slice { from: a, .. } => vec![*a],
            Operation::And(a, b)
            | Operation::Or(a, b)
            | Operation::Xor(a, b)
            | Operation::Add(a, b)
            | Operation::Subtract(a, b)
            | Operation::Multiply(a, b)
            | Operation::MultiplySigned(a, b)
            | Operation::ShiftLeft(a, b)
            | Operation::ShiftRight(a, b)
            | Operation::Equal(a, b)
            | Operation::LessThan(a, b) => vec![*a, *b],
            Operation::Mux {
                select,
                when_one,
                when_zero,
            } => vec![*select, *when_one, *when_zero],
            Operation::Concat(parts) => parts.clone(),
            Operation::Register { next, enable, .. } => {
                next.iter().chain(enable).copied().collect()
            }
        }
    }

    /// The same operation on other wires: each wire it reads replaced by what `f` makes of it.
    pub fn map_operands(&self, mut f: impl FnMut(Wire) -> Wire) -> Operation {
        let mut mapped = self.clone();
        match &mut mapped {
            Operation::Input | Operation::Constant(_) | Operation::InstanceOutput { .. } => {}
            Operation::Not(a)
            | Operation::SignExtend(a)
            | Operation::AnyBit(a)
            | Operation::AllBits(a)
            | Operation::MemoryRead { address: a, .. }
            | Operation::Slice { from: a, .. } => *a = f(*a),
            Operation::And(a, b)
            | Operation::Or(a, b)
            | Operation::Xor(a, b)
            | Operation::Add(a, b)
            | Operation::Subtract(a, b)
            | Operation::Multiply(a, b)
            | Operation::MultiplySigned(a, b)
            | Operation::ShiftLeft(a, b)
            | Operation::ShiftRight(a, b)
            | Operation::Equal(a, b)
            | Operation::LessThan(a, b) => {
                *a = f(*a);
                *b = f(*b);
            }
            Operation::Mux {
                select,
                when_one,
                when_zero,
            } => {
                *select = f(*select);
                *when_one = f(*when_one);
                *when_zero = f(*when_zero);
            }
            Operation::Concat(parts) => parts.iter_mut().for_each(|part| *part = f(*part)),
            Operation::Register { next, enable, .. } => {
                next.iter_mut()
                    .chain(enable)
                    .for_each(|wire| *wire = f(*wire));
            }
        }
        mapped
    }
}

/// One node: an operation, the width of its result, and how people should see it.
#[derive(Clone, Debug)]
pub struct Node {
    /// What it computes.
    pub operation: Operation,
    /// Bits of the result, 1 to 64.
    pub width: u32,
    /// Its name in Verilog; nodes without one are printed inside the expressions that use them
    /// where the language allows it.
    pub name: Option<String>,
    /// The section of the module it stands in: an index into [`Module::sections`].
    pub section: usize,
    /// How its bits are meant, for waveforms.
    pub meaning: Meaning,
}

/// How the bits of a signal are meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Meaning {
    /// A bit vector.
    #[default]
    Bits,
    /// A two's complement integer.
    Signed,
    /// A float of this format.
    Float(rtl_model::float::FloatFormat),
    /// A fixed-point number of this format.
    Fixed(rtl_model::fixed::FixedFormat),
}

/// A constant with a name and the reason for its value, printed as a localparam.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Localparam {
    /// Upper case by convention.
    pub name: String,
    /// The value.
    pub value: u64,
    /// Why it has this value, printed beside it.
    pub reason: String,
}

/// A use of one module in another.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The instance's name.
    pub name: String,
    /// The module.
    pub module: Arc<Module>,
    /// One wire for every input of the module, in its order, without clock and reset.
    pub inputs: Vec<Wire>,
    /// The section it stands in; where it stands ahead of its inputs, that of its outputs.
    pub section: usize,
    /// Its inputs were connected later than its outputs were there, so that what follows from an
    /// output may lead back to it.
    pub ahead: bool,
}

/// Words that are read at any time and written on the rising edge of `clk_i`. What it holds at
/// first is not said: a design must work whatever it is.
#[derive(Clone, Debug)]
pub struct Memory {
    /// Its name in Verilog.
    pub name: String,
    /// How many words, a power of two.
    pub words: u32,
    /// Bits of a word, 1 to 64.
    pub width: u32,
    /// It is to be a block RAM, however small it is.
    pub in_block: bool,
    /// The section it is declared in.
    pub section: usize,
    /// Its write port; set by [`Builder::memory_write`].
    pub write: Option<MemoryWrite>,
}

/// The write port of a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryWrite {
    /// A word is written at the edge only where this bit is 1.
    pub enable: Wire,
    /// Where.
    pub address: Wire,
    /// What.
    pub data: Wire,
}

impl MemoryWrite {
    /// The wires it reads.
    pub fn operands(self) -> [Wire; 3] {
        [self.enable, self.address, self.data]
    }

    /// The same port on other wires.
    pub fn map_operands(self, mut f: impl FnMut(Wire) -> Wire) -> MemoryWrite {
        MemoryWrite {
            enable: f(self.enable),
            address: f(self.address),
            data: f(self.data),
        }
    }
}

/// A module: ports, nodes in the order they were built, instances.
#[derive(Clone, Debug, Default)]
pub struct Module {
    /// Name of the module and of its file.
    pub name: String,
    /// Lines of the header comment: format, rounding, latency, source function.
    pub description: Vec<String>,
    /// Cycles from an input to the outputs that depend on it; 0 for combinational logic.
    pub latency: u32,
    /// Named constants.
    pub localparams: Vec<Localparam>,
    /// Section titles in dataflow order; section 0 holds the ports.
    pub sections: Vec<String>,
    /// All nodes. A node's operands stand before it, except what a register takes.
    pub nodes: Vec<Node>,
    /// Input ports in order, without clock and reset.
    pub inputs: Vec<Wire>,
    /// Output ports in order: name and what drives it.
    pub outputs: Vec<(String, Wire)>,
    /// Memories.
    pub memories: Vec<Memory>,
    /// Instances of other modules.
    pub instances: Vec<Instance>,
}

impl Module {
    /// The node behind a wire.
    pub fn node(&self, wire: Wire) -> &Node {
        &self.nodes[wire.index()]
    }

    /// The width of a wire.
    pub fn width(&self, wire: Wire) -> u32 {
        self.node(wire).width
    }

    /// The memory of this handle.
    pub fn memory(&self, memory: MemoryId) -> &Memory {
        &self.memories[memory.index()]
    }

    /// Has it a register or a memory, its own or an instance's? Then it has the port `clk_i`.
    pub fn is_clocked(&self) -> bool {
        !self.memories.is_empty()
            || self
                .nodes
                .iter()
                .any(|node| matches!(node.operation, Operation::Register { .. }))
            || self
                .instances
                .iter()
                .any(|instance| instance.module.is_clocked())
    }

    /// Has it a register with a reset value, its own or an instance's? Then it has `rst_ni`.
    pub fn has_reset(&self) -> bool {
        let own =
            |node: &Node| matches!(node.operation, Operation::Register { reset: Some(_), .. });
        self.nodes.iter().any(own) || self.instances.iter().any(|i| i.module.has_reset())
    }

    /// The input port of this name.
    pub fn input(&self, name: &str) -> Option<Wire> {
        self.inputs
            .iter()
            .copied()
            .find(|&wire| self.node(wire).name.as_deref() == Some(name))
    }

    /// What drives the output port of this name.
    pub fn output(&self, name: &str) -> Option<Wire> {
        self.outputs
            .iter()
            .find(|(output, _)| output == name)
            .map(|&(_, wire)| wire)
    }

    /// This module and every module it uses, each once, users after what they use.
    pub fn hierarchy(self: &Arc<Module>) -> Vec<Arc<Module>> {
        fn visit(module: &Arc<Module>, seen: &mut Vec<Arc<Module>>) {
            for instance in &module.instances {
                visit(&instance.module, seen);
            }
            if !seen.iter().any(|other| other.name == module.name) {
                seen.push(module.clone());
            }
        }
        let mut seen = Vec::new();
        visit(self, &mut seen);
        seen
    }
}
