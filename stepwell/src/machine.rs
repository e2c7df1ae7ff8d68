//! A scene's machine: built, its rays, its golden run, and what that came to.

mod exact;
mod subject;

use std::ops::ControlFlow;

use anyhow::{Context, bail};
use serde::Serialize;

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::units::{PaperLoop, PaperUnit, paper_stages};
use hdl_gen::verify::{ClockedRun, PaperDesign};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{
    AxiMemoryShape, HitLedger, HitReport, ID_BITS, Lookups, OccupancyOverTime, PaperRun,
    PaperShape, RunSummary, StallPattern,
};
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::readings::{E7F16, FloatReading, HasFormat, enter};
use rtl_model::scene::{
    Crossing, Machine, MachineKind, MachineLatencies, Method, Scene, WalkFormat, fifo_that_fills,
};
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse::shape_for;
use rtl_model::walker::Walker;

pub use exact::ExactScene;
pub use subject::MachineScene;

/// Texels on a side of the smallest map whose pyramid has lines to cache.
const SMALLEST_MAP: u32 = 16;

/// The paper's machine of a scene, with the frame's rays.
pub struct PaperScene {
    /// The hardware.
    pub unit: PaperUnit,
    /// Cycles of its operators.
    pub latencies: MachineLatencies,
    /// The number format.
    pub format: FloatFormat,
    /// The map.
    pub pyramid: Pyramid,
    /// The rays as the ports carry them, in the order in which they are sent.
    pub rays: Vec<Ray<u64>>,
    machine: Machine,
}

impl PaperScene {
    /// Builds it, with operators of the machine's latencies. Where the machine does not say its
    /// FIFOs, they are what fills its loop.
    ///
    /// # Errors
    /// If the scene's walk is not the paper's, its map too small, or its frame too large.
    pub fn of(scene: &Scene, machine: &Machine) -> anyhow::Result<PaperScene> {
        let name = &scene.name;
        let walks = scene.walk;
        let format = match (walks.method, walks.format, walks.crossing) {
            (Method::MixedSelective, WalkFormat::Float(format), Crossing::Index) => format,
            _ => bail!(
                "scene {name}: machine paper walks by mixed-selective in a float, crossing by index, \
                 and the scene says {} in {}; take --method mixed-selective --format e7f16",
                walks.method,
                walks.format
            ),
        };
        let pyramid = Pyramid::new(&scene.load_map()?);
        if pyramid.size() < SMALLEST_MAP {
            bail!(
                "scene {name}: machine paper needs a map of {SMALLEST_MAP} texels a side or more, \
                 and this has {}: its pyramid has no lines to cache",
                pyramid.size()
            );
        }
        let walker = Walker::new(walks, &pyramid)?;
        let mut reading = FloatReading(format);
        let rays = scene
            .view()
            .rays_by_tile(pyramid.size(), machine.tile)?
            .into_iter()
            .map(|ray| Ok(enter(&mut reading, walker.admit(ray)?)))
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
        let step = PaperStep {
            shape: shape_for(&pyramid),
            layout: HeightLayout::Tiles,
        };
        let latencies = machine.latencies.unwrap_or_default();
        let operators = OperatorLatencies::from(latencies);
        let shape = |machine: &Machine| PaperShape::new(step, format.width(), machine);
        let stages = paper_stages(&step, format, &operators, shape(machine).height_stage());
        let shape = shape(&Machine {
            fifo: Some(machine.fifo.unwrap_or(fifo_that_fills(stages))),
            ..*machine
        });
        let paper = PaperLoop::build(&shape, format, &operators);
        Ok(PaperScene {
            unit: PaperUnit::build(&paper),
            latencies,
            format,
            rays,
            machine: *machine,
            pyramid,
        })
    }

    /// All rays sent through it. With a seed, senders, receivers and memory stall at random.
    pub fn run(&self, stalls: Option<u16>) -> PaperRun<'_> {
        let [gaps, receiver] = StallPattern::of_sender_and_receiver(stalls);
        PaperRun {
            shape: self.unit.paper.shape.clone(),
            pyramid: &self.pyramid,
            rays: &self.rays,
            gaps,
            stalls: receiver,
            memory: AxiMemoryShape::of(&self.machine, stalls),
            pass_cycles: self.unit.paper.step.latency,
        }
    }

    /// Calls `with` with the comparison of a run, to be made in a simulator of choice.
    pub fn compare<T>(&self, stalls: Option<u16>, with: impl FnOnce(&ClockedRun<'_>) -> T) -> T {
        let design = PaperDesign::of_unit(&self.unit);
        let run = self.run(stalls);
        match self.format {
            // The format the unit is made for: its arithmetic compiled for it.
            FloatFormat::E7F16 => design.compare(&run, E7F16, with),
            other => design.compare(&run, other, with),
        }
    }

    /// Runs the golden machine alone, and holds every hit against the golden walk. With a seed,
    /// senders, receivers and memory stall at random.
    pub fn golden_run(&self, stalls: Option<u16>) -> MachineReport {
        match self.format {
            // The format the unit is made for: its arithmetic compiled for it.
            FloatFormat::E7F16 => self.golden(E7F16, stalls),
            other => self.golden(other, stalls),
        }
    }

    fn golden<H>(&self, format: H, stalls: Option<u16>) -> MachineReport
    where
        H: HasFormat + std::fmt::Debug + Send + Sync,
    {
        let run = self.run(stalls);
        let mut ledger = HitLedger::new(run.golden_hits(&FloatReading(format)));
        let mut occupancy = OccupancyOverTime::default();
        let mut guards = 0;
        let summary = run.run(FloatReading(format), |machine, inputs, outputs| {
            occupancy.cycle(outputs.admits || outputs.recirculates);
            if outputs.hit_valid && inputs.hit_ready {
                guards += u64::from(outputs.hit_guard);
                ledger.enter(machine.hit());
            }
            ControlFlow::Continue(())
        });
        let counts = summary.counts;
        let counted = Counted {
            trips: counts.passes,
            gaps_without_ray: counts.gaps_without_ray,
            gaps_without_room: counts.gaps_without_room,
            lines_fetched: counts.lines_fetched,
            refusals: None,
            guards,
        };
        MachineReport::new(
            MachineKind::Paper,
            &summary,
            counted,
            ledger.report(),
            occupancy,
        )
    }
}

