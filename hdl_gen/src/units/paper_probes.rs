//! Where the golden machine's words of the paper's traverse unit stand, and what is compared.

use super::paper_loop::PaperLoop;
use super::probe::Probe;
use super::traverse::shown_as;
use crate::blocks::declared_probes;
use crate::netlist::Meaning;
use rtl_model::machine::{Declared, DeclaredKind, ID_BITS, PaperShape};

/// Where the words of [`rtl_model::machine::PaperMachine::observe`] begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PaperLayout {
    /// The unit's declared signals.
    pub unit: usize,
    /// Those of FIFO 0.
    pub fifo_0: usize,
    /// Those of FIFO 1.
    pub fifo_1: usize,
    /// Those of the height cache.
    pub cache: usize,
    /// Those of the read port.
    pub port: usize,
    /// Valid bit, id, registers and results of the first stage.
    pub entry: usize,
    /// Height, miss and results of the stage in which the cache answers.
    pub answered: usize,
}

fn observed(declaration: &[Declared]) -> impl Iterator<Item = &Declared> {
    let is_input = |signal: &&Declared| signal.kind != DeclaredKind::Input;
    declaration.iter().filter(is_input)
}

impl PaperLayout {
    /// The layout of a unit.
    pub fn of(paper: &PaperLoop) -> PaperLayout {
        let shape = &paper.shape;
        let count = |declaration: &[Declared]| observed(declaration).count();
        let fifo_0 = count(&shape.declaration());
        let fifo_1 = fifo_0 + count(&shape.fifo_0.declaration());
        let cache = fifo_1 + count(&shape.fifo_1.declaration());
        let port = cache + count(&shape.cache.declaration());
        let entry = port + count(&shape.port.declaration());
        let registers = shape.step.ray_registers().len() + shape.step.walk_registers().len();
        PaperLayout {
            unit: 0,
            fifo_0,
            fifo_1,
            cache,
            port,
            entry,
            answered: entry + 2 + registers + paper.step.word_count,
        }
    }
}

/// The place among a declaration's observed words of the signal of this name.
pub fn declared_word(declaration: &[Declared], name: &str) -> usize {
    let place = observed(declaration).position(|signal| signal.name == name);
    place.unwrap_or_else(|| panic!("{name} is not declared"))
}

/// The signals of the loop's control by the unit's declaration.
const CONTROL: [&str; 6] = [
    "ends",
    "recirculates",
    "admits",
    "rays_inside",
    "lookup_valid",
    "lookup_address",
];

/// Every register and control signal of the loop, which stands in this scope.
pub fn loop_probes(paper: &PaperLoop, scope: &[String]) -> Vec<Probe> {
    let layout = PaperLayout::of(paper);
    let shape: &PaperShape = &paper.shape;
    let declaration = shape.declaration();
    let probe =
        |name: String, (width, meaning): (u32, Meaning), (word, delay): (usize, u32)| Probe {
            scope: scope.to_vec(),
            name,
            width,
            meaning,
            word,
            delay,
            sources: Vec::new(),
        };
    let mut probes = Vec::new();
    let path: Vec<&str> = scope.iter().map(String::as_str).collect();
    let unit = declared_probes(&declaration, &path, layout.unit);
    let is_control = |probe: &Probe| CONTROL.contains(&probe.name.as_str());
    probes.extend(unit.into_iter().filter(is_control));
    if shape.counters {
        for name in ["passes", "gaps_without_ray", "gaps_without_room"] {
            let word = declared_word(&declaration, &format!("{name}_o"));
            probes.push(probe(name.to_owned(), (32, Meaning::Bits), (word, 0)));
        }
    }
    let latency = paper.step.latency;
    for stage in 0..=latency {
        let bit = (1, Meaning::Bits);
        probes.push(probe(format!("valid_s{stage}"), bit, (layout.entry, stage)));
        let id = (ID_BITS, Meaning::Bits);
        probes.push(probe(format!("id_s{stage}"), id, (layout.entry + 1, stage)));
    }
    let mut registers = shape.step.ray_registers();
    registers.extend(shape.step.walk_registers());
    let inputs = layout.entry + 2;
    for (place, &(name, kind)) in registers.iter().enumerate() {
        let shown = shown_as(kind, paper.format);
        probes.push(probe(format!("{name}_s0"), shown, (inputs + place, 0)));
    }

    // What depends on the height is known when the cache answers; a register in front of an
    // earlier stage cannot depend on it.
    let answered_in = shape.height_stage();
    let mut step_scope = scope.to_vec();
    step_scope.push("step".to_owned());
    for register in &paper.step.registers {
        let place = match register.word {
            Ok(word) if register.stage < answered_in => {
                (inputs + registers.len() + word, register.stage)
            }
            Ok(word) => (layout.answered + 2 + word, register.stage - answered_in),
            Err(input) if input < registers.len() => (inputs + input, register.stage),
            // The height, then whether the cache missed.
            Err(input) => (
                layout.answered + input - registers.len(),
                register.stage - answered_in,
            ),
        };
        probes.push(Probe {
            scope: step_scope.clone(),
            ..probe(
                register.name.clone(),
                (register.width, register.meaning),
                place,
            )
        });
    }
    probes
}
