//! The two datapaths of the traverse unit, recorded from the functions the golden model evaluates.

use super::traverse::UnitConfiguration;
use crate::datapath::{BuiltDatapath, IntSignal, Recorder, build, schedule};
use rtl_model::machine::STEP_INPUTS;
use rtl_model::units::search_policy::SearchPolicy;
use rtl_model::units::step::RegisterKind;
use rtl_model::units::traverse_setup::{RayRegisters, traverse_setup};
use rtl_model::units::traverse_step::{WalkRegisters, node_address, traverse_step};

/// The module `traverse_setup`: combinational, a ray's ports in, its registers out.
pub fn build_setup(configuration: &UnitConfiguration) -> BuiltDatapath {
    let mut recorder = Recorder::new(configuration.format);
    let u = recorder.num_input("u", 0);
    let v = recorder.num_input("v", 0);
    let du = recorder.num_input("du", 0);
    let dv = recorder.num_input("dv", 0);
    let setup = traverse_setup(
        &mut recorder,
        configuration.shape,
        SearchPolicy::OH,
        u,
        v,
        du,
        dv,
    );
    let ray = setup.ray;
    for (name, signal) in [
        ("u", ray.u),
        ("v", ray.v),
        ("du", ray.du),
        ("dv", ray.dv),
        ("exact_below_u", ray.exact_below_u),
        ("exact_below_v", ray.exact_below_v),
    ] {
        recorder.output(name, signal);
    }
    recorder.output("mirror_u", ray.mirror_u);
    recorder.output("mirror_v", ray.mirror_v);
    recorder.output("root_i", setup.i);
    recorder.output("root_j", setup.j);
    let recording = recorder.finish();
    // Comparisons and arithmetic would need cycles; there are none in the setup.
    let schedule = schedule(&recording, &configuration.latencies);
    build(
        &recording,
        &schedule,
        &configuration.latencies,
        "traverse_setup",
        &[
            "Mirrors a ray so that it travels toward larger u and v.".to_owned(),
            format!("format: {}", configuration.format),
            "golden: rtl_model::units::traverse_setup::traverse_setup".to_owned(),
        ],
    )
}

/// The module `traverse_step`: pipelined, a ray's registers in, a step later out.
///
/// Inputs are [`STEP_INPUTS`] in stage 0 and `height` one cycle of memory later; outputs are the
/// same registers after the step, the position and the texel; `node_address` leaves in stage 0.
pub fn build_step(configuration: &UnitConfiguration) -> BuiltDatapath {
    let mut recorder = Recorder::new(configuration.format);
    let mut numbers = Vec::new();
    let mut integers = Vec::new();
    let mut bits = Vec::new();
    for (name, kind) in STEP_INPUTS {
        match kind {
            RegisterKind::Number => numbers.push(recorder.num_input(name, 0)),
            RegisterKind::Integer(width) => integers.push(recorder.int_input(name, width, 0)),
            RegisterKind::Bit => bits.push(recorder.bit_input(name, 0)),
        }
    }
    let height_bits = configuration.shape.height_bits;
    let height: IntSignal =
        recorder.height_input("height", height_bits, configuration.memory_latency());
    let [u, v, du, dv, exact_below_u, exact_below_v, t] = numbers[..] else {
        unreachable!("seven numbers");
    };
    let [level, i, j, steps, crossings] = integers[..] else {
        unreachable!("five integers");
    };
    let [
        mirror_u,
        mirror_v,
        at_border_v,
        corner_owed,
        corner_paid,
        hit,
        guard,
    ] = bits[..]
    else {
        unreachable!("seven bits");
    };
    let ray = RayRegisters {
        u,
        v,
        du,
        dv,
        exact_below_u,
        exact_below_v,
        mirror_u,
        mirror_v,
    };
    let walk = WalkRegisters {
        level,
        i,
        j,
        t,
        at_border_v,
        corner_owed,
        corner_paid,
        passed: None,
        crossed_before: None,
        steps,
        crossings,
        hit,
        guard,
    };
    // In the order in which the golden model evaluates them.
    let address = node_address(
        &mut recorder,
        configuration.shape,
        SearchPolicy::OH,
        &ray,
        &walk,
    );
    let result = traverse_step(
        &mut recorder,
        configuration.shape,
        SearchPolicy::OH,
        &ray,
        &walk,
        height,
    );

    recorder.early_output("node_address", address);
    for (name, signal) in [
        ("u", ray.u),
        ("v", ray.v),
        ("du", ray.du),
        ("dv", ray.dv),
        ("exact_below_u", ray.exact_below_u),
        ("exact_below_v", ray.exact_below_v),
    ] {
        recorder.output(name, signal);
    }
    let next = result.walk;
    recorder.output("mirror_u", ray.mirror_u);
    recorder.output("mirror_v", ray.mirror_v);
    recorder.output("level", next.level);
    recorder.output("i", next.i);
    recorder.output("j", next.j);
    recorder.output("t", next.t);
    recorder.output("at_border_v", next.at_border_v);
    recorder.output("corner_owed", next.corner_owed);
    recorder.output("corner_paid", next.corner_paid);
    recorder.output("steps", next.steps);
    recorder.output("crossings", next.crossings);
    recorder.output("hit", next.hit);
    recorder.output("guard", next.guard);
    recorder.output("position_u", result.position_u);
    recorder.output("position_v", result.position_v);
    recorder.output("texel_i", result.texel_i);
    recorder.output("texel_j", result.texel_j);
    let recording = recorder.finish();
    let schedule = schedule(&recording, &configuration.latencies);
    let latencies = configuration.latencies;
    build(
        &recording,
        &schedule,
        &latencies,
        "traverse_step",
        &[
            "One step of the walk down and across the pyramid of maximum heights: method oh."
                .to_owned(),
            format!("format: {}", configuration.format),
            format!(
                "map: {0} x {0} texels, heights of {1} bits",
                configuration.shape.size(),
                height_bits
            ),
            format!(
                "cycles: adder {}, multiplier {}, divider {}, comparator {}, conversion {}; {} in all",
                latencies.adder,
                latencies.multiplier,
                latencies.divider,
                latencies.comparator,
                latencies.conversion,
                schedule.last_stage
            ),
            format!(
                "height_i is read {} cycle(s) after the other inputs",
                configuration.memory_latency()
            ),
            "golden: rtl_model::units::traverse_step::traverse_step".to_owned(),
        ],
    )
}
