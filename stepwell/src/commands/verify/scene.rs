//! A scene's frame through the traverse unit.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, bail};

use hdl_gen::emit::write_design;
use hdl_gen::fault::plant;
use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use hdl_gen::verify::{
    Comparison, FoundSimulator, GoldenRun, SimulatedWaveform, TraceWindow, conform_window,
    golden_waveform, run_embedded, run_verilator, traverse_plan, verilator_waveform,
};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{ID_BITS, StallPattern};
use rtl_model::maps::Pyramid;
use rtl_model::ray::Ray;
use rtl_model::readings::E7F16;
use rtl_model::scene::{Scene, Walk};
use rtl_model::walker::Walker;

use super::summary::{Finished, SignalFacts, Summary};
use super::unit_map::unit_map;
use super::unit_walk::{unit_rays, unit_walk};
use super::{Arguments, Outcome};
use crate::output::OutputFolder;
use crate::progress;

/// Verifies the frame of a scene.
pub fn verify(arguments: &Arguments, path: &Path) -> anyhow::Result<Outcome> {
    let scene = arguments.replacements.load(path)?;
    if let Some(machine) = &scene.machine {
        return super::machine::verify(arguments, &scene, machine);
    }
    let map = scene.load_map()?;
    let pyramid = Pyramid::new(&map);
    let configuration = configuration(scene.walk, &pyramid)?;
    let rays = frame_rays(&scene, &pyramid)?;
    if rays.is_empty() {
        bail!(
            "scene {}: no pixel has a ray, so there is nothing to verify",
            scene.name
        );
    }
    let subject = Subject {
        walk: scene.walk,
        rays: ports(&configuration, &rays),
        configuration,
        map: scene.map.source.to_string(),
        pyramid,
    };
    subject.verify(arguments)
}

/// Verifies the traverse unit with random rays.
pub fn verify_random(arguments: &Arguments) -> anyhow::Result<Outcome> {
    let map = unit_map(&arguments.replacements.map)?;
    let pyramid = Pyramid::new(&map.source.load(map.channel, map.white_is_low)?);
    let walk = unit_walk(&arguments.replacements)?;
    let configuration = configuration(walk, &pyramid)?;
    let count = arguments.vectors.unwrap_or(RANDOM_RAYS);
    let rays = unit_rays(walk, &pyramid, count, arguments.seed)?;
    Subject {
        walk,
        rays: ports(&configuration, &rays),
        configuration,
        map: map.source.to_string(),
        pyramid,
    }
    .verify(arguments)
}

/// Random rays sent where nothing is said: what takes a few seconds in the slowest simulator.
const RANDOM_RAYS: u64 = 1_000;

/// Rays, and what they are sent through.
struct Subject {
    walk: Walk,
    configuration: UnitConfiguration,
    map: String,
    pyramid: Pyramid,
    /// As the unit's ports carry them.
    rays: Vec<Ray<u64>>,
}

/// The frame's rays, admitted.
fn frame_rays(scene: &Scene, pyramid: &Pyramid) -> anyhow::Result<Vec<Ray<f64>>> {
    let walker = Walker::new(scene.walk, pyramid)?;
    let rays = scene.view().rays(pyramid.size())?;
    let rays = rays.into_iter().flatten();
    rays.map(|ray| Ok(walker.admit(ray)?)).collect()
}

/// The unit of a walk, if there is one.
fn configuration(walk: Walk, pyramid: &Pyramid) -> anyhow::Result<UnitConfiguration> {
    let configuration = UnitConfiguration::of(walk, pyramid)?;
    configuration.check_loop()?;
    Ok(configuration)
}

fn ports(configuration: &UnitConfiguration, rays: &[Ray<f64>]) -> Vec<Ray<u64>> {
    let words = rays.iter().map(|&ray| configuration.port_words(ray));
    words.collect()
}

