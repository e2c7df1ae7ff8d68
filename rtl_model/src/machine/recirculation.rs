//! The traverse unit as a loop: rays go round a pipeline of steps until they have hit.
//!
//! One pipeline of `latency` cycles computes a step. A ray that leaves it unfinished enters again
//! at once; where it has finished, it is offered as a hit, and goes round once more unchanged if
//! nobody takes it, so that nothing ever stalls. A new ray enters where the loop leaves a gap.

use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::readings::{Traced, Word};
use crate::units::search_policy::SearchPolicy;
use crate::units::step::RegisterKind;
use crate::units::traverse::{Hit, Status, shape_for};
use crate::units::traverse_setup::{RayRegisters, traverse_setup};
use crate::units::traverse_step::{
    COUNTER_BITS, INDEX_BITS, LEVEL_BITS, TraverseShape, WalkRegisters, node_address,
    traverse_step, walk_start,
};

/// Bits of the id that travels with a ray: the pixels of a frame of up to 1024 x 1024.
pub const ID_BITS: u32 = 20;

/// The registers in front of the pipeline's first stage, in the order of [`StageEntry::inputs`]:
/// first what a ray keeps, then what its walk changes. The netlist is built from this list.
pub const STEP_INPUTS: [(&str, RegisterKind); 19] = [
    ("u", RegisterKind::Number),
    ("v", RegisterKind::Number),
    ("du", RegisterKind::Number),
    ("dv", RegisterKind::Number),
    ("exact_below_u", RegisterKind::Number),
    ("exact_below_v", RegisterKind::Number),
    ("mirror_u", RegisterKind::Bit),
    ("mirror_v", RegisterKind::Bit),
    ("level", RegisterKind::Integer(LEVEL_BITS)),
    ("i", RegisterKind::Integer(INDEX_BITS)),
    ("j", RegisterKind::Integer(INDEX_BITS)),
    ("t", RegisterKind::Number),
    ("at_border_v", RegisterKind::Bit),
    ("corner_owed", RegisterKind::Bit),
    ("corner_paid", RegisterKind::Bit),
    ("steps", RegisterKind::Integer(COUNTER_BITS)),
    ("crossings", RegisterKind::Integer(COUNTER_BITS)),
    ("hit", RegisterKind::Bit),
    ("guard", RegisterKind::Bit),
];

/// What the unit's input ports carry in a cycle. The ray is zero where `ray_valid` is false.
#[derive(Clone, Copy, Debug)]
pub struct CycleInputs<N> {
    /// A ray is offered.
    pub ray_valid: bool,
    /// Its id.
    pub ray_id: u32,
    /// The ray.
    pub ray: Ray<N>,
    /// A hit would be taken.
    pub hit_ready: bool,
}

/// What the unit's output ports carry in a cycle. The hit is the pipeline's last stage, whatever
/// stands there; it counts where `hit_valid` is true.
#[derive(Clone, Copy, Debug)]
pub struct CycleOutputs<N> {
    /// A ray offered in this cycle enters.
    pub ray_ready: bool,
    /// A hit is offered.
    pub hit_valid: bool,
    /// Its ray's id.
    pub hit_id: u32,
    /// The hit.
    pub hit: Hit<N>,
}

/// What stands in the registers of the first stage in a cycle, and all that will be computed from
/// it while it goes down the pipeline.
#[derive(Debug)]
pub struct StageEntry<R: Word> {
    /// Is it a ray? Else a gap: the idle ray of the input ports, computed on like any other.
    pub valid: bool,
    /// The ray's id.
    pub id: u32,
    /// The registers, as [`STEP_INPUTS`] lists them.
    pub inputs: [u64; STEP_INPUTS.len()],
    /// The result of every operation of the step, in order.
    pub words: Vec<u64>,
    ray: RayRegisters<Traced<R>>,
    outcome: Outcome<R>,
}

#[derive(Debug)]
struct Outcome<R: Word> {
    walk: WalkRegisters<Traced<R>>,
    hit: Hit<R::Num>,
}

/// The traverse unit of a map, in a number format.
#[derive(Debug)]
pub struct TraverseMachine<'a, R: Word> {
    traced: Traced<R>,
    shape: TraverseShape,
    memory: &'a [u16],
    /// Stages 0 to `latency`, as a ring; `first` is stage 0.
    stages: Vec<StageEntry<R>>,
    first: usize,
    cycle: u64,
}

