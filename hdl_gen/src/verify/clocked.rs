//! A clocked unit against its golden model: every declared signal in every cycle.

use super::divergence::{Comparison, Divergence};
use super::embedded::{DIVERGENT_CYCLES, embedded_path};
use super::golden::History;
use super::record::HarnessPlan;
use super::verilator::{RecordStream, TraceWindow, Verilator, VerilatorError, run_harness};
use crate::netlist::Module;
use crate::simulate::{SimulateError, Simulator};
use crate::units::Probe;
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Is called with the words of the input ports and the golden words of a cycle.
pub type EachCycle<'a> = dyn FnMut(&[u64], &[u64]) -> ControlFlow<()> + 'a;

/// Runs the golden side: calls its argument in every cycle with the words of the input ports and
/// the golden words of the cycle, until there are no more or it breaks.
pub type ClockedTraffic<'a> = dyn Fn(&mut EachCycle<'_>) -> ControlFlow<()> + 'a;

/// A clocked unit, what is compared of it, and what is sent through it.
pub struct ClockedRun<'a> {
    /// The unit. It is reset with all its inputs at zero.
    pub unit: &'a Arc<Module>,
    /// The signals compared.
    pub probes: &'a [Probe],
    /// The ports driven.
    pub driven: Vec<&'a str>,
    /// Cycles in reset before cycle 0.
    pub reset_cycles: u32,
    /// The pair of ports that are both 1 when a result leaves.
    pub result: (&'a str, &'a str),
    /// Its traffic, with the words of the ports driven in their order.
    pub traffic: &'a ClockedTraffic<'a>,
}

/// The input ports of a unit, in its order.
pub fn input_ports(unit: &Module) -> Vec<&str> {
    let inputs = unit.inputs.iter();
    let names = inputs.filter_map(|&port| unit.node(port).name.as_deref());
    names.collect()
}

/// After so many cycles progress is told.
const TOLD_EVERY: u64 = 16384;

impl ClockedRun<'_> {
    /// What a harness drives and compares.
    pub fn plan(&self) -> HarnessPlan {
        HarnessPlan::new(
            self.unit,
            &self.driven,
            self.probes.to_vec(),
            self.reset_cycles,
            None,
            self.result,
        )
    }

    /// Runs the unit in the embedded simulator.
    ///
    /// # Errors
    /// If the netlist cannot be simulated.
    pub fn embedded(&self) -> Result<Comparison, SimulateError> {
        self.embedded_observed(|_, _| {})
    }

    /// The same; `each` sees the words driven and those of the signals compared, as the simulator
    /// has them, in every cycle.
    pub(super) fn embedded_observed(
        &self,
        mut each: impl FnMut(&[u64], &[u64]),
    ) -> Result<Comparison, SimulateError> {
        let mut simulator = Simulator::new(self.unit)?;
        let inputs = self.driven.iter().map(|name| simulator.input(name));
        let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
        let signals = self.probes.iter();
        let signals = signals.map(|probe| simulator.signal(&embedded_path(probe)));
        let signals = signals.collect::<Result<Vec<_>, _>>()?;
        let leaves = [self.result.0, self.result.1].map(|name| simulator.signal(name));
        let [valid, ready] = leaves;
        let (valid, ready) = (valid?, ready?);
        simulator.set("rst_ni", 0)?;
        for _ in 0..self.reset_cycles {
            simulator.settle();
            simulator.clock();
        }
        simulator.set("rst_ni", 1)?;
        let longest = self.probes.iter().map(|probe| probe.delay).max();
        let mut history = History::new(longest.unwrap_or(0));
        let mut comparison = Comparison {
            signals_compared: self.probes.len() as u64,
            ..Comparison::default()
        };
        let mut divergent_cycles = 0;
        let mut shown = Vec::with_capacity(signals.len());
        let _ = (self.traffic)(&mut |driven, words| {
            history.push(words);
            for (&input, &value) in inputs.iter().zip(driven) {
                simulator.set_input(input, value);
            }
            simulator.settle();
            shown.clear();
            shown.extend(signals.iter().map(|&signal| simulator.peek(signal)));
            each(driven, &shown);
            let mut differs = 0;
            for (probe, &found) in self.probes.iter().zip(&shown) {
                let expected = history.expected(probe);
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
            comparison.rays += simulator.peek(valid) & simulator.peek(ready);
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

    /// Runs the unit under Verilator. `progress` is told now and then how many cycles have run.
    ///
    /// # Errors
    /// If Verilator cannot build or run it.
    pub fn verilator(
        &self,
        verilator: &Verilator,
        window: Option<&TraceWindow>,
        mut progress: impl FnMut(u64),
    ) -> Result<Comparison, VerilatorError> {
        let plan = self.plan();
        let program = verilator.build(self.unit, &plan, window.is_some())?;
        let mut cycles: u64 = 0;
        run_harness(
            &program,
            &plan,
            None,
            window,
            |records: &mut RecordStream<'_>| -> io::Result<()> {
                let mut outcome = Ok(());
                let _ = (self.traffic)(&mut |driven, words| {
                    cycles += 1;
                    if cycles.is_multiple_of(TOLD_EVERY) {
                        progress(cycles);
                    }
                    match records.send(driven, words) {
                        Ok(()) => ControlFlow::Continue(()),
                        Err(problem) => {
                            outcome = Err(problem);
                            ControlFlow::Break(())
                        }
                    }
                });
                outcome
            },
        )
    }
}
