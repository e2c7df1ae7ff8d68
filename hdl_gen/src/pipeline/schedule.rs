//! Which stage each operation stands in: stages as short as can be, then registers as few.

use super::delay::{Delay, delay, is_wiring, longest_path};
use crate::netlist::{Module, Operation, Wire};

/// Where a bit comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SourceBit {
    /// A bit of the result of a node that computes, or of an input.
    Computed { node: usize, bit: u32 },
    /// It is constant.
    Constant(bool),
}

/// A combinational module seen through its wiring: slices, joins and constants resolved to the
/// bits of the operations behind them.
pub(super) struct Dataflow {
    /// For every node, where its bits come from, the lowest first; its own where it computes.
    pub source_bits: Vec<Vec<SourceBit>>,
    /// For every node that computes, what it reads: node and mask of bits.
    reads: Vec<Vec<(usize, u64)>>,
    /// What the outputs read.
    output_reads: Vec<(usize, u64)>,
    delays: Vec<Delay>,
    computes: Vec<bool>,
    is_input: Vec<bool>,
    longest_path: Delay,
}

impl Dataflow {
    pub fn new(module: &Module) -> Dataflow {
        let mut source_bits: Vec<Vec<SourceBit>> = Vec::with_capacity(module.nodes.len());
        for (index, node) in module.nodes.iter().enumerate() {
            let bits = match &node.operation {
                Operation::Constant(value) => (0..node.width)
                    .map(|bit| SourceBit::Constant(value >> bit & 1 == 1))
                    .collect(),
                Operation::Slice { from, low } => {
                    source_bits[from.index()][*low as usize..][..node.width as usize].to_vec()
                }
                Operation::Concat(parts) => parts
                    .iter()
                    .rev()
                    .flat_map(|part| source_bits[part.index()].iter().copied())
                    .collect(),
                Operation::SignExtend(from) => {
                    let mut bits = source_bits[from.index()].clone();
                    let sign = *bits.last().expect("a word has bits");
                    bits.resize(node.width as usize, sign);
                    bits
                }
                _ => (0..node.width)
                    .map(|bit| SourceBit::Computed { node: index, bit })
                    .collect(),
            };
            source_bits.push(bits);
        }
        let masks = |wires: &[Wire]| {
            let mut masks: Vec<(usize, u64)> = Vec::new();
            let bits = wires.iter().flat_map(|wire| &source_bits[wire.index()]);
            for &bit in bits {
                let SourceBit::Computed { node, bit } = bit else {
                    continue;
                };
                match masks.iter_mut().find(|(other, _)| *other == node) {
                    Some((_, mask)) => *mask |= 1 << bit,
                    None => masks.push((node, 1 << bit)),
                }
            }
            masks
        };
        let computes: Vec<bool> = module
            .nodes
            .iter()
            .map(|node| !is_wiring(&node.operation))
            .collect();
        let reads = module
            .nodes
            .iter()
            .zip(&computes)
            .map(|(node, &computes)| {
                if computes {
                    masks(&node.operation.operands())
                } else {
                    vec![]
                }
            })
            .collect();
        let outputs: Vec<Wire> = module.outputs.iter().map(|&(_, wire)| wire).collect();
        Dataflow {
            output_reads: masks(&outputs),
            reads,
            delays: (0..module.nodes.len())
                .map(|index| delay(module, Wire(u32::try_from(index).expect("a node's index"))))
                .collect(),
            is_input: module
                .nodes
                .iter()
                .map(|node| node.operation == Operation::Input)
                .collect(),
            longest_path: longest_path(module),
            source_bits,
            computes,
        }
    }

    fn len(&self) -> usize {
        self.reads.len()
    }

