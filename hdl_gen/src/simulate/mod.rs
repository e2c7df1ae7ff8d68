//! The embedded simulator: a design executed without any tool, two-valued, cycle by cycle.
//!
//! The hierarchy is flattened into one linear program over a memory of 64-bit words. There is no
//! unknown value: registers, memories and inputs start at 0, and a design whose results depend on what a
//! register held before its first write shows it only under a four-valued simulator.

mod compile;
mod flatten;
mod program;

use std::collections::HashMap;
use std::sync::Arc;

use compile::{Register, WritePort, compile};
use flatten::Flat;
use program::{Run, execute};

use crate::nearest::{did_you_mean, nearest_names};
use crate::netlist::{Meaning, Module};

/// The name of the synchronous reset, low when active.
pub const RESET: &str = "rst_ni";

/// Why a design cannot be simulated, or a signal of it not be found.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum SimulateError {
    /// A signal depends on itself with no register between.
    #[error(
        "module {module}: `{path}` depends on itself with no register between; \
         put a register into the loop"
    )]
    CombinationalLoop {
        /// The module the signal stands in.
        module: String,
        /// The signal's path from the top.
        path: String,
    },
    /// No signal has this path.
    #[error("design {top} has no signal `{path}`{}", did_you_mean(near))]
    NoSuchSignal {
        /// The top module.
        top: String,
        /// The path asked for.
        path: String,
        /// Paths like it.
        near: Vec<String>,
    },
    /// The top has no input of this name.
    #[error("design {top} has no input `{name}`; its inputs: {}", inputs.join(", "))]
    NoSuchInput {
        /// The top module.
        top: String,
        /// The name asked for.
        name: String,
        /// The inputs it has.
        inputs: Vec<String>,
    },
}

/// A signal of a simulated design, found once by its path and read every cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    address: u32,
    width: u32,
    meaning: Meaning,
}

impl Signal {
    /// Bits, 1 to 64.
    pub fn width(self) -> u32 {
        self.width
    }

    /// How its bits are meant.
    pub fn meaning(self) -> Meaning {
        self.meaning
    }
}

/// An input of a simulated design, found once by its name and set every cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    address: u32,
    width: u32,
}

impl Input {
    /// Bits, 1 to 64.
    pub fn width(self) -> u32 {
        self.width
    }
}

/// The low `width` bits set; `width` is 1 to 64.
fn low_bits(width: u32) -> u64 {
    u64::MAX >> (64 - width)
}

/// A design in execution.
///
/// A cycle is: [`set_input`](Simulator::set_input) what changes, [`settle`](Simulator::settle),
/// [`peek`](Simulator::peek) what is of interest, [`clock`](Simulator::clock).
#[derive(Clone, Debug)]
pub struct Simulator {
    top: Arc<Module>,
    memory: Vec<u64>,
    runs: Vec<Run>,
    registers: Vec<Register>,
    /// How many of the registers, at the front, take their value at every edge.
    always_enabled: usize,
    /// Where the registers' values begin.
    first_register: usize,
    write_ports: Vec<WritePort>,
    /// The registers' next values, so that all change at once.
    next_values: Vec<u64>,
    inputs: HashMap<String, Input>,
    signals: Vec<(String, Signal)>,
    signal_index: HashMap<String, usize>,
    /// 1 while the design runs, 0 while it is reset.
    reset_n: u64,
    has_reset: bool,
    settled: bool,
    cycles: u64,
}

impl Simulator {
    /// Prepares a design: every register, memory and input at 0, the reset released.
    ///
    /// # Errors
    /// [`SimulateError::CombinationalLoop`] where a signal depends on itself.
    pub fn new(top: &Arc<Module>) -> Result<Simulator, SimulateError> {
        let flat = Flat::new(top);
        let flat_signals = flat.signals();
        let input_nodes: Vec<u32> = top.inputs.iter().map(|wire| wire.0).collect();
        let wanted: Vec<u32> = flat_signals.iter().map(|signal| signal.node).collect();
        let compiled = compile(&flat, &input_nodes, &wanted)?;

        let signals: Vec<(String, Signal)> = flat_signals
            .iter()
            .map(|signal| {
                let address = compiled.address_of[&signal.node];
                (signal.path.clone(), signal.at(address))
            })
            .collect();
        let signal_index = signals
            .iter()
            .enumerate()
            .map(|(index, (path, _))| (path.clone(), index))
            .collect();
        let inputs = top
            .inputs
            .iter()
            .filter_map(|&wire| {
                let node = top.node(wire);
                let input = Input {
                    address: compiled.address_of[&wire.0],
                    width: node.width,
                };
                node.name.clone().map(|name| (name, input))
            })
            .collect();
        let always = |register: &&Register| register.enable.is_none();
        let mut simulator = Simulator {
            top: top.clone(),
            always_enabled: compiled.registers.iter().filter(always).count(),
            first_register: compiled.registers.first().map_or(0, |r| r.own as usize),
            next_values: vec![0; compiled.registers.len()],
            memory: compiled.memory,
            runs: compiled.runs,
            write_ports: compiled.write_ports,
            registers: compiled.registers,
            inputs,
            signals,
            signal_index,
            reset_n: 1,
            has_reset: top.has_reset(),
            settled: false,
            cycles: 0,
        };
        simulator.settle();
        Ok(simulator)
    }

    /// The design.
    pub fn top(&self) -> &Arc<Module> {
        &self.top
    }

    /// Clock edges so far.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// Steps executed to settle the design once: the nodes that are left of it.
    pub fn steps(&self) -> usize {
        self.runs.iter().map(|run| run.steps.len()).sum()
    }

