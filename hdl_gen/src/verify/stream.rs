//! A unit behind handshakes (an operator, a step) against the golden stream machine.

use super::divergence::{Comparison, Divergence};
use super::embedded::DIVERGENT_CYCLES;
use super::icarus::{Icarus, IcarusError};
use super::record::HarnessPlan;
use super::verilator::{RecordStream, TraceWindow, Verilator, VerilatorError, run_harness};
use crate::netlist::Module;
use crate::simulate::{SimulateError, Simulator};
use crate::units::Probe;
use crate::vectors::{Field, FieldFormat, Role, VectorSet};
use rtl_model::machine::{StallPattern, StreamMachine};
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Puts the k-th operand set into the first vector and its golden results into the second.
pub type VectorSource<'a> = dyn Fn(u64, &mut Vec<u64>, &mut Vec<u64>) + 'a;

/// A stream unit, and what is to be sent through it.
pub struct StreamRun<'a> {
    /// The unit, with the ports of [`crate::operators::stream_unit`].
    pub unit: &'a Arc<Module>,
    /// Operand sets to send.
    pub count: u64,
    /// The operand sets and their golden results, in the order of the unit's ports. Called in
    /// order.
    pub vectors: &'a VectorSource<'a>,
    /// Results of operands that are all zero bits: what stands in gaps.
    pub idle_results: &'a [u64],
    /// When the sender has nothing to offer.
    pub gaps: StallPattern,
    /// When the receiver is not ready.
    pub stalls: StallPattern,
}

/// Cycles in reset before cycle 0.
fn reset_cycles(unit: &Module) -> u32 {
    unit.latency + 2
}

