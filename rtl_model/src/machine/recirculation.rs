//! The traverse unit as a loop: rays go round a pipeline of steps until they have hit.
//!
//! One pipeline of `latency` cycles computes a step. A ray that leaves it unfinished enters again
//! at once; where it has finished, it is offered as a hit, and goes round once more unchanged if
//! nobody takes it, so that nothing ever stalls in the loop. A new ray enters where the loop leaves
//! a gap.
//!
//! A ray is set up on its way in: by wires where no operation of the setup needs cycles, else by a
//! pipeline of its own, which stalls as a whole while a ray at its end waits for a gap.

use std::borrow::Cow;
use std::collections::VecDeque;

use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::readings::{Traced, Word};
use crate::units::step::{Register, Signal, Step};

/// Bits of the id that travels with a ray: the pixels of a frame of up to 1024 x 1024.
pub const ID_BITS: u32 = 20;

/// What the unit's input ports carry in a cycle.
#[derive(Clone, Copy, Debug)]
pub struct CycleInputs {
    /// A ray is offered.
    pub ray_valid: bool,
    /// Its id.
    pub ray_id: u32,
    /// The ray: the words of [`Step::ray_ports`], which are four; zero bits where `ray_valid` is
    /// false.
    pub ray: Ray<u64>,
    /// A hit would be taken.
    pub hit_ready: bool,
}

/// What the unit's handshakes carry in a cycle. The hit is the pipeline's last stage, whatever
/// stands there; it counts where `hit_valid` is true.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CycleOutputs {
    /// A ray offered in this cycle enters.
    pub ray_ready: bool,
    /// A hit is offered.
    pub hit_valid: bool,
    /// Its ray's id.
    pub hit_id: u32,
    /// The walk ended at the step bound.
    pub hit_guard: bool,
}

/// What stands in the registers of the first stage in a cycle, and all that will be computed from
/// it while it goes down the pipeline.
#[derive(Debug)]
pub struct StageEntry<R: Word> {
    /// Is it a ray? Else a gap: the idle ray of the input ports, computed on like any other.
    pub valid: bool,
    /// The ray's id.
    pub id: u32,
    /// The words of the registers: [`Step::ray_registers`], then [`Step::walk_registers`].
    pub inputs: Vec<u64>,
    /// The result of every operation of the step, in order.
    pub words: Vec<u64>,
    registers: Vec<Signal<Traced<R>>>,
    next_walk: Vec<Signal<Traced<R>>>,
}

/// What stands in a stage of the setup's pipeline, and all that is computed from it.
#[derive(Debug)]
pub struct SetupEntry<R: Word> {
    /// Is it a ray?
    pub valid: bool,
    /// The ray's id.
    pub id: u32,
    /// The words of [`Step::ray_ports`].
    pub inputs: [u64; 4],
    /// The result of every operation of the setup, in order.
    pub words: Vec<u64>,
    registers: Vec<Signal<Traced<R>>>,
}

/// Cycles of a traverse unit's pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitLatency {
    /// Of the setup; 0 where it is combinational.
    pub setup: u32,
    /// Of a step; a ray enters again one cycle later.
    pub step: u32,
}

/// The traverse unit of a map, in a number format.
#[derive(Debug)]
pub struct TraverseMachine<'a, R: Word, S: Step> {
    traced: Traced<R>,
    step: S,
    ray_ports: Vec<Register>,
    /// Registers that a ray carries unchanged.
    unchanged: usize,
    hit: usize,
    guard: usize,
    memory: Cow<'a, [u16]>,
    /// Stages 0 to `latency.step`, as a ring; `first` is stage 0.
    stages: Vec<StageEntry<R>>,
    first: usize,
    /// Stages 1 to `latency.setup`, the first in front.
    setup: VecDeque<SetupEntry<R>>,
    cycle: u64,
}

impl<'a, R: Word, S: Step> TraverseMachine<'a, R, S> {
    /// The machine after its reset, in which every stage has filled with the idle ray.
    ///
    /// # Panics
    /// If the step has no registers `hit` and `guard`, reads several heights at once, or has not
    /// four ray ports: no loop is built for such.
    pub fn new(reading: R, step: S, pyramid: &'a Pyramid, latency: UnitLatency) -> Self {
        assert_eq!(step.height_ports().len(), 1, "a height a step");
        assert_eq!(step.ray_ports().len(), 4, "a ray's ports");
        let walk_registers = step.walk_registers();
        let place = |wanted: &str| {
            let mut names = walk_registers.iter().map(|&(name, _)| name);
            names.position(|name| name == wanted).expect(wanted)
        };
        let mut machine = TraverseMachine {
            traced: Traced {
                reading,
                words: Vec::new(),
            },
            ray_ports: step.ray_ports(),
            unchanged: step.ray_registers().len(),
            hit: place("hit"),
            guard: place("guard"),
            memory: step.memory(pyramid),
            stages: Vec::new(),
            first: 0,
            setup: VecDeque::new(),
            cycle: 0,
            step,
        };
        let idle = Ray {
            u: 0,
            v: 0,
            du: 0,
            dv: 0,
        };
        for _ in 0..latency.setup {
            let entry = machine.set_up(false, 0, idle);
            machine.setup.push_back(entry);
        }
        for _ in 0..=latency.step {
            let registers = machine.set_up(false, 0, idle).registers;
            let entry = machine.enter(false, 0, registers);
            machine.stages.push(entry);
        }
        machine
    }

