//! From a scheduled recording to a module.

use super::integer_product::integer_product;
use super::naming::names;
use super::record::Recording;
use super::schedule::{OperatorLatencies, Schedule};
use super::signal::{Kind, RecordedOperation, SignalId};
use super::word_logic;
use crate::netlist::{Builder, Meaning, Module, Wire};
use crate::operators::{FloatOperator, OperatorConfiguration};
use crate::pipeline::ENABLE;
use rtl_model::float::Rounding;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// A register of a pipelined datapath, or the output register of one of its operators: a place
/// where hardware and golden model can be compared.
#[derive(Clone, Debug)]
pub struct PipelineRegister {
    /// Its name in the module: the signal's name and its stage, as in `exit_depth_u_s5`.
    pub name: String,
    /// Whose value it holds: the result of an operation, as its place among the words of the
    /// golden reading, or an input, as its place among the inputs.
    pub word: Result<usize, usize>,
    /// The stage it stands in front of: it holds the value of the evaluation that entered this
    /// many cycles before.
    pub stage: u32,
    /// Its bits.
    pub width: u32,
    /// How they are meant.
    pub meaning: Meaning,
    /// Cycles between its sources and itself: 1 for a delay, the latency of an operator.
    pub cycles_back: u32,
    /// What its value is computed from, so many cycles before.
    pub sources: Vec<Source>,
}

/// Where a value in a pipeline comes from, seen through the combinational logic in between.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A register of the datapath, by its name.
    Register(String),
    /// An input of the datapath, by its recorded name.
    Input(&'static str),
}

/// A datapath as hardware.
#[derive(Clone, Debug)]
pub struct BuiltDatapath {
    /// The module. Its first input is `enable_i` where it has registers; its other inputs are the
    /// recording's, named with `_i`; its outputs the recording's, with `_o`.
    pub module: Arc<Module>,
    /// Every register that the golden model knows, in order of stages.
    pub registers: Vec<PipelineRegister>,
    /// Cycles from the first input to the outputs.
    pub latency: u32,
    /// Operations recorded: the words that the golden reading keeps for an evaluation.
    pub word_count: usize,
    /// For every output port that is the result of an operation: its place among the words of the
    /// golden reading.
    pub output_words: BTreeMap<String, usize>,
    /// For every output port: the stage in which it leaves, the last one but for early outputs.
    pub output_stages: BTreeMap<String, u32>,
    /// For every output port: what it is computed from in the same cycle.
    pub output_sources: BTreeMap<String, Vec<Source>>,
}

/// Builds the module of a recording as the schedule says.
pub fn build(
    recording: &Recording,
    schedule: &Schedule,
    latencies: &OperatorLatencies,
    name: &str,
    description: &[String],
) -> BuiltDatapath {
    let mut build = Build {
        recording,
        names: names(recording),
        schedule,
        latencies,
        builder: Builder::new(name),
        enable: None,
        wires: HashMap::new(),
        operators: HashMap::new(),
        registers: Vec::new(),
    };
    for line in description {
        build.builder.describe(line.clone());
    }
    build.run();
    let output_words = recording
        .outputs
        .iter()
        .filter_map(|output| {
            let word = recording.signal(output.signal).word?;
            Some((format!("{}_o", output.name), word))
        })
        .collect();
    let output_stages = recording
        .outputs
        .iter()
        .map(|output| (format!("{}_o", output.name), schedule.stage_of(output)))
        .collect();
    let output_sources = recording
        .outputs
        .iter()
        .map(|output| {
            let stage = schedule.stage_of(output);
            let mut sources = Vec::new();
            build.trace(output.signal, stage, &mut sources);
            (format!("{}_o", output.name), sources)
        })
        .collect();
    BuiltDatapath {
        module: build.builder.finish(),
        registers: build.registers,
        latency: schedule.last_stage,
        word_count: recording.word_count(),
        output_words,
        output_stages,
        output_sources,
    }
}

struct Build<'a> {
    recording: &'a Recording,
    /// What each signal is called.
    names: Vec<String>,
    schedule: &'a Schedule,
    latencies: &'a OperatorLatencies,
    builder: Builder,
    enable: Option<Wire>,
    /// The wire that carries a signal in a stage.
    wires: HashMap<(SignalId, u32), Wire>,
    /// Operators built so far, each module once.
    operators: HashMap<String, Arc<Module>>,
    registers: Vec<PipelineRegister>,
}

