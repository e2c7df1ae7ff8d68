//! The exact machine against its golden model: every declared signal and every register in every
//! cycle.

use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::divergence::{Comparison, Divergence};
use super::embedded::{DIVERGENT_CYCLES, embedded_path};
use super::golden::History;
use super::record::HarnessPlan;
use super::verilator::{RecordStream, TraceWindow, Verilator, VerilatorError, run_harness};
use crate::netlist::Module;
use crate::simulate::{SimulateError, Simulator};
use crate::units::{CycleWords, ExactUnit, Probe};
use rtl_model::machine::{Declared, DeclaredKind, ExactMachineShape, ExactRun};
use rtl_model::readings::{E7F16, FloatReading, Traced};

/// The exact machine, to be held against its golden model.
#[derive(Clone, Debug)]
pub struct ExactDesign {
    /// The top module.
    pub design: Arc<Module>,
    /// What is compared.
    pub probes: Vec<Probe>,
    shape: ExactMachineShape,
    inputs: Vec<Declared>,
}

impl ExactDesign {
    /// That of a unit.
    pub fn of(unit: &ExactUnit) -> ExactDesign {
        let declaration = unit.shape.declaration().into_iter();
        let inputs = declaration.filter(|signal| signal.kind == DeclaredKind::Input);
        ExactDesign {
            design: unit.design.clone(),
            probes: unit.probes.clone(),
            shape: unit.shape.clone(),
            inputs: inputs.collect(),
        }
    }

    /// Cycles in reset before cycle 0: enough for every stage to fill with zeros.
    fn reset_cycles(&self) -> u32 {
        self.shape.effort.stages + 4
    }

    /// Runs the golden machine; `each` sees the words driven and the golden words of every cycle.
    /// Answers how many hits left.
    fn golden(
        &self,
        run: &ExactRun<'_>,
        mut each: impl FnMut(&[u64], &CycleWords) -> ControlFlow<()>,
    ) -> u64 {
        let mut words = CycleWords::default();
        let mut traced = Traced {
            reading: FloatReading(E7F16),
            words: Vec::new(),
        };
        let answered_in = self.shape.height_stage();
        let summary = run.run(|machine, inputs, _| {
            words.0.clear();
            machine.observe(inputs, &mut words.0);
            for stage in [0, answered_in] {
                machine.observe_stage(stage, &mut words.0);
                machine.trace(stage, &mut traced, &mut words.0);
            }
            let mut driven = inputs.words();
            for (word, port) in driven.iter_mut().zip(&self.inputs) {
                *word &= u64::MAX >> (64 - port.width);
            }
            each(&driven, &words)
        });
        summary.hits
    }

    /// Runs the netlist beside the golden machine.
    ///
    /// # Errors
    /// If the netlist cannot be simulated.
    pub fn embedded(&self, run: &ExactRun<'_>) -> Result<Comparison, SimulateError> {
        let mut simulator = Simulator::new(&self.design)?;
        let inputs = self.inputs.iter().map(|port| simulator.input(&port.name));
        let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
        let signals = self.probes.iter();
        let signals = signals.map(|probe| simulator.signal(&embedded_path(probe)));
        let signals = signals.collect::<Result<Vec<_>, _>>()?;
        simulator.set("rst_ni", 0)?;
        for _ in 0..self.reset_cycles() {
            simulator.settle();
            simulator.clock();
        }
        simulator.set("rst_ni", 1)?;
        let mut history = History::new(self.shape.effort.stages);
        let mut comparison = Comparison {
            signals_compared: self.probes.len() as u64,
            ..Comparison::default()
        };
        let mut divergent_cycles = 0;
        comparison.rays = self.golden(run, |driven, words| {
            history.push(words);
            for (&input, &word) in inputs.iter().zip(driven) {
                simulator.set_input(input, word);
            }
            simulator.settle();
            let mut differs = 0;
            for (probe, &signal) in self.probes.iter().zip(&signals) {
                let (expected, found) = (history.expected(probe), simulator.peek(signal));
                if found != expected {
                    differs += 1;
                    if divergent_cycles == 0 {
                        comparison.first.push(Divergence {
                            cycle: comparison.cycles,
                            unit: probe.scope.join("."),
                            signal: probe.name.clone(),
                            expected,
                            found,
                        });
                    }
                }
            }
            comparison.mismatches += differs;
            comparison.cycles += 1;
            simulator.clock();
            divergent_cycles += u64::from(differs > 0);
            match divergent_cycles < DIVERGENT_CYCLES {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
        comparison.cycles_compared = comparison.cycles;
        Ok(comparison)
    }

    /// What a harness drives and compares.
    pub fn plan(&self) -> HarnessPlan {
        let driven: Vec<&str> = self.inputs.iter().map(|port| port.name.as_str()).collect();
        HarnessPlan::new(
            &self.design,
            &driven,
            self.probes.clone(),
            self.reset_cycles(),
            None,
            ("hit_valid_o", "hit_ready_i"),
        )
    }

    /// Runs the design under Verilator beside the golden machine. `progress` is told now and then
    /// how many cycles have run.
    ///
    /// # Errors
    /// If Verilator cannot build or run it.
    pub fn verilator(
        &self,
        verilator: &Verilator,
        run: &ExactRun<'_>,
        window: Option<&TraceWindow>,
        mut progress: impl FnMut(u64),
    ) -> Result<Comparison, VerilatorError> {
        let plan = self.plan();
        let program = verilator.build(&self.design, &plan, window.is_some())?;
        let mut cycles: u64 = 0;
        let stream = |records: &mut RecordStream<'_>| -> io::Result<()> {
            let mut outcome = Ok(());
            self.golden(run, |driven, words| {
                if let Err(problem) = records.send(driven, &words.0) {
                    outcome = Err(problem);
                    return ControlFlow::Break(());
                }
                cycles += 1;
                if cycles.is_multiple_of(16384) {
                    progress(cycles);
                }
                ControlFlow::Continue(())
            });
            outcome
        };
        run_harness(&program, &plan, None, window, stream)
    }
}
