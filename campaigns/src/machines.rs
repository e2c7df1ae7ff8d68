//! Whole machines on whole frames: every signal in every cycle, every hit, with and without stalls.
//!
//! Seven maps, three cameras. A machine is held against its golden model in every cycle, its hits
//! against the golden walk, and their texels against the exact reference of the ray as the machine
//! has it. For all maps of a size a machine is built once.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use anyhow::bail;
use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use hdl_gen::units::{ExactUnit, PaperLoop, PaperUnit};
use hdl_gen::verify::{ClockedRun, Comparison, ExactDesign, PaperDesign, Verilator};
use rayon::prelude::*;
use rtl_model::calibration::{CAMERAS, SURFACES};
use rtl_model::camera::View;
use rtl_model::exact::exact_hit;
use rtl_model::float::FloatFormat;
use rtl_model::machine::{
    AxiMemoryShape, ExactEffort, ExactMachineShape, ExactRun, HitLedger, HitReport, Lookups,
    PaperRun, PaperShape, RunSummary, StallPattern,
};
use rtl_model::maps::{HeightMap, Pyramid};
use rtl_model::ray::Ray;
use rtl_model::ray_format::{QuantisedRay, RayFormat, RayRange};
use rtl_model::readings::{E7F16, FloatReading, NumberFormat, enter};
use rtl_model::scene::{FrameSize, Machine, MachineCache, MachineKind};
use rtl_model::units::bounded_shape::BoundedShape;
use rtl_model::units::paper_step::{HeightLayout, PaperStep};
use rtl_model::units::traverse::shape_for;
use serde::Serialize;

use crate::frames::{Subject, Variant};

/// Lines of 16 heights of every machine's cache: 16 KiB of 8-bit heights.
const CACHE_LINES: u32 = 1024;
/// Pixels on a side of the tiles in which rays come.
const TILE: u32 = 16;
/// The most texels of the paper's 24-bit float that may be wrong, as a share of the rays of all
/// frames: of few rays the share says nothing.
const MOST_WRONG_IN_FLOAT: f64 = 0.0005;

/// A machine of the campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MachineChoice {
    /// That of the 2013 paper, `e7f16`.
    Paper,
    /// The exact one with lines of 2 x 2 heights, of little area.
    ExactQuad,
    /// The exact one with lines of 4 x 4 heights, of few cycles.
    ExactBlock,
}

impl MachineChoice {
    /// All.
    pub const ALL: [MachineChoice; 3] = [
        MachineChoice::Paper,
        MachineChoice::ExactQuad,
        MachineChoice::ExactBlock,
    ];

    /// Its name in options and tables.
    pub const fn name(self) -> &'static str {
        match self {
            MachineChoice::Paper => "paper",
            MachineChoice::ExactQuad => "exact-quad",
            MachineChoice::ExactBlock => "exact-block",
        }
    }
}

/// The seed of stalls.
pub const STALL_SEED: u16 = 0x5eed;

/// A map, and its rays from one of the cameras, tile by tile.
pub struct MachineFrame {
    /// The map, as in the paper's tables.
    pub map_name: String,
    /// The camera.
    pub camera: &'static str,
    map: Arc<HeightMap>,
    pyramid: Arc<Pyramid>,
    rays: Vec<Ray<f64>>,
    /// The formats of all rays over maps of this size.
    format: RayFormat,
}

