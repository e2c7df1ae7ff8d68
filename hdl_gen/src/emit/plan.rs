//! What is printed where: which nodes are live, which get a signal of their own and under which
//! name, which stand inside the expressions of their users, and which bits nothing reads.

use std::collections::{BTreeMap, HashSet};

use super::definition::select;
use super::expression::Expression;
use super::known::known_values;
use super::naming;
use super::shape::{Shape, live_nodes};
use crate::identifier::is_identifier;
use crate::netlist::{Module, Operation, Wire};

/// Operators an expression may hold before it gets a signal of its own.
const OPERATORS_INLINE: u32 = 3;
/// Columns such an expression may fill.
const COLUMNS_INLINE: usize = 64;

/// Nodes a name is looked for through.
const FARTHEST_READER: u32 = 6;

/// How the users of a node refer to it.
#[derive(Clone, Debug)]
pub(super) enum Reference {
    /// By the name of its signal.
    Signal(String),
    /// By some bits of another node's signal, from this bit up.
    Select { base: Wire, low: u32 },
    /// By its value.
    Literal(u64),
    /// By the expression itself.
    Inline(Expression),
}

/// A signal with its expression, or an instance, in the order they are printed in.
#[derive(Clone, Debug)]
pub(super) enum Item {
    Wire {
        wire: Wire,
        value: Expression,
    },
    /// The outputs of an instance that stands ahead of its inputs, which is printed later.
    Outputs(usize),
    Instance(usize),
}

/// Registers of a section that take their values under the same condition.
#[derive(Clone, Debug)]
pub(super) struct RegisterGroup {
    pub(super) enable: Option<Expression>,
    /// The register, its reset value, and what it takes.
    pub(super) registers: Vec<(Wire, Option<u64>, Expression)>,
}

/// A memory's write port.
#[derive(Clone, Debug)]
pub(super) struct WriteBlock {
    pub(super) memory: usize,
    /// None where it writes at every edge.
    pub(super) enable: Option<Expression>,
    pub(super) address: Expression,
    pub(super) data: Expression,
}

/// All that one section prints.
#[derive(Clone, Debug, Default)]
pub(super) struct Section {
    pub(super) registers: Vec<Wire>,
    /// Memories that are declared here.
    pub(super) memories: Vec<usize>,
    pub(super) writes: Vec<WriteBlock>,
    pub(super) items: Vec<Item>,
    pub(super) groups: Vec<RegisterGroup>,
}

/// The plan of a module's file.
pub(super) struct Plan<'m> {
    pub(super) module: &'m Module,
    pub(super) sections: Vec<Section>,
    /// By instance, what its ports are connected to: inputs, then the names on its outputs.
    pub(super) connections: Vec<Option<(Vec<Expression>, Vec<String>)>>,
    /// Wires for outputs of instances that nothing reads: instance, name and width.
    pub(super) unused_outputs: Vec<(usize, String, u32)>,
    /// What the outputs that are no signal's own port are assigned.
    pub(super) outputs: Vec<(String, Expression)>,
    live: Vec<bool>,
    pub(super) known: Vec<Option<u64>>,
    pub(super) references: Vec<Option<Reference>>,
    section_of: Vec<usize>,
    /// Bits of each signal that are read.
    pub(super) read: Vec<u64>,
    taken: HashSet<String>,
}