impl<'a, R: Word> TraverseMachine<'a, R> {
    /// The machine after its reset, in which every stage has filled with the idle ray.
    pub fn new(reading: R, pyramid: &'a Pyramid, latency: u32) -> Self {
        let shape = shape_for(pyramid);
        let mut traced = Traced {
            reading,
            words: Vec::new(),
        };
        let zero = traced.reading.zero();
        let idle = Ray {
            u: zero,
            v: zero,
            du: zero,
            dv: zero,
        };
        let memory = pyramid.memory();
        let (ray, walk) = set_up(&mut traced, shape, idle);
        let gap = Occupant {
            valid: false,
            id: 0,
        };
        let stages = (0..=latency)
            .map(|_| enter(&mut traced, shape, memory, gap, ray, walk))
            .collect();
        TraverseMachine {
            traced,
            shape,
            memory,
            stages,
            first: 0,
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

    /// What the output ports carry in this cycle.
    pub fn outputs(&self, inputs: &CycleInputs<R::Num>) -> CycleOutputs<R::Num> {
        let last = self.last();
        let walk = &last.outcome.walk;
        let hit_valid = last.valid && (walk.hit || walk.guard);
        let leaves = hit_valid && inputs.hit_ready;
        CycleOutputs {
            ray_ready: !last.valid || leaves,
            hit_valid,
            hit_id: last.id,
            hit: last.outcome.hit,
        }
    }

    /// The rising edge at the end of this cycle.
    pub fn clock(&mut self, inputs: &CycleInputs<R::Num>) {
        let outputs = self.outputs(inputs);
        let slot = (self.first + self.stages.len() - 1) % self.stages.len();
        let last = &mut self.stages[slot];
        let words = std::mem::take(&mut last.words);
        let (occupant, ray, walk) = if outputs.ray_ready {
            let (ray, walk) = set_up(&mut self.traced, self.shape, inputs.ray);
            (
                Occupant {
                    valid: inputs.ray_valid,
                    id: inputs.ray_id,
                },
                ray,
                walk,
            )
        } else {
            (
                Occupant {
                    valid: true,
                    id: last.id,
                },
                last.ray,
                last.outcome.walk,
            )
        };
        // The words of the slot that falls free hold the next ones: nothing is allocated.
        self.traced.words = words;
        self.stages[slot] = enter(
            &mut self.traced,
            self.shape,
            self.memory,
            occupant,
            ray,
            walk,
        );
        self.first = slot;
        self.cycle += 1;
    }

    fn last(&self) -> &StageEntry<R> {
        &self.stages[(self.first + self.stages.len() - 1) % self.stages.len()]
    }
}

#[derive(Clone, Copy)]
struct Occupant {
    valid: bool,
    id: u32,
}

fn set_up<R: Word>(
    traced: &mut Traced<R>,
    shape: TraverseShape,
    ray: Ray<R::Num>,
) -> (RayRegisters<Traced<R>>, WalkRegisters<Traced<R>>) {
    let setup = traverse_setup(
        traced,
        shape,
        SearchPolicy::OH,
        ray.u,
        ray.v,
        ray.du,
        ray.dv,
    );
    (setup.ray, walk_start(traced, SearchPolicy::OH, &setup))
}

/// Evaluates the step of what enters the pipeline.
fn enter<R: Word>(
    traced: &mut Traced<R>,
    shape: TraverseShape,
    memory: &[u16],
    occupant: Occupant,
    ray: RayRegisters<Traced<R>>,
    walk: WalkRegisters<Traced<R>>,
) -> StageEntry<R> {
    let inputs = {
        let word = |value| traced.reading.word(value);
        [
            word(ray.u),
            word(ray.v),
            word(ray.du),
            word(ray.dv),
            word(ray.exact_below_u),
            word(ray.exact_below_v),
            ray.mirror_u.into(),
            ray.mirror_v.into(),
            walk.level as u64,
            walk.i as u64,
            walk.j as u64,
            word(walk.t),
            walk.at_border_v.into(),
            walk.corner_owed.into(),
            walk.corner_paid.into(),
            walk.steps as u64,
            walk.crossings as u64,
            walk.hit.into(),
            walk.guard.into(),
        ]
    };
    traced.words.clear();
    let address = node_address(traced, shape, SearchPolicy::OH, &ray, &walk);
    let height = i64::from(memory[address as usize]);
    let result = traverse_step(traced, shape, SearchPolicy::OH, &ray, &walk, height);
    let walk = result.walk;
    StageEntry {
        valid: occupant.valid,
        id: occupant.id,
        inputs,
        words: std::mem::take(&mut traced.words),
        ray,
        outcome: Outcome {
            walk,
            hit: Hit {
                i: result.texel_i as u32,
                j: result.texel_j as u32,
                t: walk.t,
                u: result.position_u,
                v: result.position_v,
                steps: walk.steps as u32,
                crossings: walk.crossings as u32,
                status: if walk.guard {
                    Status::Guard
                } else {
                    Status::Hit
                },
            },
        },
    }
}
