//! Where the golden machine's words of the exact machine stand, and what is compared.

use super::exact_machine::EXACT_MACHINE;
use super::probe::Probe;
use crate::blocks::declared_probes;
use crate::datapath::BuiltDatapath;
use crate::netlist::Meaning;
use rtl_model::machine::{Declared, DeclaredKind, ExactMachineShape, KNOWN_STAGE};

/// Where the words of a cycle begin: those of [`rtl_model::machine::ExactMachine::observe`], of the first stage
/// ([`observe_entry`](rtl_model::machine::ExactMachine::observe_entry)), then, of the stage in which the ray has
/// been read and of that in which the cache answers, what stands there
/// ([`observe_stage`](rtl_model::machine::ExactMachine::observe_stage)) and what comes of it
/// ([`trace`](rtl_model::machine::ExactMachine::trace)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactLayout {
    /// The FIFO's.
    pub fifo: usize,
    /// The cache's.
    pub cache: usize,
    /// The read port's.
    pub port: usize,
    /// What stands in the first stage beside the walk.
    pub entry: usize,
    /// What stands where the ray has been read.
    pub read: usize,
    /// What comes of it.
    pub read_trace: usize,
    /// What stands where the cache answers.
    pub answered: usize,
    /// What comes of it.
    pub answered_trace: usize,
}

/// Words of the first stage: valid, slot, fresh.
const OF_ENTRY: usize = 3;
/// Words in front of a datapath's inputs: missed, place.
const BEFORE_INPUTS: usize = 2;

impl ExactLayout {
    /// The layout of a machine.
    pub fn of(shape: &ExactMachineShape, trip: &BuiltDatapath) -> ExactLayout {
        let count = |declaration: &[Declared]| {
            let is_input = |signal: &&Declared| signal.kind != DeclaredKind::Input;
            declaration.iter().filter(is_input).count()
        };
        let fifo = count(&shape.declaration());
        let cache = fifo + count(&shape.leaf_fifo.declaration());
        let port = cache + count(&shape.cache.declaration());
        let entry = port + count(&shape.port.declaration());
        let inputs = 5 + shape.walk_registers().len() + 4 + shape.bounded.lines().cells();
        let read = entry + OF_ENTRY;
        let read_trace = read + BEFORE_INPUTS + inputs;
        let answered = read_trace + trip.word_count;
        ExactLayout {
            fifo,
            cache,
            port,
            entry,
            read,
            read_trace,
            answered,
            answered_trace: answered + BEFORE_INPUTS + inputs,
        }
    }
}

/// Every output port, register and control signal of the machine.
pub(super) fn exact_probes(shape: &ExactMachineShape, trip: &BuiltDatapath) -> Vec<Probe> {
    let layout = ExactLayout::of(shape, trip);
    let mut probes = declared_probes(&shape.declaration(), &[EXACT_MACHINE], 0);
    for (declaration, instance, word) in [
        (shape.leaf_fifo.declaration(), "leaf_fifo", layout.fifo),
        (shape.cache.declaration(), "height_cache", layout.cache),
        (shape.port.declaration(), "read_port", layout.port),
    ] {
        probes.extend(declared_probes(
            &declaration,
            &[EXACT_MACHINE, instance],
            word,
        ));
    }
    let probe = |scope: &[&str], name: String, width: u32, word: usize, delay: u32| Probe {
        scope: scope.iter().map(|&part| part.to_owned()).collect(),
        name,
        width,
        meaning: Meaning::Bits,
        word,
        delay,
        sources: Vec::new(),
    };
    let top = [EXACT_MACHINE];
    for stage in 0..shape.effort.stages {
        probes.push(probe(
            &top,
            format!("valid_s{stage}"),
            1,
            layout.entry,
            stage,
        ));
        let (name, slot) = (format!("slot_s{stage}"), layout.entry + 1);
        probes.push(probe(&top, name, shape.slot_bits(), slot, stage));
    }
    probes.push(probe(&top, "fresh_s0".to_owned(), 1, layout.entry + 2, 0));
    probes.push(probe(&top, "missed".to_owned(), 1, layout.answered, 0));
    if shape.offset_bits() > 0 {
        let (name, place) = ("lookup_place".to_owned(), layout.answered + 1);
        probes.push(probe(&top, name, shape.offset_bits(), place, 0));
    }
    // What depends on the heights is known when the cache answers; a register in front of an
    // earlier stage cannot depend on them.
    let answered_in = shape.height_stage();
    for register in &trip.registers {
        let is_early = register.stage < answered_in;
        let (inputs, trace) = match is_early {
            true => (layout.read, layout.read_trace),
            false => (layout.answered, layout.answered_trace),
        };
        let word = match register.word {
            Ok(word) => trace + word,
            Err(input) => inputs + BEFORE_INPUTS + input,
        };
        let observed_in = if is_early { KNOWN_STAGE } else { answered_in };
        let delay = register.stage - observed_in;
        let scope = [EXACT_MACHINE, "trip"];
        probes.push(Probe {
            meaning: register.meaning,
            ..probe(&scope, register.name.clone(), register.width, word, delay)
        });
    }
    probes
}
