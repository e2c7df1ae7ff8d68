//! The whole traverse unit of the 2013 hardware paper: the loop between its FIFOs, with its height
//! cache and the port to the memory.

use std::collections::HashMap;
use std::sync::Arc;

use super::paper_loop::{PAPER_LOOP, PaperLoop};
use super::paper_probes::{PaperLayout, loop_probes};
use super::probe::Probe;
use crate::blocks::{declared_probes, fifo, height_cache, read_port};
use crate::netlist::{Builder, InstanceAhead, Meaning, Module, Wire};
use rtl_model::machine::{Declared, DeclaredKind, PaperShape};

/// The module's name.
pub const PAPER_MACHINE: &str = "paper_machine";

/// The unit as hardware, with all that is compared of it.
#[derive(Clone, Debug)]
pub struct PaperUnit {
    /// Its loop.
    pub paper: PaperLoop,
    /// The module `paper_machine` with all it uses.
    pub design: Arc<Module>,
    /// Every output port and register the golden machine knows.
    pub probes: Vec<Probe>,
}

impl PaperUnit {
    /// Builds the unit around its loop.
    pub fn build(paper: &PaperLoop) -> PaperUnit {
        PaperUnit {
            design: build_machine(paper),
            probes: probes(paper),
            paper: paper.clone(),
        }
    }
}

/// Wires by the names of the ports they are for, or come from.
#[derive(Default)]
pub(super) struct Ports(HashMap<String, Wire>);

impl Ports {
    pub(super) fn put(&mut self, name: impl Into<String>, wire: Wire) {
        self.0.insert(name.into(), wire);
    }

    pub(super) fn get(&self, name: &str) -> Wire {
        let wire = self.0.get(name).copied();
        wire.unwrap_or_else(|| panic!("no port {name}"))
    }

    pub(super) fn outputs(module: &Module, wires: Vec<Wire>) -> Ports {
        let names = module.outputs.iter().map(|(name, _)| name.clone());
        Ports(names.zip(wires).collect())
    }

    /// The wires for a module's inputs, in its order.
    pub(super) fn inputs(&self, module: &Module) -> Vec<Wire> {
        let inputs = module.inputs.iter();
        let names = inputs.map(|&port| module.node(port).name.as_deref().expect("a port's name"));
        names.map(|name| self.get(name)).collect()
    }
}

/// A block that stands ahead of what leads back to it.
pub(super) struct Block {
    module: Arc<Module>,
    instance: InstanceAhead,
    pub(super) outputs: Ports,
}

impl Block {
    pub(super) fn new(b: &mut Builder, name: &str, module: Arc<Module>) -> Block {
        let (instance, outputs) = b.instance_ahead(name, &module);
        Block {
            outputs: Ports::outputs(&module, outputs),
            instance,
            module,
        }
    }

    pub(super) fn connect(self, b: &mut Builder, inputs: &Ports) {
        b.connect_instance(self.instance, &inputs.inputs(&self.module));
    }
}

