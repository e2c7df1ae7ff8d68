//! What is compared in every cycle, and what the golden model says it must be.

use crate::netlist::Meaning;
use rtl_model::machine::{CycleInputs, STEP_INPUTS, TraverseMachine};
use rtl_model::readings::Word;

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
/// cycle, what stands in front of the first stage, and the result of every operation on it.
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
    /// Place of the first of [`STEP_INPUTS`].
    pub const INPUTS: usize = 4;
    /// Place of the first operation's result.
    pub const OPERATIONS: usize = Self::INPUTS + STEP_INPUTS.len();

    /// Takes the words of the machine's present cycle.
    pub fn take<R: Word>(
        &mut self,
        machine: &TraverseMachine<'_, R>,
        inputs: &CycleInputs<R::Num>,
    ) {
        let outputs = machine.outputs(inputs);
        let entry = machine.entry();
        let words = &mut self.0;
        words.clear();
        words.push(outputs.ray_ready.into());
        words.push(outputs.hit_valid.into());
        words.push(entry.valid.into());
        words.push(entry.id.into());
        words.extend_from_slice(&entry.inputs);
        words.extend_from_slice(&entry.words);
    }
}
