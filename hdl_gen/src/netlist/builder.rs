//! Builds modules node by node.

use std::sync::Arc;

use super::{
    Instance, Localparam, Meaning, Memory, MemoryId, MemoryWrite, Module, Node, Operation, Wire,
};
use crate::identifier::is_identifier;

/// An instance whose inputs are still to be connected.
#[derive(Debug)]
pub struct InstanceAhead(usize);

/// Builds a [`Module`] node by node, checking every width.
#[derive(Debug)]
pub struct Builder {
    module: Module,
}

impl Builder {
    /// An empty module of this name.
    pub fn new(name: impl Into<String>) -> Builder {
        Builder {
            module: Module {
                name: name.into(),
                sections: vec!["ports".to_owned()],
                ..Module::default()
            },
        }
    }

    /// Adds a line to the header comment.
    pub fn describe(&mut self, line: impl Into<String>) {
        self.module.description.push(line.into());
    }

    /// States the module's latency in cycles.
    pub fn set_latency(&mut self, cycles: u32) {
        self.module.latency = cycles;
    }

    /// A named constant with its reason; returns its value, for use in widths.
    pub fn localparam(&mut self, name: &str, value: u64, reason: &str) -> u64 {
        self.module.localparams.push(Localparam {
            name: name.to_owned(),
            value,
            reason: reason.to_owned(),
        });
        value
    }

    /// Opens a section: the nodes built from here on stand under this title.
    pub fn section(&mut self, title: impl Into<String>) {
        self.module.sections.push(title.into());
    }

    /// A node of any operation, for passes that rebuild a module: the widths are the caller's care.
    pub(crate) fn push(&mut self, operation: Operation, width: u32) -> Wire {
        assert!(
            (1..=64).contains(&width),
            "{}: a width of {width} bits",
            self.module.name
        );
        let section = self.module.sections.len() - 1;
        let wire = Wire(u32::try_from(self.module.nodes.len()).expect("fewer than 2^32 nodes"));
        self.module.nodes.push(Node {
            operation,
            width,
            name: None,
            section,
            meaning: Meaning::Bits,
        });
        wire
    }

    /// The width of a wire built so far.
    pub fn width(&self, wire: Wire) -> u32 {
        self.module.width(wire)
    }

    /// The module as built so far.
    pub fn module(&self) -> &Module {
        &self.module
    }

    fn same_width(&self, a: Wire, b: Wire) -> u32 {
        let (wa, wb) = (self.width(a), self.width(b));
        assert_eq!(wa, wb, "{}: operands of different widths", self.module.name);
        wa
    }

    /// Names a wire. The first name a wire gets is kept; names are unique in a module.
    pub fn name(&mut self, wire: Wire, name: impl Into<String>) -> Wire {
        let name = name.into();
        if self.module.node(wire).name.is_none() {
            assert!(
                !self
                    .module
                    .nodes
                    .iter()
                    .any(|node| node.name.as_deref() == Some(&name)),
                "{}: two signals named {name}",
                self.module.name
            );
            self.module.nodes[wire.index()].name = Some(name);
        }
        wire
    }

    /// Says how a wire's bits are meant.
    pub fn mean(&mut self, wire: Wire, meaning: Meaning) -> Wire {
        self.module.nodes[wire.index()].meaning = meaning;
        wire
    }

    /// An input port.
    pub fn input(&mut self, name: &str, width: u32) -> Wire {
        let wire = self.push(Operation::Input, width);
        self.module.nodes[wire.index()].section = 0;
        self.module.inputs.push(wire);
        self.name(wire, name)
    }

    /// An output port, driven by a wire.
    pub fn output(&mut self, name: &str, wire: Wire) {
        assert!(
            !self.module.outputs.iter().any(|(other, _)| other == name),
            "{}: two outputs named {name}",
            self.module.name
        );
        self.module.outputs.push((name.to_owned(), wire));
    }

    /// A constant of a width.
    pub fn constant(&mut self, value: u64, width: u32) -> Wire {
        assert!(
            width == 64 || value >> width == 0,
            "{}: {value} in {width} bits",
            self.module.name
        );
        self.push(Operation::Constant(value), width)
    }

    /// Every bit inverted.
    pub fn not(&mut self, a: Wire) -> Wire {
        self.push(Operation::Not(a), self.width(a))
    }

    /// Bitwise and.
    pub fn and(&mut self, a: Wire, b: Wire) -> Wire {
        let width = self.same_width(a, b);
        self.push(Operation::And(a, b), width)
    }

