//! The exact machine: setups, the loop of trips, the leaf check, with the height cache and the port
//! to the memory.

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
use rtl_model::machine::{DeclaredKind, EXACT_COUNTER_BITS, ExactMachineShape};
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

    /// The word in this width: of a signed word.
    fn fit(&mut self, wire: Wire, width: u32) -> Wire {
        match self.b.width(wire) > width {
            true => self.b.slice(wire, width - 1, 0),
            false => self.b.sign_extend(wire, width),
        }
    }

    fn load(&mut self, register: &str, value: Wire, enable: Wire) {
        let register = self.get(register);
        let value = self.fit(value, self.b.width(register));
        self.b.connect_enabled(register, value, enable);
    }

    /// Words side by side in memories of up to 64 bits; answers what is read.
    fn memory(
        &mut self,
        name: &str,
        words: u32,
        fields: &[Wire],
        (enable, write): (Wire, Wire),
        read: Wire,
    ) -> Vec<Wire> {
        let b = &mut self.b;
        let mut groups: Vec<Vec<Wire>> = Vec::new();
        let mut bits = 65;
        for &field in fields {
            if bits + b.width(field) > 64 {
                groups.push(Vec::new());
                bits = 0;
            }
            bits += b.width(field);
            groups.last_mut().expect("one was pushed").push(field);
        }
        let mut outputs = Vec::new();
        for (number, group) in groups.iter().enumerate() {
            let data = b.concat(group);
            let memory = b.memory(&format!("{name}_{number}"), words, b.width(data));
            b.memory_write(memory, enable, write, data);
            let word = b.memory_read(memory, read);
            let mut high = b.width(word);
            for &field in group {
                let width = b.width(field);
                outputs.push(b.slice(word, high - 1, high - width));
                high -= width;
            }
        }
        outputs
    }

    /// Is a count at least this?
    fn reaches(&mut self, count: Wire, bound: u32) -> Wire {
        let bound = self.b.constant(bound.into(), self.b.width(count));
        let below = self.b.less_than(count, bound);
        self.b.not(below)
    }

    fn next_number(&mut self, count: Wire) -> Wire {
        let one = self.b.constant(1, self.b.width(count));
        self.b.add(count, one)
    }

    fn all(&mut self, bits: &[Wire]) -> Wire {
        let mut result = bits[0];
        for &bit in &bits[1..] {
            result = self.b.and(result, bit);
        }
        result
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
        self.leaf(&entry, &fifo_block.outputs);

        self.b.section("the FIFO before the leaf check");
        let mut inputs = Ports::default();
        inputs.put("in_valid_i", self.get("ends"));
        for field in &shape.leaf_fifo.fields {
            let wire = match field.name.as_str() {
                "slot" => trip.get("slot"),
                "texel_u" => trip.get("i_o"),
                "texel_v" => trip.get("j_o"),
                name => trip.get(&format!("{name}_o")),
            };
            let wire = self.fit(wire, field.width);
            inputs.put(format!("in_{}_i", field.name), wire);
        }
        inputs.put("out_ready_i", self.get("waits"));
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

    /// The setups; answers what leaves the last, and `is_set_up`.
    fn setups(&mut self) -> Ports {
        let shape = self.shape;
        let setups = shape.effort.setups;
        let ray_names: Vec<&str> = shape.ray_registers().iter().map(|&(n, _)| n).collect();
        let division_names: Vec<&str> =
            shape.division_registers().iter().map(|&(n, _)| n).collect();

        self.b.section("which setups are done, and which are free");
        let fresh = self.get("fresh_s0");
        let mut done = Vec::new();
        let mut running = Vec::new();
        for n in 0..setups {
            let turns = self.get(&format!("setup_{n}_turns"));
            let runs = self.b.any_bit(turns);
            let rests = self.b.not(runs);
            let busy = self.get(&format!("setup_{n}_busy"));
            done.push(self.b.and(busy, rests));
            running.push(runs);
        }
        let not_fresh = self.b.not(fresh);
        let last = setups as usize - 1;
        let is_set_up = self.b.and(done[last], not_fresh);
        let mut free = vec![fresh; setups as usize];
        for n in (0..setups as usize).rev() {
            let busy = self.get(&format!("setup_{n}_busy"));
            let idle = self.b.not(busy);
            let leaves = match n == last {
                true => fresh,
                false => self.b.and(done[n], free[n + 1]),
            };
            free[n] = self.b.or(idle, leaves);
        }
        self.b.output("ray_ready_o", free[0]);

        for n in 0..setups as usize {
            self.b.section(format!("setup {n}"));
            let offered = match n {
                0 => self.get("ray_valid_i"),
                _ => done[n - 1],
            };
            let loads = self.b.and(offered, free[n]);
            let busy = self.get(&format!("setup_{n}_busy"));
            let not_free = self.b.not(free[n]);
            let stays = self.b.and(busy, not_free);
            let next = self.b.or(loads, stays);
            self.b.connect(busy, next);
            let turns = self.get(&format!("setup_{n}_turns"));
            let width = self.b.width(turns);
            let all = self.b.constant(shape.setup_turns(n as u32).into(), width);
            let one = self.b.constant(1, width);
            let fewer = self.b.subtract(turns, one);
            let next = self.b.mux(loads, all, fewer);
            let changes = self.b.or(loads, running[n]);
            self.b.connect_enabled(turns, next, changes);

            // What a ray brings along.
            let mut loaded = Ports::default();
            if n == 0 {
                let ports = [
                    ("u", self.get("ray_u_i")),
                    ("v", self.get("ray_v_i")),
                    ("du", self.get("ray_du_i")),
                    ("dv", self.get("ray_dv_i")),
                ];
                let entry = self.datapath(BoundedDatapath::SetupEntry, "", &ports);
                for name in &ray_names {
                    let wire = match *name {
                        "id" => self.get("ray_id_i"),
                        "texel_u" => entry.get("i_o"),
                        "texel_v" => entry.get("j_o"),
                        name => entry.get(&format!("{name}_o")),
                    };
                    loaded.put(*name, wire);
                }
                let texel = 1 << shape.bounded.words.entry_fraction_bits;
                for axis in ["u", "v"] {
                    for &(name, width) in &shape.division_registers() {
                        let wire = match name {
                            "delta_remainder" => self.b.constant(texel, width),
                            "first_remainder" => entry.get(&format!("first_way_{axis}_o")),
                            "t_delta" | "t_near" => self.b.constant(0, width),
                            name => entry.get(&format!("{name}_{axis}_o")),
                        };
                        loaded.put(format!("{name}_{axis}"), wire);
                    }
                }
            } else {
                for name in &ray_names {
                    loaded.put(*name, self.get(&format!("setup_{}_{name}", n - 1)));
                }
                for axis in ["u", "v"] {
                    for name in &division_names {
                        let wire = self.get(&format!("setup_{}_{name}_{axis}", n - 1));
                        loaded.put(format!("{name}_{axis}"), wire);
                    }
                }
            }
            for name in &ray_names {
                self.load(&format!("setup_{n}_{name}"), loaded.get(name), loads);
            }
            for axis in ["u", "v"] {
                let after = self.digits(n, axis, shape.effort.setup_digits, "");
                for name in &division_names {
                    let register = self.get(&format!("setup_{n}_{name}_{axis}"));
                    let width = self.b.width(register);
                    let start = self.fit(loaded.get(&format!("{name}_{axis}")), width);
                    // What a digit does not change is but loaded.
                    let is_unchanged =
                        ["delta_saturates", "first_saturates", "texels_back"].contains(name);
                    if is_unchanged {
                        self.b.connect_enabled(register, start, loads);
                        continue;
                    }
                    let turned = self.fit(after.get(&format!("{name}_o")), width);
                    let next = self.b.mux(loads, start, turned);
                    self.b.connect_enabled(register, next, changes);
                }
            }
        }

        self.b.section("a ray that is set up");
        let mut set_up = Ports::default();
        set_up.put("is_set_up", is_set_up);
        for name in &ray_names {
            set_up.put(*name, self.get(&format!("setup_{last}_{name}")));
        }
        for axis in ["u", "v"] {
            let (t_delta, t_near) = match shape.setup_rest() {
                0 => (
                    self.get(&format!("setup_{last}_t_delta_{axis}")),
                    self.get(&format!("setup_{last}_t_near_{axis}")),
                ),
                rest => {
                    let after = self.digits(last, axis, rest, "_rest");
                    (after.get("t_delta_o"), after.get("t_near_o"))
                }
            };
            let t_near = self.fit(t_near, shape.bounded.bound_bits());
            let upper = self.datapath(BoundedDatapath::SetupEnd, "", &[("t_near", t_near)]);
            let t_delta = self.fit(t_delta, shape.bounded.delta_bits() + 1);
            set_up.put(format!("t_delta_{axis}"), t_delta);
            let t_near = self.fit(upper.get("t_near_o"), shape.bounded.bound_bits());
            set_up.put(format!("t_near_{axis}"), t_near);
        }
        set_up
    }

    /// The division of a setup on an axis after so many digits.
    fn digits(&mut self, setup: usize, axis: &str, count: u32, suffix: &str) -> Ports {
        let names = self.shape.division_registers();
        let slope = self.get(&format!("setup_{setup}_slope_{axis}"));
        let mut inputs = vec![("slope", slope)];
        for &(name, _) in &names {
            inputs.push((name, self.get(&format!("setup_{setup}_{name}_{axis}"))));
        }
        self.datapath(BoundedDatapath::SetupDigits(count), suffix, &inputs)
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
        for stage in 0..stages {
            self.b.name(valid, format!("valid_s{stage}"));
            self.b.name(slot, format!("slot_s{stage}"));
            if stage + 1 < stages {
                valid = self.b.registered(valid, None, Some(0));
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
        let slots = shape.effort.slots;
        let free_slots = self.get("free_slots");
        let (one_hot, number) = self.lowest(free_slots);
        self.wires.put("slot_taken", one_hot);
        self.wires.put("new_slot", number);
        let admits = self.admits_ahead(&trip, set_up, cache);
        let names = [
            "t_delta_u",
            "t_delta_v",
            "start_line",
            "mirror_u",
            "mirror_v",
        ];
        let fields = names.map(|name| set_up.get(name));
        let ray = self.memory("step_rays", slots, &fields, (admits, number), slot_s0);

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
        let fresh = self.get("fresh_s0");
        let mut base = Vec::new();
        for axis in ["u", "v"] {
            let near = self.fit(trip.get(&format!("t_near_{axis}_o")), bounded.bound_bits());
            let words = slots << line_bits;
            let name = format!("t_near_{axis}");
            let stored = self.memory(&name, words, &[near], (writes, write), read)[0];
            let own = set_up.get(&format!("t_near_{axis}"));
            base.push(self.b.mux(fresh, own, stored));
        }

        self.b.section("the cache is asked, a stage later");
        let lookup_valid = self.get("lookup_valid");
        self.b.connect(lookup_valid, valid_s0);
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
        inputs.put("fresh_i", fresh);
        inputs.put("missed_i", missed);
        for (number, height) in heights.into_iter().enumerate() {
            inputs.put(format!("height_{number}_i"), height);
        }
        let inputs = inputs.inputs(&module);
        self.b.connect_instance(instance, &inputs);
        trip
    }

    /// The lowest bit set, alone, and its number.
    fn lowest(&mut self, word: Wire) -> (Wire, Wire) {
        let width = self.b.width(word);
        let zero = self.b.constant(0, width);
        let negative = self.b.subtract(zero, word);
        let one_hot = self.b.and(word, negative);
        let bits = width.trailing_zeros();
        let number: Vec<Wire> = (0..bits)
            .rev()
            .map(|bit| {
                let places = (0..width).filter(|place| place >> bit & 1 == 1);
                let mask = places.fold(0_u64, |mask, place| mask | 1 << place);
                let mask = self.b.constant(mask, width);
                let of_bit = self.b.and(one_hot, mask);
                self.b.any_bit(of_bit)
            })
            .collect();
        (one_hot, self.b.concat(&number))
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
        let place = self.b.slice(address, shape.offset_bits() - 1, 0);
        let place = self.b.registered(place, None, None);
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

    /// The leaf check, from the FIFO to the hit.
    fn leaf(&mut self, entry: &Entry, waiting: &Ports) {
        let shape = self.shape;
        let walk_names: Vec<&str> = shape
            .leaf_walk_registers()
            .iter()
            .map(|&(n, _)| n)
            .collect();
        let ray_names: Vec<&str> = shape.leaf_ray_registers().iter().map(|&(n, _)| n).collect();
        self.b
            .section("a walk waits for the leaf check, with its ray");
        let waiting_valid = self.get("waiting_valid");
        let is_free = self.b.not(waiting_valid);
        let waits = self.b.and(waiting.get("out_valid_o"), is_free);
        self.wires.put("waits", waits);
        let new_slot = self.get("new_slot");
        let set_up: Vec<Wire> = {
            let last = shape.effort.setups - 1;
            ray_names
                .iter()
                .map(|name| self.get(&format!("setup_{last}_{name}")))
                .collect()
        };
        let slot = waiting.get("out_slot_o");
        let slots = shape.effort.slots;
        let ray = self.memory("leaf_rays", slots, &set_up, (entry.admits, new_slot), slot);
        for name in &walk_names {
            let wire = waiting.get(&format!("out_{name}_o"));
            self.load(&format!("waiting_{name}"), wire, waits);
        }
        for (name, &wire) in ray_names.iter().zip(&ray) {
            self.load(&format!("waiting_{name}"), wire, waits);
        }

        self.b.section("the check begins");
        let check_valid = self.get("check_valid");
        let is_free = self.b.not(check_valid);
        let checks = self.b.and(waiting_valid, is_free);
        let not_checked = self.b.not(checks);
        let stays = self.b.and(waiting_valid, not_checked);
        let next = self.b.or(waits, stays);
        self.b.connect(waiting_valid, next);
        let checked = ["id", "slope_u", "slope_v", "mirror_u", "mirror_v"];
        for name in walk_names.iter().chain(&checked) {
            let wire = self.get(&format!("waiting_{name}"));
            self.load(&format!("check_{name}"), wire, checks);
        }
        let inputs = [
            ("mirrored_u", "mirrored_u"),
            ("mirrored_v", "mirrored_v"),
            ("i", "texel_u"),
            ("j", "texel_v"),
            ("slope_u", "slope_u"),
            ("slope_v", "slope_v"),
        ];
        let inputs = inputs.map(|(name, of)| (name, self.get(&format!("waiting_{of}"))));
        let ways = self.datapath(BoundedDatapath::LeafEntry, "", &inputs);

        self.b
            .section("the ray at the texel's depth, and the error term, digit by digit");
        let turns = self.get("check_turns");
        let has_travel = self.reaches(turns, shape.travel_turns());
        let has_corner = self.reaches(turns, shape.corner_turns());
        let not_travelled = self.b.not(has_travel);
        let travels = self.b.and(check_valid, not_travelled);
        let not_turned = self.b.not(has_corner);
        let corners = self.b.and(check_valid, not_turned);
        let turn_on = self.b.or(travels, corners);
        let one_more = self.next_number(turns);
        let none = self.b.constant(0, self.b.width(turns));
        let next = self.b.mux(checks, none, one_more);
        let changes = self.b.or(checks, turn_on);
        self.b.connect_enabled(turns, next, changes);
        for axis in ["u", "v"] {
            let way = ways.get(&format!("way_{axis}_o"));
            self.load(&format!("check_way_{axis}"), way, checks);
        }
        let of_check = |this: &Self, name: &'static str| (name, this.get(&format!("check_{name}")));
        let names = ["slope_u", "slope_v", "travel_u", "travel_v", "depth_digits"];
        let inputs = names.map(|name| of_check(self, name));
        let digits = BoundedDatapath::LeafTravel(shape.effort.travel_digits);
        let travel = self.datapath(digits, "", &inputs);
        let depth = self.get("waiting_depth");
        let depth = self
            .b
            .zero_extend(depth, shape.bounded.words.height_bits + 1);
        let starts = [
            ("travel_u", ways.get("way_u_o")),
            ("travel_v", ways.get("way_v_o")),
            ("depth_digits", depth),
        ];
        self.turn(&starts, &travel, checks, travels);
        let names = ["slope_u", "slope_v", "corner_u", "corner_v", "error"];
        let inputs = names.map(|name| of_check(self, name));
        let digits = BoundedDatapath::LeafCorner(shape.effort.corner_digits);
        let corner = self.datapath(digits, "", &inputs);
        let starts = ["corner_u", "corner_v", "error"];
        let starts = starts.map(|name| (name, ways.get(&format!("{name}_o"))));
        self.turn(&starts, &corner, checks, corners);

        self.b.section("the verdict");
        let error = match shape.corner_rest() {
            0 => self.get("check_error"),
            rest => {
                let rest = BoundedDatapath::LeafCorner(rest);
                let width = self.b.width(self.get("check_error"));
                let rest = self.datapath(rest, "_rest", &inputs);
                self.fit(rest.get("error_o"), width)
            }
        };
        let names = [
            "slope_u", "slope_v", "way_u", "way_v", "travel_u", "travel_v",
        ];
        let mut inputs: Vec<(&str, Wire)> = names.iter().map(|name| of_check(self, name)).collect();
        inputs.push(("error", error));
        let verdict = self.datapath(BoundedDatapath::LeafVerdict, "", &inputs);
        let needs_no_corner = self.b.not(verdict.get("needs_corner_o"));
        let suffices = self.b.or(has_corner, needs_no_corner);
        let answer_valid = self.get("answer_valid");
        let is_free = self.b.not(answer_valid);
        let answers = self.all(&[check_valid, has_travel, suffices, is_free]);
        let not_answered = self.b.not(answers);
        let stays = self.b.and(check_valid, not_answered);
        let next = self.b.or(checks, stays);
        self.b.connect(check_valid, next);
        for name in walk_names.iter().chain(&["id", "mirror_u", "mirror_v"]) {
            let wire = self.get(&format!("check_{name}"));
            self.load(&format!("answer_{name}"), wire, answers);
        }
        let guard = self.get("check_guard");
        let no_guard = self.b.not(guard);
        let refused = self.b.and(verdict.get("refused_o"), no_guard);
        self.load("answer_refused", refused, answers);
        let at_border_v = verdict.get("at_border_v_o");
        self.load("answer_at_border_u", verdict.get("at_border_u_o"), answers);
        self.load("answer_at_border_v", at_border_v, answers);
        for (name, of_axis) in [("way", "check_way"), ("slope", "check_slope")] {
            let on = |this: &Self, axis: &str| this.get(&format!("{of_axis}_{axis}"));
            let (u, v) = (on(self, "u"), on(self, "v"));
            let chosen = self.b.mux(at_border_v, v, u);
            self.load(&format!("answer_{name}"), chosen, answers);
        }

        self.b
            .section("the answer: a hit, or the walk goes back into the loop");
        let not_refused = self.b.not(self.wires.get("answer_refused"));
        let hit_valid = self.b.and(answer_valid, not_refused);
        let taken = self.b.and(hit_valid, self.wires.get("hit_ready_i"));
        let leaves = self.b.or(taken, entry.returns);
        let remains = self.b.not(leaves);
        let stays = self.b.and(answer_valid, remains);
        let next = self.b.or(answers, stays);
        self.b.connect(answer_valid, next);
        self.b.output("hit_valid_o", hit_valid);
        for (name, width) in shape.hit_fields() {
            let register = match name {
                "i" => "texel_u",
                "j" => "texel_v",
                name => name,
            };
            let mut wire = self.get(&format!("answer_{register}"));
            if let "i" | "j" = name {
                wire = self.b.slice(wire, width - 1, 0);
                let axis = if name == "i" { "u" } else { "v" };
                let mirror = self.get(&format!("answer_mirror_{axis}"));
                let mirror = self.b.sign_extend(mirror, width);
                wire = self.b.xor(wire, mirror);
                if shape.bounded.words.root_level == 0 {
                    wire = self.b.constant(0, 1);
                }
            }
            self.b.output(&format!("hit_{name}_o"), wire);
        }

        self.b
            .section("slots: taken by a new ray, free when its hit is taken");
        let free_slots = self.get("free_slots");
        let none = self.b.constant(0, slots);
        let taken_slot = self.b.mux(entry.admits, self.wires.get("slot_taken"), none);
        let kept = self.b.not(taken_slot);
        let kept = self.b.and(free_slots, kept);
        let slot = self.get("answer_slot");
        let bits: Vec<Wire> = (0..slots)
            .rev()
            .map(|number| {
                let number = self.b.constant(number.into(), shape.slot_bits());
                let is_this = self.b.equal(slot, number);
                self.b.and(is_this, taken)
            })
            .collect();
        let freed = self.b.concat(&bits);
        let next = self.b.or(kept, freed);
        self.b.connect(free_slots, next);
    }

    /// Registers of the check that begin so and go on so.
    fn turn(&mut self, starts: &[(&str, Wire)], after: &Ports, begins: Wire, goes_on: Wire) {
        let changes = self.b.or(begins, goes_on);
        for &(name, start) in starts {
            let register = self.get(&format!("check_{name}"));
            let width = self.b.width(register);
            let start = self.fit(start, width);
            let turned = self.fit(after.get(&format!("{name}_o")), width);
            let next = self.b.mux(begins, start, turned);
            self.b.connect_enabled(register, next, changes);
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
