//! The exact machine of a scene, with the frame's rays.

use std::ops::ControlFlow;

use anyhow::bail;

use hdl_gen::units::ExactUnit;
use rtl_model::frame::fit_scene;
use rtl_model::machine::{
    AxiMemoryShape, ExactEffort, ExactMachineShape, ExactRun, HitLedger, ID_BITS,
    OccupancyOverTime, StallPattern,
};
use rtl_model::maps::Pyramid;
use rtl_model::ray_format::QuantisedRay;
use rtl_model::scene::{Family, Machine, MachineEffort, MachineKind, Scene, WalkFormat};
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::walker::Walker;

use super::{Counted, MachineReport, SMALLEST_MAP};

/// The exact machine of a scene, with the frame's rays.
pub struct ExactScene {
    /// The hardware.
    pub unit: ExactUnit,
    /// The map.
    pub pyramid: Pyramid,
    /// The rays as the ports carry them, in the order in which they are sent.
    pub rays: Vec<QuantisedRay>,
    machine: Machine,
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
        let rays = scene
            .view()
            .rays_by_tile(pyramid.size(), machine.tile)?
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
            machine: *machine,
            pyramid,
        })
    }

    /// All rays sent through it. With a seed, senders, receivers and memory stall at random.
    pub fn run(&self, stalls: Option<u16>) -> ExactRun<'_> {
        let [gaps, receiver] = StallPattern::of_sender_and_receiver(stalls);
        ExactRun {
            shape: self.unit.shape.clone(),
            lines: self.pyramid.lines(self.unit.shape.bounded.log2_side),
            rays: &self.rays,
            gaps,
            stalls: receiver,
            receiver_starts: 0,
            memory: AxiMemoryShape::of(&self.machine, stalls),
        }
    }

    /// Runs the golden machine alone, and holds every hit against the golden walks. With a seed,
    /// senders, receivers and memory stall at random.
    pub fn golden_run(&self, stalls: Option<u16>) -> MachineReport {
        let shape = self.unit.shape.bounded;
        let run = self.run(stalls);
        let mut ledger = HitLedger::new(run.golden_hits(self.pyramid.lines(2)));
        let mut occupancy = OccupancyOverTime::default();
        let mut counted = Counted::default();
        let summary = run.run(|machine, inputs, outputs| {
            let begins = outputs.admits || outputs.recirculates || outputs.returns;
            occupancy.cycle(begins);
            if !begins {
                match machine.is_set_up() {
                    true => counted.gaps_without_room += 1,
                    false => counted.gaps_without_ray += 1,
                }
            }
            if outputs.hit_valid && inputs.hit_ready {
                let hit = machine.hit();
                counted.guards += u64::from(hit.guard);
                ledger.enter(&hit.words(shape));
            }
            ControlFlow::Continue(())
        });
        counted.trips = summary.counts.trips;
        counted.lines_fetched = summary.counts.lines_fetched;
        counted.refusals = Some(summary.counts.refusals);
        MachineReport::new(
            MachineKind::Exact,
            &summary,
            counted,
            ledger.report(),
            occupancy,
        )
    }
}