impl MachineFrame {
    /// The frames of maps and cameras whose names are wanted.
    ///
    /// # Errors
    /// A map that is not there.
    pub fn load(
        workspace: &Path,
        screen: FrameSize,
        wanted: impl Fn(&str, &str) -> bool,
    ) -> anyhow::Result<Vec<MachineFrame>> {
        let mut frames = Vec::new();
        // Formats are those of all maps and cameras, so that a part is run on the same hardware.
        let mut ranges: BTreeMap<u32, (RayRange, Arc<Pyramid>)> = BTreeMap::new();
        for calibrated in &SURFACES {
            let subject = Subject::load(workspace, calibrated, Variant::Own)?;
            let (map, pyramid) = subject.into_map_and_pyramid();
            let (map, pyramid) = (Arc::new(map), Arc::new(pyramid));
            for (camera, view) in &CAMERAS {
                let view = View::new(view, &calibrated.surface, screen.width, screen.height);
                let rays = view.rays_by_tile(map.size(), TILE)?;
                let range = rays.iter().map(|&ray| RayRange::of(ray));
                let Some(range) = range.reduce(RayRange::and) else {
                    continue;
                };
                ranges
                    .entry(map.size())
                    .and_modify(|(all, _)| *all = all.and(range))
                    .or_insert_with(|| (range, pyramid.clone()));
                if wanted(calibrated.name, camera) {
                    frames.push((calibrated.name, camera, map.clone(), pyramid.clone(), rays));
                }
            }
        }
        let frames = frames
            .into_iter()
            .map(|(map_name, camera, map, pyramid, rays)| {
                let (range, sample) = &ranges[&map.size()];
                MachineFrame {
                    map_name: map_name.to_owned(),
                    camera,
                    format: RayFormat::for_rays(range, sample),
                    map,
                    pyramid,
                    rays,
                }
            });
        Ok(frames.collect())
    }
}

/// What a machine came to on a frame.
#[derive(Clone, Debug, Serialize)]
pub struct MachineRow {
    /// The machine.
    pub machine: &'static str,
    /// The map.
    pub map: String,
    /// The camera.
    pub camera: String,
    /// Sender, receiver and memory stalled at random.
    pub stalls: bool,
    /// Rays sent.
    pub rays: u64,
    /// Cycles from the first ray's entry to the last hit.
    pub cycles: u64,
    /// Of each pixel that has a ray.
    pub cycles_per_pixel: f64,
    /// Trips begun a cycle while 64 rays or more wait.
    pub occupancy: f64,
    /// Lookups that found their line, of all.
    pub hit_rate: f64,
    /// Bytes from the memory, of each pixel that has a ray.
    pub bytes_per_pixel: f64,
    /// Signals compared in every cycle.
    pub signals: u64,
    /// Cycles in which they were.
    pub cycles_compared: u64,
    /// Signals that were not the golden model's.
    pub mismatches: u64,
    /// Hits that left the hardware.
    pub hits: u64,
    /// Rays that never left.
    pub lost: u64,
    /// Hits that left twice.
    pub duplicated: u64,
    /// Hits other than the golden walk's.
    pub wrong_hits: u64,
    /// Hits in another texel than the exact one of the ray as the machine has it.
    pub wrong_texels: u64,
    /// The first signals that differed.
    pub first: Vec<String>,
    /// Wall-clock seconds of the comparison.
    pub seconds: f64,
    /// All of it as it must be, but for the wrong texels of a float, which
    /// [`wrong_texels_are_few`] judges over all frames.
    pub agreed: bool,
}

/// Of all rays of frames, are no more texels wrong than the paper's 24-bit float may have? One is
/// always granted.
pub fn wrong_texels_are_few(rows: &[MachineRow]) -> bool {
    let rays: u64 = rows.iter().map(|row| row.rays).sum();
    let wrong: u64 = rows.iter().map(|row| row.wrong_texels).sum();
    wrong <= 1.max((MOST_WRONG_IN_FLOAT * rays as f64) as u64)
}

impl MachineRow {
    /// One line for a terminal.
    pub fn line(&self) -> String {
        format!(
            "{:<11} {:<8} {:<8} {:<6} {:>7} rays {:>6.2} cycles/px {:.3} full {:>5.1} % cache \
             {:>5.2} B/px {:>5} signals {:>9} cycles {:>3} mismatches {:>2} lost {:>2} twice {:>2} \
             wrong hits {:>3} wrong texels {:>6.1} s{}",
            self.machine,
            self.map,
            self.camera,
            if self.stalls { "stalls" } else { "free" },
            self.rays,
            self.cycles_per_pixel,
            self.occupancy,
            100.0 * self.hit_rate,
            self.bytes_per_pixel,
            self.signals,
            self.cycles_compared,
            self.mismatches,
            self.lost,
            self.duplicated,
            self.wrong_hits,
            self.wrong_texels,
            self.seconds,
            if self.agreed { "" } else { "  DIFFERS" }
        )
    }
}