fn build_machine(paper: &PaperLoop) -> Arc<Module> {
    let shape = &paper.shape;
    let mut machine = Builder::new(PAPER_MACHINE);
    let b = &mut machine;
    b.describe("The traverse unit of the 2013 hardware paper (section 4): FIFO 0, the loop of");
    b.describe(
        "passes, FIFO 1, a height cache that sends a ray round on a miss, an AXI4 read port.",
    );
    b.describe(format!(
        "map: {0} x {0} texels, heights of {1} bits; format: {2}",
        shape.step.shape.size(),
        shape.step.shape.height_bits,
        paper.format
    ));
    b.describe("golden: rtl_model::machine::PaperMachine");
    b.set_latency(paper.step.latency + 3);
    let mut ports = Ports::default();
    let declaration = shape.declaration();
    let inputs = declaration
        .iter()
        .filter(|signal| signal.kind == DeclaredKind::Input);
    for port in inputs {
        let wire = b.input(&port.name, port.width);
        if ["ray_u_i", "ray_v_i", "ray_du_i", "ray_dv_i"].contains(&port.name.as_str()) {
            b.mean(wire, Meaning::Float(paper.format));
        }
        ports.put(port.name.clone(), wire);
    }

    b.section("what the blocks around the loop give");
    let fifo_0 = Block::new(b, "fifo_0", fifo(&shape.fifo_0));
    let fifo_1 = Block::new(b, "fifo_1", fifo(&shape.fifo_1));
    let cache = Block::new(b, "height_cache", height_cache(&shape.cache));

    b.section("the port to the memory");
    let mut to_port = Ports::default();
    to_port.put("request_valid_i", cache.outputs.get("fetch_valid_o"));
    to_port.put("request_line_i", cache.outputs.get("fetch_line_o"));
    // The cache takes every beat at once.
    let always = b.constant(1, 1);
    to_port.put("beat_ready_i", always);
    for port in ["arready", "rvalid", "rid", "rdata", "rresp", "rlast"] {
        let name = format!("mem_{port}_i");
        to_port.put(name.clone(), ports.get(&name));
    }
    let read_port = read_port(&shape.port);
    let wires = b.instance("read_port", &read_port, &to_port.inputs(&read_port));
    let from_port = Ports::outputs(&read_port, wires);

    b.section("the loop");
    let hit_ready = ports.get("hit_ready_i");
    let hit_leaves = b.and(fifo_1.outputs.get("out_valid_o"), hit_ready);
    b.name(hit_leaves, "hit_leaves");
    let mut to_loop = Ports::default();
    for name in ["valid", "id", "u", "v", "du", "dv"] {
        let wire = fifo_0.outputs.get(&format!("out_{name}_o"));
        to_loop.put(format!("waiting_{name}_i"), wire);
    }
    to_loop.put("hit_leaves_i", hit_leaves);
    to_loop.put("cache_ready_i", cache.outputs.get("lookup_ready_o"));
    to_loop.put("answer_valid_i", cache.outputs.get("answer_valid_o"));
    to_loop.put("answer_hit_i", cache.outputs.get("hit_o"));
    to_loop.put("answer_height_i", cache.outputs.get("height_o"));
    let design = &paper.design;
    let wires = b.instance(PAPER_LOOP, design, &to_loop.inputs(design));
    let from_loop = Ports::outputs(design, wires);

    b.section("what leads back to the blocks");
    let mut to_fifo_0 = Ports::default();
    for name in ["valid", "id", "u", "v", "du", "dv"] {
        to_fifo_0.put(format!("in_{name}_i"), ports.get(&format!("ray_{name}_i")));
    }
    to_fifo_0.put("out_ready_i", from_loop.get("admits_o"));
    let mut to_fifo_1 = Ports::default();
    to_fifo_1.put("in_valid_i", from_loop.get("ends_o"));
    for field in &shape.fifo_1.fields {
        let wire = from_loop.get(&format!("ended_{}_o", field.name));
        to_fifo_1.put(format!("in_{}_i", field.name), wire);
    }
    to_fifo_1.put("out_ready_i", hit_ready);
    let mut to_cache = Ports::default();
    to_cache.put("lookup_valid_i", from_loop.get("lookup_valid_o"));
    to_cache.put("lookup_address_i", from_loop.get("lookup_address_o"));
    to_cache.put("fetch_ready_i", from_port.get("request_ready_o"));
    to_cache.put("beat_valid_i", from_port.get("beat_valid_o"));
    to_cache.put("beat_data_i", from_port.get("beat_data_o"));
    outputs(
        b,
        shape,
        [&fifo_0.outputs, &fifo_1.outputs, &cache.outputs],
        &from_loop,
        &from_port,
    );
    fifo_0.connect(b, &to_fifo_0);
    fifo_1.connect(b, &to_fifo_1);
    cache.connect(b, &to_cache);
    machine.finish()
}

fn outputs(
    b: &mut Builder,
    shape: &PaperShape,
    [fifo_0, fifo_1, cache]: [&Ports; 3],
    from_loop: &Ports,
    from_port: &Ports,
) {
    b.output("ray_ready_o", fifo_0.get("in_ready_o"));
    b.output("hit_valid_o", fifo_1.get("out_valid_o"));
    for field in &shape.fifo_1.fields {
        let wire = fifo_1.get(&format!("out_{}_o", field.name));
        b.output(&format!("hit_{}_o", field.name), wire);
    }
    for port in [
        "arvalid", "araddr", "arlen", "arsize", "arburst", "arid", "rready",
    ] {
        let name = format!("mem_{port}_o");
        b.output(&name, from_port.get(&name));
    }
    b.output("error_o", from_port.get("error_o"));
    if shape.counters {
        for name in ["passes_o", "gaps_without_ray_o", "gaps_without_room_o"] {
            b.output(name, from_loop.get(name));
        }
        for (name, counter) in [
            ("cache_hits_o", "hits_o"),
            ("cache_misses_o", "misses_o"),
            ("lines_fetched_o", "fetches_o"),
        ] {
            b.output(name, cache.get(counter));
        }
    }
}

fn probes(paper: &PaperLoop) -> Vec<Probe> {
    let shape = &paper.shape;
    let layout = PaperLayout::of(paper);
    let unit = declared_probes(&shape.declaration(), &[PAPER_MACHINE], layout.unit);
    // What is no port of the unit stands in its loop.
    let is_port = |probe: &Probe| probe.name.ends_with("_o");
    let mut probes: Vec<Probe> = unit.into_iter().filter(is_port).collect();
    for probe in &mut probes {
        if ["hit_t_o", "hit_u_o", "hit_v_o"].contains(&probe.name.as_str()) {
            probe.meaning = Meaning::Float(paper.format);
        }
    }
    probes.extend(loop_probes(
        paper,
        &[PAPER_MACHINE.to_owned(), PAPER_LOOP.to_owned()],
    ));
    let blocks: [(&str, Vec<Declared>, usize); 4] = [
        ("fifo_0", shape.fifo_0.declaration(), layout.fifo_0),
        ("fifo_1", shape.fifo_1.declaration(), layout.fifo_1),
        ("height_cache", shape.cache.declaration(), layout.cache),
        ("read_port", shape.port.declaration(), layout.port),
    ];
    for (name, declaration, word) in blocks {
        let observed = declared_probes(&declaration, &[PAPER_MACHINE, name], word);
        // An output port's value is seen outside; inside it may be a slice without a name.
        probes.extend(
            observed
                .into_iter()
                .filter(|probe| !probe.name.ends_with("_o")),
        );
    }
    probes
}
