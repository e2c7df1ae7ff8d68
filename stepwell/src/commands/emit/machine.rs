//! A scene's machine, with its memory in the testbench.

use std::path::Path;

use anyhow::bail;

use hdl_gen::package::{Package, package_machine};
use hdl_gen::verify::{ExactDesign, PaperDesign};
use rtl_model::scene::{Machine, MachineKind, Scene};

use crate::machine::{ExactScene, MachineReport, PaperScene};

/// Emits the machine of a scene. With a seed, senders, receivers and memory stall at random.
pub fn package(
    scene: &Scene,
    machine: &Machine,
    stalls: Option<u16>,
    folder: &Path,
) -> anyhow::Result<Package> {
    match machine.kind {
        MachineKind::Paper => {
            let subject = PaperScene::of(scene, machine)?;
            check(&subject.golden_run(stalls))?;
            let design = PaperDesign::of_unit(&subject.unit);
            let run = subject.run(stalls);
            let surroundings = design.surroundings(&run);
            Ok(subject.compare(stalls, |run| {
                package_machine(run, &surroundings, scene, folder)
            })?)
        }
        MachineKind::Exact => {
            let subject = ExactScene::of(scene, machine)?;
            check(&subject.golden_run(stalls))?;
            let design = ExactDesign::of(&subject.unit);
            let run = subject.run(stalls);
            let surroundings = design.surroundings(&run);
            Ok(design.compare(&run, |run| {
                package_machine(run, &surroundings, scene, folder)
            })?)
        }
    }
}

/// The expected hits are the golden machine's: they must be the golden walk's.
fn check(report: &MachineReport) -> anyhow::Result<()> {
    if !report.agrees() {
        bail!(
            "the golden machine's hits are not the golden walk's ({} lost, {} twice, {} other): \
             this is a defect of stepwell",
            report.lost,
            report.duplicated,
            report.hits_differing
        );
    }
    Ok(())
}
