//! Hardware operators under Verilator against the golden arithmetic.
//!
//! An operator stands in one design in all roundings asked for, which see the same operands, so
//! that C++ is compiled once for them. Golden answers are computed in chunks by all threads, ahead of
//! the simulator; every cycle brings new operands, and every result is compared as it leaves.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;
use std::time::Instant;

use hdl_gen::netlist::{Builder, Module};
use hdl_gen::operators::{FloatOperator, OperatorConfiguration, stream_unit};
use hdl_gen::pipeline::ENABLE;
use hdl_gen::verify::{OperandSets, StreamRun, Verilator, VerilatorError};
use rayon::prelude::*;
use rtl_model::float::Operation;
use rtl_model::machine::StallPattern;

use crate::operands::Operands;
use crate::sweep::{Difference, Outcome};

/// Operand sets whose golden answers are computed by one thread in one go.
const CHUNK: u64 = 1 << 14;
/// Chunks in a batch: computed side by side, then handed over in order.
const BATCH: u64 = 8;

/// The operand sets of an operator.
enum Sets {
    /// Related floats.
    Floats(Operands),
    /// Integers, heights, and operands of a narrower domain.
    Others(OperandSets),
}

impl Sets {
    fn new(configuration: OperatorConfiguration, count: u64, seed: u64) -> Sets {
        let OperatorConfiguration {
            operator, format, ..
        } = configuration;
        let like = match operator {
            FloatOperator::Add | FloatOperator::Subtract => Operation::Add,
            FloatOperator::Compare
            | FloatOperator::CompareSignalling
            | FloatOperator::Minimum
            | FloatOperator::Maximum
            | FloatOperator::LessThan
            | FloatOperator::LessEqual => Operation::Add,
            FloatOperator::Multiply => Operation::Multiply,
            FloatOperator::Divide => Operation::Divide,
            FloatOperator::SquareRoot
            | FloatOperator::ToInteger { .. }
            | FloatOperator::ToUnsigned { .. }
            | FloatOperator::Convert { .. }
            | FloatOperator::RoundToIntegral
            | FloatOperator::Floor => Operation::SquareRoot,
            _ => return Sets::Others(OperandSets::new(operator, format, count, seed)),
        };
        Sets::Floats(Operands::new(like, format, count, seed))
    }

    fn count(&self) -> u64 {
        match self {
            Sets::Floats(sets) => sets.count(),
            Sets::Others(sets) => sets.count(),
        }
    }

    fn is_exhaustive(&self) -> bool {
        match self {
            Sets::Floats(sets) => sets.is_exhaustive(),
            Sets::Others(sets) => sets.is_exhaustive(),
        }
    }

    fn set(&self, k: u64, operands: &mut Vec<u64>) {
        match self {
            Sets::Floats(sets) => {
                operands.clear();
                operands.extend_from_slice(&sets.set(k)[..sets.width()]);
            }
            Sets::Others(sets) => sets.set(k, operands),
        }
    }
}

/// Configurations of one operator that differ in their rounding, side by side behind one
/// handshake.
pub struct Gallery {
    configurations: Vec<OperatorConfiguration>,
    latency: u32,
    sets: Sets,
    /// The design.
    pub unit: Arc<Module>,
}

impl Gallery {
    /// Builds it, and chooses `count` operand sets, or all where there are no more.
    ///
    /// # Panics
    /// If there is no configuration.
    pub fn new(
        configurations: Vec<OperatorConfiguration>,
        latency: u32,
        count: u64,
        seed: u64,
    ) -> Gallery {
        let first = configurations[0];
        let core = first.build(latency);
        let mut builder = Builder::new(format!("{}_roundings", core.name));
        builder.describe("One operator in several roundings, side by side.");
        builder.set_latency(latency);
        let mut inputs = Vec::new();
        for &wire in &core.inputs {
            let node = core.node(wire);
            let name = node.name.as_deref().unwrap_or(ENABLE);
            inputs.push(builder.input(name, node.width));
        }
        for &configuration in &configurations {
            let module = configuration.build(latency);
            let instance = format!("in_{}", configuration.rounding);
            let results = builder.instance(&instance, &module, &inputs);
            for (&result, (port, _)) in results.iter().zip(&module.outputs) {
                builder.output(&format!("{}_{port}", configuration.rounding), result);
            }
        }
        Gallery {
            unit: stream_unit(&builder.finish()),
            sets: Sets::new(first, count, seed),
            configurations,
            latency,
        }
    }

