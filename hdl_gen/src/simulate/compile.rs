//! From the flat list of nodes to a program: live nodes only, constants folded into the memory,
//! equal steps computed once, steps ordered so that long runs share an opcode.

use std::collections::HashMap;

use super::flatten::Flat;
use super::program::{Opcode, Run, Step, execute};
use super::{SimulateError, low_bits};
use crate::netlist::Operation;

/// A word of the memory before its address is known.
type Word = u32;

/// What a word holds.
enum Content {
    Constant(u64),
    Input,
    /// An index into the registers.
    Register,
    /// An index into the steps.
    Result(u32),
}

/// A register by the words, later the addresses, that it reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Register {
    pub(super) own: u32,
    pub(super) next: u32,
    pub(super) enable: Option<u32>,
    pub(super) reset: Option<u64>,
}

/// The write port of a memory by the addresses that it reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct WritePort {
    /// Where the memory's words lie.
    pub(super) first: u32,
    pub(super) enable: u32,
    pub(super) address: u32,
    pub(super) data: u32,
}

/// The program, its memory as it stands before the first step, and where everything lies.
pub(super) struct Compiled {
    pub(super) memory: Vec<u64>,
    pub(super) runs: Vec<Run>,
    /// In the order of their addresses, which are consecutive; those without enable come first.
    pub(super) registers: Vec<Register>,
    /// Of the memories that are read.
    pub(super) write_ports: Vec<WritePort>,
    /// The address of every flat node asked for.
    pub(super) address_of: HashMap<u32, u32>,
}

/// Compiles what the `wanted` nodes depend on; `inputs` get a word whether used or not.
pub(super) fn compile(
    flat: &Flat,
    inputs: &[u32],
    wanted: &[u32],
) -> Result<Compiled, SimulateError> {
    let mut lowering = Lowering {
        flat,
        word_of: vec![None; flat.len()],
        contents: Vec::new(),
        constants: HashMap::new(),
        steps: Vec::new(),
        step_of: HashMap::new(),
        registers: Vec::new(),
        memories: Vec::new(),
    };
    for &input in inputs {
        lowering.visit(input)?;
    }
    for &node in wanted {
        lowering.visit(node)?;
    }
    // What a register takes, or a memory, may hold further registers and memories, which the
    // loop then reaches.
    let (mut registers, mut memories) = (0, 0);
    loop {
        if let Some(&(_, node)) = lowering.registers.get(registers) {
            let (operation, _, base) = flat.node(node);
            if let Operation::Register { next, enable, .. } = operation {
                for wire in next.iter().chain(enable) {
                    lowering.visit(base + wire.0)?;
                }
            }
            registers += 1;
        } else if let Some(&place) = lowering.memories.get(memories) {
            let (memory, base) = flat.memory(place);
            for wire in memory.write.iter().flat_map(|write| write.operands()) {
                lowering.visit(base + wire.0)?;
            }
            memories += 1;
        } else {
            break;
        }
    }
    lowering.lay_out(inputs, wanted)
}

struct Lowering<'a> {
    flat: &'a Flat,
    /// By flat node.
    word_of: Vec<Option<Word>>,
    contents: Vec<Content>,
    constants: HashMap<u64, Word>,
    /// Operands and results are words, not addresses yet.
    steps: Vec<(Opcode, Step)>,
    step_of: HashMap<(Opcode, Step), Word>,
    /// Word and flat node.
    registers: Vec<(Word, u32)>,
    /// Places of the memories that are read.
    memories: Vec<u32>,
}