    /// Bitwise or.
    pub fn or(&mut self, a: Wire, b: Wire) -> Wire {
        let width = self.same_width(a, b);
        self.push(Operation::Or(a, b), width)
    }

    /// Bitwise exclusive or.
    pub fn xor(&mut self, a: Wire, b: Wire) -> Wire {
        let width = self.same_width(a, b);
        self.push(Operation::Xor(a, b), width)
    }

    /// Sum modulo 2^width.
    pub fn add(&mut self, a: Wire, b: Wire) -> Wire {
        let width = self.same_width(a, b);
        self.push(Operation::Add(a, b), width)
    }

    /// Difference modulo 2^width.
    pub fn subtract(&mut self, a: Wire, b: Wire) -> Wire {
        let width = self.same_width(a, b);
        self.push(Operation::Subtract(a, b), width)
    }

    /// Full product.
    pub fn multiply(&mut self, a: Wire, b: Wire) -> Wire {
        let width = self.width(a) + self.width(b);
        self.push(Operation::Multiply(a, b), width)
    }

    /// Full product of two's complement words.
    pub fn multiply_signed(&mut self, a: Wire, b: Wire) -> Wire {
        let width = self.width(a) + self.width(b);
        self.push(Operation::MultiplySigned(a, b), width)
    }

    /// `a << amount`, in the width of `a`.
    pub fn shift_left(&mut self, a: Wire, amount: Wire) -> Wire {
        self.push(Operation::ShiftLeft(a, amount), self.width(a))
    }

    /// `a >> amount`, in the width of `a`.
    pub fn shift_right(&mut self, a: Wire, amount: Wire) -> Wire {
        self.push(Operation::ShiftRight(a, amount), self.width(a))
    }

    /// One bit: `a == b`.
    pub fn equal(&mut self, a: Wire, b: Wire) -> Wire {
        self.same_width(a, b);
        self.push(Operation::Equal(a, b), 1)
    }

    /// One bit: `a < b`, both unsigned.
    pub fn less_than(&mut self, a: Wire, b: Wire) -> Wire {
        self.same_width(a, b);
        self.push(Operation::LessThan(a, b), 1)
    }

    /// `when_one` where `select` is 1, else `when_zero`.
    pub fn mux(&mut self, select: Wire, when_one: Wire, when_zero: Wire) -> Wire {
        assert_eq!(
            self.width(select),
            1,
            "{}: a select of several bits",
            self.module.name
        );
        let width = self.same_width(when_one, when_zero);
        self.push(
            Operation::Mux {
                select,
                when_one,
                when_zero,
            },
            width,
        )
    }

    /// Words side by side, the first at the most significant end.
    pub fn concat(&mut self, words: &[Wire]) -> Wire {
        if let [only] = words {
            return *only;
        }
        let width = words.iter().map(|&word| self.width(word)).sum();
        self.push(Operation::Concat(words.to_vec()), width)
    }

    /// Bits `low` to `high`, both included.
    pub fn slice(&mut self, from: Wire, high: u32, low: u32) -> Wire {
        assert!(
            low <= high && high < self.width(from),
            "{}: bits {high}:{low} of {}",
            self.module.name,
            self.width(from)
        );
        if low == 0 && high + 1 == self.width(from) {
            return from;
        }
        self.push(Operation::Slice { from, low }, high - low + 1)
    }

    /// One bit of a word.
    pub fn bit(&mut self, from: Wire, index: u32) -> Wire {
        self.slice(from, index, index)
    }

    /// The word with zeros in front.
    pub fn zero_extend(&mut self, a: Wire, width: u32) -> Wire {
        let own = self.width(a);
        assert!(
            width >= own,
            "{}: {own} bits extended to {width}",
            self.module.name
        );
        if width == own {
            return a;
        }
        let zeros = self.constant(0, width - own);
        self.concat(&[zeros, a])
    }

    /// The word with its most significant bit repeated in front.
    pub fn sign_extend(&mut self, a: Wire, width: u32) -> Wire {
        let own = self.width(a);
        assert!(
            width >= own,
            "{}: {own} bits extended to {width}",
            self.module.name
        );
        if width == own {
            return a;
        }
        self.push(Operation::SignExtend(a), width)
    }

    /// One bit: is any bit 1?
    pub fn any_bit(&mut self, a: Wire) -> Wire {
        if self.width(a) == 1 {
            return a;
        }
        self.push(Operation::AnyBit(a), 1)
    }

    /// One bit: are all bits 1?
    pub fn all_bits(&mut self, a: Wire) -> Wire {
        if self.width(a) == 1 {
            return a;
        }
        self.push(Operation::AllBits(a), 1)
    }