impl<'m> Plan<'m> {
    pub(super) fn new(module: &'m Module) -> Plan<'m> {
        let known = known_values(module);
        let live = live_nodes(module, &known);
        let count = module.nodes.len();
        let mut plan = Plan {
            module,
            sections: vec![Section::default(); module.sections.len()],
            connections: vec![None; module.instances.len()],
            unused_outputs: Vec::new(),
            outputs: Vec::new(),
            live,
            known,
            references: vec![None; count],
            section_of: module.nodes.iter().map(|node| node.section).collect(),
            read: vec![0; count],
            taken: naming::taken_names(module),
        };
        let shape = Shape::new(module, &plan.live, &plan.known);
        for index in 0..count {
            if plan.live[index] {
                plan.place(Wire(index as u32), &shape);
            }
        }
        plan.connect_ahead();
        plan.group_registers();
        plan.place_memories(&shape);
        plan.assign_outputs();
        plan
    }

    /// The name of a node's signal, if it has one.
    pub(super) fn signal(&self, wire: Wire) -> Option<&str> {
        match self.references[wire.index()].as_ref() {
            Some(Reference::Signal(name)) => Some(name),
            _ => None,
        }
    }

    /// Is this wire's signal one of the module's ports?
    pub(super) fn is_port(&self, wire: Wire) -> bool {
        let name = self.signal(wire);
        matches!(self.module.node(wire).operation, Operation::Input)
            || self
                .module
                .outputs
                .iter()
                .any(|(port, _)| Some(port.as_str()) == name)
    }

    /// Is a register with a reset, or without one, printed here, not in an instance? A memory
    /// counts as one without.
    pub(super) fn has_registers(&self, with_reset: bool) -> bool {
        if !with_reset
            && self
                .sections
                .iter()
                .any(|section| !section.writes.is_empty())
        {
            return true;
        }
        let groups = self.sections.iter().flat_map(|section| &section.groups);
        groups
            .flat_map(|group| &group.registers)
            .any(|(_, reset, _)| !with_reset || reset.is_some())
    }

    /// Does any expression read the node?
    pub(super) fn is_read(&self, wire: Wire) -> bool {
        self.read[wire.index()] != 0
    }

    /// A name nothing else has.
    pub(super) fn new_name(&mut self, wanted: &str) -> String {
        naming::unique(&mut self.taken, wanted.to_owned())
    }

    /// The bits of signals that nothing reads, as selects.
    pub(super) fn unread(&self) -> Vec<Expression> {
        let mut unread = Vec::new();
        for (index, node) in self.module.nodes.iter().enumerate() {
            let wire = Wire(index as u32);
            let input = matches!(node.operation, Operation::Input);
            let name = match (self.signal(wire), &node.name) {
                (Some(_), _) if self.is_port(wire) && !input => continue,
                (Some(_), _) if matches!(node.operation, Operation::Constant(_)) => continue,
                (Some(name), _) => name,
                (None, Some(name)) if input => name,
                _ => continue,
            };
            let mut high = node.width;
            while high > 0 {
                let read = |bit: u32| self.read[index] >> bit & 1 == 1;
                if read(high - 1) {
                    high -= 1;
                    continue;
                }
                let low = (0..high)
                    .rev()
                    .find(|&bit| read(bit))
                    .map_or(0, |bit| bit + 1);
                unread.push(select(name, node.width, low, high - low));
                high = low;
            }
        }
        unread
    }

    /// Gives a live node its reference; its operands have theirs.
    fn place(&mut self, wire: Wire, shape: &Shape) {
        let node = self.module.node(wire);
        let known = self.known[wire.index()];
        if let Operation::InstanceOutput { instance, .. } = node.operation {
            self.connect(instance, shape);
            return;
        }
        if !matches!(node.operation, Operation::Register { .. }) {
            self.stand_behind(wire, &node.operation.operands());
        }
        if let Operation::MemoryRead { memory, .. } = node.operation {
            let section = &mut self.section_of[wire.index()];
            *section = self.module.memory(memory).section.max(*section);
        }
        let section = self.section_of[wire.index()];
        let reference = match &node.operation {
            Operation::Input => Reference::Signal(node.name.clone().unwrap_or_default()),
            Operation::Constant(value) => match &node.name {
                Some(name) => Reference::Signal(name.clone()),
                None => Reference::Literal(*value),
            },
            _ if known.is_some() && node.name.is_none() => {
                Reference::Literal(known.unwrap_or_default())
            }
            Operation::Register { .. } => {
                self.sections[section].registers.push(wire);
                Reference::Signal(self.signal_name(wire, shape))
            }
            &Operation::Slice { from, low } if node.name.is_none() => self.slice(from, low, node),
            _ => {
                let value = self.definition(node, known);
                if self.stays_inline(wire, &value, shape) {
                    Reference::Inline(value)
                } else {
                    let name = self.signal_name(wire, shape);
                    self.sections[section]
                        .items
                        .push(Item::Wire { wire, value });
                    Reference::Signal(name)
                }
            }
        };
        self.references[wire.index()] = Some(reference);
    }

    /// Moves a node into the latest section of those it depends on, should it be told to stand
    /// in an earlier one: a signal is declared before it is read.
    fn stand_behind(&mut self, wire: Wire, operands: &[Wire]) {
        let sections = operands
            .iter()
            .map(|operand| self.section_of[operand.index()]);
        let latest = sections.max().unwrap_or_default();
        let section = &mut self.section_of[wire.index()];
        *section = latest.max(*section);
    }

    fn signal_name(&mut self, wire: Wire, shape: &Shape) -> String {
        if let Some(name) = &self.module.node(wire).name {
            return name.clone();
        }
        if let Some(&output) = shape.output_of.get(&wire) {
            return self.module.outputs[output].0.clone();
        }
        let register = shape.register_of.get(&wire);
        if let Some(name) = register.and_then(|&register| self.given_name(register, shape)) {
            let wanted = naming::next_of(name);
            return naming::unique(&mut self.taken, wanted);
        }
        let reader = self.named_reader(wire, shape);
        let names = |operand: Wire| self.short_name(operand);
        let wanted = naming::derived_name(self.module, wire, reader, names);
        naming::unique(&mut self.taken, wanted)
    }

    /// The name a node got from its builder, as a signal or as an output port.
    fn given_name(&self, wire: Wire, shape: &Shape) -> Option<&'m str> {
        let output = shape.output_of.get(&wire);
        let output = output.map(|&output| self.module.outputs[output].0.as_str());
        self.module.node(wire).name.as_deref().or(output)
    }