    /// The earliest stage of every operation when none is longer than `period`; none where the
    /// stages do not suffice.
    fn as_early_as_possible(&self, period: Delay, stages: u32) -> Option<Vec<u32>> {
        let mut place = vec![(0, 0); self.len()];
        for node in 0..self.len() {
            let start = self.reads[node]
                .iter()
                .map(|&(source, _)| place[source])
                .max();
            let (stage, time) = start.unwrap_or((0, 0));
            let own = self.delays[node];
            place[node] = if time + own <= period {
                (stage, time + own)
            } else {
                (stage + 1, own)
            };
            if own > period || place[node].0 >= stages {
                return None;
            }
        }
        Some(place.into_iter().map(|(stage, _)| stage).collect())
    }

    /// The latest stage of every operation; `period` suffices, as the earliest stages showed.
    fn as_late_as_possible(&self, period: Delay, stages: u32) -> Vec<u32> {
        // (stage, time from the operation's start to the end of its stage)
        let mut place = vec![(stages - 1, 0); self.len()];
        let mut latest = vec![(stages - 1, 0); self.len()];
        for node in (0..self.len()).rev() {
            let (stage, time) = latest[node];
            let own = self.delays[node];
            place[node] = if self.is_input[node] {
                (0, 0)
            } else if time + own <= period {
                (stage, time + own)
            } else {
                (stage - 1, own)
            };
            for &(source, _) in &self.reads[node] {
                let (stage, time) = latest[source];
                latest[source] = match place[node].0.cmp(&stage) {
                    std::cmp::Ordering::Less => place[node],
                    std::cmp::Ordering::Equal => (stage, time.max(place[node].1)),
                    std::cmp::Ordering::Greater => (stage, time),
                };
            }
        }
        place.into_iter().map(|(stage, _)| stage).collect()
    }

    /// Does every operation stand behind what it reads, and no stage take longer than `period`?
    fn is_feasible(&self, stages: &[u32], period: Delay) -> bool {
        let mut arrival = vec![0; self.len()];
        for node in 0..self.len() {
            let mut start = 0;
            for &(source, _) in &self.reads[node] {
                match stages[source].cmp(&stages[node]) {
                    std::cmp::Ordering::Greater => return false,
                    std::cmp::Ordering::Equal => start = start.max(arrival[source]),
                    std::cmp::Ordering::Less => {}
                }
            }
            arrival[node] = start + self.delays[node];
            if arrival[node] > period {
                return false;
            }
        }
        true
    }

    /// Register bits between the stages, the output registers not counted.
    fn register_bits(&self, stages: &[u32], count: u32) -> u32 {
        // need[node][stage]: the bits read in that stage.
        let count = count as usize;
        let mut need = vec![0_u64; self.len() * count];
        for node in 0..self.len() {
            for &(source, mask) in &self.reads[node] {
                need[source * count + stages[node] as usize] |= mask;
            }
        }
        for &(source, mask) in &self.output_reads {
            need[source * count + count - 1] |= mask;
        }
        let mut bits = 0;
        for node in 0..self.len() {
            let mut later = 0;
            for stage in (stages[node] as usize + 1..count).rev() {
                later |= need[node * count + stage];
                bits += later.count_ones();
            }
        }
        bits
    }

    /// The shortest longest stage that `stages` stages allow.
    pub fn shortest_period(&self, stages: u32) -> Delay {
        let (mut too_short, mut enough) = (0, self.longest_path);
        if self.as_early_as_possible(0, stages).is_some() {
            return 0;
        }
        while enough - too_short > 1 {
            let middle = too_short.midpoint(enough);
            if self.as_early_as_possible(middle, stages).is_some() {
                enough = middle;
            } else {
                too_short = middle;
            }
        }
        enough
    }

    /// The stage of every node that computes (of the others without meaning), counted from 0: no
    /// stage longer than `period`, and few registers.
    pub fn schedule(&self, period: Delay, count: u32) -> Vec<u32> {
        let early = self
            .as_early_as_possible(period, count)
            .expect("the period was found by this very test");
        let late = self.as_late_as_possible(period, count);
        let early = self.with_fewer_registers(early, period, count);
        let late = self.with_fewer_registers(late, period, count);
        if self.register_bits(&late, count) < self.register_bits(&early, count) {
            late
        } else {
            early
        }
    }