impl Lowering<'_> {
    /// Gives a word to a node and to all it depends on, registers being where that ends.
    fn visit(&mut self, root: u32) -> Result<(), SimulateError> {
        enum Task {
            Enter(u32),
            Leave(u32),
        }
        let mut open = std::collections::HashSet::new();
        let mut tasks = vec![Task::Enter(self.flat.resolve(root)?)];
        while let Some(task) = tasks.pop() {
            match task {
                Task::Enter(node) => {
                    if self.word_of[node as usize].is_some() {
                        continue;
                    }
                    if !open.insert(node) {
                        return Err(self.flat.combinational_loop(node));
                    }
                    tasks.push(Task::Leave(node));
                    let (operation, _, base) = self.flat.node(node);
                    if !matches!(operation, Operation::Register { .. }) {
                        for wire in operation.operands() {
                            tasks.push(Task::Enter(self.flat.resolve(base + wire.0)?));
                        }
                    }
                }
                Task::Leave(node) => {
                    open.remove(&node);
                    self.word_of[node as usize] = Some(self.lower(node)?);
                }
            }
        }
        Ok(())
    }

    fn add_word(&mut self, content: Content) -> Word {
        self.contents.push(content);
        (self.contents.len() - 1) as Word
    }

    fn constant(&mut self, value: u64) -> Word {
        if let Some(&word) = self.constants.get(&value) {
            return word;
        }
        let word = self.add_word(Content::Constant(value));
        self.constants.insert(value, word);
        word
    }

    fn is_zero(&self, word: Word) -> bool {
        matches!(self.contents[word as usize], Content::Constant(0))
    }

    fn step(&mut self, opcode: Opcode, operands: &[Word], mask: u64, shift: u32) -> Word {
        let mut step = Step {
            mask,
            shift,
            ..Step::default()
        };
        step.operands[..operands.len()].copy_from_slice(operands);
        let constants: Vec<u64> = operands
            .iter()
            .filter_map(|&word| match self.contents[word as usize] {
                Content::Constant(value) => Some(value),
                _ => None,
            })
            .collect();
        // What a memory holds is no constant, wherever it is read.
        if constants.len() == operands.len() && opcode != Opcode::MemoryRead {
            // Folded by the interpreter itself, so that there is one meaning of an opcode.
            let mut memory = [0; 4];
            memory[..constants.len()].copy_from_slice(&constants);
            let alone = Step {
                operands: [0, 1, 2],
                result: 3,
                ..step
            };
            execute(opcode, &[alone], &mut memory);
            return self.constant(memory[3]);
        }
        if let Some(&word) = self.step_of.get(&(opcode, step)) {
            return word;
        }
        let word = self.add_word(Content::Result(self.steps.len() as u32));
        self.step_of.insert((opcode, step), word);
        step.result = word;
        self.steps.push((opcode, step));
        word
    }

    /// The word of a node whose operands have theirs.
    fn lower(&mut self, node: u32) -> Result<Word, SimulateError> {
        let flat = self.flat;
        let (operation, width, base) = flat.node(node);
        let mask = low_bits(width);
        let mut words = Vec::new();
        if !matches!(operation, Operation::Register { .. }) {
            for wire in operation.operands() {
                let operand = flat.resolve(base + wire.0)?;
                match self.word_of[operand as usize] {
                    Some(word) => words.push(word),
                    None => return Err(flat.combinational_loop(operand)),
                }
            }
        }
        let opcode = match operation {
            Operation::Input => return Ok(self.add_word(Content::Input)),
            Operation::Constant(value) => return Ok(self.constant(*value)),
            Operation::Register { .. } => {
                let word = self.add_word(Content::Register);
                self.registers.push((word, node));
                return Ok(word);
            }
            Operation::Concat(parts) => {
                let mut joined = words[0];
                for (&word, &wire) in words.iter().zip(parts).skip(1) {
                    joined = if self.is_zero(joined) {
                        // Zeros in front cost nothing: a word is as good as its extension.
                        word
                    } else {
                        let shift = flat.width(base, wire);
                        self.step(Opcode::Join, &[joined, word], 0, shift)
                    };
                }
                return Ok(joined);
            }
            Operation::Slice { low, .. } => {
                return Ok(self.step(Opcode::Slice, &words, mask, *low));
            }
            Operation::SignExtend(from) => {
                let sign = flat.width(base, *from) - 1;
                return Ok(self.step(Opcode::SignExtend, &words, mask, sign));
            }
            Operation::MultiplySigned(a, b) => {
                // The low bits of a product are those of the words extended by their signs.
                let sides = [(a, words[0]), (b, words[1])].map(|(wire, word)| {
                    let sign = flat.width(base, *wire) - 1;
                    self.step(Opcode::SignExtend, &[word], mask, sign)
                });
                let product = self.step(Opcode::Multiply, &sides, mask, 0);
                return Ok(self.step(Opcode::Slice, &[product], mask, 0));
            }
            Operation::AllBits(from) => {
                let all = low_bits(flat.width(base, *from));
                return Ok(self.step(Opcode::AllBits, &words, all, 0));
            }
            Operation::MemoryRead { memory, .. } => {
                let place = flat.memory_place(node, *memory);
                if !self.memories.contains(&place) {
                    self.memories.push(place);
                }
                // The address of its first word is not known before all are laid out.
                return Ok(self.step(Opcode::MemoryRead, &words, place.into(), 0));
            }
            Operation::InstanceOutput { .. } => return Err(flat.combinational_loop(node)),
            Operation::Not(..) => Opcode::Not,
            Operation::And(..) => Opcode::And,
            Operation::Or(..) => Opcode::Or,
            Operation::Xor(..) => Opcode::Xor,
            Operation::Add(..) => Opcode::Add,
            Operation::Subtract(..) => Opcode::Subtract,
            Operation::Multiply(..) => Opcode::Multiply,
            Operation::ShiftLeft(..) => Opcode::ShiftLeft,
            Operation::ShiftRight(..) => Opcode::ShiftRight,
            Operation::Equal(..) => Opcode::Equal,
            Operation::LessThan(..) => Opcode::LessThan,
            Operation::Mux { .. } => Opcode::Mux,
            Operation::AnyBit(..) => Opcode::AnyBit,
        };
        Ok(self.step(opcode, &words, mask, 0))
    }

    /// Addresses: constants, inputs, registers, then the results in the order of execution, then
    /// the words of the memories.
    fn lay_out(self, inputs: &[u32], wanted: &[u32]) -> Result<Compiled, SimulateError> {
        let word_of = |base: u32, wire: crate::netlist::Wire| {
            let node = self.flat.resolve(base + wire.0)?;
            self.word_of[node as usize].ok_or_else(|| self.flat.combinational_loop(node))
        };
        let mut registers = Vec::new();
        for &(own, node) in &self.registers {
            let (operation, _, base) = self.flat.node(node);
            if let Operation::Register {
                next,
                enable,
                reset,
            } = operation
            {
                registers.push(Register {
                    own,
                    next: next.map_or(Ok(own), |wire| word_of(base, wire))?,
                    enable: enable.map(|wire| word_of(base, wire)).transpose()?,
                    reset: *reset,
                });
            }
        }
        registers.sort_by_key(|register| register.enable.is_some());

        let order = schedule(&self.contents, &self.steps);
        let mut memory = Vec::with_capacity(self.contents.len());
        let mut address = vec![0; self.contents.len()];
        for (word, content) in self.contents.iter().enumerate() {
            let start = match content {
                Content::Constant(value) => *value,
                Content::Input => 0,
                _ => continue,
            };
            address[word] = memory.len() as u32;
            memory.push(start);
        }
        for register in &registers {
            address[register.own as usize] = memory.len() as u32;
            memory.push(0);
        }
        for &step in &order {
            address[self.steps[step].1.result as usize] = memory.len() as u32;
            memory.push(0);
        }

        let mut first_word = HashMap::new();
        let mut write_ports = Vec::new();
        for &place in &self.memories {
            let (contents, base) = self.flat.memory(place);
            let first = memory.len() as u32;
            first_word.insert(u64::from(place), u64::from(first));
            memory.resize(memory.len() + contents.words as usize, 0);
            if let Some(write) = contents.write {
                let at = |wire| Ok(address[word_of(base, wire)? as usize]);
                write_ports.push(WritePort {
                    first,
                    enable: at(write.enable)?,
                    address: at(write.address)?,
                    data: at(write.data)?,
                });
            }
        }

        let mut runs: Vec<Run> = Vec::new();
        for &step in &order {
            let (opcode, mut step) = self.steps[step];
            if opcode == Opcode::MemoryRead {
                step.mask = first_word[&step.mask];
            }
            for operand in &mut step.operands[..opcode.operands()] {
                *operand = address[*operand as usize];
            }
            step.result = address[step.result as usize];
            match runs.last_mut() {
                Some(run) if run.opcode == opcode => run.steps.push(step),
                _ => runs.push(Run {
                    opcode,
                    steps: vec![step],
                }),
            }
        }
        for register in &mut registers {
            register.own = address[register.own as usize];
            register.next = address[register.next as usize];
            register.enable = register.enable.map(|word| address[word as usize]);
        }
        let mut address_of = HashMap::new();
        for &node in inputs.iter().chain(wanted) {
            let resolved = self.flat.resolve(node)?;
            let word = self.word_of[resolved as usize]
                .ok_or_else(|| self.flat.combinational_loop(resolved))?;
            address_of.insert(node, address[word as usize]);
        }
        Ok(Compiled {
            memory,
            runs,
            registers,
            write_ports,
            address_of,
        })
    }
}