    /// The first named node on the way from a node through those that alone read it; and is it
    /// a slice right behind the node?
    fn named_reader(&self, wire: Wire, shape: &Shape) -> Option<(&'m str, bool)> {
        let mut reader = shape.only_user(wire)?;
        let slice = matches!(self.module.node(reader).operation, Operation::Slice { .. });
        if let (true, Some(name)) = (slice, self.given_name(reader, shape)) {
            return Some((name, true));
        }
        for _ in 0..FARTHEST_READER {
            if let Some(name) = self.given_name(reader, shape) {
                return Some((name, false));
            }
            reader = shape.only_user(reader)?;
        }
        None
    }

    /// A word for a node inside the name of another, where it has one.
    fn short_name(&self, wire: Wire) -> Option<String> {
        match self.references[wire.index()].as_ref()? {
            Reference::Signal(name) => Some(naming::without_suffix(name).to_lowercase()),
            Reference::Select { base, .. } => self.short_name(*base),
            Reference::Literal(value) => Some(value.to_string()),
            Reference::Inline(Expression::Unary("!" | "~", a)) => match &**a {
                Expression::Atom(name) if is_identifier(name) => {
                    Some(format!("not_{}", naming::without_suffix(name)))
                }
                _ => None,
            },
            // An extended word goes by the name of the word.
            Reference::Inline(_) => match &self.module.node(wire).operation {
                Operation::SignExtend(a) => self.short_name(*a),
                Operation::Concat(parts) => match parts[..] {
                    [zeros, a] if self.known[zeros.index()] == Some(0) => self.short_name(a),
                    _ => None,
                },
                _ => None,
            },
        }
    }

    /// May the expression stand where its node is used?
    fn stays_inline(&self, wire: Wire, value: &Expression, shape: &Shape) -> bool {
        let node = self.module.node(wire);
        if node.name.is_some()
            || shape.needs_signal.contains(&wire)
            || shape.output_of.contains_key(&wire)
        {
            return false;
        }
        if let Expression::Unary("!" | "~", a) = value {
            // `!valid` needs no second name, however often it is used.
            if matches!(**a, Expression::Atom(_)) {
                return true;
            }
        }
        if shape.uses[wire.index()] != 1 {
            return false;
        }
        if let (Expression::Choice(arms, _), Some(user)) = (value, shape.only_user(wire)) {
            let goes_on = matches!(self.module.node(user).operation,
                Operation::Mux { when_zero, when_one, select }
                    if when_zero == wire && when_one != wire && select != wire);
            if goes_on {
                return arms.len() < 12;
            }
        }
        operators(value) <= OPERATORS_INLINE && value.flat().len() <= COLUMNS_INLINE
    }

    /// Names the live outputs of an instance and connects it, at the first of them.
    fn connect(&mut self, instance: usize, shape: &Shape) {
        if self.connections[instance].is_some() {
            return;
        }
        let inner = &self.module.instances[instance];
        let outputs = &shape.instance_outputs[instance];
        if !inner.ahead {
            for &wire in outputs.values() {
                self.stand_behind(wire, &inner.inputs);
            }
        }
        let sections = outputs.values().map(|wire| self.section_of[wire.index()]);
        let section = sections.max().unwrap_or_default();
        let inputs = match inner.ahead {
            true => Vec::new(),
            false => self.instance_inputs(instance),
        };
        let mut names = Vec::new();
        for (output, (port, driver)) in inner.module.outputs.iter().enumerate() {
            let name = match outputs.get(&output) {
                Some(&wire) => {
                    let name = self.signal_name(wire, shape);
                    self.references[wire.index()] = Some(Reference::Signal(name.clone()));
                    self.section_of[wire.index()] = section;
                    name
                }
                None => {
                    let port = naming::without_suffix(port);
                    let wanted = format!("unused_{}_{port}", inner.name);
                    let name = naming::unique(&mut self.taken, wanted);
                    let width = inner.module.width(*driver);
                    self.unused_outputs.push((instance, name.clone(), width));
                    name
                }
            };
            names.push(name);
        }
        self.connections[instance] = Some((inputs, names));
        self.sections[section].items.push(match inner.ahead {
            true => Item::Outputs(instance),
            false => Item::Instance(instance),
        });
    }

