//! The paper's traverse unit, whole or its loop alone, against the golden machine: every declared
//! signal and every register in every cycle.

use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::divergence::{Comparison, Divergence};
use super::embedded::{DIVERGENT_CYCLES, embedded_path};
use super::golden::History;
use super::record::HarnessPlan;
use super::verilator::{RecordStream, TraceWindow, Verilator, VerilatorError, run_harness};
use crate::netlist::Module;
use crate::simulate::{SimulateError, Simulator};
use crate::units::{
    CycleWords, PAPER_LOOP, PaperLayout, PaperLoop, PaperUnit, Probe, declared_word, loop_probes,
};
use rtl_model::machine::{DeclaredKind, PaperInputs, PaperOutputs, PaperRun};
use rtl_model::readings::{FloatReading, HasFormat};

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

    fn driven_words(
        &self,
        inputs: &PaperInputs,
        outputs: &PaperOutputs,
        words: &[u64],
    ) -> Vec<u64> {
        let input_words = inputs.words();
        let word = |&(_, driven): &(String, Driven)| match driven {
            Driven::Input(place) => input_words[place],
            Driven::Golden(place) => words[place],
            Driven::HitLeaves => (outputs.hit_valid && inputs.hit_ready).into(),
        };
        self.driven.iter().map(word).collect()
    }

    /// Runs the golden machine; `each` sees the words driven and the golden words of every cycle.
    fn golden<H: HasFormat + std::fmt::Debug>(
        &self,
        run: &PaperRun<'_>,
        format: H,
        mut each: impl FnMut(&[u64], &CycleWords, &PaperOutputs) -> ControlFlow<()>,
    ) -> u64 {
        let mut words = CycleWords::default();
        let summary = run.run(FloatReading(format), |machine, inputs, outputs| {
            words.0.clear();
            machine.observe(inputs, &mut words.0);
            let driven = self.driven_words(inputs, outputs, &words.0);
            each(&driven, &words, outputs)
        });
        summary.hits
    }

    /// Runs the netlist beside the golden machine.
    ///
    /// # Errors
    /// If the netlist cannot be simulated.
    pub fn embedded<H: HasFormat + std::fmt::Debug>(
        &self,
        run: &PaperRun<'_>,
        format: H,
    ) -> Result<Comparison, SimulateError> {
        let mut simulator = Simulator::new(&self.design)?;
        let inputs = self.driven.iter().map(|(name, _)| simulator.input(name));
        let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
        let signals = self
            .probes
            .iter()
            .map(|probe| simulator.signal(&embedded_path(probe)))
            .collect::<Result<Vec<_>, _>>()?;
        simulator.set("rst_ni", 0)?;
        for _ in 0..run.reset_cycles() {
            simulator.settle();
            simulator.clock();
        }
        simulator.set("rst_ni", 1)?;
        let mut history = History::new(run.pass_cycles);
        let mut comparison = Comparison {
            signals_compared: self.probes.len() as u64,
            ..Comparison::default()
        };
        let mut divergent_cycles = 0;
        comparison.rays = self.golden(run, format, |driven, words, _| {
            history.push(words);
            for (&input, &word) in inputs.iter().zip(driven) {
                simulator.set_input(input, word);
            }
            simulator.settle();
            let mut differs = 0;
            for (probe, &signal) in self.probes.iter().zip(&signals) {
                let (expected, found) = (history.expected(probe), simulator.peek(signal));
                if found != expected {
                    differs += 1;
                    if divergent_cycles == 0 {
                        comparison.first.push(Divergence {
                            cycle: comparison.cycles,
                            unit: probe.scope.join("."),
                            signal: probe.name.clone(),
                            expected,
                            found,
                        });
                    }
                }
            }
            comparison.mismatches += differs;
            comparison.cycles += 1;
            simulator.clock();
            divergent_cycles += u64::from(differs > 0);
            match divergent_cycles < DIVERGENT_CYCLES {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
        comparison.cycles_compared = comparison.cycles;
        Ok(comparison)
    }

    /// What a harness drives and compares.
    pub fn plan(&self, run: &PaperRun<'_>) -> HarnessPlan {
        let driven: Vec<&str> = self.driven.iter().map(|(name, _)| name.as_str()).collect();
        HarnessPlan::new(
            &self.design,
            &driven,
            self.probes.clone(),
            run.reset_cycles(),
            None,
            self.result,
        )
    }

    /// Runs the design under Verilator beside the golden machine. `progress` is told now and then
    /// how many cycles have run.
    ///
    /// # Errors
    /// If Verilator cannot build or run it.
    pub fn verilator<H: HasFormat + std::fmt::Debug>(
        &self,
        verilator: &Verilator,
        run: &PaperRun<'_>,
        format: H,
        window: Option<&TraceWindow>,
        mut progress: impl FnMut(u64),
    ) -> Result<Comparison, VerilatorError> {
        let plan = self.plan(run);
        let program = verilator.build(&self.design, &plan, window.is_some())?;
        let mut cycles: u64 = 0;
        let stream = |records: &mut RecordStream<'_>| -> io::Result<()> {
            let mut outcome = Ok(());
            self.golden(run, format, |driven, words, _| {
                if let Err(problem) = records.send(driven, &words.0) {
                    outcome = Err(problem);
                    return ControlFlow::Break(());
                }
                cycles += 1;
                if cycles.is_multiple_of(16384) {
                    progress(cycles);
                }
                ControlFlow::Continue(())
            });
            outcome
        };
        run_harness(&program, &plan, None, window, stream)
    }
}
