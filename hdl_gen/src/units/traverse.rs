//! The traverse unit: the step's pipeline closed to a loop, a ray port, a hit port, a memory port.

use super::probe::{CycleWords, Probe};
use super::traverse_datapaths::{build_setup, build_step};
use crate::datapath::{BuiltDatapath, OperatorLatencies, Source};
use crate::netlist::{Builder, Meaning, Module, Wire};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{ID_BITS, STEP_INPUTS};
use rtl_model::units::step::RegisterKind;
use rtl_model::units::traverse_step::TraverseShape;
use std::sync::Arc;

/// What a traverse unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitConfiguration {
    /// The map's size and height bits.
    pub shape: TraverseShape,
    /// The number format.
    pub format: FloatFormat,
    /// Cycles of each operator.
    pub latencies: OperatorLatencies,
}

impl UnitConfiguration {
    /// Cycles from an address to its height: the memory is synchronous.
    pub const fn memory_latency(&self) -> u32 {
        1
    }
}

/// The unit as hardware, with all that is compared of it.
#[derive(Clone, Debug)]
pub struct TraverseUnit {
    /// What it was built for.
    pub configuration: UnitConfiguration,
    /// The module `traverse` with all it uses.
    pub design: Arc<Module>,
    /// Cycles of a step; a ray enters again one cycle later.
    pub latency: u32,
    /// Every output port and register the golden machine knows.
    pub probes: Vec<Probe>,
}

impl TraverseUnit {
    /// Builds the unit.
    pub fn build(configuration: UnitConfiguration) -> TraverseUnit {
        let setup = build_setup(&configuration);
        let step = build_step(&configuration);
        let mut loop_builder = LoopBuilder {
            configuration,
            latency: step.latency,
            builder: Builder::new("traverse"),
            probes: Vec::new(),
        };
        loop_builder.build(&setup, &step);
        TraverseUnit {
            configuration,
            design: loop_builder.builder.finish(),
            latency: step.latency,
            probes: loop_builder.probes,
        }
    }
}

struct LoopBuilder {
    configuration: UnitConfiguration,
    latency: u32,
    builder: Builder,
    probes: Vec<Probe>,
}

