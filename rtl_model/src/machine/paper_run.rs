//! The paper's traverse unit run on a list of rays, with a memory behind it.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::axi_memory::{AxiMemory, AxiMemoryShape};
use super::ledger::HIT_WORDS;
use super::paper::{PaperCounts, PaperInputs, PaperMachine, PaperOutputs};
use super::paper_shape::PaperShape;
use super::run_summary::{PATIENCE, RunSummary, WAITING};
use super::stall::StallPattern;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::readings::{NumberFormat, Word};
use crate::units::paper_step::PAPER_POLICY;
use crate::units::traverse::{Status, walk};

/// Rays to be sent through the paper's unit, and how.
#[derive(Clone, Debug)]
pub struct PaperRun<'a> {
    /// What the unit is built as.
    pub shape: PaperShape,
    /// The map's pyramid: what the memory holds.
    pub pyramid: &'a Pyramid,
    /// The rays, as bits of the unit's format; a ray's id is its place here.
    pub rays: &'a [Ray<u64>],
    /// When the sender has nothing to offer.
    pub gaps: StallPattern,
    /// When the receiver of hits is not ready.
    pub stalls: StallPattern,
    /// The memory.
    pub memory: AxiMemoryShape,
    /// Cycles of a pass.
    pub pass_cycles: u32,
}

impl PaperRun<'_> {
    /// What must leave FIFO 1 for each ray, as [`PaperMachine::hit`] has it: the golden walk's hit.
    pub fn golden_hits<R>(&self, reading: &R) -> Vec<[u64; HIT_WORDS]>
    where
        R: Word + NumberFormat + Clone + Sync,
    {
        let memory = self.pyramid.memory();
        let hits = self.rays.par_iter().enumerate().map(|(id, &ray)| {
            let mut reading = reading.clone();
            let entered = ray.map(|word| reading.number(word));
            let hit = walk(&mut reading, PAPER_POLICY, self.pyramid, memory, entered);
            [
                id as u64,
                hit.i.into(),
                hit.j.into(),
                reading.word(hit.t),
                reading.word(hit.u),
                reading.word(hit.v),
                hit.steps.into(),
                hit.crossings.into(),
                (hit.status == Status::Guard).into(),
            ]
        });
        hits.collect()
    }

    /// Cycles in reset before cycle 0: enough for every stage to fill with what stands in an empty
    /// FIFO 0.
    pub fn reset_cycles(&self) -> u32 {
        self.pass_cycles + 4
    }

    /// Runs the machine until every ray has left it, and calls `each` with every cycle. Ends early
    /// where `each` breaks, and where no hit leaves any more: then fewer hits than rays have left.
    pub fn run<R: Word>(
        &self,
        reading: R,
        mut each: impl FnMut(&PaperMachine<R>, &PaperInputs, &PaperOutputs) -> ControlFlow<()>,
    ) -> RunSummary<PaperCounts> {
        let words = PaperMachine::<R>::memory_words(&self.shape, self.pyramid);
        let mut memory = AxiMemory::new(self.memory, words);
        let mut machine =
            PaperMachine::new(reading, self.shape.clone(), self.pyramid, self.pass_cycles);
        let (mut gaps, mut stalls) = (self.gaps, self.stalls);
        let (mut taken, mut offers) = (0, false);
        let mut summary = RunSummary::<PaperCounts>::default();
        let (mut first_entry, mut last_hit) = (None, 0);
        // A few cycles more than the rays need: nothing may leave the unit that never entered.
        let mut cycles_to_come = u64::from(self.pass_cycles) + 4;
        while cycles_to_come > 0 {
            let all_left = summary.hits == self.rays.len() as u64;
            cycles_to_come -= u64::from(all_left);
            // An offer stands until it is taken.
            offers = taken < self.rays.len() && (offers || gaps.next_ready());
            let answer = memory.outputs();
            let idle = Ray {
                u: 0,
                v: 0,
                du: 0,
                dv: 0,
            };
            let inputs = PaperInputs {
                ray_valid: offers,
                ray_id: if offers { taken as u32 } else { 0 },
                ray: if offers { self.rays[taken] } else { idle },
                hit_ready: stalls.next_ready(),
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
                summary.busy_trips += u64::from(outputs.admits || outputs.recirculates);
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
