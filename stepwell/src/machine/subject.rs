//! The machine of a scene, whichever it is.

use std::sync::Arc;

use hdl_gen::netlist::Module;
use hdl_gen::units::Probe;
use hdl_gen::verify::{ClockedRun, ExactDesign};
use rtl_model::scene::{Machine, MachineKind, Scene};

use super::{ExactScene, MachineReport, PaperScene};

/// The machine of a scene, with the frame's rays.
pub enum MachineScene {
    /// The paper's.
    Paper(PaperScene),
    /// The exact one.
    Exact(ExactScene),
}

impl MachineScene {
    /// Builds it.
    ///
    /// # Errors
    /// If the scene's walk is not the machine's, its map too small, or its frame too large.
    pub fn of(scene: &Scene, machine: &Machine) -> anyhow::Result<MachineScene> {
        Ok(match machine.kind {
            MachineKind::Paper => MachineScene::Paper(PaperScene::of(scene, machine)?),
            MachineKind::Exact => MachineScene::Exact(ExactScene::of(scene, machine)?),
        })
    }

    /// The hardware.
    pub fn design(&self) -> &Arc<Module> {
        match self {
            MachineScene::Paper(subject) => &subject.unit.design,
            MachineScene::Exact(subject) => &subject.unit.design,
        }
    }

    /// The hardware, to be changed.
    pub fn design_mut(&mut self) -> &mut Arc<Module> {
        match self {
            MachineScene::Paper(subject) => &mut subject.unit.design,
            MachineScene::Exact(subject) => &mut subject.unit.design,
        }
    }

    /// What is compared.
    pub fn probes(&self) -> &[Probe] {
        match self {
            MachineScene::Paper(subject) => &subject.unit.probes,
            MachineScene::Exact(subject) => &subject.unit.probes,
        }
    }

    /// Rays sent.
    pub fn sent(&self) -> u64 {
        match self {
            MachineScene::Paper(subject) => subject.rays.len() as u64,
            MachineScene::Exact(subject) => subject.rays.len() as u64,
        }
    }

    /// Runs the golden machine alone, and holds every hit against the golden walk. With a seed,
    /// senders, receivers and memory stall at random.
    pub fn golden_run(&self, stalls: Option<u16>) -> MachineReport {
        match self {
            MachineScene::Paper(subject) => subject.golden_run(stalls),
            MachineScene::Exact(subject) => subject.golden_run(stalls),
        }
    }

    /// Calls `with` with the comparison of a run, to be made in a simulator of choice.
    pub fn compare<T>(&self, stalls: Option<u16>, with: impl FnOnce(&ClockedRun<'_>) -> T) -> T {
        match self {
            MachineScene::Paper(subject) => subject.compare(stalls, with),
            MachineScene::Exact(subject) => {
                ExactDesign::of(&subject.unit).compare(&subject.run(stalls), with)
            }
        }
    }
}
