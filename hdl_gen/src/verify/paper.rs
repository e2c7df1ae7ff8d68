//! The paper's traverse unit, whole or its loop alone, against the golden machine: every declared
//! signal and every register in every cycle.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::clocked::{ClockedRun, EachCycle};
use crate::netlist::Module;
use crate::units::{
    PAPER_LOOP, PaperLayout, PaperLoop, PaperUnit, Probe, declared_word, loop_probes,
};
use crate::vectors::MachineSurroundings;
use rtl_model::machine::{DeclaredKind, PaperInputs, PaperMachine, PaperOutputs, PaperRun};
use rtl_model::readings::{E7F16, FloatReading, HasFormat};

/// Where a driven word comes from.
#[derive(Clone, Copy, Debug)]
enum Driven {
    /// From this place among the unit's input words.
    Input(usize),
    /// From this place among the golden words.
    Golden(usize),
    /// A hit leaves FIFO 1.
    HitLeaves,
}

/// A design that is held against the golden machine.
#[derive(Clone, Debug)]
pub struct PaperDesign {
    /// The top module.
    pub design: Arc<Module>,
    /// What is compared.
    pub probes: Vec<Probe>,
    /// The ports that are driven.
    driven: Vec<(String, Driven)>,
    /// The pair of signals that are both 1 when a ray gets its answer or its hit leaves.
    result: (&'static str, &'static str),
}

impl PaperDesign {
    /// The loop alone: FIFOs and cache are the golden ones.
    pub fn of_loop(paper: &PaperLoop) -> PaperDesign {
        let layout = PaperLayout::of(paper);
        let shape = &paper.shape;
        let waiting = |name: &str| {
            let word = declared_word(&shape.fifo_0.declaration(), &format!("out_{name}_o"));
            Driven::Golden(layout.fifo_0 + word)
        };
        let cache = |name: &str| {
            Driven::Golden(layout.cache + declared_word(&shape.cache.declaration(), name))
        };
        let mut driven = Vec::new();
        for name in ["valid", "id", "u", "v", "du", "dv"] {
            driven.push((format!("waiting_{name}_i"), waiting(name)));
        }
        for (port, word) in [
            ("hit_leaves_i", Driven::HitLeaves),
            ("cache_ready_i", cache("lookup_ready_o")),
            ("answer_valid_i", cache("answer_valid_o")),
            ("answer_hit_i", cache("hit_o")),
            ("answer_height_i", cache("height_o")),
        ] {
            driven.push((port.to_owned(), word));
        }
        PaperDesign {
            design: paper.design.clone(),
            probes: loop_probes(paper, &[PAPER_LOOP.to_owned()]),
            driven,
            result: ("ends_o", "ends_o"),
        }
    }

    /// The whole unit: the memory is the golden one.
    pub fn of_unit(unit: &PaperUnit) -> PaperDesign {
        let declaration = unit.paper.shape.declaration();
        let inputs = declaration
            .iter()
            .filter(|signal| signal.kind == DeclaredKind::Input);
        let driven = inputs.enumerate();
        let driven = driven.map(|(place, port)| (port.name.clone(), Driven::Input(place)));
        PaperDesign {
            design: unit.design.clone(),
            probes: unit.probes.clone(),
            driven: driven.collect(),
            result: ("hit_valid_o", "hit_ready_i"),
        }
    }

    /// What stands around the machine in a run.
    pub fn surroundings(&self, run: &PaperRun<'_>) -> MachineSurroundings {
        let memory_words =
            PaperMachine::<FloatReading<E7F16>>::memory_words(&run.shape, run.pyramid);
        MachineSurroundings {
            memory_words,
            memory: run.memory,
            gaps: run.gaps,
            stalls: run.stalls,
            receiver_starts: 0,
        }
    }

    fn drive(
        &self,
        inputs: &PaperInputs,
        outputs: &PaperOutputs,
        words: &[u64],
        driven: &mut Vec<u64>,
    ) {
        let input_words = inputs.words();
        let word = |&(_, from): &(String, Driven)| match from {
            Driven::Input(place) => input_words[place],
            Driven::Golden(place) => words[place],
            Driven::HitLeaves => (outputs.hit_valid && inputs.hit_ready).into(),
        };
        driven.clear();
        driven.extend(self.driven.iter().map(word));
    }

    /// Runs the golden machine; `each` sees the words driven and the golden words of every cycle.
    fn golden<H: HasFormat + std::fmt::Debug>(
        &self,
        run: &PaperRun<'_>,
        format: H,
        each: &mut EachCycle<'_>,
    ) -> ControlFlow<()> {
        let mut words = Vec::new();
        let mut driven = Vec::new();
        let mut flow = ControlFlow::Continue(());
        run.run(FloatReading(format), |machine, inputs, outputs| {
            words.clear();
            machine.observe(inputs, &mut words);
            self.drive(inputs, outputs, &words, &mut driven);
            flow = each(&driven, &words);
            flow
        });
        flow
    }

    /// Calls `with` with the comparison of a run, to be made in a simulator of choice.
    pub fn compare<T, H: HasFormat + std::fmt::Debug>(
        &self,
        run: &PaperRun<'_>,
        format: H,
        with: impl FnOnce(&ClockedRun<'_>) -> T,
    ) -> T {
        with(&ClockedRun {
            unit: &self.design,
            probes: &self.probes,
            driven: self.driven.iter().map(|(name, _)| name.as_str()).collect(),
            reset_cycles: run.reset_cycles(),
            result: self.result,
            traffic: &|each| self.golden(run, format, each),
        })
    }
}