    /// An input port of the top by its name; the reset is not among them.
    ///
    /// # Errors
    /// [`SimulateError::NoSuchInput`], which lists those there are.
    pub fn input(&self, name: &str) -> Result<Input, SimulateError> {
        self.inputs.get(name).copied().ok_or_else(|| {
            let inputs = self.top.inputs.iter();
            SimulateError::NoSuchInput {
                top: self.top.name.clone(),
                name: name.to_owned(),
                inputs: inputs
                    .filter_map(|&wire| self.top.node(wire).name.clone())
                    .collect(),
            }
        })
    }

    /// A named signal or port by its path from the top: `signal`, `instance.signal`,
    /// `instance.instance.signal`.
    ///
    /// # Errors
    /// [`SimulateError::NoSuchSignal`], which names paths like it.
    pub fn signal(&self, path: &str) -> Result<Signal, SimulateError> {
        match self.signal_index.get(path) {
            Some(&index) => Ok(self.signals[index].1),
            None => Err(SimulateError::NoSuchSignal {
                top: self.top.name.clone(),
                path: path.to_owned(),
                near: nearest_names(path, self.signals.iter().map(|(path, _)| path.as_str())),
            }),
        }
    }

    /// All named signals and ports with their paths: a module's own, then its instances'.
    pub fn signals(&self) -> &[(String, Signal)] {
        &self.signals
    }

    /// Drives an input.
    ///
    /// # Panics
    /// If the value is wider than the input.
    pub fn set_input(&mut self, input: Input, value: u64) {
        assert!(
            value <= low_bits(input.width),
            "{value:#x} on an input of {} bits",
            input.width
        );
        let word = &mut self.memory[input.address as usize];
        self.settled &= *word == value;
        *word = value;
    }

    /// Drives an input found by its name; `rst_ni` is accepted where the design has a reset.
    ///
    /// # Errors
    /// [`SimulateError::NoSuchInput`].
    ///
    /// # Panics
    /// If the value is wider than the input.
    pub fn set(&mut self, name: &str, value: u64) -> Result<(), SimulateError> {
        if name == RESET && self.has_reset {
            assert!(value <= 1, "{value} on the reset, which is one bit");
            self.reset_n = value;
        } else {
            self.set_input(self.input(name)?, value);
        }
        Ok(())
    }

    /// Holds the reset for one clock edge and releases it; data registers take what they take.
    pub fn reset(&mut self) {
        let before = std::mem::replace(&mut self.reset_n, 0);
        self.clock();
        self.reset_n = before;
    }

    /// Lets the inputs and registers work through the combinational logic.
    pub fn settle(&mut self) {
        if !self.settled {
            for run in &self.runs {
                execute(run.opcode, &run.steps, &mut self.memory);
            }
            self.settled = true;
        }
    }

    /// A rising clock edge: settles, then every register takes its next value at once. What
    /// depends on the registers is current again after the next [`settle`](Simulator::settle).
    pub fn clock(&mut self) {
        self.settle();
        let memory = &mut self.memory;
        let (always, enabled) = self.registers.split_at(self.always_enabled);
        let (next_always, next_enabled) = self.next_values.split_at_mut(self.always_enabled);
        for (next, register) in next_always.iter_mut().zip(always) {
            *next = memory[register.next as usize];
        }
        for (next, register) in next_enabled.iter_mut().zip(enabled) {
            let enable = register.enable.map_or(1, |enable| memory[enable as usize]);
            let source = if enable != 0 {
                register.next
            } else {
                register.own
            };
            *next = memory[source as usize];
        }
        if self.reset_n == 0 {
            for (next, register) in self.next_values.iter_mut().zip(&self.registers) {
                *next = register.reset.unwrap_or(*next);
            }
        }
        // Before the registers change: the ports read them.
        for port in &self.write_ports {
            if memory[port.enable as usize] != 0 {
                let place = u64::from(port.first) + memory[port.address as usize];
                memory[place as usize] = memory[port.data as usize];
            }
        }
        memory[self.first_register..][..self.next_values.len()].copy_from_slice(&self.next_values);
        self.settled = false;
        self.cycles += 1;
    }

    /// The value of a signal.
    ///
    /// # Panics
    /// If an input changed or the clock rose since the last [`settle`](Simulator::settle): the
    /// value would be of no moment that ever was.
    pub fn peek(&self, signal: Signal) -> u64 {
        assert!(self.settled, "{}: read before it settled", self.top.name);
        self.memory[signal.address as usize]
    }

    /// The value of a signal found by its path, after settling: for tests and small tools.
    ///
    /// # Errors
    /// [`SimulateError::NoSuchSignal`].
    pub fn get(&mut self, path: &str) -> Result<u64, SimulateError> {
        let signal = self.signal(path)?;
        self.settle();
        Ok(self.peek(signal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::netlist::{Builder, Operation, Wire};

    #[test]
    fn a_combinational_loop_is_an_error_that_names_it() {
        let mut b = Builder::new("ring");
        let a = b.input("a_i", 1);
        let first = b.not(a);
        let second = b.not(first);
        b.name(second, "second");
        b.output("y_o", second);
        let mut module = Module::clone(&b.finish());
        // No builder makes this: it takes a wire before it is there.
        module.nodes[first.index()].operation = Operation::Not(Wire(second.0));
        let error = Simulator::new(&Arc::new(module)).unwrap_err();
        assert!(
            matches!(&error, SimulateError::CombinationalLoop { path, .. } if path == "second")
        );
    }
}
