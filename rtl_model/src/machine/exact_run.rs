//! The exact machine run on a list of rays, with a memory behind it.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::axi_memory::{AxiMemory, AxiMemoryShape};
use super::exact::{ExactCounts, ExactHit, ExactInputs, ExactMachine, ExactOutputs};
use super::exact_shape::ExactMachineShape;
use super::ledger::HIT_WORDS;
use super::run_summary::{PATIENCE, RunSummary, WAITING};
use super::stall::StallPattern;
use crate::maps::Lines;
use crate::ray_format::QuantisedRay;
use crate::units::bounded::bounded_walk;
use crate::units::bounded_shape::BoundedShape;
use crate::units::fixed_traverse::FixedHit;
use crate::units::traverse::Status;
use crate::units::wide_fixed::wide_fixed_walk;
use crate::units::wide_fixed_step::WideFixedShape;

/// What stands on the ports where no ray is offered.
const NO_RAY: QuantisedRay = QuantisedRay {
    u: 0,
    v: 0,
    du: 0,
    dv: 0,
    saturated: false,
};

/// Rays to be sent through the exact machine, and how.
#[derive(Clone, Debug)]
pub struct ExactRun<'a> {
    /// What the machine is built as.
    pub shape: ExactMachineShape,
    /// The map's lines: what the memory holds.
    pub lines: &'a Lines,
    /// The rays; a ray's id is its place here.
    pub rays: &'a [QuantisedRay],
    /// When the sender has nothing to offer.
    pub gaps: StallPattern,
    /// When the receiver of hits is not ready.
    pub stalls: StallPattern,
    /// Before this cycle the receiver is never ready.
    pub receiver_starts: u64,
    /// The memory.
    pub memory: AxiMemoryShape,
}

/// A hit of the golden walk as words, in the order in which a [`super::HitLedger`] has them.
fn words_of(id: u32, hit: &FixedHit) -> [u64; HIT_WORDS] {
    [
        id.into(),
        hit.i.into(),
        hit.j.into(),
        hit.side.into(),
        hit.depth_numerator as u64,
        hit.depth_denominator as u64,
        hit.steps.into(),
        hit.crossings.into(),
        (hit.status == Status::Guard).into(),
    ]
}

impl ExactHit {
    /// The hit and its id as words of a [`super::HitLedger`].
    pub fn words(&self, shape: BoundedShape) -> [u64; HIT_WORDS] {
        words_of(self.id, &self.fixed_hit(shape))
    }

    /// The hit as the golden walk answers it.
    pub fn fixed_hit(&self, shape: BoundedShape) -> FixedHit {
        let at_border = self.at_border_u || self.at_border_v;
        FixedHit {
            i: self.i,
            j: self.j,
            side: at_border || self.depth == 0,
            depth_numerator: match at_border {
                true => -self.way << shape.words.height_bits,
                false => self.depth,
            },
            depth_denominator: if at_border { self.slope } else { 1 },
            steps: self.steps,
            crossings: self.crossings,
            status: match self.guard {
                true => Status::Guard,
                false => Status::Hit,
            },
        }
    }
}

impl ExactRun<'_> {
    /// What must leave for each ray: texel, side or top and depth of the exact walk with its error
    /// term, by lines of 4 x 4 heights, which shares no step with the machine's; steps and
    /// crossings are those of the walk by bounds, where the machine counts.
    pub fn golden_hits(&self, lines_of_16: &Lines) -> Vec<[u64; HIT_WORDS]> {
        let shape = self.shape.bounded;
        let exact = WideFixedShape {
            words: shape.words,
            log2_side: 2,
        };
        let counted = |count: u32| if self.shape.counters { count } else { 0 };
        let hits = self.rays.par_iter().enumerate().map(|(id, ray)| {
            let own = bounded_walk(shape, self.lines, ray);
            let hit = FixedHit {
                steps: counted(own.steps),
                crossings: counted(own.crossings),
                ..wide_fixed_walk(exact, lines_of_16, ray)
            };
            words_of(id as u32, &hit)
        });
        hits.collect()
    }

    /// Runs the machine until every ray has left it, and calls `each` with every cycle. Ends early
    /// where `each` breaks, and where no hit leaves any more: then fewer hits than rays have left.
    pub fn run(
        &self,
        mut each: impl FnMut(&ExactMachine, &ExactInputs, &ExactOutputs) -> ControlFlow<()>,
    ) -> RunSummary<ExactCounts> {
        let mut memory = AxiMemory::new(self.memory, self.shape.memory_words(self.lines));
        let mut machine = ExactMachine::new(self.shape.clone());
        let (mut gaps, mut stalls) = (self.gaps, self.stalls);
        let (mut taken, mut offers) = (0, false);
        let mut summary = RunSummary::<ExactCounts>::default();
        let (mut first_entry, mut last_hit) = (None, 0);
        // More cycles than the rays need: nothing may leave the machine that never entered.
        let mut cycles_to_come = 64;
        while cycles_to_come > 0 {
            let all_left = summary.hits == self.rays.len() as u64;
            cycles_to_come -= u64::from(all_left);
            // An offer stands until it is taken.
            offers = taken < self.rays.len() && (offers || gaps.next_ready());
            let answer = memory.outputs();
            let inputs = ExactInputs {
                ray_valid: offers,
                ray_id: if offers { taken as u32 } else { 0 },
                ray: match offers {
                    true => self.rays[taken],
                    false => NO_RAY,
                },
                hit_ready: stalls.next_ready() && machine.cycle() >= self.receiver_starts,
                arready: answer.arready,
                r: answer.r,
            };
            let outputs = machine.outputs(&inputs);
            if each(&machine, &inputs, &outputs).is_break() {
                break;
            }
            if outputs.admits {
                first_entry.get_or_insert(machine.cycle());
            }
            if first_entry.is_some() && self.rays.len() - taken >= WAITING {
                summary.busy_cycles += 1;
                let begins = outputs.admits || outputs.returns || outputs.recirculates;
                summary.busy_trips += u64::from(begins);
            }
            if offers && outputs.ray_ready {
                taken += 1;
                offers = false;
            }
            if outputs.hit_valid && inputs.hit_ready {
                summary.hits += 1;
                last_hit = machine.cycle();
            }
            machine.clock(&inputs);
            memory.clock(&outputs.ar, outputs.rready);
            if !all_left && machine.cycle() - last_hit > PATIENCE {
                break;
            }
        }
        summary.cycles = first_entry.map_or(0, |first| (last_hit + 1).saturating_sub(first));
        summary.counts = machine.counts();
        summary.bytes = 8 * memory.beats();
        summary
    }
}
