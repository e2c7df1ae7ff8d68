//! The step alone, behind handshakes, for those who check it on its own.

use super::traverse::UnitConfiguration;
use super::traverse_datapaths::build_step;
use crate::netlist::{Builder, Module, Wire};
use crate::operators::stream_unit;
use crate::pipeline::ENABLE;
use std::sync::Arc;

/// The module `traverse_step_unit`: the step with `valid`/`ready` handshakes (see
/// [`stream_unit`]), a ray's registers and the height of its node in together, all results out
/// together.
///
/// The step itself reads the height as late as the memory answers and gives the address at once.
/// Between it and the handshakes stands `traverse_step_aligned`, which delays both by registers
/// that stall with the pipeline.
pub fn build_step_unit(configuration: &UnitConfiguration) -> Arc<Module> {
    let unit = stream_unit(&aligned_step(configuration));
    Arc::new(Module {
        name: "traverse_step_unit".to_owned(),
        ..Module::clone(&unit)
    })
}

fn aligned_step(configuration: &UnitConfiguration) -> Arc<Module> {
    let step = build_step(configuration).module;
    let mut builder = Builder::new("traverse_step_aligned");
    builder.describe("A step whose height comes with its other inputs, and whose address leaves");
    builder.describe("with its other results: for checks of the step alone.");
    for line in &step.description {
        builder.describe(line);
    }
    builder.set_latency(step.latency);
    let ports: Vec<(&str, Wire)> = step
        .inputs
        .iter()
        .map(|&port| {
            let node = step.node(port);
            let name = node.name.as_deref().expect("an input has a name");
            let wire = builder.input(name, node.width);
            (name, builder.mean(wire, node.meaning))
        })
        .collect();
    let enable = ports.iter().find(|(name, _)| *name == ENABLE);
    let enable = enable.map(|&(_, wire)| wire);
    let delayed = |builder: &mut Builder, name: &str, wire: Wire, cycles: u32| {
        (1..=cycles).fold(wire, |before, stage| {
            let register = builder.registered(before, enable, None);
            builder.name(register, format!("{name}_s{stage}"))
        })
    };

    builder.section("the height, when the memory would have answered");
    let inputs: Vec<Wire> = ports
        .iter()
        .map(|&(name, wire)| match name {
            "height_i" => delayed(&mut builder, "height", wire, configuration.memory_latency()),
            _ => wire,
        })
        .collect();

    builder.section("the step");
    let results = builder.instance("step", &step, &inputs);

    builder.section("the address, with the other results");
    for (result, (name, driver)) in results.into_iter().zip(&step.outputs) {
        let result = builder.mean(result, step.node(*driver).meaning);
        let result = match name.as_str() {
            "node_address_o" => delayed(&mut builder, "node_address", result, step.latency),
            _ => result,
        };
        builder.output(name, result);
    }
    builder.finish()
}
