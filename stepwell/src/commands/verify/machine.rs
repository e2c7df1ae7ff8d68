//! A scene's frame through its whole machine.

use std::time::Instant;

use anyhow::bail;

use hdl_gen::emit::write_design;
use hdl_gen::fault::plant;
use hdl_gen::verify::{ClockedRun, Comparison, FoundSimulator, PaperDesign};
use rtl_model::float::FloatFormat;
use rtl_model::machine::PaperRun;
use rtl_model::readings::E7F16;
use rtl_model::scene::{Machine, MachineKind, Scene};

use super::summary::{Finished, SignalFacts, Summary};
use super::{Arguments, Outcome};
use crate::machine::PaperScene;
use crate::output::OutputFolder;
use crate::progress;

/// Verifies the frame of a scene that has a machine.
pub fn verify(arguments: &Arguments, scene: &Scene, machine: &Machine) -> anyhow::Result<Outcome> {
    if machine.kind != MachineKind::Paper {
        bail!(
            "scene {}: machine {} is not verified yet; take kind = \"paper\"",
            scene.name,
            machine.kind.name()
        );
    }
    if arguments.vcd.is_some() {
        bail!("--vcd: waveforms of machines are not written yet; leave it out");
    }
    let simulator = arguments.sim.find()?;
    let folder = arguments
        .output
        .as_deref()
        .map(OutputFolder::prepare)
        .transpose()?;
    let mut subject = PaperScene::of(scene, machine)?;
    if let Some(fault) = &arguments.plant_fault {
        subject.unit.design = plant(&subject.unit.design, &fault.signal, fault.bit)?;
    }
    let stalls = arguments.stalls.then_some(arguments.seed as u16);
    let report = subject.golden_run(stalls);
    let design = PaperDesign::of_unit(&subject.unit);
    let run = subject.run(stalls);
    let start = Instant::now();
    if let FoundSimulator::Verilator(verilator) = &simulator {
        let build = |run: &ClockedRun<'_>| verilator.build(run.unit, &run.plan(), false);
        compare(&design, &run, subject.format, build)?;
    }
    let build_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let comparison = match &simulator {
        FoundSimulator::Icarus(_) => bail!(
            "--sim icarus: machines are compared by Verilator or the embedded simulator; take \
             --sim verilator or --sim embedded"
        ),
        FoundSimulator::Embedded => compare(&design, &run, subject.format, |run| run.embedded())?,
        FoundSimulator::Verilator(verilator) => {
            let bar = progress::bar(report.cycles(), "cycles");
            let advance = |cycles| bar.set_position(cycles);
            let compared = compare(&design, &run, subject.format, |run| {
                run.verilator(verilator, None, advance)
            });
            bar.finish_and_clear();
            compared?
        }
    };
    let comparison = Comparison {
        guards: report.guards,
        ..comparison
    };
    let unit = &subject.unit.design;
    let mut files = Vec::new();
    if let Some(folder) = folder {
        folder.publish(|folder| Ok(write_design(unit, folder).map(|_| ())?))?;
        let output = arguments.output.clone().unwrap_or_default();
        files.push(output.join(format!("{}.v", unit.name)));
    }
    let facts = subject.unit.probes.iter().map(|probe| SignalFacts {
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
        sent: subject.rays.len() as u64,
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

/// The comparison of a run, in the format the unit is made for where it is known when this is
/// compiled.
fn compare<T>(
    design: &PaperDesign,
    run: &PaperRun<'_>,
    format: FloatFormat,
    with: impl FnOnce(&ClockedRun<'_>) -> T,
) -> T {
    match format {
        FloatFormat::E7F16 => design.compare(run, E7F16, with),
        other => design.compare(run, other, with),
    }
}