    /// Cycles since reset.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// What stands in the first stage in this cycle.
    pub fn entry(&self) -> &StageEntry<R> {
        &self.stages[self.first]
    }

    /// What stands in the stages of the setup's pipeline, from stage 1 on.
    pub fn setup_entries(&self) -> impl Iterator<Item = &SetupEntry<R>> {
        self.setup.iter()
    }

    /// What the handshakes carry in this cycle.
    pub fn outputs(&self, inputs: &CycleInputs) -> CycleOutputs {
        let last = &self.stages[self.last()];
        let bit = |place: usize| last.next_walk[place].bit();
        let hit_valid = last.valid && (bit(self.hit) || bit(self.guard));
        let leaves = hit_valid && inputs.hit_ready;
        let has_gap = !last.valid || leaves;
        CycleOutputs {
            ray_ready: has_gap || self.setup.back().is_some_and(|entry| !entry.valid),
            hit_valid,
            hit_id: last.id,
            hit_guard: bit(self.guard),
        }
    }

    /// The rising edge at the end of this cycle.
    pub fn clock(&mut self, inputs: &CycleInputs) {
        let outputs = self.outputs(inputs);
        let slot = self.last();
        let last = &mut self.stages[slot];
        let has_gap = !last.valid || outputs.hit_valid && inputs.hit_ready;
        // The words of the slot that falls free hold the next ones.
        let words = std::mem::take(&mut last.words);
        let (valid, id) = (last.valid, last.id);
        let mut round_again = std::mem::take(&mut last.registers);
        round_again.truncate(self.unchanged);
        round_again.append(&mut last.next_walk);

        let arrives = outputs.ray_ready.then(|| {
            let id = inputs.ray_id;
            self.set_up(inputs.ray_valid, id, inputs.ray)
        });
        // What reaches the end of the setup, if that advances.
        let ready = match (arrives, self.setup.is_empty()) {
            (arrives, true) => arrives,
            (None, false) => None,
            (Some(arrives), false) => {
                self.setup.push_front(arrives);
                self.setup.pop_back()
            }
        };
        self.traced.words = words;
        self.stages[slot] = match ready {
            Some(new) if has_gap => self.enter(new.valid, new.id, new.registers),
            // Without a gap the setup advances over an empty last stage of its own.
            _ => self.enter(valid, id, round_again),
        };
        self.first = slot;
        self.cycle += 1;
    }

    fn last(&self) -> usize {
        (self.first + self.stages.len() - 1) % self.stages.len()
    }

    fn set_up(&mut self, valid: bool, id: u32, ray: Ray<u64>) -> SetupEntry<R> {
        let inputs = [ray.u, ray.v, ray.du, ray.dv];
        let ports = self.ray_ports.iter().zip(inputs);
        let signals: Vec<Signal<Traced<R>>> = ports
            .map(|(&(_, kind), word)| Signal::of_word(&self.traced, kind, word))
            .collect();
        self.traced.words.clear();
        let registers = self.step.set_up(&mut self.traced, &signals);
        SetupEntry {
            valid,
            id,
            inputs,
            words: std::mem::take(&mut self.traced.words),
            registers,
        }
    }

    /// Evaluates the step of what enters the pipeline.
    fn enter(&mut self, valid: bool, id: u32, registers: Vec<Signal<Traced<R>>>) -> StageEntry<R> {
        let inputs = registers.iter().map(|signal| signal.word(&self.traced));
        let inputs = inputs.collect();
        self.traced.words.clear();
        let address = self.step.address(&mut self.traced, &registers);
        let height = i64::from(self.memory[address as usize]);
        let (next_walk, _) = self.step.step(&mut self.traced, &registers, &[height]);
        StageEntry {
            valid,
            id,
            inputs,
            words: std::mem::take(&mut self.traced.words),
            registers,
            next_walk,
        }
    }
}
