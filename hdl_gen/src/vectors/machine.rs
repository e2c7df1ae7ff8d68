//! The vectors of a whole machine: rays, hits, and the memory that its port reads, out of a run of
//! its golden model.

use std::ops::ControlFlow;

use rtl_model::machine::{AxiMemoryShape, StallPattern};

use super::field::{Field, FieldFormat, Role};
use super::set::VectorSet;
use crate::verify::{ClockedRun, History};

/// What stands around a machine in a run: the memory, and how sender and receiver behave.
#[derive(Clone, Debug)]
pub struct MachineSurroundings {
    /// What the memory holds, from address 0.
    pub memory_words: Vec<u64>,
    /// How it behaves.
    pub memory: AxiMemoryShape,
    /// When the sender has no ray to offer.
    pub gaps: StallPattern,
    /// When the receiver of hits is not ready.
    pub stalls: StallPattern,
    /// Before this cycle the receiver is never ready.
    pub receiver_starts: u64,
}

/// Rays in, hits out, and what the memory holds.
#[derive(Clone, Debug)]
pub struct MachineVectors {
    /// The fields of the ray ports, valid bit and id aside; a ray's id is its line, from 0.
    pub rays: VectorSet,
    /// The fields of the hit ports, likewise: line k is the answer to ray k.
    pub hits: VectorSet,
    /// The memory, a word of 64 bits a line.
    pub memory: VectorSet,
    /// The cycle in which the last hit left, counted from 0 behind the reset.
    pub last_hit: u64,
}

/// The name of a field by its port: `ray_du_i` is `du`.
fn field_of<'p>(port: &'p str, side: &str, direction: &str) -> Option<&'p str> {
    let name = port.strip_prefix(side)?.strip_suffix(direction)?;
    (!["valid", "ready", "id"].contains(&name)).then_some(name)
}

/// The vectors of a machine's golden run. Its hits are those of the golden machine: whoever writes
/// them holds them against the golden walk.
///
/// # Panics
/// If the unit has no ports of rays and hits.
pub fn machine_vectors(run: &ClockedRun<'_>, memory_words: &[u64]) -> MachineVectors {
    let unit = run.unit;
    let driven = |port: &str| {
        let place = run.driven.iter().position(|name| *name == port);
        place.unwrap_or_else(|| panic!("{port}: not driven"))
    };
    let probe = |port: &str| {
        let mut probes = run.probes.iter();
        let found = probes.find(|probe| probe.scope.len() == 1 && probe.name == port);
        found.unwrap_or_else(|| panic!("{port}: not observed"))
    };
    let mut rays = VectorSet::new(Vec::new());
    let mut ray_words = Vec::new();
    for (place, port) in run.driven.iter().enumerate() {
        if let Some(name) = field_of(port, "ray_", "_i") {
            let wire = unit.input(port).expect("a driven port is an input");
            let node = unit.node(wire);
            let format = FieldFormat::of_port(node.meaning, node.width);
            let meaning = ray_meaning(name);
            rays.fields
                .push(Field::new(name, Role::Input, node.width, format, meaning));
            ray_words.push(place);
        }
    }
    let mut hits = VectorSet::new(Vec::new());
    let mut hit_probes = Vec::new();
    for (port, wire) in &unit.outputs {
        if let Some(name) = field_of(port, "hit_", "_o") {
            // What an instance drives has no meaning in the netlist; the probe's is declared.
            let (shown, width) = (probe(port), unit.width(*wire));
            let format = FieldFormat::of_port(shown.meaning, width);
            let meaning = hit_meaning(name);
            hits.fields
                .push(Field::new(name, Role::Output, width, format, meaning));
            hit_probes.push(shown);
        }
    }
    let word = Field::new(
        "word",
        Role::Memory,
        64,
        FieldFormat::Unsigned,
        "heights, the lowest address in the lowest bits",
    );
    let mut memory = VectorSet::new(vec![word]);
    for &word in memory_words {
        memory.push(vec![word]);
    }

    let [ray_valid, hit_ready] = ["ray_valid_i", "hit_ready_i"].map(driven);
    let [ray_ready, hit_valid, hit_id] = ["ray_ready_o", "hit_valid_o", "hit_id_o"].map(probe);
    let longest = run.probes.iter().map(|probe| probe.delay).max();
    let mut history = History::new(longest.unwrap_or(0));
    let mut answers: Vec<Option<Vec<u64>>> = Vec::new();
    let (mut cycle, mut last_hit) = (0, 0);
    let _ = (run.traffic)(&mut |driven, words| {
        history.push(words);
        if driven[ray_valid] != 0 && history.expected(ray_ready) != 0 {
            let fields = ray_words.iter().zip(&rays.fields);
            let ray = fields.map(|(&place, field)| driven[place] & field.mask());
            let ray = ray.collect();
            rays.push(ray);
        }
        if driven[hit_ready] != 0 && history.expected(hit_valid) != 0 {
            let id = history.expected(hit_id) as usize;
            answers.resize(answers.len().max(id + 1), None);
            let words = hit_probes.iter().map(|probe| history.expected(probe));
            answers[id] = Some(words.collect());
            last_hit = cycle;
        }
        cycle += 1;
        ControlFlow::Continue(())
    });
    for answer in answers.into_iter().flatten() {
        hits.push(answer);
    }
    MachineVectors {
        rays,
        hits,
        memory,
        last_hit,
    }
}

fn ray_meaning(name: &str) -> &'static str {
    match name {
        "u" => "entry along the rows",
        "v" => "entry along the columns",
        "du" => "offset of u for one unit of depth",
        "dv" => "offset of v for one unit of depth",
        _ => "of this name in the machine's source",
    }
}

fn hit_meaning(name: &str) -> &'static str {
    match name {
        "i" => "texel on u",
        "j" => "texel on v",
        "t" => "depth, 0 top to 1 bottom",
        "u" => "position on u, not wrapped",
        "v" => "position on v, not wrapped",
        "steps" => "steps taken",
        "crossings" => "crossings among them",
        "at_border_u" => "it is the texel's side across u that is hit",
        "at_border_v" => "it is the texel's side across v that is hit",
        "way" => {
            "from that side's border to the ray's entry, in units of an entry: negative, in two's \
             complement"
        }
        "slope" => "the ray's slope on that axis, in its units",
        "depth" => "the texel's depth in height steps: that of a hit on its top",
        "guard" => "the walk ended at the step bound: a defect",
        _ => "of this name in the machine's source",
    }
}
