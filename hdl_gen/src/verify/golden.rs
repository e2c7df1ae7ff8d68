//! The golden side: the machine run on a list of rays, cycle by cycle.

use crate::units::{CycleWords, Probe};
use rtl_model::machine::{CycleInputs, CycleOutputs, StallPattern, TraverseMachine, UnitLatency};
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::readings::{FloatReading, HasFormat};
use rtl_model::units::any_step::AnyStep;
use std::ops::ControlFlow;

/// Rays to be sent through the traverse unit, and how.
#[derive(Clone, Debug)]
pub struct GoldenRun<'a> {
    /// The map's pyramid: what the height memory holds.
    pub pyramid: &'a Pyramid,
    /// The rays, as bits of the unit's format; a ray's id is its place here.
    pub rays: &'a [Ray<u64>],
    /// When the receiver of hits is not ready.
    pub stalls: StallPattern,
    /// What a step does.
    pub step: AnyStep,
    /// Cycles of the unit's pipelines.
    pub latency: UnitLatency,
}

impl GoldenRun<'_> {
    /// Cycles in reset before cycle 0: enough for every stage to fill with the idle ray.
    pub fn reset_cycles(&self) -> u32 {
        self.latency.setup + self.latency.step + 2
    }

    /// Runs the machine until every ray has left it, and calls `each` with every cycle: the
    /// inputs, what the outputs must be, and all words known of the cycle. Ends early where `each`
    /// breaks. Returns the cycles run.
    pub fn run<H: HasFormat + std::fmt::Debug>(
        &self,
        format: H,
        mut each: impl FnMut(&CycleInputs, &CycleOutputs, &CycleWords) -> ControlFlow<()>,
    ) -> u64 {
        let reading = FloatReading(format);
        let mut machine = TraverseMachine::new(reading, self.step, self.pyramid, self.latency);
        let mut stalls = self.stalls;
        let mut words = CycleWords::default();
        let mut offered = 0;
        let mut left = 0;
        // A few cycles more than the rays need: nothing may leave the unit that never entered.
        let mut cycles_to_come = u64::from(self.latency.setup + self.latency.step) + 1;
        while left < self.rays.len() || cycles_to_come > 0 {
            if left == self.rays.len() {
                cycles_to_come -= 1;
            }
            let ray = self.rays.get(offered);
            let inputs = CycleInputs {
                ray_valid: ray.is_some(),
                ray_id: if ray.is_some() { offered as u32 } else { 0 },
                ray: ray.copied().unwrap_or(Ray {
                    u: 0,
                    v: 0,
                    du: 0,
                    dv: 0,
                }),
                hit_ready: stalls.next_ready(),
            };
            let outputs = machine.outputs(&inputs);
            words.take(&machine, &outputs);
            if each(&inputs, &outputs, &words).is_break() {
                break;
            }
            offered += usize::from(inputs.ray_valid && outputs.ray_ready);
            left += usize::from(outputs.hit_valid && inputs.hit_ready);
            machine.clock(&inputs);
        }
        machine.cycle()
    }
}

/// The words of the last cycles, so that a register can be held against what entered the pipeline
/// as many cycles before as it stands behind the entry.
#[derive(Clone, Debug)]
pub struct History {
    cycles: Vec<Vec<u64>>,
    newest: usize,
}

impl History {
    /// A history of `latency + 1` cycles.
    pub fn new(latency: u32) -> History {
        History {
            cycles: vec![Vec::new(); latency as usize + 1],
            newest: 0,
        }
    }

    /// Appends a cycle. The first one also stands for all before it: the idle unit after reset.
    pub fn push(&mut self, words: &[u64]) {
        if self.cycles[self.newest].is_empty() {
            for cycle in &mut self.cycles {
                cycle.extend_from_slice(words);
            }
            return;
        }
        self.newest = (self.newest + 1) % self.cycles.len();
        let cycle = &mut self.cycles[self.newest];
        cycle.clear();
        cycle.extend_from_slice(words);
    }

    /// What the golden model says a probe must show in the newest cycle.
    pub fn expected(&self, probe: &Probe) -> u64 {
        let count = self.cycles.len();
        let cycle = (self.newest + count - probe.delay as usize) % count;
        self.cycles[cycle][probe.word] & probe.mask()
    }
}
