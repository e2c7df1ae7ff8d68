//! The embedded simulator as the hardware: nothing but Rust needed.

use super::divergence::{Comparison, Divergence};
use super::golden::{GoldenRun, History};
use super::traverse::driven_words;
use crate::simulate::{Input, SimulateError, Simulator};
use crate::units::TraverseUnit;
use rtl_model::machine::CycleInputs;
use rtl_model::ray::Ray;
use std::ops::ControlFlow;

/// After this many cycles with a difference a run ends: what follows is consequence.
pub(super) const DIVERGENT_CYCLES: u64 = 64;

struct Ports {
    driven: Vec<Input>,
    height: Input,
}

impl Ports {
    fn new(unit: &TraverseUnit, simulator: &Simulator) -> Result<Ports, SimulateError> {
        let driven = unit.driven_ports();
        let driven = driven.iter().map(|port| simulator.input(port));
        Ok(Ports {
            driven: driven.collect::<Result<_, _>>()?,
            height: simulator.input(&unit.height_port())?,
        })
    }

    fn drive(&self, simulator: &mut Simulator, inputs: &CycleInputs) {
        for (&port, word) in self.driven.iter().zip(driven_words(inputs)) {
            simulator.set_input(port, word);
        }
    }
}

/// Runs the unit's netlist beside the golden machine and compares every probe in every cycle.
/// `observe` sees each cycle's number, its inputs and the probes' values as the simulator has
/// them.
///
/// # Errors
/// If the netlist cannot be simulated.
pub fn run_embedded(
    unit: &TraverseUnit,
    run: &GoldenRun<'_>,
    mut observe: impl FnMut(u64, &CycleInputs, &[u64]),
) -> Result<Comparison, SimulateError> {
    let mut simulator = Simulator::new(&unit.design)?;
    let ports = Ports::new(unit, &simulator)?;
    let address = simulator.signal("height_address_o")?;
    let signals = unit
        .probes
        .iter()
        .map(|probe| simulator.signal(&embedded_path(probe)))
        .collect::<Result<Vec<_>, _>>()?;
    let memory = run.pyramid.memory();
    let idle = CycleInputs {
        ray_valid: false,
        ray_id: 0,
        ray: Ray {
            u: 0,
            v: 0,
            du: 0,
            dv: 0,
        },
        hit_ready: false,
    };
    // The memory is synchronous: the address of a cycle gives the height of the next.
    let clock = |simulator: &mut Simulator| {
        let height = memory[simulator.peek(address) as usize];
        simulator.clock();
        simulator.set_input(ports.height, height.into());
    };
    simulator.set("rst_ni", 0)?;
    for _ in 0..run.reset_cycles() {
        ports.drive(&mut simulator, &idle);
        simulator.settle();
        clock(&mut simulator);
    }
    simulator.set("rst_ni", 1)?;

    let mut history = History::new(unit.latency.step);
    let mut comparison = Comparison {
        signals_compared: unit.probes.len() as u64,
        ..Comparison::default()
    };
    let mut divergent_cycles = 0;
    let mut found = vec![0; unit.probes.len()];
    run.run(unit.configuration.format, |inputs, outputs, words| {
        history.push(&words.0);
        ports.drive(&mut simulator, inputs);
        simulator.settle();
        let cycle = comparison.cycles;
        let mut differs = 0;
        for (place, (probe, &signal)) in unit.probes.iter().zip(&signals).enumerate() {
            let expected = history.expected(probe);
            found[place] = simulator.peek(signal);
            if found[place] != expected {
                differs += 1;
                if divergent_cycles == 0 {
                    comparison.first.push(Divergence {
                        cycle,
                        unit: probe.scope.join("."),
                        signal: probe.name.clone(),
                        expected,
                        found: found[place],
                    });
                }
            }
        }
        observe(cycle, inputs, &found);
        comparison.mismatches += differs;
        comparison.cycles += 1;
        comparison.cycles_compared += 1;
        if outputs.hit_valid && inputs.hit_ready {
            comparison.rays += 1;
            comparison.guards += u64::from(outputs.hit_guard);
        }
        clock(&mut simulator);
        divergent_cycles += u64::from(differs > 0);
        if divergent_cycles >= DIVERGENT_CYCLES {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    Ok(comparison)
}

/// A probe's path in the embedded simulator, which does not name the top module.
pub(super) fn embedded_path(probe: &crate::units::Probe) -> String {
    let mut parts: Vec<&str> = probe.scope.iter().skip(1).map(String::as_str).collect();
    parts.push(&probe.name);
    parts.join(".")
}
