//! The traverse unit: the step's pipeline closed to a loop, a ray port, a hit port, a memory port.

use super::configuration::UnitConfiguration;
use super::probe::Probe;
use super::traverse_datapaths::{BuiltSetup, FreshValue, build_setup, build_step, step_registers};
use super::traverse_probes::UnitProbes;
use crate::datapath::BuiltDatapath;
use crate::netlist::{Builder, Meaning, Module, Wire};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{ID_BITS, UnitLatency};
use rtl_model::units::step::{RegisterKind, Step};
use std::sync::Arc;

/// The unit as hardware, with all that is compared of it.
#[derive(Clone, Debug)]
pub struct TraverseUnit {
    /// What it was built for.
    pub configuration: UnitConfiguration,
    /// The module `traverse` with all it uses.
    pub design: Arc<Module>,
    /// Cycles of its pipelines.
    pub latency: UnitLatency,
    /// Every output port and register the golden machine knows.
    pub probes: Vec<Probe>,
}

impl TraverseUnit {
    /// Builds the unit.
    ///
    /// # Panics
    /// Where [`UnitConfiguration::check_loop`] fails.
    pub fn build(configuration: UnitConfiguration) -> TraverseUnit {
        if let Err(error) = configuration.check_loop() {
            panic!("{error}");
        }
        let setup = build_setup(&configuration);
        let step = build_step(&configuration);
        let latency = UnitLatency {
            setup: setup.datapath.latency,
            step: step.latency,
        };
        let design = build_loop(&configuration, latency, &setup, &step);
        let probes = UnitProbes {
            configuration: &configuration,
            latency,
            setup: &setup,
            step: &step,
            design: &design,
        };
        TraverseUnit {
            configuration,
            latency,
            probes: probes.all(),
            design,
        }
    }

    /// The ports driven in every cycle: the ray's handshake and id, the ray, the hit's readiness.
    pub fn driven_ports(&self) -> Vec<String> {
        let ray = self.configuration.step.ray_ports();
        let ray = ray.iter().map(|(name, _)| format!("ray_{name}_i"));
        ["ray_valid_i".to_owned(), "ray_id_i".to_owned()]
            .into_iter()
            .chain(ray)
            .chain(["hit_ready_i".to_owned()])
            .collect()
    }

    /// The port on which the synchronous memory answers.
    pub fn height_port(&self) -> String {
        format!("{}_i", self.configuration.step.height_ports()[0].0)
    }
}