/// What runs the hardware.
pub enum Hardware<'a> {
    /// Compiled by Verilator; a design seen before is not compiled again.
    Verilator(&'a Verilator),
    /// The embedded simulator.
    Embedded,
}

impl Hardware<'_> {
    fn compare(&self, run: &ClockedRun<'_>) -> anyhow::Result<Comparison> {
        Ok(match self {
            Hardware::Verilator(verilator) => run.verilator(verilator, None, |_| ())?,
            Hardware::Embedded => run.embedded()?,
        })
    }
}

/// What is run.
pub struct MachineCampaign<'a> {
    /// What runs the hardware.
    pub hardware: Hardware<'a>,
    /// A signal of the hardware and a bit of it that are planted wrong: the campaign must see it.
    pub planted: Option<(String, u32)>,
}

impl MachineCampaign<'_> {
    /// Sends a frame's rays through a machine.
    ///
    /// # Errors
    /// A design that cannot be built or run, or a frame without rays.
    pub fn run(
        &self,
        machine: MachineChoice,
        frame: &MachineFrame,
        stalls: bool,
    ) -> anyhow::Result<MachineRow> {
        if frame.rays.is_empty() {
            bail!("{} {}: no pixel has a ray", frame.map_name, frame.camera);
        }
        let seed = stalls.then_some(STALL_SEED);
        match machine {
            MachineChoice::Paper => self.paper(frame, seed),
            MachineChoice::ExactQuad => self.exact(machine, 1, ExactEffort::AREA, frame, seed),
            MachineChoice::ExactBlock => {
                self.exact(machine, 2, ExactEffort::THROUGHPUT, frame, seed)
            }
        }
    }

    fn planted(&self, design: &Arc<Module>) -> anyhow::Result<Arc<Module>> {
        match &self.planted {
            Some((signal, bit)) => Ok(plant(design, signal, *bit)?),
            None => Ok(design.clone()),
        }
    }

    fn paper(&self, frame: &MachineFrame, seed: Option<u16>) -> anyhow::Result<MachineRow> {
        let format = FloatFormat::E7F16;
        let step = PaperStep {
            shape: shape_for(&frame.pyramid),
            layout: HeightLayout::Tiles,
        };
        let machine = Machine {
            cache: cache(),
            ..Machine::of_kind(MachineKind::Paper)
        };
        let shape = PaperShape::new(step, format.width(), &machine);
        let unit = PaperUnit::build(&PaperLoop::build(&shape, format, &OperatorLatencies::PAPER));
        let reading = FloatReading(E7F16);
        let rays: Vec<Ray<u64>> = frame
            .rays
            .iter()
            .map(|&ray| enter(&mut { reading }, ray))
            .collect();
        let [gaps, stalls] = StallPattern::of_sender_and_receiver(seed);
        let run = PaperRun {
            shape,
            pyramid: &frame.pyramid,
            rays: &rays,
            gaps,
            stalls,
            memory: AxiMemoryShape::of(&machine, seed),
            pass_cycles: unit.paper.step.latency,
        };
        let golden = run.golden_hits(&reading);
        let wrong = golden.par_iter().map(|words| {
            let entered = rays[words[0] as usize].map(|number| reading.to_f64(number));
            let truth = exact_hit(&frame.map, entered)?;
            Ok(u64::from(
                words[1..3] != [u64::from(truth.i), truth.j.into()],
            ))
        });
        let wrong = wrong.sum::<anyhow::Result<u64>>()?;
        let mut ledger = HitLedger::new(golden);
        let summary = run.run(reading, |machine, inputs, outputs| {
            if outputs.hit_valid && inputs.hit_ready {
                ledger.enter(machine.hit());
            }
            std::ops::ControlFlow::Continue(())
        });
        let mut design = PaperDesign::of_unit(&unit);
        design.design = self.planted(&design.design)?;
        let start = Instant::now();
        let comparison = design.compare(&run, E7F16, |run| self.hardware.compare(run))?;
        Ok(row(
            (MachineChoice::Paper, frame, seed.is_some()),
            &summary,
            ledger.report(),
            comparison,
            (wrong, false),
            start,
        ))
    }

    fn exact(
        &self,
        choice: MachineChoice,
        log2_side: u32,
        effort: ExactEffort,
        frame: &MachineFrame,
        seed: Option<u16>,
    ) -> anyhow::Result<MachineRow> {
        let words = frame.format.shape();
        let bounded = BoundedShape::new(words, log2_side);
        let shape = ExactMachineShape::new(bounded, effort, &cache(), true);
        let unit = ExactUnit::build(&shape);
        let rays: Vec<QuantisedRay> = frame
            .rays
            .iter()
            .map(|&ray| frame.format.quantise(ray))
            .collect();
        let lines = frame.pyramid.lines(log2_side);
        let [gaps, stalls] = StallPattern::of_sender_and_receiver(seed);
        let run = ExactRun {
            shape,
            lines,
            rays: &rays,
            gaps,
            stalls,
            receiver_starts: 0,
            memory: AxiMemoryShape::of(&Machine::of_kind(MachineKind::Exact), seed),
        };
        let golden = run.golden_hits(frame.pyramid.lines(2));
        let wrong = golden.par_iter().map(|words| {
            let entered = frame.format.entered(&rays[words[0] as usize]);
            let truth = exact_hit(&frame.map, entered)?;
            let expected: [u64; 3] = [truth.i.into(), truth.j.into(), truth.side.into()];
            Ok(u64::from(words[1..4] != expected))
        });
        let wrong = wrong.sum::<anyhow::Result<u64>>()?;
        let mut ledger = HitLedger::new(golden);
        let summary = run.run(|machine, inputs, outputs| {
            if outputs.hit_valid && inputs.hit_ready {
                ledger.enter(&machine.hit().words(bounded));
            }
            std::ops::ControlFlow::Continue(())
        });
        let mut design = ExactDesign::of(&unit);
        design.design = self.planted(&design.design)?;
        let start = Instant::now();
        let comparison = design.compare(&run, |run| self.hardware.compare(run))?;
        Ok(row(
            (choice, frame, seed.is_some()),
            &summary,
            ledger.report(),
            comparison,
            (wrong, true),
            start,
        ))
    }
}