    /// Moves operations over the cuts, each with all that must move along, as long as that saves
    /// registers: a descent to a local optimum, deterministic.
    fn with_fewer_registers(&self, mut stages: Vec<u32>, period: Delay, count: u32) -> Vec<u32> {
        let mut bits = self.register_bits(&stages, count);
        loop {
            let before = bits;
            for node in (0..self.len()).filter(|&n| self.computes[n] && !self.is_input[n]) {
                for later in [true, false] {
                    let Some(moved) = self.moved(&stages, node, later, count) else {
                        continue;
                    };
                    let moved_bits = self.register_bits(&moved, count);
                    if moved_bits < bits && self.is_feasible(&moved, period) {
                        (stages, bits) = (moved, moved_bits);
                    }
                }
            }
            if bits == before {
                return stages;
            }
        }
    }

    /// The stages after moving a node to the next stage with all of its stage that depend on it,
    /// or to the stage before with all that it depends on.
    fn moved(&self, stages: &[u32], node: usize, later: bool, count: u32) -> Option<Vec<u32>> {
        let stage = stages[node];
        if (later && stage + 1 == count) || (!later && stage == 0) {
            return None;
        }
        let mut moves = vec![false; self.len()];
        moves[node] = true;
        if later {
            for other in node + 1..self.len() {
                moves[other] = stages[other] == stage
                    && self.reads[other].iter().any(|&(source, _)| moves[source]);
            }
        } else {
            for other in (0..=node).rev().filter(|&other| stages[other] == stage) {
                if moves[other] {
                    for &(source, _) in &self.reads[other] {
                        moves[source] |= stages[source] == stage;
                    }
                }
            }
        }
        Some(
            stages
                .iter()
                .zip(&moves)
                .map(|(&own, &moves)| match (moves, later) {
                    (false, _) => own,
                    (true, true) => own + 1,
                    (true, false) => own - 1,
                })
                .collect(),
        )
    }

    /// The ranges of bits (low, high) of every node that are read in each stage: entries of
    /// (stage, low, high), an output counted as a reader in the last stage.
    pub fn ranges_read(
        &self,
        module: &Module,
        stages: &[u32],
        count: u32,
    ) -> Vec<Vec<(u32, u32, u32)>> {
        let mut ranges = vec![vec![]; self.len()];
        let mut read = |wire: Wire, stage: u32| {
            for run in runs(&self.source_bits[wire.index()]) {
                if let Run::Source { node, low, high } = run {
                    ranges[node].push((stage, low, high));
                }
            }
        };
        for (node, &stage) in module.nodes.iter().zip(stages) {
            if !is_wiring(&node.operation) {
                for operand in node.operation.operands() {
                    read(operand, stage);
                }
            }
        }
        for &(_, wire) in &module.outputs {
            read(wire, count - 1);
        }
        ranges
    }
}

/// Neighbouring bits of one origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Run {
    /// Bits low..=high of a node, ascending.
    Source { node: usize, low: u32, high: u32 },
    /// So many constant bits and their value.
    Constant { width: u32, value: u64 },
}

/// A word's bits in runs, the lowest first.
pub(super) fn runs(bits: &[SourceBit]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for &bit in bits {
        match (runs.last_mut(), bit) {
            (Some(Run::Source { node, high, .. }), SourceBit::Computed { node: source, bit })
                if *node == source && *high + 1 == bit =>
            {
                *high = bit;
            }
            (Some(Run::Constant { width, value }), SourceBit::Constant(bit)) => {
                *value |= u64::from(bit) << *width;
                *width += 1;
            }
            (_, SourceBit::Computed { node, bit }) => runs.push(Run::Source {
                node,
                low: bit,
                high: bit,
            }),
            (_, SourceBit::Constant(bit)) => runs.push(Run::Constant {
                width: 1,
                value: bit.into(),
            }),
        }
    }
    runs
}