impl LoopBuilder {
    fn build(&mut self, setup: &BuiltDatapath, step: &BuiltDatapath) {
        let format = self.configuration.format;
        let latency = self.latency;
        let float = Meaning::Float(format);
        let builder = &mut self.builder;
        builder
            .describe("The traverse unit: rays go round the step's pipeline until they have hit.");
        builder.describe(format!("format: {format}"));
        builder.describe(format!(
            "map: {0} x {0} texels",
            self.configuration.shape.size()
        ));
        builder.describe(format!(
            "cycles of a step: {}, of a trip round: {}",
            latency,
            latency + 1
        ));
        builder.describe("golden: rtl_model::machine::TraverseMachine");
        builder.set_latency(latency + 1);
        let id_bits = u32::try_from(builder.localparam(
            "ID_BITS",
            ID_BITS.into(),
            "tells the rays of a frame of up to 1024 x 1024 pixels apart",
        ))
        .expect("few bits");
        let last_stage = builder.localparam(
            "LAST_STAGE",
            latency.into(),
            "stages 0 to LAST_STAGE, each with a valid bit and an id",
        );

        let ray_valid = builder.input("ray_valid_i", 1);
        let ray_id = builder.input("ray_id_i", id_bits);
        let ray_ports = ["u", "v", "du", "dv"].map(|name| {
            let port = builder.input(&format!("ray_{name}_i"), format.width());
            builder.mean(port, float)
        });
        let hit_ready = builder.input("hit_ready_i", 1);
        let height = builder.input("height_i", self.configuration.shape.height_bits);

        builder.section("stage 0: what enters the step");
        let entry_valid = builder.register(1, None, Some(0));
        let entry_id = builder.register(id_bits, None, None);
        let entry_registers: Vec<Wire> = STEP_INPUTS
            .iter()
            .map(|&(name, kind)| {
                let (width, meaning) = match kind {
                    RegisterKind::Number => (format.width(), float),
                    RegisterKind::Integer(bits) => (bits, Meaning::Signed),
                    RegisterKind::Bit => (1, Meaning::Bits),
                };
                let register = builder.register(width, None, None);
                builder.name(register, format!("{name}_s0"));
                builder.mean(register, meaning)
            })
            .collect();

        builder.section("the step");
        let advance = builder.constant(1, 1);
        let mut ports = vec![advance];
        ports.extend(&entry_registers);
        ports.push(height);
        let results = builder.instance("step", &step.module, &ports);
        let result = |name: &str| {
            let port = format!("{name}_o");
            let outputs = &step.module.outputs;
            let place = outputs.iter().position(|(output, _)| *output == port);
            results[place.expect("the step has this output")]
        };

        builder.section("valid bits and ids beside it");
        let mut valid = vec![entry_valid];
        let mut ids = vec![entry_id];
        for stage in 1..=latency as usize {
            let bit = builder.registered(valid[stage - 1], None, Some(0));
            valid.push(bit);
            let id = builder.registered(ids[stage - 1], None, None);
            ids.push(id);
        }
        for stage in 0..=latency as usize {
            builder.name(valid[stage], format!("valid_s{stage}"));
            builder.name(ids[stage], format!("id_s{stage}"));
        }

        builder.section("the last stage: out, or round again");
        let last_stage = usize::try_from(last_stage).expect("few stages");
        let (last_valid, last_id) = (valid[last_stage], ids[last_stage]);
        let ended = builder.or(result("hit"), result("guard"));
        let hit_valid = builder.and(last_valid, ended);
        builder.name(hit_valid, "hit_valid");
        let leaves = builder.and(hit_valid, hit_ready);
        builder.name(leaves, "leaves");
        let stays = builder.not(leaves);
        let recirculates = builder.and(last_valid, stays);
        builder.name(recirculates, "recirculates");
        let ray_ready = builder.not(recirculates);
        builder.name(ray_ready, "ray_ready");

        builder.section("a new ray");
        let set_up = builder.instance("setup", &setup.module, &ray_ports);
        let set_up_output = |name: &str| {
            let port = format!("{name}_o");
            let place = setup
                .module
                .outputs
                .iter()
                .position(|(output, _)| *output == port);
            place.map(|place| set_up[place])
        };

        builder.section("what enters stage 0 next");
        let next_valid = builder.or(recirculates, ray_valid);
        builder.connect(entry_valid, next_valid);
        let next_id = builder.mux(recirculates, last_id, ray_id);
        builder.connect(entry_id, next_id);
        let root_level = u64::from(self.configuration.shape.root_level);
        for (&(name, _), &register) in STEP_INPUTS.iter().zip(&entry_registers) {
            let width = builder.width(register);
            let fresh = match (name, set_up_output(name)) {
                (_, Some(wire)) => wire,
                ("i", None) => {
                    let root = set_up_output("root_i").expect("the setup gives the root node");
                    builder.sign_extend(root, width)
                }
                ("j", None) => {
                    let root = set_up_output("root_j").expect("the setup gives the root node");
                    builder.sign_extend(root, width)
                }
                ("level", None) => builder.constant(root_level, width),
                // Depth, counts and flags of a walk that has not begun.
                _ => builder.constant(0, width),
            };
            let round_again = builder.sign_extend(result(name), width);
            let next = builder.mux(recirculates, round_again, fresh);
            builder.connect(register, next);
        }

        builder.section("ports");
        let texel_bits = self.configuration.shape.root_level.max(1);
        let texel_i = builder.slice(result("texel_i"), texel_bits - 1, 0);
        let texel_j = builder.slice(result("texel_j"), texel_bits - 1, 0);
        // The counters are never negative.
        let count_bits = builder.width(result("steps")) - 1;
        let steps = builder.slice(result("steps"), count_bits - 1, 0);
        let crossings = builder.slice(result("crossings"), count_bits - 1, 0);
        let address_bits = self.configuration.shape.address_bits();
        let address = builder.slice(result("node_address"), address_bits - 1, 0);
        builder.output("ray_ready_o", ray_ready);
        builder.output("hit_valid_o", hit_valid);
        builder.output("hit_id_o", last_id);
        builder.output("hit_i_o", texel_i);
        builder.output("hit_j_o", texel_j);
        builder.output("hit_t_o", result("t"));
        builder.output("hit_u_o", result("position_u"));
        builder.output("hit_v_o", result("position_v"));
        builder.output("hit_steps_o", steps);
        builder.output("hit_crossings_o", crossings);
        builder.output("hit_guard_o", result("guard"));
        builder.output("height_address_o", address);
        self.probe(step);
    }