impl Build<'_> {
    fn run(&mut self) {
        if self.schedule.last_stage > 0 {
            self.enable = Some(self.builder.input(ENABLE, 1));
        }
        self.builder.set_latency(self.schedule.last_stage);
        for id in self.recording.inputs().collect::<Vec<_>>() {
            let RecordedOperation::Input { stage } = self.recording.signal(id).operation else {
                unreachable!("inputs() yields inputs");
            };
            let name = format!("{}_i", self.name(id));
            let wire = self.builder.input(&name, self.recording.width(id));
            self.builder.mean(wire, self.meaning(id));
            self.wires.insert((id, stage), wire);
        }
        for stage in 0..=self.schedule.last_stage {
            self.builder.section(match stage {
                0 if self.schedule.last_stage == 0 => "combinational".to_owned(),
                _ => format!("stage {stage}"),
            });
            self.registers_of(stage);
            self.operations_of(stage);
        }
        for output in &self.recording.outputs {
            let stage = self.schedule.stage_of(output);
            let wire = self.wire(output.signal, stage);
            self.builder.output(&format!("{}_o", output.name), wire);
        }
    }

    /// The ranks in front of a stage: a register for every signal made earlier and read here or
    /// later, and the outputs of the operators that end here.
    fn registers_of(&mut self, stage: u32) {
        for index in 0..self.recording.signals.len() {
            let id = SignalId(index);
            let (Some(available), Some(last_read)) = (
                self.schedule.available[index],
                self.schedule.last_read[index],
            ) else {
                continue;
            };
            if available < stage && stage <= last_read {
                let before = self.wires[&(id, stage - 1)];
                let register = self.builder.registered(before, self.enable, None);
                self.name_in_stage(id, stage, register);
                self.add_register(id, stage);
            } else if available == stage
                && self.latencies.of(&self.recording.signal(id).operation) > 0
            {
                self.name_in_stage(id, stage, self.wires[&(id, stage)]);
                self.add_register(id, stage);
            }
        }
    }

    fn name_in_stage(&mut self, id: SignalId, stage: u32, wire: Wire) {
        let name = self.stage_name(id, stage);
        self.builder.name(wire, name);
        self.builder.mean(wire, self.meaning(id));
        self.wires.insert((id, stage), wire);
    }

    fn add_register(&mut self, id: SignalId, stage: u32) {
        let read = match self.recording.signal(id).operation {
            RecordedOperation::IntFromHeight(height) => height,
            _ => id,
        };
        let input_place = || self.recording.inputs().position(|input| input == read);
        let word = self.recording.signal(id).word;
        let is_delay = self.schedule.available[id.index()] != Some(stage);
        let operation = &self.recording.signal(id).operation;
        let mut sources = Vec::new();
        let cycles_back = if is_delay {
            self.trace(id, stage - 1, &mut sources);
            1
        } else {
            let start = self.schedule.start[id.index()];
            for operand in operation.operands() {
                self.trace(operand, start, &mut sources);
            }
            stage - start
        };
        self.registers.push(PipelineRegister {
            name: self.stage_name(id, stage),
            word: word.ok_or_else(|| input_place().expect("an operation or an input")),
            stage,
            width: self.recording.width(id),
            meaning: self.meaning(id),
            cycles_back,
            sources,
        });
    }

    /// Finds the registers and inputs behind a signal in a stage.
    fn trace(&self, id: SignalId, stage: u32, sources: &mut Vec<Source>) {
        let signal = self.recording.signal(id);
        let Some(available) = self.schedule.available[id.index()] else {
            return;
        };
        let source = match signal.operation {
            RecordedOperation::Input { stage: arrival } if arrival == stage => {
                Source::Input(signal.name.unwrap_or("?"))
            }
            ref operation if available == stage && self.latencies.of(operation) == 0 => {
                for operand in operation.operands() {
                    self.trace(operand, stage, sources);
                }
                return;
            }
            _ => Source::Register(self.stage_name(id, stage)),
        };
        if !sources.contains(&source) {
            sources.push(source);
        }
    }

    fn operations_of(&mut self, stage: u32) {
        for (index, signal) in self.recording.signals.iter().enumerate() {
            let id = SignalId(index);
            let is_built = self.schedule.last_read[index].is_some()
                && !signal.operation.is_constant()
                && !matches!(signal.operation, RecordedOperation::Input { .. });
            if !is_built || self.schedule.start[index] != stage {
                continue;
            }
            let latency = self.latencies.of(&signal.operation);
            let wire = self.operation(id, stage);
            self.wires.insert((id, stage + latency), wire);
            if latency == 0 && signal.name.is_some() {
                self.name_in_stage(id, stage, wire);
            }
        }
    }

    fn name(&self, id: SignalId) -> &str {
        &self.names[id.index()]
    }

    fn stage_name(&self, id: SignalId, stage: u32) -> String {
        if self.schedule.last_stage == 0 {
            return self.name(id).to_owned();
        }
        format!("{}_s{stage}", self.name(id))
    }

    fn meaning(&self, id: SignalId) -> Meaning {
        match self.recording.signal(id).kind {
            Kind::Num => Meaning::Float(self.recording.format),
            Kind::Int(_) => Meaning::Signed,
            Kind::Height(_) | Kind::Bit => Meaning::Bits,
        }
    }

    /// The wire of a signal in a stage; constants are made where they are used.
    fn wire(&mut self, id: SignalId, stage: u32) -> Wire {
        let width = self.recording.width(id);
        match self.recording.signal(id).operation {
            RecordedOperation::Zero => self.builder.constant(0, width),
            RecordedOperation::Constant(value) => self
                .builder
                .constant(value as u64 & (u64::MAX >> (64 - width)), width),
            _ => *self.wires.get(&(id, stage)).unwrap_or_else(|| {
                panic!("{} is not there in stage {stage}", self.name(id));
            }),
        }
    }

    fn integer(&mut self, id: SignalId, stage: u32, width: u32) -> Wire {
        let wire = self.wire(id, stage);
        self.builder.sign_extend(wire, width)
    }

    /// An instance of a float operator; returns its result.
    fn instance(
        &mut self,
        id: SignalId,
        kind: FloatOperator,
        rounding: Rounding,
        inputs: &[Wire],
    ) -> Wire {
        let latency = self.latencies.of(&self.recording.signal(id).operation);
        let made = OperatorConfiguration::new(kind, self.recording.format, rounding).build(latency);
        self.instance_of(id, made, inputs)
    }

    /// An instance of a module of its own for an operation; returns its result.
    fn instance_of(&mut self, id: SignalId, made: Arc<Module>, inputs: &[Wire]) -> Wire {
        let module = self
            .operators
            .entry(made.name.clone())
            .or_insert(made)
            .clone();
        let mut operands = inputs.iter();
        let ports: Vec<Wire> = module
            .inputs
            .iter()
            .map(|&port| match module.node(port).name.as_deref() {
                Some(ENABLE) => self
                    .enable
                    .expect("a datapath with an operator has an enable"),
                _ => *operands.next().expect("one operand for each port"),
            })
            .collect();
        let name = self.name(id).to_owned();
        self.builder
            .instance(&format!("{name}_operator"), &module, &ports)[0]
    }

    fn operation(&mut self, id: SignalId, stage: u32) -> Wire {
        use RecordedOperation::*;
        let operation = self.recording.signal(id).operation;
        let width = self.recording.width(id);
        let format = self.recording.format;
        let any = Rounding::NearestEven;
        match operation {
            Input { .. } | Zero | Constant(_) => unreachable!("made where it is used"),
            Add(rounding, a, b) => self.binary(id, stage, FloatOperator::Add, rounding, a, b),
            Sub(rounding, a, b) => self.binary(id, stage, FloatOperator::Subtract, rounding, a, b),
            Mul(rounding, a, b) => self.binary(id, stage, FloatOperator::Multiply, rounding, a, b),
            Div(rounding, a, b) => self.binary(id, stage, FloatOperator::Divide, rounding, a, b),
            LessThan(a, b) => self.binary(id, stage, FloatOperator::LessThan, any, a, b),
            LessEqual(a, b) => self.binary(id, stage, FloatOperator::LessEqual, any, a, b),
            UlpsUp(a, ulps) => {
                let a = self.wire(a, stage);
                self.instance(id, FloatOperator::UlpsUp { ulps }, any, &[a])
            }
            ExactBelow(a) => {
                let a = self.wire(a, stage);
                self.instance(id, FloatOperator::ExactBelow, any, &[a])
            }
            FromInteger(rounding, value, exponent) => {
                let kind = FloatOperator::FromInteger {
                    value_bits: self.recording.width(value),
                    exponent_bits: self.recording.width(exponent),
                };
                self.binary(id, stage, kind, rounding, value, exponent)
            }
            Scale(a, exponent) => {
                let a = self.wire(a, stage);
                word_logic::scale(&mut self.builder, a, exponent, format)
            }
            Floor(a, bits) => {
                let a = self.wire(a, stage);
                self.instance(id, FloatOperator::ToInteger { bits }, Rounding::Down, &[a])
            }
            DepthFromHeight(height, bits) => {
                let height = self.wire(height, stage);
                let height = self.builder.slice(height, bits - 1, 0);
                self.instance(id, FloatOperator::DepthFromHeight { bits }, any, &[height])
            }
            IntFromHeight(height) => {
                let height = self.wire(height, stage);
                self.builder.zero_extend(height, width)
            }
            NegateIf(condition, a) => {
                let (condition, a) = (self.wire(condition, stage), self.wire(a, stage));
                let sign = self.builder.bit(a, width - 1);
                let sign = self.builder.xor(sign, condition);
                let rest = self.builder.slice(a, width - 2, 0);
                self.builder.concat(&[sign, rest])
            }
            Magnitude(a) => {
                let a = self.wire(a, stage);
                let rest = self.builder.slice(a, width - 2, 0);
                self.builder.zero_extend(rest, width)
            }
            IsNegative(a) => {
                let a = self.wire(a, stage);
                word_logic::is_negative(&mut self.builder, a, format)
            }
            IsZero(a) => {
                let a = self.wire(a, stage);
                word_logic::is_zero(&mut self.builder, a, format)
            }
            Select(condition, one, zero) => {
                let condition = self.wire(condition, stage);
                let (one, zero) = (
                    self.integer(one, stage, width),
                    self.integer(zero, stage, width),
                );
                self.builder.mux(condition, one, zero)
            }
            IntAdd(a, b) => {
                let (a, b) = (self.integer(a, stage, width), self.integer(b, stage, width));
                self.builder.add(a, b)
            }
            IntSub(a, b) => {
                let (a, b) = (self.integer(a, stage, width), self.integer(b, stage, width));
                self.builder.subtract(a, b)
            }
            IntShiftLeft(a, amount, amount_bits) => {
                let (a, amount) = (self.integer(a, stage, width), self.wire(amount, stage));
                let amount = self.low_bits(amount, amount_bits);
                self.builder.shift_left(a, amount)
            }
            IntShiftRight(a, amount, amount_bits) => {
                let (a, amount) = (self.wire(a, stage), self.wire(amount, stage));
                let amount = self.low_bits(amount, amount_bits);
                word_logic::shift_right(&mut self.builder, a, amount)
            }
            IntMul(a, b) => {
                let latency = self.latencies.of(&operation);
                let widths = [a, b].map(|operand| self.recording.width(operand));
                let made = integer_product(widths, latency);
                let inputs = [self.wire(a, stage), self.wire(b, stage)];
                self.instance_of(id, made, &inputs)
            }
            IntBitLength(a) => {
                let a = self.wire(a, stage);
                word_logic::bit_length(&mut self.builder, a, width)
            }
            IntXor(a, b) => {
                let (a, b) = (self.integer(a, stage, width), self.integer(b, stage, width));
                self.builder.xor(a, b)
            }
            IntWrap(a, _) => {
                let a = self.wire(a, stage);
                self.builder.slice(a, width - 1, 0)
            }
            IntLowBits(a, bits) => {
                let a = self.wire(a, stage);
                let low = self.low_bits(a, bits);
                self.builder.zero_extend(low, width)
            }
            And(a, b) => {
                let (a, b) = (self.integer(a, stage, width), self.integer(b, stage, width));
                self.builder.and(a, b)
            }
            Or(a, b) => {
                let (a, b) = (self.integer(a, stage, width), self.integer(b, stage, width));
                self.builder.or(a, b)
            }
            Not(a) => {
                let a = self.wire(a, stage);
                self.builder.not(a)
            }
            IntComplementIf(condition, a) => {
                let (condition, a) = (self.wire(condition, stage), self.wire(a, stage));
                let inverted = self.builder.not(a);
                self.builder.mux(condition, inverted, a)
            }
            IntEqual(a, b) => {
                let width = self.recording.width(a).max(self.recording.width(b));
                let (a, b) = (self.integer(a, stage, width), self.integer(b, stage, width));
                self.builder.equal(a, b)
            }
            IntLessThan(a, b) => {
                // The sign of an exact difference.
                let width = self.recording.width(a).max(self.recording.width(b)) + 1;
                let (a, b) = (self.integer(a, stage, width), self.integer(b, stage, width));
                let difference = self.builder.subtract(a, b);
                self.builder.bit(difference, width - 1)
            }
            IntFromBit(condition) => {
                let condition = self.wire(condition, stage);
                self.builder.zero_extend(condition, width)
            }
        }
    }

    fn binary(
        &mut self,
        id: SignalId,
        stage: u32,
        kind: FloatOperator,
        rounding: Rounding,
        a: SignalId,
        b: SignalId,
    ) -> Wire {
        let inputs = [self.wire(a, stage), self.wire(b, stage)];
        self.instance(id, kind, rounding, &inputs)
    }

    fn low_bits(&mut self, a: Wire, bits: u32) -> Wire {
        let a = self.builder.sign_extend(a, bits.max(self.builder.width(a)));
        self.builder.slice(a, bits - 1, 0)
    }
}
