//! The exact machine: setups, the loop of trips, the leaf check, with the height cache and the port
//! to the memory.

mod leaf;
mod setups;
mod words;

use std::collections::HashMap;
use std::sync::Arc;

use super::bounded_datapaths::build_bounded;
use super::exact_probes::exact_probes;
use super::exact_trip::{build_exact_trip, trip_input};
use super::paper_machine::{Block, Ports};
use super::probe::Probe;
use crate::blocks::{fifo, height_cache, read_port};
use crate::datapath::BuiltDatapath;
use crate::netlist::{Builder, Module, Wire};
use rtl_model::machine::{DeclaredKind, EXACT_COUNTER_BITS, ExactMachineShape, READ_STAGE};
use rtl_model::units::bounded_datapaths::BoundedDatapath;
use rtl_model::units::bounded_shape::LINE_BITS;

/// The module's name.
pub const EXACT_MACHINE: &str = "exact_machine";

/// The exact machine as hardware.
#[derive(Clone, Debug)]
pub struct ExactUnit {
    /// What it is built as.
    pub shape: ExactMachineShape,
    /// A trip of its loop.
    pub trip: BuiltDatapath,
    /// The module `exact_machine` with all it uses.
    pub design: Arc<Module>,
    /// Every output port and register that the golden machine knows.
    pub probes: Vec<Probe>,
}

impl ExactUnit {
    /// Builds the machine.
    pub fn build(shape: &ExactMachineShape) -> ExactUnit {
        let trip = build_exact_trip(shape);
        ExactUnit {
            design: Build::new(shape, &trip).run(),
            probes: exact_probes(shape, &trip),
            shape: shape.clone(),
            trip,
        }
    }
}

struct Build<'a> {
    shape: &'a ExactMachineShape,
    trip: &'a BuiltDatapath,
    b: Builder,
    /// Ports, registers and what else is read in several places.
    wires: Ports,
    /// Modules of datapaths by their names.
    modules: HashMap<String, Arc<Module>>,
    /// Instances of them, to tell them apart.
    instances: u32,
}

/// What enters the first stage, and when.
struct Entry {
    recirculates: Wire,
    returns: Wire,
    admits: Wire,
}