/// An order of the steps in which each stands behind those it reads: again and again all that is
/// ready of the opcode with most ready steps, so that runs are long and dispatches few.
fn schedule(contents: &[Content], steps: &[(Opcode, Step)]) -> Vec<usize> {
    let mut users: Vec<Vec<usize>> = vec![Vec::new(); steps.len()];
    let mut waiting_for = vec![0; steps.len()];
    let mut ready: Vec<Vec<usize>> = vec![Vec::new(); Opcode::COUNT];
    for (index, (opcode, step)) in steps.iter().enumerate() {
        for &operand in &step.operands[..opcode.operands()] {
            if let Content::Result(producer) = contents[operand as usize] {
                users[producer as usize].push(index);
                waiting_for[index] += 1;
            }
        }
        if waiting_for[index] == 0 {
            ready[*opcode as usize].push(index);
        }
    }
    let mut order = Vec::with_capacity(steps.len());
    loop {
        let opcode = (0..Opcode::COUNT)
            .max_by_key(|&opcode| ready[opcode].len())
            .unwrap_or_default();
        if ready[opcode].is_empty() {
            return order;
        }
        while let Some(step) = ready[opcode].pop() {
            order.push(step);
            for &user in &users[step] {
                waiting_for[user] -= 1;
                if waiting_for[user] == 0 {
                    ready[steps[user].0 as usize].push(user);
                }
            }
        }
    }
}
