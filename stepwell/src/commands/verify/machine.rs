//! A scene's frame through its whole machine.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, bail};

use hdl_gen::emit::write_design;
use hdl_gen::fault::plant;
use hdl_gen::verify::{ClockedRun, Comparison, FoundSimulator, TraceWindow, verilator_waveform};
use rtl_model::scene::{Machine, Scene};

use super::scene::create;
use super::summary::{Finished, SignalFacts, Summary};
use super::{Arguments, Outcome};
use crate::machine::MachineScene;
use crate::output::OutputFolder;
use crate::progress;

/// Verifies the frame of a scene that has a machine.
pub fn verify(arguments: &Arguments, scene: &Scene, machine: &Machine) -> anyhow::Result<Outcome> {
    let simulator = arguments.sim.find()?;
    let folder = arguments
        .output
        .as_deref()
        .map(OutputFolder::prepare)
        .transpose()?;
    let mut subject = MachineScene::of(scene, machine)?;
    if let Some(fault) = &arguments.plant_fault {
        *subject.design_mut() = plant(subject.design(), &fault.signal, fault.bit)?;
    }
    let stalls = arguments.stalls.then_some(arguments.seed as u16);
    let report = subject.golden_run(stalls);
    let start = Instant::now();
    if let FoundSimulator::Verilator(verilator) = &simulator {
        let traced = arguments.vcd.is_some();
        let build = |run: &ClockedRun<'_>| verilator.build(run.unit, &run.plan(), traced);
        subject.compare(stalls, build)?;
    }
    let build_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let mut comparison = None;
    let mut files = Vec::new();
    let mut simulated = |folder: Option<&Path>| -> anyhow::Result<()> {
        let cycles = report.cycles();
        comparison = Some(subject.compare(stalls, |run| {
            simulate(arguments, &simulator, run, cycles, folder)
        })?);
        Ok(())
    };
    let unit = subject.design();
    match folder {
        None => simulated(None)?,
        Some(folder) => {
            folder.publish(|folder| {
                write_design(unit, folder)?;
                simulated(Some(folder))
            })?;
            let output = arguments.output.clone().unwrap_or_default();
            files.push(output.join(format!("{}.v", unit.name)));
            if arguments.vcd.is_some() {
                files.extend(WAVEFORMS.map(|name| output.join(name)));
            }
        }
    }
    let comparison = comparison.context("the run left no comparison")?;
    let comparison = Comparison {
        guards: report.guards,
        ..comparison
    };
    let facts = subject.probes().iter().map(|probe| SignalFacts {
        path: probe.path(),
        width: probe.width,
        meaning: probe.meaning,
        sources: probe.sources.clone(),
    });
    let finished = Finished {
        unit,
        simulator: &simulator,
        format: scene.walk.format.to_string(),
        method: Some(scene.walk.method.to_string()),
        map: Some(scene.map.source.to_string()),
        comparison,
        signals: facts.collect(),
        sent: subject.sent(),
        exhaustive: false,
        seconds: start.elapsed().as_secs_f64(),
        build_seconds,
        files,
    };
    let agrees = report.agrees();
    let outcome = Summary::new(arguments, finished)
        .of_machine(report)
        .answer(arguments.answer.json)?;
    Ok(if agrees { outcome } else { Outcome::Disagreed })
}

/// The files of waveforms: golden, and the hardware's.
const WAVEFORMS: [&str; 2] = ["golden.vcd", "hardware.vcd"];

/// Runs a machine, and writes into the folder the waveforms that are asked for.
fn simulate(
    arguments: &Arguments,
    simulator: &FoundSimulator,
    run: &ClockedRun<'_>,
    cycles: u64,
    folder: Option<&Path>,
) -> anyhow::Result<Comparison> {
    let window = arguments.vcd.as_ref().map(|window| window.0.clone());
    let waveforms = folder.zip(window);
    if let Some((folder, window)) = &waveforms {
        run.golden_waveform(window.clone(), create(&folder.join(WAVEFORMS[0]))?)?;
    }
    match (simulator, waveforms) {
        (FoundSimulator::Icarus(_), _) => bail!(
            "--sim icarus: machines are compared by Verilator or the embedded simulator; take \
             --sim verilator or --sim embedded, or stepwell emit, whose testbench Icarus runs"
        ),
        (FoundSimulator::Embedded, None) => Ok(run.embedded()?),
        (FoundSimulator::Embedded, Some((folder, window))) => {
            let output = create(&folder.join(WAVEFORMS[1]))?;
            let (comparison, written) = run.embedded_waveform(window, output)?;
            written?;
            Ok(comparison)
        }
        (FoundSimulator::Verilator(verilator), waveforms) => {
            let raw = tempfile::NamedTempFile::new().context("a temporary file")?;
            let trace = waveforms.as_ref().map(|(_, window)| TraceWindow {
                file: raw.path().to_owned(),
                first: *window.start(),
                last: *window.end(),
            });
            let bar = progress::bar(cycles, "cycles");
            let comparison =
                run.verilator(verilator, trace.as_ref(), |cycles| bar.set_position(cycles));
            bar.finish_and_clear();
            let comparison = comparison?;
            if let Some((folder, window)) = waveforms {
                let input = BufReader::new(File::open(raw.path()).context("Verilator's waveform")?);
                let output = create(&folder.join(WAVEFORMS[1]))?;
                run.conform_waveform(input, &verilator_waveform(), window, output)?;
            }
            Ok(comparison)
        }
    }
}