    /// A register whose input is connected later, so that loops can be built.
    pub fn register(&mut self, width: u32, enable: Option<Wire>, reset: Option<u64>) -> Wire {
        if let Some(enable) = enable {
            assert_eq!(
                self.width(enable),
                1,
                "{}: an enable of several bits",
                self.module.name
            );
        }
        self.push(
            Operation::Register {
                next: None,
                enable,
                reset,
            },
            width,
        )
    }

    /// Says what a register takes at the clock edge.
    pub fn connect(&mut self, register: Wire, value: Wire) {
        self.same_width(register, value);
        match &mut self.module.nodes[register.index()].operation {
            Operation::Register {
                next: next @ None, ..
            } => *next = Some(value),
            _ => panic!("{}: connect of no open register", self.module.name),
        }
    }

    /// Says what a register that was built without an enable takes at the clock edge, and by
    /// which bit it is enabled.
    pub fn connect_enabled(&mut self, register: Wire, value: Wire, enable: Wire) {
        assert_eq!(self.width(enable), 1, "{}: an enable", self.module.name);
        self.connect(register, value);
        match &mut self.module.nodes[register.index()].operation {
            Operation::Register {
                enable: own @ None, ..
            } => *own = Some(enable),
            _ => panic!("{}: a register enabled by two", self.module.name),
        }
    }

    /// A register that takes `value` at every enabled edge.
    pub fn registered(&mut self, value: Wire, enable: Option<Wire>, reset: Option<u64>) -> Wire {
        let register = self.register(self.width(value), enable, reset);
        self.connect(register, value);
        register
    }

    /// A memory of `words` words, to be written by [`memory_write`](Builder::memory_write).
    ///
    /// # Panics
    /// If `words` is no power of two from 2 up, or a word has not 1 to 64 bits.
    pub fn memory(&mut self, name: &str, words: u32, width: u32) -> MemoryId {
        assert!(
            words >= 2 && words.is_power_of_two() && (1..=64).contains(&width),
            "{}: memory {name} of {words} words of {width} bits",
            self.module.name
        );
        let memory = u32::try_from(self.module.memories.len()).expect("few memories");
        self.module.memories.push(Memory {
            name: name.to_owned(),
            words,
            width,
            in_block: false,
            section: self.module.sections.len() - 1,
            write: None,
        });
        MemoryId(memory)
    }

    /// The memory is to be a block RAM, however small it is: its reads are all taken by registers.
    /// Synthesis takes it for one only if it sees that no word is read and written at one edge.
    pub fn memory_in_block(&mut self, memory: MemoryId) {
        self.module.memories[memory.index()].in_block = true;
    }

    fn check_address(&self, memory: MemoryId, address: Wire) {
        let memory = self.module.memory(memory);
        assert_eq!(
            self.width(address),
            memory.words.trailing_zeros(),
            "{}: an address of memory {}",
            self.module.name,
            memory.name
        );
    }

    /// The word at an address, within the cycle: what was written at edges before this cycle. A
    /// memory is read at as many addresses as there are calls. A register that takes the word and
    /// nothing else is what synthesis makes a block RAM of.
    pub fn memory_read(&mut self, memory: MemoryId, address: Wire) -> Wire {
        self.check_address(memory, address);
        let width = self.module.memory(memory).width;
        self.push(Operation::MemoryRead { memory, address }, width)
    }

    /// The memory's write port: `data` goes to `address` at every edge at which `enable` is 1.
    ///
    /// # Panics
    /// If the memory has one already, or a width is wrong.
    pub fn memory_write(&mut self, memory: MemoryId, enable: Wire, address: Wire, data: Wire) {
        self.check_address(memory, address);
        let name = self.module.memory(memory).name.clone();
        assert!(
            self.width(enable) == 1 && self.width(data) == self.module.memory(memory).width,
            "{}: widths of the write port of memory {name}",
            self.module.name
        );
        let write = MemoryWrite {
            enable,
            address,
            data,
        };
        let port = &mut self.module.memories[memory.index()].write;
        assert!(port.is_none(), "memory {name} is written by two");
        *port = Some(write);
    }

    /// An instance of another module; returns its outputs in order.
    pub fn instance(&mut self, name: &str, module: &Arc<Module>, inputs: &[Wire]) -> Vec<Wire> {
        let outputs = self.new_instance(name, module, false);
        self.connect_inputs(self.module.instances.len() - 1, inputs);
        outputs
    }