impl StreamRun<'_> {
    fn operand_ports(&self) -> Vec<&str> {
        let names = self.unit.inputs.iter().map(|&port| {
            self.unit
                .node(port)
                .name
                .as_deref()
                .expect("an input has a name")
        });
        names
            .filter(|name| !matches!(*name, "valid_i" | "ready_i"))
            .collect()
    }

    /// The ports compared: `ready_o`, `valid_o`, then the results.
    fn probes(&self) -> Vec<Probe> {
        let results = self
            .unit
            .outputs
            .iter()
            .filter(|(name, _)| !matches!(name.as_str(), "ready_o" | "valid_o"));
        let probe = |(place, name): (usize, &str)| {
            let wire = self.unit.output(name).expect("an output of the unit");
            Probe {
                scope: vec![self.unit.name.clone()],
                name: name.to_owned(),
                width: self.unit.width(wire),
                meaning: self.unit.node(wire).meaning,
                word: place,
                delay: 0,
                sources: Vec::new(),
            }
        };
        let names = ["ready_o", "valid_o"]
            .into_iter()
            .chain(results.map(|(name, _)| name.as_str()));
        names.enumerate().map(probe).collect()
    }

    /// Runs the golden machine: `each` sees the words for the input ports (valid, ready, operands)
    /// and those of the output ports. Returns the results that left.
    fn golden(&self, mut each: impl FnMut(&[u64], &[u64]) -> ControlFlow<()>) -> u64 {
        let mut machine = StreamMachine::new(self.unit.latency, self.idle_results);
        let (mut gaps, mut stalls) = (self.gaps, self.stalls);
        let operand_count = self.operand_ports().len();
        let (mut operands, mut results) = (Vec::new(), Vec::new());
        let mut driven = Vec::new();
        let mut words = Vec::new();
        let (mut next, mut left, mut cycles_to_come) = (0, 0, u64::from(self.unit.latency) + 1);
        let mut offered = false;
        while left < self.count || cycles_to_come > 0 {
            if left == self.count {
                cycles_to_come -= 1;
            }
            // An offer stands until it is taken.
            if !offered && next < self.count && gaps.next_ready() {
                offered = true;
                operands.clear();
                results.clear();
                (self.vectors)(next, &mut operands, &mut results);
            }
            if !offered {
                operands.clear();
                operands.resize(operand_count, 0);
                results.clear();
                results.extend_from_slice(self.idle_results);
            }
            let ready = stalls.next_ready();
            let outputs = machine.outputs(ready);
            driven.clear();
            driven.extend([u64::from(offered), u64::from(ready)]);
            driven.extend_from_slice(&operands);
            words.clear();
            words.extend([u64::from(outputs.ready), u64::from(outputs.valid)]);
            words.extend_from_slice(outputs.results);
            let (taken, leaves) = (offered && outputs.ready, outputs.valid && ready);
            if each(&driven, &words).is_break() {
                break;
            }
            machine.clock(ready, offered, &results);
            left += u64::from(leaves);
            if taken {
                next += 1;
                offered = false;
            }
        }
        left
    }

    /// What a harness drives and compares.
    pub fn plan(&self) -> HarnessPlan {
        let mut driven = vec!["valid_i", "ready_i"];
        driven.extend(self.operand_ports());
        HarnessPlan::new(
            self.unit,
            &driven,
            self.probes(),
            reset_cycles(self.unit),
            None,
            ("valid_o", "ready_i"),
        )
    }

    /// Runs the unit under Verilator.
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
        run_harness(
            &program,
            &plan,
            None,
            window,
            |records: &mut RecordStream<'_>| -> io::Result<()> {
                let mut outcome = Ok(());
                let mut left = 0_u64;
                self.golden(|driven, words| {
                    if let Err(problem) = records.send(driven, words) {
                        outcome = Err(problem);
                        return ControlFlow::Break(());
                    }
                    left += words[1] & driven[1];
                    if left.is_multiple_of(4096) {
                        progress(left);
                    }
                    ControlFlow::Continue(())
                });
                outcome
            },
        )
    }

    /// Runs the unit by its testbench under Icarus, which compares each result once, as it leaves:
    /// the cycles compared are those.
    ///
    /// # Errors
    /// If Icarus cannot compile or run it.
    pub fn icarus(&self, icarus: &Icarus) -> Result<Comparison, IcarusError> {
        let ports = self
            .operand_ports()
            .into_iter()
            .map(|name| (Role::Input, name));
        let outputs = self
            .unit
            .outputs
            .iter()
            .map(|(name, _)| (Role::Output, name.as_str()));
        let is_handshake = |name: &str| matches!(name, "ready_o" | "valid_o");
        let results = outputs.filter(|(_, name)| !is_handshake(name));
        let field = |(role, name): (Role, &str)| {
            let wire = self.unit.input(name).or_else(|| self.unit.output(name));
            let node = self.unit.node(wire.expect("a port of the unit"));
            Field::new(
                name,
                role,
                node.width,
                FieldFormat::of_port(node.meaning, node.width),
                "",
            )
        };
        let mut set = VectorSet::new(ports.chain(results).map(field).collect());
        let (mut operands, mut golden) = (Vec::new(), Vec::new());
        for k in 0..self.count {
            operands.clear();
            golden.clear();
            (self.vectors)(k, &mut operands, &mut golden);
            set.push(operands.iter().chain(&golden).copied().collect());
        }
        let verdict = icarus.run_vectors(self.unit, &set)?;
        let hexadecimal = |text: &str| u64::from_str_radix(text, 16).unwrap_or(0);
        let first = verdict.differences.iter().map(|difference| Divergence {
            cycle: difference.vector,
            unit: self.unit.name.clone(),
            signal: difference.field.clone(),
            expected: hexadecimal(&difference.expected),
            found: hexadecimal(&difference.found),
        });
        Ok(Comparison {
            rays: verdict.vectors,
            guards: 0,
            cycles: verdict.vectors,
            cycles_compared: verdict.vectors,
            signals_compared: self.probes().len() as u64 - 2,
            mismatches: match verdict.passed {
                true => 0,
                false => (verdict.vectors - verdict.agreed).max(1),
            },
            first: first.collect(),
        })
    }

    /// Runs the unit in the embedded simulator. `observe` sees each cycle's number, the golden
    /// words of the probes and the simulator's.
    ///
    /// # Errors
    /// If the netlist cannot be simulated.
    pub fn embedded(
        &self,
        mut observe: impl FnMut(u64, &[u64], &[u64]),
    ) -> Result<Comparison, SimulateError> {
        let mut simulator = Simulator::new(self.unit)?;
        let plan = self.plan();
        let inputs = plan
            .driven
            .iter()
            .map(|port| simulator.input(&port.name))
            .collect::<Result<Vec<_>, _>>()?;
        let probes = self.probes();
        let signals = probes
            .iter()
            .map(|probe| simulator.signal(&probe.name))
            .collect::<Result<Vec<_>, _>>()?;
        simulator.set("rst_ni", 0)?;
        for _ in 0..reset_cycles(self.unit) {
            simulator.settle();
            simulator.clock();
        }
        simulator.set("rst_ni", 1)?;
        let mut comparison = Comparison {
            signals_compared: probes.len() as u64,
            ..Comparison::default()
        };
        let mut divergent_cycles = 0;
        let mut found = vec![0; probes.len()];
        comparison.rays = self.golden(|driven, words| {
            for (&input, &value) in inputs.iter().zip(driven) {
                simulator.set_input(input, value);
            }
            simulator.settle();
            let mut differs = 0;
            for (place, probe) in probes.iter().enumerate() {
                found[place] = simulator.peek(signals[place]);
                if found[place] != words[place] {
                    differs += 1;
                    if divergent_cycles == 0 {
                        comparison.first.push(Divergence {
                            cycle: comparison.cycles,
                            unit: probe.scope.join("."),
                            signal: probe.name.clone(),
                            expected: words[place],
                            found: found[place],
                        });
                    }
                }
            }
            observe(comparison.cycles, words, &found);
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
}