    fn instance_inputs(&mut self, instance: usize) -> Vec<Expression> {
        let module = self.module;
        let inputs = module.instances[instance].inputs.iter();
        inputs.map(|&wire| self.operand(wire)).collect()
    }

    /// Connects the instances that stand ahead of their inputs, each behind the last of them.
    fn connect_ahead(&mut self) {
        for (instance, inner) in self.module.instances.iter().enumerate() {
            if !inner.ahead || self.connections[instance].is_none() {
                continue;
            }
            let sections = inner.inputs.iter();
            let sections = sections.map(|wire| self.section_of[wire.index()]);
            let section = sections.max().unwrap_or_default().max(inner.section);
            let inputs = self.instance_inputs(instance);
            if let Some((connected, _)) = &mut self.connections[instance] {
                *connected = inputs;
            }
            self.sections[section].items.push(Item::Instance(instance));
        }
    }

    /// Gathers the registers that share section and condition.
    fn group_registers(&mut self) {
        let mut groups: BTreeMap<(usize, Option<Wire>, bool), Vec<Wire>> = BTreeMap::new();
        for (index, node) in self.module.nodes.iter().enumerate() {
            let Operation::Register {
                next,
                enable,
                reset,
            } = &node.operation
            else {
                continue;
            };
            if !self.live[index] {
                continue;
            }
            // The block stands where all it reads has been declared.
            let read = next
                .iter()
                .chain(enable)
                .map(|wire| self.section_of[wire.index()]);
            let section = read.max().unwrap_or_default().max(self.section_of[index]);
            let key = (section, *enable, reset.is_none());
            groups.entry(key).or_default().push(Wire(index as u32));
        }
        for ((section, enable, _), wires) in groups {
            let enable = enable.map(|wire| self.operand(wire));
            let mut registers = Vec::new();
            for wire in wires {
                if let Operation::Register { next, reset, .. } = self.module.node(wire).operation {
                    let value = self.operand(next.unwrap_or(wire));
                    registers.push((wire, reset, value));
                }
            }
            self.sections[section]
                .groups
                .push(RegisterGroup { enable, registers });
        }
    }

    /// Declares the memories that are read, and gives each write port its block, behind all that
    /// the port reads.
    fn place_memories(&mut self, shape: &Shape) {
        for (place, memory) in self.module.memories.iter().enumerate() {
            let (true, Some(write)) = (shape.live_memories[place], memory.write) else {
                continue;
            };
            self.sections[memory.section].memories.push(place);
            let read = write.operands().map(|wire| self.section_of[wire.index()]);
            let latest = read.into_iter().max().unwrap_or_default();
            let always = self.known[write.enable.index()] == Some(1);
            let block = WriteBlock {
                memory: place,
                enable: (!always).then(|| self.operand(write.enable)),
                address: self.operand(write.address),
                data: self.operand(write.data),
            };
            self.sections[latest.max(memory.section)].writes.push(block);
        }
    }

    fn assign_outputs(&mut self) {
        for (name, wire) in &self.module.outputs {
            if self.signal(*wire) != Some(name) {
                let value = self.operand(*wire);
                self.outputs.push((name.clone(), value));
            }
        }
    }
}

/// How many operators an expression has; inverting a name is none.
fn operators(expression: &Expression) -> u32 {
    match expression {
        Expression::Atom(_) => 0,
        Expression::Unary(_, a) => operators(a) + u32::from(!matches!(**a, Expression::Atom(_))),
        Expression::Chain(_, operands) => {
            operands.len() as u32 - 1 + operands.iter().map(operators).sum::<u32>()
        }
        Expression::Choice(arms, otherwise) => {
            let inside = |(a, b): &(Expression, Expression)| 1 + operators(a) + operators(b);
            arms.iter().map(inside).sum::<u32>() + operators(otherwise)
        }
        Expression::Concat(parts) => parts.iter().map(operators).sum(),
        Expression::Replicate(_, a) => operators(a),
    }
}