impl Build<'_> {
    fn new<'a>(shape: &'a ExactMachineShape, trip: &'a BuiltDatapath) -> Build<'a> {
        Build {
            shape,
            trip,
            b: Builder::new(EXACT_MACHINE),
            wires: Ports::default(),
            modules: HashMap::new(),
            instances: 0,
        }
    }

    fn describe(&mut self) {
        let (shape, b) = (self.shape, &mut self.b);
        let lines = shape.bounded.lines();
        b.describe("The exact machine: rays are set up digit by digit, walk round a loop of trips, and are");
        b.describe(
            "checked, exactly, at the texel they come to. Hits leave as they are found, by id.",
        );
        b.describe(format!(
            "lines of {0} x {0} nodes; map: {1} x {1} texels, heights of {2} bits",
            lines.side(),
            lines.size(),
            lines.height_bits
        ));
        b.describe("Nothing in the loop ever stops: whatever leaves it has a place in the FIFO, which has one");
        b.describe("for every slot, and a ray has its slot from its entry into the loop until its hit is taken.");
        b.describe("golden: rtl_model::machine::ExactMachine");
        b.set_latency(shape.effort.stages);
        b.localparam(
            "SLOTS",
            shape.effort.slots.into(),
            "rays that may be inside at once",
        );
        b.localparam(
            "STAGES",
            shape.effort.stages.into(),
            "of the loop: a walk comes round after so many cycles",
        );
    }

    fn get(&self, name: &str) -> Wire {
        self.wires.get(name)
    }

    /// An instance of a datapath without registers, its inputs by name; its outputs by name.
    fn datapath(
        &mut self,
        datapath: BoundedDatapath,
        suffix: &str,
        inputs: &[(&str, Wire)],
    ) -> Ports {
        let name = format!("{}{suffix}", datapath.name(self.shape.bounded));
        let module = match self.modules.get(&name) {
            Some(module) => module.clone(),
            None => {
                let built = build_bounded(datapath, self.shape.bounded, 0, 1);
                let mut module = Module::clone(&built.module);
                module.name.clone_from(&name);
                let module = Arc::new(module);
                self.modules.insert(name, module.clone());
                module
            }
        };
        let mut ports = Ports::default();
        for &(name, wire) in inputs {
            ports.put(format!("{name}_i"), wire);
        }
        self.instances += 1;
        let name = format!("{}_{}", module.name.replace("bounded_", ""), self.instances);
        let inputs = ports.inputs(&module);
        let outputs = self.b.instance(&name, &module, &inputs);
        Ports::outputs(&module, outputs)
    }

    fn run(mut self) -> Arc<Module> {
        self.describe();
        let shape = self.shape;
        let declaration = shape.declaration();
        for signal in &declaration {
            if signal.kind == DeclaredKind::Input {
                let wire = self.b.input(&signal.name, signal.width);
                self.wires.put(&signal.name, wire);
            }
        }
        self.b.section("registers");
        for signal in &declaration {
            if let DeclaredKind::Register(reset) = signal.kind {
                let register = self.b.register(signal.width, None, reset);
                self.b.name(register, &signal.name);
                self.wires.put(&signal.name, register);
            }
        }
        let fifo_block = Block::new(&mut self.b, "leaf_fifo", fifo(&shape.leaf_fifo));
        let cache = Block::new(&mut self.b, "height_cache", height_cache(&shape.cache));
        let port = Block::new(&mut self.b, "read_port", read_port(&shape.port));

        let fresh_s0 = self.b.register(1, None, Some(0));
        self.b.name(fresh_s0, "fresh_s0");
        self.wires.put("fresh_s0", fresh_s0);
        let set_up = self.setups();
        let trip = self.trips(&set_up, &cache.outputs);
        let entry = self.entry();
        self.enter(&entry, &trip, &set_up);
        self.leaf(&entry, &trip, &fifo_block.outputs);

        self.b.section("the FIFO before the leaf check");
        let mut inputs = Ports::default();
        inputs.put("in_valid_i", self.get("ends"));
        inputs.put("in_slot_i", trip.get("slot"));
        inputs.put("out_ready_i", self.get("fetches"));
        fifo_block.connect(&mut self.b, &inputs);

        self.b
            .section("the height cache, and the port to the memory");
        let mut inputs = Ports::default();
        inputs.put("lookup_valid_i", self.get("lookup_valid"));
        let address = self.get("lookup_address");
        let line = self.b.slice(
            address,
            shape.bounded.address_bits() - 1,
            shape.offset_bits(),
        );
        inputs.put("lookup_address_i", line);
        inputs.put("fetch_ready_i", port.outputs.get("request_ready_o"));
        inputs.put("beat_valid_i", port.outputs.get("beat_valid_o"));
        inputs.put("beat_data_i", port.outputs.get("beat_data_o"));
        let mut port_inputs = Ports::default();
        port_inputs.put("request_valid_i", cache.outputs.get("fetch_valid_o"));
        port_inputs.put("request_line_i", cache.outputs.get("fetch_line_o"));
        let one = self.b.constant(1, 1);
        port_inputs.put("beat_ready_i", one);
        for name in [
            "mem_arready_i",
            "mem_rvalid_i",
            "mem_rid_i",
            "mem_rdata_i",
            "mem_rresp_i",
            "mem_rlast_i",
        ] {
            port_inputs.put(name, self.get(name));
        }
        for name in [
            "mem_arvalid_o",
            "mem_araddr_o",
            "mem_arlen_o",
            "mem_arsize_o",
            "mem_arburst_o",
            "mem_arid_o",
            "mem_rready_o",
            "error_o",
        ] {
            self.b.output(name, port.outputs.get(name));
        }
        if shape.counters {
            self.counters(&entry);
            for (name, of_cache) in [
                ("cache_hits_o", "hits_o"),
                ("cache_misses_o", "misses_o"),
                ("lines_fetched_o", "fetches_o"),
            ] {
                self.b.output(name, cache.outputs.get(of_cache));
            }
        }
        cache.connect(&mut self.b, &inputs);
        port.connect(&mut self.b, &port_inputs);
        self.b.finish()
    }

    /// The loop; answers what comes out of the last stage, with the slot there.
    fn trips(&mut self, set_up: &Ports, cache: &Ports) -> Ports {
        let shape = self.shape;
        let bounded = shape.bounded;
        let (stages, slot_bits) = (shape.effort.stages, shape.slot_bits());
        self.b.section("valid bits and slots beside the trips");
        let mut valid = self.b.register(1, None, Some(0));
        let mut slot = self.b.register(slot_bits, None, None);
        let (valid_s0, slot_s0) = (valid, slot);
        let mut valid_read = valid;
        for stage in 0..stages {
            self.b.name(valid, format!("valid_s{stage}"));
            self.b.name(slot, format!("slot_s{stage}"));
            if stage + 1 < stages {
                valid = self.b.registered(valid, None, Some(0));
                if stage + 1 == READ_STAGE {
                    valid_read = valid;
                }
                slot = self.b.registered(slot, None, None);
            }
        }
        self.wires.put("valid_s0", valid_s0);
        self.wires.put("slot_s0", slot_s0);

        self.b.section("the trip's datapath");
        let module = self.trip.module.clone();
        let (instance, outputs) = self.b.instance_ahead("trip", &module);
        let mut trip = Ports::outputs(&module, outputs);
        trip.put("valid", valid);
        trip.put("slot", slot);

        self.b
            .section("a ray's constants, by slot: written when it enters the loop");
        let free_slots = self.get("free_slots");
        let (one_hot, number) = self.lowest(free_slots);
        self.wires.put("slot_taken", one_hot);
        self.wires.put("new_slot", number);
        let admits = self.admits_ahead(&trip, set_up, cache);
        let always = self.b.constant(1, 1);
        let names = [
            "t_delta_u",
            "t_delta_v",
            "start_line",
            "mirror_u",
            "mirror_v",
        ];
        let fields = names.map(|name| set_up.get(name));
        let ray = self.read_memory("step_rays", &fields, (admits, number), (always, slot_s0));
        let ray: Vec<Wire> = ray
            .into_iter()
            .map(|word| self.b.registered(word, None, None))
            .collect();

        self.b.section("the bounds of blocks, by slot and line");
        let line_bits = bounded
            .line_levels()
            .next_power_of_two()
            .max(2)
            .trailing_zeros();
        let line = self.get("line_s0");
        let from_own_line = self.get("from_own_line_s0");
        let from_above = self.b.not(from_own_line);
        let above = self.b.zero_extend(from_above, LINE_BITS);
        let base_line = self.b.add(line, above);
        let base_line = self.b.slice(base_line, line_bits - 1, 0);
        let read = self.b.concat(&[slot_s0, base_line]);
        let near_line = self.b.slice(trip.get("near_line_o"), line_bits - 1, 0);
        let write = self.b.concat(&[slot, near_line]);
        let writes = self.b.and(valid, trip.get("writes_o"));
        let near = ["u", "v"]
            .map(|axis| self.fit(trip.get(&format!("t_near_{axis}_o")), bounded.bound_bits()));
        let stored = self.read_memory("t_near", &near, (writes, write), (always, read));
        let fresh_s0 = self.get("fresh_s0");
        let fresh = self.b.registered(fresh_s0, None, Some(0));
        self.b.name(fresh, "fresh_s1");
        let fresh_read = self.b.registered(fresh, None, Some(0));
        let mut base = Vec::new();
        for (axis, stored) in ["u", "v"].into_iter().zip(stored) {
            let own = set_up.get(&format!("t_near_{axis}"));
            let own = self.b.registered(own, None, None);
            let base_s1 = self.b.mux(fresh, own, stored);
            base.push(self.b.registered(base_s1, None, None));
        }

        self.b.section("the cache is asked, a stage later");
        let lookup_valid = self.get("lookup_valid");
        self.b.connect(lookup_valid, valid_read);
        let address = self.fit(trip.get("line_address_o"), bounded.address_bits());
        let lookup_address = self.get("lookup_address");
        self.b.connect(lookup_address, address);

        self.b.section("the cache has answered");
        let not_hit = self.b.not(cache.get("hit_o"));
        let missed = self.b.and(cache.get("answer_valid_o"), not_hit);
        self.b.name(missed, "missed");
        let heights = self.heights(cache);

        let mut inputs = Ports::default();
        let one = self.b.constant(1, 1);
        inputs.put("enable_i", one);
        for (name, wire) in names.iter().zip(ray) {
            inputs.put(format!("{name}_i"), wire);
        }
        for (name, _) in shape.walk_registers() {
            let port = format!("{}_i", trip_input(name));
            inputs.put(port, self.get(&format!("{name}_s0")));
        }
        inputs.put("t_base_u_i", base[0]);
        inputs.put("t_base_v_i", base[1]);
        inputs.put("fresh_i", fresh_read);
        inputs.put("missed_i", missed);
        for (number, height) in heights.into_iter().enumerate() {
            inputs.put(format!("height_{number}_i"), height);
        }
        let inputs = inputs.inputs(&module);
        self.b.connect_instance(instance, &inputs);
        trip
    }

    /// What enters the loop: a walk of the last stage, one that was refused, or a new ray.
    fn admits_ahead(&mut self, trip: &Ports, set_up: &Ports, cache: &Ports) -> Wire {
        let open = self.b.not(trip.get("ends_o"));
        let recirculates = self.b.and(trip.get("valid"), open);
        self.b.name(recirculates, "recirculates");
        let ends = self.b.and(trip.get("valid"), trip.get("ends_o"));
        self.b.name(ends, "ends");
        let gap = self.b.not(recirculates);
        let refused = self.b.and(
            self.wires.get("answer_valid"),
            self.wires.get("answer_refused"),
        );
        let returns = self.b.and(gap, refused);
        self.b.name(returns, "returns");
        let not_refused = self.b.not(refused);
        let has_slot = self.b.any_bit(self.wires.get("free_slots"));
        let waits = [
            set_up.get("is_set_up"),
            has_slot,
            cache.get("lookup_ready_o"),
            not_refused,
        ];
        let may_enter = self.all(&waits);
        let admits = self.b.and(may_enter, gap);
        self.b.name(admits, "admits");
        for (name, wire) in [
            ("recirculates", recirculates),
            ("ends", ends),
            ("returns", returns),
            ("admits", admits),
            ("not_refused", not_refused),
        ] {
            self.wires.put(name, wire);
        }
        admits
    }

    /// The heights of the line that is read: of the cache's line, a piece.
    fn heights(&mut self, cache: &Ports) -> Vec<Wire> {
        let shape = self.shape;
        let bits = shape.bounded.words.height_bits;
        let in_word = 64 / bits;
        let cells = shape.bounded.lines().cells() as u32;
        let all: Vec<Wire> = (0..16)
            .map(|number| {
                let word = cache.get(&format!("line_{}_o", number / in_word));
                let low = number % in_word * bits;
                self.b.slice(word, low + bits - 1, low)
            })
            .collect();
        if shape.offset_bits() == 0 {
            return all;
        }
        let address = self.get("lookup_address");
        let mut place = self.b.slice(address, shape.offset_bits() - 1, 0);
        for _ in 0..shape.cache.latency {
            place = self.b.registered(place, None, None);
        }
        self.b.name(place, "lookup_place");
        let (low, high) = (self.b.bit(place, 0), self.b.bit(place, 1));
        (0..cells)
            .map(|cell| {
                let at = |piece: u32| all[(piece * cells + cell) as usize];
                let first = self.b.mux(low, at(1), at(0));
                let second = self.b.mux(low, at(3), at(2));
                self.b.mux(high, second, first)
            })
            .collect()
    }

    fn entry(&self) -> Entry {
        Entry {
            recirculates: self.get("recirculates"),
            returns: self.get("returns"),
            admits: self.get("admits"),
        }
    }

    /// The registers in front of the first stage.
    fn enter(&mut self, entry: &Entry, trip: &Ports, set_up: &Ports) {
        let shape = self.shape;
        self.b.section("what enters the first stage");
        let refused_or_new = self.b.or(entry.returns, entry.admits);
        let begins = self.b.or(entry.recirculates, refused_or_new);
        self.wires.put("begins", begins);
        let valid = self.get("valid_s0");
        self.b.connect(valid, begins);
        let fresh = self.get("fresh_s0");
        self.b.connect(fresh, entry.admits);
        let slot = self.get("slot_s0");
        let refused = self.get("answer_refused");
        let refused = {
            let valid = self.get("answer_valid");
            self.b.and(valid, refused)
        };
        let outside = self.b.mux(
            refused,
            self.wires.get("answer_slot"),
            self.wires.get("new_slot"),
        );
        let next = self.b.mux(entry.recirculates, trip.get("slot"), outside);
        self.b.connect_enabled(slot, next, begins);
        for (name, width) in shape.walk_registers() {
            let zero = self.b.constant(0, width);
            let (resumed, new) = match name {
                "line" => (zero, set_up.get("start_line")),
                "from_own_line" => {
                    let one = self.b.constant(1, 1);
                    (one, one)
                }
                "column" | "row" => (zero, zero),
                "resumes" => (self.b.constant(1, 1), zero),
                "i" => (self.get("answer_texel_u"), set_up.get("texel_u")),
                "j" => (self.get("answer_texel_v"), set_up.get("texel_v")),
                name => {
                    let kept = self.get(&format!("answer_{name}"));
                    (self.b.zero_extend(kept, width), zero)
                }
            };
            let outside = self.b.mux(refused, resumed, new);
            let round = self.fit(trip.get(&format!("{name}_o")), width);
            let next = self.b.mux(entry.recirculates, round, outside);
            let register = self.get(&format!("{name}_s0"));
            self.b.connect_enabled(register, next, begins);
        }
    }

    fn counters(&mut self, entry: &Entry) {
        self.b.section("counters");
        let begins = self.get("begins");
        let gap = self.b.not(begins);
        for (name, event) in [
            ("trips", begins),
            ("gaps", gap),
            ("refusals", entry.returns),
        ] {
            let counter = self.b.register(EXACT_COUNTER_BITS, None, Some(0));
            self.b.name(counter, name);
            let next = self.next_number(counter);
            self.b.connect_enabled(counter, next, event);
            self.b.output(&format!("{name}_o"), counter);
        }
    }
}
