//! A clocked unit against its golden model: every declared signal in every cycle.

use super::divergence::{Comparison, Divergence};
use super::embedded::{DIVERGENT_CYCLES, embedded_path};
use super::record::HarnessPlan;
use super::verilator::{RecordStream, Verilator, VerilatorError, run_harness};
use crate::netlist::Module;
use crate::simulate::{SimulateError, Simulator};
use crate::units::Probe;
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Runs the golden side: calls its argument in every cycle with the words of the input ports and
/// the golden words of the cycle, until there are no more or it breaks.
pub type ClockedTraffic<'a> =
    dyn Fn(&mut dyn FnMut(&[u64], &[u64]) -> ControlFlow<()>) -> ControlFlow<()> + 'a;

/// A clocked unit, what is compared of it, and what is sent through it.
pub struct ClockedRun<'a> {
    /// The unit. It is reset with all its inputs at zero.
    pub unit: &'a Arc<Module>,
    /// The signals compared, without delay.
    pub probes: &'a [Probe],
    /// The pair of ports that are both 1 when a result leaves.
    pub result: (&'a str, &'a str),
    /// Its traffic, with the words of the inputs in the order of the unit's ports.
    pub traffic: &'a ClockedTraffic<'a>,
}

/// Cycles in reset before cycle 0.
const RESET_CYCLES: u32 = 4;

impl ClockedRun<'_> {
    fn driven(&self) -> Vec<&str> {
        let inputs = self.unit.inputs.iter();
        let names = inputs.filter_map(|&port| self.unit.node(port).name.as_deref());
        names.collect()
    }

    /// What a harness drives and compares.
    pub fn plan(&self) -> HarnessPlan {
        HarnessPlan::new(
            self.unit,
            &self.driven(),
            self.probes.to_vec(),
            RESET_CYCLES,
            None,
            self.result,
        )
    }

    /// Runs the unit in the embedded simulator.
    ///
    /// # Errors
    /// If the netlist cannot be simulated.
    pub fn embedded(&self) -> Result<Comparison, SimulateError> {
        let mut simulator = Simulator::new(self.unit)?;
        let inputs = self.driven().into_iter().map(|name| simulator.input(name));
        let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
        let signals = self.probes.iter();
        let signals = signals.map(|probe| simulator.signal(&embedded_path(probe)));
        let signals = signals.collect::<Result<Vec<_>, _>>()?;
        let leaves = [self.result.0, self.result.1].map(|name| simulator.signal(name));
        let [valid, ready] = leaves;
        let (valid, ready) = (valid?, ready?);
        simulator.set("rst_ni", 0)?;
        for _ in 0..RESET_CYCLES {
            simulator.clock();
        }
        simulator.set("rst_ni", 1)?;
        let mut comparison = Comparison {
            signals_compared: self.probes.len() as u64,
            ..Comparison::default()
        };
        let mut divergent_cycles = 0;
        let _ = (self.traffic)(&mut |driven, words| {
            for (&input, &value) in inputs.iter().zip(driven) {
                simulator.set_input(input, value);
            }
            simulator.settle();
            let mut differs = 0;
            for (probe, &signal) in self.probes.iter().zip(&signals) {
                let (expected, found) = (words[probe.word], simulator.peek(signal));
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

    /// Runs the unit under Verilator.
    ///
    /// # Errors
    /// If Verilator cannot build or run it.
    pub fn verilator(&self, verilator: &Verilator) -> Result<Comparison, VerilatorError> {
        let plan = self.plan();
        let program = verilator.build(self.unit, &plan, false)?;
        run_harness(
            &program,
            &plan,
            None,
            None,
            |records: &mut RecordStream<'_>| -> io::Result<()> {
                let mut outcome = Ok(());
                let _ = (self.traffic)(&mut |driven, words| match records.send(driven, words) {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(problem) => {
                        outcome = Err(problem);
                        ControlFlow::Break(())
                    }
                });
                outcome
            },
        )
    }
}
