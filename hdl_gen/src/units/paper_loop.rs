//! The loop of the paper's traverse unit as a module: passes, recirculation, controller. The FIFOs,
//! the height cache and the port to the memory stand around it.

use std::sync::Arc;

use super::paper_datapaths::{BuiltPaperSetup, build_paper_setup, build_paper_step};
use super::traverse::shown_as;
use super::traverse_datapaths::FreshValue;
use crate::datapath::{BuiltDatapath, OperatorLatencies};
use crate::netlist::{Builder, Meaning, Module, Wire};
use rtl_model::float::FloatFormat;
use rtl_model::machine::{ID_BITS, PaperShape};

/// Bits of the counters, which run over.
const COUNTER_BITS: u32 = 32;

/// The module's name.
pub const PAPER_LOOP: &str = "paper_loop";

/// The loop as hardware, with what it is made of.
#[derive(Clone, Debug)]
pub struct PaperLoop {
    /// What the unit is built as.
    pub shape: PaperShape,
    /// The format of its numbers.
    pub format: FloatFormat,
    /// The module `paper_loop`.
    pub design: Arc<Module>,
    /// A pass of it.
    pub step: BuiltDatapath,
}

impl PaperLoop {
    /// Builds the loop.
    pub fn build(
        shape: &PaperShape,
        format: FloatFormat,
        latencies: &OperatorLatencies,
    ) -> PaperLoop {
        let step = build_paper_step(&shape.step, format, latencies, shape.height_stage());
        let setup = build_paper_setup(&shape.step, format);
        PaperLoop {
            design: build_loop(shape, format, &setup, &step),
            shape: shape.clone(),
            format,
            step,
        }
    }
}