    /// An instance whose inputs are connected later ([`Builder::connect_instance`]), so that what
    /// follows from its outputs may lead back to it: a block whose outputs come from registers, or
    /// at least not from that input. Returns its outputs in order.
    pub fn instance_ahead(
        &mut self,
        name: &str,
        module: &Arc<Module>,
    ) -> (InstanceAhead, Vec<Wire>) {
        let outputs = self.new_instance(name, module, true);
        (InstanceAhead(self.module.instances.len() - 1), outputs)
    }

    /// Connects the inputs of an instance that stands ahead of them.
    ///
    /// # Panics
    /// If their number or a width is wrong.
    pub fn connect_instance(&mut self, instance: InstanceAhead, inputs: &[Wire]) {
        self.connect_inputs(instance.0, inputs);
    }

    fn connect_inputs(&mut self, instance: usize, inputs: &[Wire]) {
        let name = self.module.instances[instance].name.clone();
        let module = self.module.instances[instance].module.clone();
        assert_eq!(
            inputs.len(),
            module.inputs.len(),
            "{name}: one wire an input"
        );
        for (&wire, &port) in inputs.iter().zip(&module.inputs) {
            assert_eq!(
                self.width(wire),
                module.width(port),
                "{name}: port {}",
                module.node(port).name.as_deref().unwrap_or("?")
            );
        }
        self.module.instances[instance].inputs = inputs.to_vec();
    }

    fn new_instance(&mut self, name: &str, module: &Arc<Module>, ahead: bool) -> Vec<Wire> {
        let instance = self.module.instances.len();
        self.module.instances.push(Instance {
            name: name.to_owned(),
            module: module.clone(),
            inputs: Vec::new(),
            section: self.module.sections.len() - 1,
            ahead,
        });
        (0..module.outputs.len())
            .map(|output| {
                let width = module.width(module.outputs[output].1);
                self.push(Operation::InstanceOutput { instance, output }, width)
            })
            .collect()
    }

    /// Signals, ports and instances of a module share one space of names with its clock and reset;
    /// an output may have the name of the signal that drives it.
    fn check_names(&self) {
        let module = &self.module;
        let mut seen = std::collections::HashSet::from(["clk_i", "rst_ni"]);
        let check = |name: &str| {
            assert!(
                is_identifier(name),
                "{}: `{name}` is no name in Verilog",
                module.name
            );
        };
        check(&module.name);
        let signals = module.nodes.iter().filter_map(|node| node.name.as_deref());
        let instances = module.instances.iter().map(|other| other.name.as_str());
        let outputs = module.outputs.iter().filter_map(|(name, driver)| {
            let own = module.node(*driver).name.as_ref() == Some(name);
            (!own).then_some(name.as_str())
        });
        let memories = module.memories.iter().map(|memory| memory.name.as_str());
        for name in signals.chain(instances).chain(outputs).chain(memories) {
            check(name);
            assert!(
                seen.insert(name),
                "{}: `{name}` names two things",
                module.name
            );
        }
    }

    /// The finished module.
    ///
    /// # Panics
    /// If a register was never connected, a memory is never written, or a name is none in Verilog
    /// or stands for two things.
    pub fn finish(self) -> Arc<Module> {
        self.check_names();
        for node in &self.module.nodes {
            if let Operation::Register { next: None, .. } = node.operation {
                panic!("{}: a register that takes nothing", self.module.name);
            }
        }
        for memory in &self.module.memories {
            let (module, name) = (&self.module.name, &memory.name);
            assert!(memory.write.is_some(), "{module}: nothing writes {name}");
        }
        for instance in &self.module.instances {
            assert!(
                instance.inputs.len() == instance.module.inputs.len(),
                "{}: instance {} was never connected",
                self.module.name,
                instance.name
            );
        }
        Arc::new(self.module)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(signal: &str, output: &str) -> Arc<Module> {
        let mut b = Builder::new("named");
        let a = b.input("a_i", 2);
        let inverted = b.not(a);
        b.name(inverted, signal);
        b.output(output, a);
        b.output("same_o", inverted);
        b.finish()
    }

    #[test]
    fn an_output_may_be_named_as_its_driver() {
        assert_eq!(named("same_o", "y_o").outputs.len(), 2);
    }

    #[test]
    #[should_panic(expected = "names two things")]
    fn an_output_may_not_be_named_as_another_signal() {
        named("inverted", "inverted");
    }

    #[test]
    #[should_panic(expected = "names two things")]
    fn the_clock_is_taken() {
        named("clk_i", "y_o");
    }

    #[test]
    #[should_panic(expected = "no name in Verilog")]
    fn a_word_of_the_language_is_no_name() {
        named("signed", "y_o");
    }
}
