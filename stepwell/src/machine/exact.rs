//! The exact machine of a scene, with the frame's rays.

use std::ops::ControlFlow;

use anyhow::bail;
use rayon::prelude::*;

use hdl_gen::units::ExactUnit;
use rtl_model::frame::fit_scene;
use rtl_model::machine::{
    AxiMemoryShape, ExactEffort, ExactMachineShape, ExactRun, HitLedger, ID_BITS,
    OccupancyOverTime, StallPattern,
};
use rtl_model::maps::Pyramid;
use rtl_model::ray_format::QuantisedRay;
use rtl_model::scene::{Family, Machine, MachineEffort, Scene, WalkFormat};
use rtl_model::units::bounded::bounded_walk;
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::units::fixed_traverse::FixedHit;
use rtl_model::units::traverse::Status;
use rtl_model::units::wide_fixed::wide_fixed_walk;
use rtl_model::units::wide_fixed_step::WideFixedShape;
use rtl_model::walker::Walker;

use super::{GapsByCause, MachineReport, SMALLEST_MAP, rays_by_tile};

/// Words of a hit.
const HIT_WORDS: usize = 9;

/// The exact machine of a scene, with the frame's rays.
pub struct ExactScene {
    /// The hardware.
    pub unit: ExactUnit,
    /// The map.
    pub pyramid: Pyramid,
    /// The rays as the ports carry them, in the order in which they are sent.
    pub rays: Vec<QuantisedRay>,
    memory: AxiMemoryShape,
}

impl ExactScene {
    /// Builds it. The width of its step is that of the scene's method; it has the effort that the
    /// machine asks for, or else little area where a line is 2 x 2 and few cycles where it is 4 x 4.
    ///
    /// # Errors
    /// If the scene's walk is not by bounds in fixed point, its map too small, or its frame too
    /// large.
    pub fn of(scene: &Scene, machine: &Machine) -> anyhow::Result<ExactScene> {
        let name = &scene.name;
        let log2_side = match (scene.walk.method.family(), scene.walk.format) {
            (Family::Bounded { log2_side }, WalkFormat::Fixed(_)) => log2_side,
            _ => bail!(
                "scene {name}: machine exact walks by bounds in fixed point, and the scene says {} \
                 in {}; take --method bounded-quad or bounded-block, --format fixed",
                scene.walk.method,
                scene.walk.format
            ),
        };
        let pyramid = Pyramid::new(&scene.load_map()?);
        if pyramid.size() < SMALLEST_MAP {
            bail!(
                "scene {name}: machine exact needs a map of {SMALLEST_MAP} texels a side or more, \
                 and this has {}: its pyramid has no lines to cache",
                pyramid.size()
            );
        }
        let fit = fit_scene(scene, &pyramid)?;
        let walker = Walker::new(fit.walk, &pyramid)?;
        let Some(format) = fit.ray_format else {
            bail!("scene {name}: no pixel has a ray, so the machine has nothing to do");
        };
        let rays = rays_by_tile(scene, &pyramid, machine.tile)?
            .into_iter()
            .map(|ray| Ok(format.quantise(walker.admit(ray)?)))
            .collect::<anyhow::Result<Vec<_>>>()?;
        if rays.is_empty() {
            bail!("scene {name}: no pixel has a ray, so the machine has nothing to do");
        }
        if rays.len() > 1 << ID_BITS {
            bail!(
                "scene {name}: {} rays are more than ids of {ID_BITS} bits tell apart; take a \
                 smaller --size",
                rays.len()
            );
        }
        let effort = match (machine.effort, log2_side) {
            (Some(MachineEffort::Area), _) | (None, 1) => ExactEffort::AREA,
            (Some(MachineEffort::Throughput), _) | (None, _) => ExactEffort::THROUGHPUT,
        };
        let bounded = BoundedShape::new(format.shape(), log2_side);
        let shape = ExactMachineShape::new(bounded, effort, &machine.cache, machine.counters);
        Ok(ExactScene {
            unit: ExactUnit::build(&shape),
            rays,
            memory: AxiMemoryShape {
                latency: machine.memory.latency,
                bytes_per_cycle: machine.memory.bytes_per_cycle,
                outstanding: machine.cache.pending,
                stalls: machine.memory.stalls.then_some(1),
            },
            pyramid,
        })
    }

    /// All rays sent through it. With a seed, senders, receivers and memory stall at random.
    pub fn run(&self, stalls: Option<u16>) -> ExactRun<'_> {
        let pattern = |turned: u32| match stalls {
            Some(seed) => StallPattern::one_in_eight(seed.rotate_left(turned)),
            None => StallPattern::never(),
        };
        ExactRun {
            shape: self.unit.shape.clone(),
            lines: self.pyramid.lines(self.unit.shape.bounded.log2_side),
            rays: &self.rays,
            gaps: pattern(3),
            stalls: pattern(0),
            receiver_starts: 0,
            memory: AxiMemoryShape {
                stalls: stalls.or(self.memory.stalls),
                ..self.memory
            },
        }
    }

    /// Runs the golden machine alone, and holds every hit against the golden walks. With a seed,
    /// senders, receivers and memory stall at random.
    pub fn golden_run(&self, stalls: Option<u16>) -> MachineReport {
        let shape = self.unit.shape.bounded;
        let expected: Vec<[u64; HIT_WORDS]> = (0..self.rays.len())
            .into_par_iter()
            .map(|id| hit_words(id as u32, &self.golden_hit(id)))
            .collect();
        let mut ledger = HitLedger::new(expected.concat(), HIT_WORDS);
        let mut occupancy = OccupancyOverTime::default();
        let (mut guards, mut gaps) = (0, GapsByCause::default());
        let summary = self.run(stalls).run(|machine, inputs, outputs| {
            let begins = outputs.admits || outputs.recirculates || outputs.returns;
            occupancy.cycle(begins);
            if !begins {
                match machine.is_set_up() {
                    true => gaps.without_room += 1,
                    false => gaps.without_ray += 1,
                }
            }
            if outputs.hit_valid && inputs.hit_ready {
                let hit = machine.hit();
                guards += u64::from(hit.guard);
                ledger.enter(&hit_words(hit.id, &hit.fixed_hit(shape)));
            }
            ControlFlow::Continue(())
        });
        MachineReport::of_exact(summary, ledger.report(), gaps, guards, occupancy)
    }

    /// What must leave for a ray: texel, side or top and depth of the exact walk with its error
    /// term, which shares no step with the machine's; the counts are those of the machine's own.
    fn golden_hit(&self, id: usize) -> FixedHit {
        let shape = self.unit.shape.bounded;
        let own = bounded_walk(shape, self.pyramid.lines(shape.log2_side), &self.rays[id]);
        let exact = WideFixedShape {
            words: shape.words,
            log2_side: 2,
        };
        // Without counters the hardware has none.
        let counted = |count: u32| if self.unit.shape.counters { count } else { 0 };
        FixedHit {
            steps: counted(own.steps),
            crossings: counted(own.crossings),
            ..wide_fixed_walk(exact, self.pyramid.lines(2), &self.rays[id])
        }
    }
}

fn hit_words(id: u32, hit: &FixedHit) -> [u64; HIT_WORDS] {
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