fn build_loop(
    configuration: &UnitConfiguration,
    unit_latency: UnitLatency,
    setup: &BuiltSetup,
    step: &BuiltDatapath,
) -> Arc<Module> {
    let format = configuration.format;
    let latency = unit_latency.step;
    let registers = step_registers(&configuration.step);
    let mut loop_builder = Builder::new("traverse");
    let builder = &mut loop_builder;
    builder.describe("The traverse unit: rays go round the step's pipeline until they have hit.");
    for line in configuration.description() {
        builder.describe(line);
    }
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
    let ray_ports = configuration.step.ray_ports();
    let ray_ports = ray_ports.iter().map(|&(name, kind)| {
        let (width, meaning) = shown_as(kind, format);
        let port = builder.input(&format!("ray_{name}_i"), width);
        builder.mean(port, meaning)
    });
    let ray_ports: Vec<Wire> = ray_ports.collect();
    let hit_ready = builder.input("hit_ready_i", 1);
    let (height, height_bits) = configuration.step.height_ports()[0];
    let height = builder.input(&format!("{height}_i"), height_bits);

    builder.section("stage 0: what enters the step");
    let entry_valid = builder.register(1, None, Some(0));
    let entry_id = builder.register(id_bits, None, None);
    let entry_registers: Vec<Wire> = registers
        .iter()
        .map(|&(name, kind)| {
            let (width, meaning) = shown_as(kind, format);
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
    let has_gap = builder.not(recirculates);
    let mut setup_ports = ray_ports;
    let (arrives, arriving_id, ray_ready) = match unit_latency.setup {
        0 => {
            builder.name(has_gap, "ray_ready");
            (ray_valid, ray_id, has_gap)
        }
        stages => {
            builder.name(has_gap, "has_gap");
            let pipeline = setup_control(builder, stages, [ray_valid, ray_id], has_gap, id_bits);
            setup_ports.insert(0, pipeline.advances);
            (pipeline.last_valid, pipeline.last_id, pipeline.advances)
        }
    };

    builder.section("a new ray");
    let set_up = builder.instance("setup", &setup.datapath.module, &setup_ports);
    let set_up_output = |port: &str| {
        let outputs = &setup.datapath.module.outputs;
        let place = outputs.iter().position(|(output, _)| *output == port);
        set_up[place.expect("the setup has this output")]
    };

    builder.section("what enters stage 0 next");
    let next_valid = builder.or(recirculates, arrives);
    builder.connect(entry_valid, next_valid);
    let next_id = builder.mux(recirculates, last_id, arriving_id);
    builder.connect(entry_id, next_id);
    for ((&(name, _), &register), fresh) in registers.iter().zip(&entry_registers).zip(&setup.fresh)
    {
        let width = builder.width(register);
        let fresh = match fresh {
            FreshValue::Port(port) => builder.sign_extend(set_up_output(port), width),
            FreshValue::Constant(value) => builder.constant(*value, width),
        };
        let round_again = builder.sign_extend(result(name), width);
        let next = builder.mux(recirculates, round_again, fresh);
        builder.connect(register, next);
    }

    builder.section("ports");
    let texel_bits = configuration.shape.root_level.max(1);
    let texel_i = builder.slice(result("texel_i"), texel_bits - 1, 0);
    let texel_j = builder.slice(result("texel_j"), texel_bits - 1, 0);
    // The counters are never negative.
    let count_bits = builder.width(result("steps")) - 1;
    let steps = builder.slice(result("steps"), count_bits - 1, 0);
    let crossings = builder.slice(result("crossings"), count_bits - 1, 0);
    let address_bits = configuration.step.address_bits();
    let address = result(configuration.step.address_port());
    let address = builder.slice(address, address_bits - 1, 0);
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
    loop_builder.finish()
}

/// The bits of a register, and how they are meant.
pub(super) fn shown_as(kind: RegisterKind, format: FloatFormat) -> (u32, Meaning) {
    match kind {
        RegisterKind::Number => (format.width(), Meaning::Float(format)),
        RegisterKind::Integer(bits) => (bits, Meaning::Signed),
        RegisterKind::Bit => (1, Meaning::Bits),
    }
}

/// What the setup's pipeline gives the loop.
struct SetupControl {
    advances: Wire,
    last_valid: Wire,
    last_id: Wire,
}

/// Valid bits and ids beside the stages of the setup. It advances as a whole: when a ray at its end
/// enters the loop, or there is none.
fn setup_control(
    builder: &mut Builder,
    stages: u32,
    [ray_valid, ray_id]: [Wire; 2],
    has_gap: Wire,
    id_bits: u32,
) -> SetupControl {
    builder.section("the setup's pipeline");
    let valid: Vec<Wire> = (0..stages)
        .map(|_| builder.register(1, None, Some(0)))
        .collect();
    let ids: Vec<Wire> = (0..stages)
        .map(|_| builder.register(id_bits, None, None))
        .collect();
    for (stage, (&valid, &id)) in (1..).zip(valid.iter().zip(&ids)) {
        builder.name(valid, format!("setup_valid_s{stage}"));
        builder.name(id, format!("setup_id_s{stage}"));
    }
    let last = stages as usize - 1;
    let (last_valid, last_id) = (valid[last], ids[last]);
    let last_is_empty = builder.not(last_valid);
    let advances = builder.or(has_gap, last_is_empty);
    builder.name(advances, "ray_ready");
    for (rank, before) in [(valid, ray_valid), (ids, ray_id)] {
        let mut before = before;
        for register in rank {
            let next = builder.mux(advances, before, register);
            builder.connect(register, next);
            before = register;
        }
    }
    SetupControl {
        advances,
        last_valid,
        last_id,
    }
}