/// The machine of a scene.
///
/// # Errors
/// If the scene has none.
pub fn machine_of(scene: &Scene) -> anyhow::Result<Machine> {
    scene.machine.with_context(|| {
        format!(
            "scene {}: it has no table [machine]; add one with kind = \"{}\" or \"{}\"",
            scene.name,
            MachineKind::Paper.name(),
            MachineKind::Exact.name()
        )
    })
}

/// What is counted of a run beside its summary.
#[derive(Clone, Copy, Debug, Default)]
struct Counted {
    trips: u64,
    /// Cycles in which no trip began since no ray waited, and since there was no room.
    gaps_without_ray: u64,
    gaps_without_room: u64,
    lines_fetched: u64,
    refusals: Option<u64>,
    guards: u64,
}

/// What a golden machine's run came to.
#[derive(Clone, Debug, Serialize)]
pub struct MachineReport {
    /// Which machine.
    pub machine: &'static str,
    /// Trips begun a cycle, while 64 rays or more wait; none where there were never so many.
    pub occupancy: Option<f64>,
    /// From the first ray's entry to the last hit, of each pixel that has a ray.
    pub cycles_per_pixel: f64,
    /// Trips round the loop.
    pub trips: u64,
    /// Cycles in which none began since no ray waited.
    pub gaps_without_ray: u64,
    /// Cycles in which none began since there was no room behind the loop, or the cache was being
    /// cleared.
    pub gaps_without_room: u64,
    /// Of the exact machine: walks that the leaf check sent back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refusals: Option<u64>,
    /// Lookups that found their height, of all.
    pub cache_hit_rate: f64,
    /// Lines fetched.
    pub lines_fetched: u64,
    /// Bytes that came from the memory, of each pixel that has a ray.
    pub memory_bytes_per_pixel: f64,
    /// Rays that never left.
    pub lost: u64,
    /// Hits that left twice.
    pub duplicated: u64,
    /// Hits other than the golden walk's.
    pub hits_differing: u64,
    /// Walks that ended at the step bound. Whoever prints a report has a place for them.
    #[serde(skip)]
    pub guards: u64,
    #[serde(skip)]
    occupancy_over_time: OccupancyOverTime,
}

impl MachineReport {
    fn new<C: Lookups>(
        kind: MachineKind,
        summary: &RunSummary<C>,
        counted: Counted,
        hits: HitReport,
        occupancy_over_time: OccupancyOverTime,
    ) -> MachineReport {
        MachineReport {
            machine: kind.name(),
            occupancy: (summary.busy_cycles > 0).then(|| summary.occupancy()),
            cycles_per_pixel: summary.cycles_per_ray(),
            trips: counted.trips,
            gaps_without_ray: counted.gaps_without_ray,
            gaps_without_room: counted.gaps_without_room,
            refusals: counted.refusals,
            cache_hit_rate: summary.hit_rate(),
            lines_fetched: counted.lines_fetched,
            memory_bytes_per_pixel: summary.bytes as f64 / summary.hits.max(1) as f64,
            lost: hits.lost(),
            duplicated: hits.duplicated,
            hits_differing: hits.differing,
            guards: counted.guards,
            occupancy_over_time,
        }
    }

    /// Did every ray leave once, with the golden walk's hit?
    pub fn agrees(&self) -> bool {
        self.lost == 0 && self.duplicated == 0 && self.hits_differing == 0
    }

    /// Cycles of the run.
    pub fn cycles(&self) -> u64 {
        self.trips + self.gaps_without_ray + self.gaps_without_room
    }

    /// For each span of cycles its middle and the trips begun a cycle.
    pub fn occupancy_points(&self) -> Vec<(f64, f64)> {
        self.occupancy_over_time.points()
    }

    /// Rows for people.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let occupancy = match self.occupancy {
            Some(occupancy) => format!("{occupancy:.3} trips a cycle while 64 rays or more wait"),
            None => "never as many as 64 rays waited".to_owned(),
        };
        let refusals = self.refusals.map(|refusals| {
            let share = refusals as f64 / self.trips.max(1) as f64;
            (
                "leaf check",
                format!(
                    "{refusals} walks sent back, {:.2} % of trips",
                    100.0 * share
                ),
            )
        });
        let mut rows = vec![
            ("machine", self.machine.to_owned()),
            ("occupancy", occupancy),
            ("cycles", format!("{:.2} a pixel", self.cycles_per_pixel)),
            (
                "trips",
                format!(
                    "{}; cycles without one: {} no ray waited, {} no room behind",
                    self.trips, self.gaps_without_ray, self.gaps_without_room
                ),
            ),
            (
                "cache",
                format!(
                    "{:.2} % hits, {} lines fetched, {:.2} bytes a pixel",
                    100.0 * self.cache_hit_rate,
                    self.lines_fetched,
                    self.memory_bytes_per_pixel
                ),
            ),
            (
                "hits",
                format!(
                    "{} lost, {} left twice, {} other than the golden walk's",
                    self.lost, self.duplicated, self.hits_differing
                ),
            ),
        ];
        rows.extend(refusals);
        rows
    }
}
