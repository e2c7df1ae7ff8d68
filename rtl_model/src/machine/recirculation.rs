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
use crate::units::step::{Named, Register, Signal, Step};

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
///
/// After [`TraverseMachine::new`] nothing is allocated: what enters a pipeline takes over the
/// buffers of what left it.
#[derive(Debug)]
pub struct TraverseMachine<'a, R: Word, S: Step> {
    datapath: Datapath<'a, R, S>,
    /// Registers that a ray carries unchanged.
    unchanged: usize,
    hit: usize,
    guard: usize,
    /// Stages 0 to `latency.step`, as a ring; `first` is stage 0.
    stages: Vec<StageEntry<R>>,
    first: usize,
    /// Stages 1 to `latency.setup`, the first in front.
    setup: VecDeque<SetupEntry<R>>,
    /// The words of a setup by wires: nobody asks for them.
    setup_by_wires: Vec<u64>,
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
        let ray_ports = step.ray_ports();
        let walk_registers = step.walk_registers();
        let place = |wanted: &str| {
            let mut names = walk_registers.iter().map(|&(name, _)| name);
            names.position(|name| name == wanted).expect(wanted)
        };
        let (hit, guard) = (place("hit"), place("guard"));
        let unchanged = step.ray_registers().len();
        let mut datapath = Datapath {
            traced: Traced {
                reading,
                words: Vec::new(),
            },
            ray_ports: ray_ports.try_into().expect("a ray's four ports"),
            memory: step.memory(pyramid),
            answer: Vec::new(),
            step,
        };
        let idle = Ray {
            u: 0,
            v: 0,
            du: 0,
            dv: 0,
        };
        let mut setup_by_wires = Vec::new();
        let setup = (0..latency.setup).map(|_| {
            let mut entry = SetupEntry {
                valid: false,
                id: 0,
                inputs: [0; 4],
                words: Vec::new(),
                registers: Vec::new(),
            };
            datapath.set_up(idle, &mut entry.words, &mut entry.registers);
            entry
        });
        let setup = setup.collect();
        let stages = (0..=latency.step).map(|_| {
            let mut entry = StageEntry {
                valid: false,
                id: 0,
                inputs: Vec::new(),
                words: Vec::new(),
                registers: Vec::new(),
                next_walk: Vec::new(),
            };
            datapath.set_up(idle, &mut setup_by_wires, &mut entry.registers);
            datapath.enter(&mut entry);
            entry
        });
        TraverseMachine {
            stages: stages.collect(),
            datapath,
            unchanged,
            hit,
            guard,
            first: 0,
            setup,
            setup_by_wires,
            cycle: 0,
        }
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
        // The slot that falls free holds what enters.
        let entry = &mut self.stages[slot];
        let has_gap = !entry.valid || outputs.hit_valid && inputs.hit_ready;
        if !has_gap {
            entry.registers.truncate(self.unchanged);
            entry.registers.extend_from_slice(&entry.next_walk);
        }
        if outputs.ray_ready {
            match self.setup.pop_back() {
                // By wires, what is taken enters at once; it is taken into a gap only.
                None => {
                    (entry.valid, entry.id) = (inputs.ray_valid, inputs.ray_id);
                    let words = &mut self.setup_by_wires;
                    self.datapath
                        .set_up(inputs.ray, words, &mut entry.registers);
                }
                Some(mut ready) => {
                    // Without a gap the setup advances over an empty last stage of its own.
                    if has_gap {
                        (entry.valid, entry.id) = (ready.valid, ready.id);
                        std::mem::swap(&mut entry.registers, &mut ready.registers);
                    }
                    (ready.valid, ready.id) = (inputs.ray_valid, inputs.ray_id);
                    let ray = inputs.ray;
                    ready.inputs = [ray.u, ray.v, ray.du, ray.dv];
                    self.datapath
                        .set_up(ray, &mut ready.words, &mut ready.registers);
                    self.setup.push_front(ready);
                }
            }
        }
        self.datapath.enter(entry);
        self.first = slot;
        self.cycle += 1;
    }

    fn last(&self) -> usize {
        match self.first {
            0 => self.stages.len() - 1,
            first => first - 1,
        }
    }
}

/// What computes: setup, step and memory.
#[derive(Debug)]
struct Datapath<'a, R: Word, S: Step> {
    traced: Traced<R>,
    step: S,
    ray_ports: [Register; 4],
    memory: Cow<'a, [u16]>,
    /// What the hit would be; the probes have it from the words.
    answer: Vec<Named<Traced<R>>>,
}

impl<R: Word, S: Step> Datapath<'_, R, S> {
    /// Sets a ray up: its registers, and the result of every operation.
    fn set_up(
        &mut self,
        ray: Ray<u64>,
        words: &mut Vec<u64>,
        registers: &mut Vec<Signal<Traced<R>>>,
    ) {
        let inputs = [ray.u, ray.v, ray.du, ray.dv];
        let signal = |port: usize| {
            let (_, kind) = self.ray_ports[port];
            Signal::of_word(&self.traced, kind, inputs[port])
        };
        let signals = [0, 1, 2, 3].map(signal);
        words.clear();
        registers.clear();
        std::mem::swap(&mut self.traced.words, words);
        self.step.set_up_into(&mut self.traced, &signals, registers);
        std::mem::swap(&mut self.traced.words, words);
    }

    /// Evaluates the step on the registers of what enters the pipeline.
    fn enter(&mut self, entry: &mut StageEntry<R>) {
        let words = entry
            .registers
            .iter()
            .map(|signal| signal.word(&self.traced));
        entry.inputs.clear();
        entry.inputs.extend(words);
        entry.words.clear();
        entry.next_walk.clear();
        self.answer.clear();
        std::mem::swap(&mut self.traced.words, &mut entry.words);
        let address = self.step.address(&mut self.traced, &entry.registers);
        let height = i64::from(self.memory[address as usize]);
        self.step.step_into(
            &mut self.traced,
            &entry.registers,
            &[height],
            &mut entry.next_walk,
            &mut self.answer,
        );
        std::mem::swap(&mut self.traced.words, &mut entry.words);
    }
}