    /// How many operand sets there are.
    pub fn count(&self) -> u64 {
        self.sets.count()
    }

    /// Are they all there can be?
    pub fn is_exhaustive(&self) -> bool {
        self.sets.is_exhaustive()
    }

    fn golden(&self, operands: &[u64], results: &mut Vec<u64>) {
        for configuration in &self.configurations {
            configuration.golden_results(operands, results);
        }
    }

    /// Operands and results of a chunk's sets, one after the other.
    fn chunk(&self, chunk: u64) -> Vec<u64> {
        let mut words = Vec::new();
        let (mut operands, mut results) = (Vec::new(), Vec::new());
        for k in chunk * CHUNK..self.count().min((chunk + 1) * CHUNK) {
            results.clear();
            self.sets.set(k, &mut operands);
            self.golden(&operands, &mut results);
            words.extend_from_slice(&operands);
            words.extend_from_slice(&results);
        }
        words
    }

    /// Runs a design, this gallery's or one with a fault in it, on all sets. A case is a set in all
    /// roundings.
    ///
    /// # Errors
    /// If Verilator cannot build or run it.
    pub fn run(
        &self,
        unit: &Arc<Module>,
        verilator: &Verilator,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Outcome, VerilatorError> {
        let begin = Instant::now();
        let mut idle_operands = Vec::new();
        self.sets.set(0, &mut idle_operands);
        let width = idle_operands.len();
        let mut idle_results = Vec::new();
        self.golden(&vec![0; width], &mut idle_results);
        let stride = width + idle_results.len();
        let comparison = thread::scope(|scope| {
            let (sender, receiver) = sync_channel(2 * BATCH as usize);
            scope.spawn(move || {
                let chunks = self.count().div_ceil(CHUNK);
                for batch in (0..chunks).step_by(BATCH as usize) {
                    let range = batch..chunks.min(batch + BATCH);
                    let made: Vec<Vec<u64>> = range
                        .into_par_iter()
                        .map(|chunk| self.chunk(chunk))
                        .collect();
                    for words in made {
                        // The receiver hangs up where the simulator has seen enough.
                        if sender.send(words).is_err() {
                            return;
                        }
                    }
                }
            });
            let ready = Ready::new(receiver, stride);
            let run = StreamRun {
                unit,
                count: self.count(),
                vectors: &|_, operands, results| {
                    ready.next(|words| {
                        operands.extend_from_slice(&words[..width]);
                        results.extend_from_slice(&words[width..]);
                    });
                },
                idle_results: &idle_results,
                gaps: StallPattern::never(),
                stalls: StallPattern::never(),
            };
            run.verilator(verilator, None, progress)
        })?;
        let mut outcome = Outcome {
            cases: comparison.rays * self.configurations.len() as u64,
            differences: comparison.mismatches,
            first: Vec::new(),
            duration: begin.elapsed(),
        };
        let mut operands = Vec::new();
        for divergence in &comparison.first {
            // A set enters every cycle from cycle 0 on, and leaves after the latency.
            let index = divergence.cycle.saturating_sub(u64::from(self.latency));
            self.sets.set(index, &mut operands);
            outcome.first.push(Difference {
                index,
                operands: operands.clone(),
                golden: vec![divergence.expected],
                other: vec![divergence.found],
            });
        }
        Ok(outcome)
    }
}

/// Chunks as they come in, read set by set.
struct Ready {
    receiver: Receiver<Vec<u64>>,
    stride: usize,
    current: RefCell<(Vec<u64>, usize)>,
}

impl Ready {
    fn new(receiver: Receiver<Vec<u64>>, stride: usize) -> Ready {
        Ready {
            receiver,
            stride,
            current: RefCell::new((Vec::new(), 0)),
        }
    }

    fn next(&self, take: impl FnOnce(&[u64])) {
        let mut current = self.current.borrow_mut();
        if current.1 == current.0.len() {
            let words = self
                .receiver
                .recv()
                .expect("the makers outlive their reader");
            *current = (words, 0);
        }
        let (words, position) = &mut *current;
        take(&words[*position..*position + self.stride]);
        *position += self.stride;
    }
}