fn build_loop(
    shape: &PaperShape,
    format: FloatFormat,
    setup: &BuiltPaperSetup,
    step: &BuiltDatapath,
) -> Arc<Module> {
    let latency = step.latency;
    let mut loop_builder = Builder::new(PAPER_LOOP);
    let b = &mut loop_builder;
    b.describe(
        "The loop of the 2013 hardware paper's traverse unit (section 4): rays go round the",
    );
    b.describe(
        "pipeline of passes until they have their answer. The controller lets a ray in only",
    );
    b.describe("while FIFO 1 has a place for it, so that nothing in the loop ever stops.");
    b.describe(format!(
        "map: {0} x {0} texels, heights of {1} bits; format: {format}",
        shape.step.shape.size(),
        shape.step.shape.height_bits
    ));
    b.describe(format!("stages: {}", latency + 1));
    b.describe("golden: rtl_model::machine::PaperMachine");
    b.set_latency(latency + 1);
    b.localparam(
        "ID_BITS",
        ID_BITS.into(),
        "tells the rays of a frame of up to 1024 x 1024 pixels apart",
    );
    b.localparam(
        "LAST_STAGE",
        latency.into(),
        "stages 0 to LAST_STAGE, each with a valid bit and an id",
    );
    b.localparam(
        "PLACES",
        shape.fifo_1.depth.into(),
        "of FIFO 1: so many rays may be in the loop and in it together",
    );

    let waiting_valid = b.input("waiting_valid_i", 1);
    let waiting_id = b.input("waiting_id_i", ID_BITS);
    let waiting_ray: Vec<Wire> = ["u", "v", "du", "dv"]
        .iter()
        .map(|name| {
            let port = b.input(&format!("waiting_{name}_i"), format.width());
            b.mean(port, Meaning::Float(format))
        })
        .collect();
    let hit_leaves = b.input("hit_leaves_i", 1);
    let cache_ready = b.input("cache_ready_i", 1);
    let answer_valid = b.input("answer_valid_i", 1);
    let answer_hit = b.input("answer_hit_i", 1);
    let answer_height = b.input("answer_height_i", shape.step.shape.height_bits);

    b.section("stage 0: what enters a pass");
    let mut registers = shape.step.ray_registers();
    let unchanged = registers.len();
    registers.extend(shape.step.walk_registers());
    let valid_s0 = b.register(1, None, Some(0));
    let id_s0 = b.register(ID_BITS, None, None);
    let entry: Vec<Wire> = registers
        .iter()
        .map(|&(name, kind)| {
            let (width, meaning) = shown_as(kind, format);
            let register = b.register(width, None, None);
            b.name(register, format!("{name}_s0"));
            b.mean(register, meaning)
        })
        .collect();

    b.section("the cache has answered");
    let not_hit = b.not(answer_hit);
    let missed = b.and(answer_valid, not_hit);
    b.name(missed, "missed");

    b.section("the pass");
    let advance = b.constant(1, 1);
    let mut ports = vec![advance];
    ports.extend(&entry);
    ports.extend([answer_height, missed]);
    let results = b.instance("step", &step.module, &ports);
    let result = |name: &str| {
        let port = format!("{name}_o");
        let outputs = &step.module.outputs;
        let place = outputs.iter().position(|(output, _)| *output == port);
        results[place.expect("the step has this output")]
    };

    b.section("the height cache is asked, a stage later");
    let starts_s0 = entry[unchanged];
    let walks = b.not(starts_s0);
    let asks = b.and(valid_s0, walks);
    let lookup_valid = b.registered(asks, None, Some(0));
    b.name(lookup_valid, "lookup_valid");
    let address = b.slice(result("node_address"), shape.step.address_bits() - 1, 0);
    let lookup_address = b.registered(address, None, Some(0));
    b.name(lookup_address, "lookup_address");

    b.section("valid bits and ids beside the pass");
    let (mut valid, mut id) = (valid_s0, id_s0);
    b.name(valid, "valid_s0");
    b.name(id, "id_s0");
    for stage in 1..=latency {
        valid = b.registered(valid, None, Some(0));
        b.name(valid, format!("valid_s{stage}"));
        id = b.registered(id, None, None);
        b.name(id, format!("id_s{stage}"));
    }

    b.section("the last stage: into FIFO 1, or round again");
    let answered = b.or(result("hit"), result("guard"));
    let ends = b.and(valid, answered);
    b.name(ends, "ends");
    let open = b.not(answered);
    let recirculates = b.and(valid, open);
    b.name(recirculates, "recirculates");

    b.section("the controller: room for one more ray?");
    let inside_bits = shape.inside_bits();
    let rays_inside = b.register(inside_bits, None, Some(0));
    b.name(rays_inside, "rays_inside");
    let places = b.constant(shape.fifo_1.depth.into(), inside_bits);
    let is_below = b.less_than(rays_inside, places);
    let has_place = b.or(is_below, hit_leaves);
    let has_room = b.and(has_place, cache_ready);
    b.name(has_room, "has_room");
    let has_gap = b.not(recirculates);
    let may_admit = b.and(has_gap, has_room);
    let admits = b.and(may_admit, waiting_valid);
    b.name(admits, "admits");
    let entering = b.zero_extend(admits, inside_bits);
    let leaving = b.zero_extend(hit_leaves, inside_bits);
    let with_entering = b.add(rays_inside, entering);
    let inside_next = b.subtract(with_entering, leaving);
    b.connect(rays_inside, inside_next);

    b.section("a new ray");
    let fresh = b.instance("setup", &setup.module, &waiting_ray);
    let fresh_output = |port: &str| {
        let outputs = &setup.module.outputs;
        let place = outputs.iter().position(|(output, _)| *output == port);
        fresh[place.expect("the setup has this output")]
    };

    b.section("what enters stage 0 next");
    let valid_next = b.or(recirculates, admits);
    b.connect(valid_s0, valid_next);
    let id_next = b.mux(recirculates, id, waiting_id);
    b.connect(id_s0, id_next);
    for ((&(name, _), &register), fresh) in registers.iter().zip(&entry).zip(&setup.fresh) {
        let width = b.width(register);
        let fresh = match fresh {
            FreshValue::Port(port) => b.sign_extend(fresh_output(port), width),
            FreshValue::Constant(value) => b.constant(*value, width),
        };
        let round_again = b.sign_extend(result(name), width);
        let next = b.mux(recirculates, round_again, fresh);
        b.connect(register, next);
    }

    if shape.counters {
        b.section("counters");
        let gap_without_room = {
            let no_room = b.not(has_room);
            b.and(has_gap, no_room)
        };
        let gap_without_ray = {
            let no_ray = b.not(waiting_valid);
            b.and(may_admit, no_ray)
        };
        for (name, event) in [
            ("passes", valid_next),
            ("gaps_without_ray", gap_without_ray),
            ("gaps_without_room", gap_without_room),
        ] {
            let counter = b.register(COUNTER_BITS, None, Some(0));
            b.name(counter, name);
            let one = b.zero_extend(event, COUNTER_BITS);
            let next = b.add(counter, one);
            b.connect(counter, next);
            b.output(&format!("{name}_o"), counter);
        }
    }

    b.section("ports");
    let texel_bits = shape.step.shape.root_level.max(1);
    let texel_i = b.slice(result("texel_i"), texel_bits - 1, 0);
    let texel_j = b.slice(result("texel_j"), texel_bits - 1, 0);
    // The counters are never negative.
    let count_bits = b.width(result("steps")) - 1;
    let steps = b.slice(result("steps"), count_bits - 1, 0);
    let crossings = b.slice(result("crossings"), count_bits - 1, 0);
    b.output("admits_o", admits);
    b.output("lookup_valid_o", lookup_valid);
    b.output("lookup_address_o", lookup_address);
    b.output("ends_o", ends);
    for (name, wire) in [
        ("id", id),
        ("i", texel_i),
        ("j", texel_j),
        ("t", result("depth")),
        ("u", result("position_u")),
        ("v", result("position_v")),
        ("steps", steps),
        ("crossings", crossings),
        ("guard", result("guard")),
    ] {
        b.output(&format!("ended_{name}_o"), wire);
    }
    loop_builder.finish()
}