fn cache() -> MachineCache {
    MachineCache {
        lines: CACHE_LINES,
        ..MachineCache::default()
    }
}

fn row<C: Lookups>(
    (machine, frame, stalls): (MachineChoice, &MachineFrame, bool),
    summary: &RunSummary<C>,
    hits: HitReport,
    comparison: Comparison,
    (wrong_texels, is_exact): (u64, bool),
    start: Instant,
) -> MachineRow {
    let rays = frame.rays.len() as u64;
    let agreed = comparison.mismatches == 0
        && comparison.cycles_compared > 0
        && comparison.rays == rays
        && hits.agrees()
        && (!is_exact || wrong_texels == 0);
    let first = comparison.first.iter().map(|one| {
        format!(
            "cycle {}: {}.{} is {:#x}, not {:#x}",
            one.cycle, one.unit, one.signal, one.found, one.expected
        )
    });
    MachineRow {
        machine: machine.name(),
        map: frame.map_name.clone(),
        camera: frame.camera.to_owned(),
        stalls,
        rays,
        cycles: summary.cycles,
        cycles_per_pixel: summary.cycles_per_ray(),
        occupancy: summary.occupancy(),
        hit_rate: summary.hit_rate(),
        bytes_per_pixel: summary.bytes as f64 / rays as f64,
        signals: comparison.signals_compared,
        cycles_compared: comparison.cycles_compared,
        mismatches: comparison.mismatches,
        hits: comparison.rays,
        lost: hits.lost(),
        duplicated: hits.duplicated,
        wrong_hits: hits.differing,
        wrong_texels,
        first: first.collect(),
        seconds: start.elapsed().as_secs_f64(),
        agreed,
    }
}