impl Subject {
    fn verify(&self, arguments: &Arguments) -> anyhow::Result<Outcome> {
        let Subject {
            walk,
            configuration,
            map,
            pyramid,
            rays,
        } = self;
        if rays.len() > 1 << ID_BITS {
            bail!(
                "{} rays are more than the unit's ids of {ID_BITS} bits tell apart; take a smaller \
                 --size",
                rays.len()
            );
        }
        let simulator = arguments.sim.find()?;
        let folder = arguments
            .output
            .as_deref()
            .map(OutputFolder::prepare)
            .transpose()?;
        let mut unit = TraverseUnit::build(*configuration);
        if let Some(fault) = &arguments.plant_fault {
            unit.design = plant(&unit.design, &fault.signal, fault.bit)?;
        }
        let run = GoldenRun {
            pyramid,
            rays,
            stalls: StallPattern::one_in_eight(arguments.seed as u16),
            step: configuration.step,
            latency: unit.latency,
        };
        let start = Instant::now();
        if let FoundSimulator::Verilator(verilator) = &simulator {
            let plan = traverse_plan(&unit, &run);
            verilator.build(&unit.design, &plan, arguments.vcd.is_some())?;
        }
        let build_seconds = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let mut files = Vec::new();
        let comparison = match &folder {
            None => simulate(arguments, &simulator, &unit, &run, None)?,
            Some(folder) => {
                let mut comparison = None;
                folder.publish(|folder| {
                    write_design(&unit.design, folder)?;
                    comparison = Some(simulate(arguments, &simulator, &unit, &run, Some(folder))?);
                    Ok(())
                })?;
                let output = arguments.output.clone().unwrap_or_default();
                files.push(output.join(format!("{}.v", unit.design.name)));
                if arguments.vcd.is_some() {
                    files.extend(["golden.vcd", "hardware.vcd"].map(|name| output.join(name)));
                }
                comparison.context("the run left no comparison")?
            }
        };
        let signals: Vec<SignalFacts> = unit
            .probes
            .iter()
            .map(|probe| SignalFacts {
                path: probe.path(),
                width: probe.width,
                meaning: probe.meaning,
                sources: probe.sources.clone(),
            })
            .collect();
        let finished = Finished {
            unit: &unit.design,
            simulator: &simulator,
            format: walk.format.to_string(),
            method: Some(walk.method.to_string()),
            map: Some(map.clone()),
            comparison,
            signals,
            sent: rays.len() as u64,
            exhaustive: false,
            seconds: start.elapsed().as_secs_f64(),
            build_seconds,
            files,
        };
        Summary::new(arguments, finished).answer(arguments.answer.json)
    }
}

/// Runs the hardware, and writes the waveforms that are asked for.
fn simulate(
    arguments: &Arguments,
    simulator: &FoundSimulator,
    unit: &TraverseUnit,
    run: &GoldenRun<'_>,
    folder: Option<&Path>,
) -> anyhow::Result<Comparison> {
    let window = arguments.vcd.as_ref().map(|window| window.0.clone());
    let waveforms = folder.zip(window);
    let format = unit.configuration.format;
    if let Some((folder, window)) = &waveforms {
        let output = create(&folder.join("golden.vcd"))?;
        golden_waveform(unit, run, window.clone(), output)?;
    }
    match simulator {
        FoundSimulator::Embedded => match waveforms {
            None => Ok(run_embedded(unit, run, |_, _, _| {})?),
            Some((folder, window)) => {
                let output = create(&folder.join("hardware.vcd"))?;
                let mut waveform =
                    SimulatedWaveform::new(unit, run.pyramid.memory(), window, output)?;
                let comparison = run_embedded(unit, run, |cycle, inputs, probes| {
                    waveform.observe(cycle, inputs, probes);
                })?;
                waveform.finish()?;
                Ok(comparison)
            }
        },
        FoundSimulator::Icarus(icarus) => {
            if let Some((folder, window)) = waveforms {
                let output = create(&folder.join("hardware.vcd"))?;
                icarus.waveform(unit, run, window, output)?;
            }
            Ok(icarus.run_traverse(unit, run)?)
        }
        FoundSimulator::Verilator(verilator) => {
            let raw = tempfile::NamedTempFile::new().context("a temporary file")?;
            let trace = waveforms.as_ref().map(|(_, window)| TraceWindow {
                file: raw.path().to_owned(),
                first: *window.start(),
                last: *window.end(),
            });
            let bar = progress::bar(run.rays.len() as u64, "rays");
            let advance = |rays| bar.set_position(rays);
            let comparison = match format {
                // The format the unit is made for: its arithmetic compiled for it.
                FloatFormat::E7F16 => {
                    run_verilator(verilator, unit, run, E7F16, trace.as_ref(), advance)
                }
                other => run_verilator(verilator, unit, run, other, trace.as_ref(), advance),
            };
            bar.finish_and_clear();
            let comparison = comparison?;
            if let Some((folder, window)) = waveforms {
                let input = BufReader::new(File::open(raw.path()).context("Verilator's waveform")?);
                let output = create(&folder.join("hardware.vcd"))?;
                conform_window(unit, input, &verilator_waveform(), window, output)?;
            }
            Ok(comparison)
        }
    }
}

/// A file of a waveform.
pub(super) fn create(path: &PathBuf) -> anyhow::Result<BufWriter<File>> {
    let file =
        File::create(path).with_context(|| format!("{}: cannot be written", path.display()))?;
    Ok(BufWriter::new(file))
}
