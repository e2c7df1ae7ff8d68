//! The exact machine against its golden model: every declared signal and every register in every
//! cycle.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::clocked::{ClockedRun, EachCycle};
use crate::netlist::Module;
use crate::units::{ExactUnit, Probe};
use crate::vectors::MachineSurroundings;
use rtl_model::machine::{Declared, DeclaredKind, ExactMachineShape, ExactRun, KNOWN_STAGE};
use rtl_model::readings::{E7F16, FloatReading, Traced};

/// The exact machine, to be held against its golden model.
#[derive(Clone, Debug)]
pub struct ExactDesign {
    /// The top module.
    pub design: Arc<Module>,
    /// What is compared.
    pub probes: Vec<Probe>,
    shape: ExactMachineShape,
    inputs: Vec<Declared>,
}

impl ExactDesign {
    /// That of a unit.
    pub fn of(unit: &ExactUnit) -> ExactDesign {
        let declaration = unit.shape.declaration().into_iter();
        let inputs = declaration.filter(|signal| signal.kind == DeclaredKind::Input);
        ExactDesign {
            design: unit.design.clone(),
            probes: unit.probes.clone(),
            shape: unit.shape.clone(),
            inputs: inputs.collect(),
        }
    }

    /// What stands around the machine in a run.
    pub fn surroundings(&self, run: &ExactRun<'_>) -> MachineSurroundings {
        MachineSurroundings {
            memory_words: run.shape.memory_words(run.lines),
            memory: run.memory,
            gaps: run.gaps,
            stalls: run.stalls,
            receiver_starts: run.receiver_starts,
        }
    }

    /// Runs the golden machine; `each` sees the words driven and the golden words of every cycle.
    fn golden(&self, run: &ExactRun<'_>, each: &mut EachCycle<'_>) -> ControlFlow<()> {
        let mut words = Vec::new();
        let mut traced = Traced {
            reading: FloatReading(E7F16),
            words: Vec::new(),
        };
        let answered_in = self.shape.height_stage();
        let mut flow = ControlFlow::Continue(());
        run.run(|machine, inputs, _| {
            words.clear();
            machine.observe(inputs, &mut words);
            machine.observe_entry(&mut words);
            for stage in [KNOWN_STAGE, answered_in] {
                machine.observe_stage(stage, &mut words);
                machine.trace(stage, &mut traced, &mut words);
            }
            let mut driven = inputs.words();
            for (word, port) in driven.iter_mut().zip(&self.inputs) {
                *word &= u64::MAX >> (64 - port.width);
            }
            flow = each(&driven, &words);
            flow
        });
        flow
    }

    /// Calls `with` with the comparison of a run, to be made in a simulator of choice.
    pub fn compare<T>(&self, run: &ExactRun<'_>, with: impl FnOnce(&ClockedRun<'_>) -> T) -> T {
        with(&ClockedRun {
            unit: &self.design,
            probes: &self.probes,
            driven: self.inputs.iter().map(|port| port.name.as_str()).collect(),
            // Enough for every stage to fill with zeros.
            reset_cycles: self.shape.effort.stages + 4,
            result: ("hit_valid_o", "hit_ready_i"),
            traffic: &|each| self.golden(run, each),
        })
    }
}