    /// Lists what the golden machine knows: ports, the registers of the loop, those of the step.
    fn probe(&mut self, step: &BuiltDatapath) {
        let top = vec!["traverse".to_owned()];
        let float = Meaning::Float(self.configuration.format);
        let latency = self.latency;
        let path = |source: &Source| match source {
            Source::Register(name) => format!("traverse.step.{name}"),
            Source::Input("height") => "traverse.height_i".to_owned(),
            Source::Input(name) => format!("traverse.{name}_s0"),
        };
        let paths = |sources: &[Source], cycles: u32| -> Vec<(String, u32)> {
            sources
                .iter()
                .map(|source| (path(source), cycles))
                .collect()
        };
        // What decides whether a ray leaves or goes round again.
        let mut control = paths(&step.output_sources["hit_o"], 0);
        control.extend(paths(&step.output_sources["guard_o"], 0));
        control.push((format!("traverse.valid_s{latency}"), 0));
        let before = |sources: &[(String, u32)]| -> Vec<(String, u32)> {
            sources
                .iter()
                .map(|(path, cycles)| (path.clone(), cycles + 1))
                .collect()
        };
        let with = |sources: &[(String, u32)], more: &[&str]| {
            let mut all = sources.to_vec();
            all.extend(more.iter().map(|port| (format!("traverse.{port}"), 0)));
            all
        };
        let mut add = |name: String, width: u32, meaning, word, delay, sources| {
            let scope = top.clone();
            self.probes.push(Probe {
                scope,
                name,
                width,
                meaning,
                word,
                delay,
                sources,
            });
        };
        let bits = Meaning::Bits;
        let ready_sources = with(&control, &["hit_ready_i"]);
        add(
            "ray_ready_o".into(),
            1,
            bits,
            CycleWords::RAY_READY,
            0,
            ready_sources,
        );
        add(
            "hit_valid_o".into(),
            1,
            bits,
            CycleWords::HIT_VALID,
            0,
            control.clone(),
        );
        let id_source = vec![(format!("traverse.id_s{latency}"), 0)];
        add(
            "hit_id_o".into(),
            ID_BITS,
            bits,
            CycleWords::ID,
            latency,
            id_source,
        );
        let module = &step.module;
        let design = self.builder.module();
        for (port, output) in [
            ("hit_i_o", "texel_i_o"),
            ("hit_j_o", "texel_j_o"),
            ("hit_t_o", "t_o"),
            ("hit_u_o", "position_u_o"),
            ("hit_v_o", "position_v_o"),
            ("hit_steps_o", "steps_o"),
            ("hit_crossings_o", "crossings_o"),
            ("hit_guard_o", "guard_o"),
            ("height_address_o", "node_address_o"),
        ] {
            let word = CycleWords::OPERATIONS + step.output_words[output];
            let width = design.width(design.output(port).expect("a port just made"));
            let meaning = match module.output(output).map(|wire| module.node(wire).meaning) {
                Some(Meaning::Float(_)) => float,
                _ => bits,
            };
            let delay = if output == "node_address_o" {
                0
            } else {
                latency
            };
            let sources = paths(&step.output_sources[output], 0);
            add(port.into(), width, meaning, word, delay, sources);
        }
        for stage in 0..=latency {
            let (valid_sources, id_sources) = if stage == 0 {
                let valid = with(&control, &["ray_valid_i", "hit_ready_i"]);
                let mut id = with(&control, &["ray_id_i", "hit_ready_i"]);
                id.push((format!("traverse.id_s{latency}"), 0));
                (before(&valid), before(&id))
            } else {
                let earlier = |name: &str| vec![(format!("traverse.{name}_s{}", stage - 1), 1)];
                (earlier("valid"), earlier("id"))
            };
            add(
                format!("valid_s{stage}"),
                1,
                bits,
                CycleWords::VALID,
                stage,
                valid_sources,
            );
            add(
                format!("id_s{stage}"),
                ID_BITS,
                bits,
                CycleWords::ID,
                stage,
                id_sources,
            );
        }
        let ports = ["ray_u_i", "ray_v_i", "ray_du_i", "ray_dv_i", "hit_ready_i"];
        for (place, &(name, kind)) in STEP_INPUTS.iter().enumerate() {
            let (width, meaning) = match kind {
                RegisterKind::Number => (self.configuration.format.width(), float),
                RegisterKind::Integer(bits) => (bits, Meaning::Signed),
                RegisterKind::Bit => (1, bits),
            };
            let mut sources = with(&control, &ports);
            sources.extend(paths(&step.output_sources[&format!("{name}_o")], 0));
            let word = CycleWords::INPUTS + place;
            add(
                format!("{name}_s0"),
                width,
                meaning,
                word,
                0,
                before(&sources),
            );
        }
        for register in &step.registers {
            let word = match register.word {
                Ok(word) => CycleWords::OPERATIONS + word,
                Err(input) if input < STEP_INPUTS.len() => CycleWords::INPUTS + input,
                // The height comes from outside; the golden model keeps no register of it.
                Err(_) => continue,
            };
            self.probes.push(Probe {
                scope: vec!["traverse".to_owned(), "step".to_owned()],
                name: register.name.clone(),
                width: register.width,
                meaning: register.meaning,
                word,
                delay: register.stage,
                sources: paths(&register.sources, register.cycles_back),
            });
        }
    }
}
