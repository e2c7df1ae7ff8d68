//! What stands in the stages of the paper's loop, and what is computed from it.

use crate::maps::Pyramid;
use crate::readings::{Traced, Word};
use crate::units::paper_step::PaperStep;
use crate::units::step::{Named, Signal};

/// What stands in a stage, and all that is computed from it.
#[derive(Debug)]
pub(super) struct Pass<R: Word> {
    pub(super) valid: bool,
    pub(super) id: u32,
    /// The words of the registers in front of the first stage.
    pub(super) inputs: Vec<u64>,
    /// The result of every operation; of those that depend on the height only from the stage in
    /// which the cache answers.
    pub(super) words: Vec<u64>,
    pub(super) address: u64,
    pub(super) starts: bool,
    pub(super) height: u64,
    pub(super) missed: bool,
    pub(super) registers: Vec<Signal<Traced<R>>>,
    pub(super) after: Vec<Signal<Traced<R>>>,
    pub(super) answers: Vec<Named<Traced<R>>>,
}

/// What computes, and the memory's heights, to guess what the cache will answer.
#[derive(Debug)]
pub(super) struct Datapath<R: Word> {
    traced: Traced<R>,
    step: PaperStep,
    heights: Vec<u16>,
    /// Registers that a ray carries unchanged.
    unchanged: usize,
}

impl<R: Word> Datapath<R> {
    /// The datapath of a pass on a map.
    pub(super) fn new(reading: R, step: PaperStep, pyramid: &Pyramid) -> Datapath<R> {
        Datapath {
            traced: Traced {
                reading,
                words: Vec::new(),
            },
            heights: step.memory(pyramid),
            unchanged: step.ray_registers().len(),
            step,
        }
    }

    /// Sets up what stands at the end of FIFO 0, be it a ray or not.
    pub(super) fn set_up(&mut self, waiting: &[u64], pass: &mut Pass<R>) {
        let &[id, u, v, du, dv] = waiting else {
            unreachable!("an id and a ray");
        };
        pass.id = id as u32;
        let ray = [u, v, du, dv].map(|word| Signal::Number(self.traced.number(word)));
        self.traced.words.clear();
        pass.registers.clear();
        self.step
            .set_up_into(&mut self.traced, &ray, &mut pass.registers);
    }

    /// What leaves the last stage without an answer enters the first again.
    pub(super) fn go_round(&self, pass: &mut Pass<R>) {
        pass.registers.truncate(self.unchanged);
        pass.registers.extend_from_slice(&pass.after);
    }

    /// What enters the first stage, with the height that the memory holds for it: all that does
    /// not depend on the height is right by that, and mostly the rest.
    pub(super) fn begin(&mut self, pass: &mut Pass<R>) {
        pass.starts = pass.registers[self.unchanged].bit();
        pass.inputs.clear();
        let words = pass.registers.iter();
        pass.inputs
            .extend(words.map(|signal| signal.word(&self.traced)));
        self.evaluate(pass, None);
    }

    /// The cache answers a pass.
    pub(super) fn answer(&mut self, pass: &mut Pass<R>, height: u64, missed: bool) {
        if (height, missed) != (pass.height, pass.missed) {
            debug_assert!(
                missed || pass.starts || !pass.valid,
                "the cache holds what the memory does"
            );
            self.evaluate(pass, Some((height, missed)));
        }
    }

    /// Evaluates a pass, with what the memory holds where the cache has not answered.
    fn evaluate(&mut self, pass: &mut Pass<R>, answer: Option<(u64, bool)>) {
        pass.words.clear();
        pass.after.clear();
        pass.answers.clear();
        std::mem::swap(&mut self.traced.words, &mut pass.words);
        pass.address = self.step.address(&mut self.traced, &pass.registers) as u64;
        let held = u64::from(self.heights[pass.address as usize]);
        (pass.height, pass.missed) = answer.unwrap_or((held, false));
        self.step.step_into(
            &mut self.traced,
            &pass.registers,
            pass.height as i64,
            pass.missed,
            &mut pass.after,
            &mut pass.answers,
        );
        std::mem::swap(&mut self.traced.words, &mut pass.words);
    }

    /// What a ray with its answer puts into FIFO 1.
    pub(super) fn hit_fields(&self, pass: &Pass<R>) -> [u64; 9] {
        let word = |signal: Signal<Traced<R>>| signal.word(&self.traced);
        let [_, guard, t, u, v, i, j] = pass.answers[..] else {
            unreachable!("the answers of the step");
        };
        let [steps, crossings] = [8, 9].map(|place: usize| word(pass.after[place]));
        let [i, j, t, u, v, guard] = [i, j, t, u, v, guard].map(|(_, signal)| word(signal));
        [pass.id.into(), i, j, t, u, v, steps, crossings, guard]
    }
}

impl<R: Word> Pass<R> {
    pub(super) fn empty() -> Pass<R> {
        Pass {
            valid: false,
            id: 0,
            inputs: Vec::new(),
            words: Vec::new(),
            address: 0,
            starts: false,
            height: 0,
            missed: false,
            registers: Vec::new(),
            after: Vec::new(),
            answers: Vec::new(),
        }
    }
}
