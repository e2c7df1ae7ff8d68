//! Writing the cut module: every stage's logic, and the registers between.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::ENABLE;
use super::delay::is_wiring;
use super::schedule::{Dataflow, Run, runs};
use crate::netlist::{Builder, Module, Operation, Wire};

/// Bits low..=high of a value, held in a register.
struct Piece {
    low: u32,
    high: u32,
    wire: Wire,
}

/// The module being written.
pub(super) struct Rebuild<'a> {
    module: &'a Module,
    dataflow: &'a Dataflow,
    stages: &'a [u32],
    latency: u32,
    builder: Builder,
    enable: Wire,
    /// Nodes in the stage they are computed in, and wiring in every stage it is used in.
    placed: HashMap<(usize, u32), Wire>,
    /// What is held of a node in a later stage.
    held: HashMap<(usize, u32), Vec<Piece>>,
    names: HashSet<String>,
}

impl<'a> Rebuild<'a> {
    /// Writes everything but what is added to the description.
    pub fn new(
        module: &'a Module,
        name: &str,
        dataflow: &'a Dataflow,
        stages: &'a [u32],
        latency: u32,
    ) -> Rebuild<'a> {
        let mut builder = Builder::new(name);
        for line in &module.description {
            builder.describe(line);
        }
        for localparam in &module.localparams {
            builder.localparam(&localparam.name, localparam.value, &localparam.reason);
        }
        builder.set_latency(latency);
        let enable = builder.input(ENABLE, 1);
        let mut placed = HashMap::new();
        for &input in &module.inputs {
            let node = module.node(input);
            let name = node.name.as_deref().expect("an input has a name");
            let wire = builder.input(name, node.width);
            builder.mean(wire, node.meaning);
            placed.insert((input.index(), 0), wire);
        }
        let names = module.nodes.iter().filter_map(|node| node.name.clone());
        let mut rebuild = Rebuild {
            names: names.collect(),
            module,
            dataflow,
            stages,
            latency,
            builder,
            enable,
            placed,
            held: HashMap::new(),
        };
        let ranges = dataflow.ranges_read(module, stages, latency);
        for stage in 0..latency {
            if stage > 0 {
                rebuild.registers_into(stage, &ranges);
            }
            rebuild.logic_of(stage);
        }
        rebuild.output_registers();
        rebuild
    }

    pub fn describe(&mut self, line: String) {
        self.builder.describe(line);
    }

    pub fn finish(self) -> Arc<Module> {
        self.builder.finish()
    }

    /// The registers between the stage before and this one.
    fn registers_into(&mut self, stage: u32, ranges: &[Vec<(u32, u32, u32)>]) {
        self.builder
            .section(format!("registers into stage {}", stage + 1));
        for (node, ranges) in ranges.iter().enumerate() {
            if self.stages[node] >= stage || is_wiring(&self.module.nodes[node].operation) {
                continue;
            }
            let needed = ranges.iter().filter(|range| range.0 >= stage);
            let mut needed: Vec<(u32, u32)> = needed.map(|&(_, low, high)| (low, high)).collect();
            needed.sort_unstable();
            let mut joined: Vec<(u32, u32)> = Vec::new();
            for (low, high) in needed {
                match joined.last_mut() {
                    Some(last) if low <= last.1 => last.1 = last.1.max(high),
                    _ => joined.push((low, high)),
                }
            }
            for (low, high) in joined {
                let value = self.bits(node, low, high, stage - 1);
                let wire = self.builder.registered(value, Some(self.enable), None);
                let name = format!("{}_s{}", self.piece_name(node, low, high), stage + 1);
                self.name(wire, name);
                if let Some(slice) = self.whole_or_slice(node, low, high) {
                    self.builder.mean(wire, self.module.nodes[slice].meaning);
                }
                let pieces = self.held.entry((node, stage)).or_default();
                pieces.push(Piece { low, high, wire });
            }
        }
    }

    /// The operations of one stage, under their sections' titles.
    fn logic_of(&mut self, stage: u32) {
        let mut section = None;
        for (index, node) in self.module.nodes.iter().enumerate() {
            let belongs = self.stages[index] == stage && !is_wiring(&node.operation);
            if !belongs || node.operation == Operation::Input {
                continue;
            }
            if section != Some(node.section) {
                section = Some(node.section);
                let title = &self.module.sections[node.section];
                self.builder
                    .section(format!("stage {}: {title}", stage + 1));
            }
            let operands = node.operation.operands();
            let mut operands = operands
                .into_iter()
                .map(|wire| self.word(wire, stage))
                .collect::<Vec<_>>()
                .into_iter();
            let operation = node
                .operation
                .map_operands(|_| operands.next().expect("one wire an operand"));
            let wire = self.builder.push(operation, node.width);
            self.builder.mean(wire, node.meaning);
            if let Some(name) = &node.name {
                self.builder.name(wire, name);
            }
            self.placed.insert((index, stage), wire);
        }
    }

    /// A register at every output, for the bits of it that are not constant.
    fn output_registers(&mut self) {
        self.builder.section("output registers");
        for (port, wire) in &self.module.outputs {
            let value = self.word(*wire, self.latency - 1);
            let mut low = 0;
            let mut kept = Vec::new(); // (low, width) of what is registered, the lowest first
            let mut layout = Vec::new(); // (low, width, is it constant), the lowest first
            for run in runs(&self.dataflow.source_bits[wire.index()]) {
                let (width, constant) = match run {
                    Run::Source { low, high, .. } => (high - low + 1, false),
                    Run::Constant { width } => (width, true),
                };
                if !constant {
                    kept.push((low, width));
                }
                layout.push((low, width, constant));
                low += width;
            }
            let mut result = value;
            if !kept.is_empty() {
                let whole = kept.iter().map(|&(_, width)| width).sum::<u32>() == low;
                let data = if whole {
                    value
                } else {
                    let parts: Vec<Wire> = kept
                        .iter()
                        .rev()
                        .map(|&(low, width)| self.builder.slice(value, low + width - 1, low))
                        .collect();
                    self.builder.concat(&parts)
                };
                let register = self.builder.registered(data, Some(self.enable), None);
                let base = port.strip_suffix("_o").unwrap_or(port);
                self.name(register, format!("{base}_registered"));
                result = register;
                if !whole {
                    let mut parts = Vec::new();
                    let mut next = 0;
                    for (low, width, constant) in layout {
                        let part = if constant {
                            self.builder.slice(value, low + width - 1, low)
                        } else {
                            next += width;
                            self.builder.slice(register, next - 1, next - width)
                        };
                        parts.push(part);
                    }
                    parts.reverse();
                    result = self.builder.concat(&parts);
                }
                self.builder.mean(result, self.module.node(*wire).meaning);
            }
            self.builder.output(port, result);
        }
    }

    /// A word of the original as it is to be read in a stage.
    fn word(&mut self, wire: Wire, stage: u32) -> Wire {
        let index = wire.index();
        let node = self.module.node(wire);
        if !is_wiring(&node.operation) {
            return self.bits(index, 0, node.width - 1, stage);
        }
        if let Some(&placed) = self.placed.get(&(index, stage)) {
            return placed;
        }
        let placed = match &node.operation {
            Operation::Constant(value) => self.builder.constant(*value, node.width),
            Operation::Concat(parts) => {
                let parts: Vec<Wire> = parts.iter().map(|&part| self.word(part, stage)).collect();
                self.builder.concat(&parts)
            }
            Operation::SignExtend(from) => {
                let from = self.word(*from, stage);
                self.builder.sign_extend(from, node.width)
            }
            // A slice: the source may be held in this stage only as far as it is read.
            Operation::Slice { from, low } => {
                let runs = runs(&self.dataflow.source_bits[index]);
                if let [Run::Source { node, low, high }] = runs[..] {
                    self.bits(node, low, high, stage)
                } else {
                    let from = self.word(*from, stage);
                    self.builder.slice(from, low + node.width - 1, *low)
                }
            }
            other => unreachable!("{other:?} is no wiring"),
        };
        if let Some(name) = &node.name {
            let is_first = (0..stage).all(|s| !self.placed.contains_key(&(index, s)));
            if is_first {
                self.builder_name_if_unnamed(placed, name.clone());
            } else {
                self.name(placed, format!("{name}_s{}", stage + 1));
            }
            self.builder.mean(placed, node.meaning);
        }
        self.placed.insert((index, stage), placed);
        placed
    }

    /// Bits of a computed value in a stage: from where it is computed, or from a register.
    fn bits(&mut self, node: usize, low: u32, high: u32, stage: u32) -> Wire {
        if self.stages[node] == stage {
            let wire = self.placed[&(node, stage)];
            return self.builder.slice(wire, high, low);
        }
        let piece = self.held[&(node, stage)]
            .iter()
            .find(|piece| piece.low <= low && high <= piece.high)
            .expect("what is read in a stage is held there");
        let (wire, base) = (piece.wire, piece.low);
        self.builder.slice(wire, high - base, low - base)
    }

    /// The node that is exactly these bits of a value: the value itself or a named slice of it.
    fn whole_or_slice(&self, node: usize, low: u32, high: u32) -> Option<usize> {
        if low == 0 && high + 1 == self.module.nodes[node].width {
            return Some(node);
        }
        let wanted = Run::Source { node, low, high };
        (0..self.module.nodes.len()).find(|&other| {
            let other_node = &self.module.nodes[other];
            other_node.name.is_some()
                && matches!(other_node.operation, Operation::Slice { .. })
                && runs(&self.dataflow.source_bits[other]) == [wanted]
        })
    }

    /// What a held value is called, without the stage.
    fn piece_name(&self, node: usize, low: u32, high: u32) -> String {
        let own_name = |index: usize| {
            let name = self.module.nodes[index].name.clone();
            name.unwrap_or_else(|| format!("value_{index}"))
        };
        match self.whole_or_slice(node, low, high) {
            Some(index) => own_name(index),
            None if low == high => format!("{}_{low}", own_name(node)),
            None => format!("{}_{high}_{low}", own_name(node)),
        }
    }

    /// Names a wire that the original does not have, unless it or the name is taken.
    fn name(&mut self, wire: Wire, name: String) {
        let unnamed = self.builder.module().node(wire).name.is_none();
        if unnamed && self.names.insert(name.clone()) {
            self.builder.name(wire, name);
        }
    }

    /// Gives a wire a name of the original, unless it has one already.
    fn builder_name_if_unnamed(&mut self, wire: Wire, name: String) {
        let module = self.builder.module();
        let taken = module
            .nodes
            .iter()
            .any(|node| node.name.as_deref() == Some(&name));
        if !taken {
            self.builder.name(wire, name);
        }
    }
}
