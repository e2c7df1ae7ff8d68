//! What is compared in every cycle, and what the golden model says it must be.

use crate::netlist::Meaning;
use rtl_model::machine::{CycleOutputs, TraverseMachine};
use rtl_model::readings::Word;
use rtl_model::units::step::Step;

/// A signal of the design whose value the golden model knows in every cycle.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The instances it stands in, the top module first.
    pub scope: Vec<String>,
    /// Its name in its module.
    pub name: String,
    /// Its bits.
    pub width: u32,
    /// How they are meant.
    pub meaning: Meaning,
    /// Which of the cycle's [`CycleWords`] it holds ...
    pub word: usize,
    /// ... and of how many cycles before.
    pub delay: u32,
    /// What its value is computed from: paths of other probes or of input ports, and how many
    /// cycles before. Empty where that is not known.
    pub sources: Vec<(String, u32)>,
}

impl Probe {
    /// Instances and name, joined by points.
    pub fn path(&self) -> String {
        format!("{}.{}", self.scope.join("."), self.name)
    }

    /// A mask of its bits.
    pub fn mask(&self) -> u64 {
        u64::MAX >> (64 - self.width)
    }
}

/// The words the golden machine says of one cycle, in a fixed order: what its control does in this
/// cycle, what stands in front of the first stage and the result of every operation on it; then,
/// for every stage of the setup's pipeline, what stands there and all results of it.
#[derive(Clone, Debug, Default)]
pub struct CycleWords(pub Vec<u64>);

impl CycleWords {
    /// Place of `ray_ready_o`.
    pub const RAY_READY: usize = 0;
    /// Place of `hit_valid_o`.
    pub const HIT_VALID: usize = 1;
    /// Place of the first stage's valid bit.
    pub const VALID: usize = 2;
    /// Place of the first stage's id.
    pub const ID: usize = 3;
    /// Place of the first of the step's registers.
    pub const INPUTS: usize = 4;

    /// Takes the words of the machine's present cycle, in which its outputs are these.
    pub fn take<R: Word, S: Step>(
        &mut self,
        machine: &TraverseMachine<'_, R, S>,
        outputs: &CycleOutputs,
    ) {
        let entry = machine.entry();
        let words = &mut self.0;
        words.clear();
        words.push(outputs.ray_ready.into());
        words.push(outputs.hit_valid.into());
        words.push(entry.valid.into());
        words.push(entry.id.into());
        words.extend_from_slice(&entry.inputs);
        words.extend_from_slice(&entry.words);
        for entry in machine.setup_entries() {
            words.push(entry.valid.into());
            words.push(entry.id.into());
            words.extend_from_slice(&entry.inputs);
            words.extend_from_slice(&entry.words);
        }
    }
}

/// Where the words of a unit's cycles stand: how many there are of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CycleLayout {
    /// Registers in front of the step.
    pub registers: usize,
    /// Operations of the step.
    pub operations: usize,
    /// Ports of a ray.
    pub ray_ports: usize,
    /// Operations of the setup.
    pub setup_operations: usize,
}

impl CycleLayout {
    /// Place of the result of an operation of the step.
    pub fn operation(&self, word: usize) -> usize {
        CycleWords::INPUTS + self.registers + word
    }

    /// Place of the valid bit of a stage of the setup, 1 the first; the id is behind it.
    pub fn setup_valid(&self, stage: u32) -> usize {
        let of_a_stage = 2 + self.ray_ports + self.setup_operations;
        self.operation(self.operations) + (stage as usize - 1) * of_a_stage
    }

    /// Place of a ray's port in a stage of the setup.
    pub fn setup_input(&self, stage: u32, place: usize) -> usize {
        self.setup_valid(stage) + 2 + place
    }

    /// Place of the result of an operation in a stage of the setup.
    pub fn setup_operation(&self, stage: u32, word: usize) -> usize {
        self.setup_input(stage, self.ray_ports) + word
    }
}
