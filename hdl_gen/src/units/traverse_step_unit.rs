//! A step alone, behind handshakes, for those who check it on its own.

use super::configuration::UnitConfiguration;
use super::traverse_datapaths::build_step;
use crate::netlist::{Builder, Module, Wire};
use crate::operators::stream_unit;
use crate::pipeline::ENABLE;
use rtl_model::units::step::Step;
use std::sync::Arc;

/// The name that the step has as an instance in `<step>_aligned`.
pub(crate) const STEP_INSTANCE: &str = "step";

/// The module `<step>_unit`, such as `traverse_step_unit`: the step with `valid`/`ready` handshakes
/// (see [`stream_unit`]), a ray's registers and the heights it asks for in together, all results
/// out together.
///
/// The step itself reads the heights as late as the memory answers and gives the address at once.
/// Between it and the handshakes stands `<step>_aligned`, which delays both by registers that
/// stall with the pipeline.
pub fn build_step_unit(configuration: &UnitConfiguration) -> Arc<Module> {
    let unit = stream_unit(&aligned_step(configuration));
    Arc::new(Module {
        name: format!("{}_unit", configuration.step.name()),
        ..Module::clone(&unit)
    })
}

fn aligned_step(configuration: &UnitConfiguration) -> Arc<Module> {
    let built = build_step(configuration);
    let step = built.module;
    let heights: Vec<String> = configuration
        .step
        .height_ports()
        .iter()
        .map(|(name, _)| format!("{name}_i"))
        .collect();
    let address_port = configuration.step.address_port();
    let asked_in = built.output_stages[&format!("{address_port}_o")];
    let answered_in = asked_in + configuration.memory_latency();
    let mut builder = Builder::new(format!("{}_aligned", step.name));
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
        .map(
            |&(name, wire)| match heights.iter().any(|height| height == name) {
                true => {
                    let base = name.strip_suffix("_i").unwrap_or(name);
                    delayed(&mut builder, base, wire, answered_in)
                }
                false => wire,
            },
        )
        .collect();

    builder.section("the step");
    let results = builder.instance(STEP_INSTANCE, &step, &inputs);

    builder.section("the address, with the other results");
    for (result, (name, driver)) in results.into_iter().zip(&step.outputs) {
        let result = builder.mean(result, step.node(*driver).meaning);
        let result = match name.strip_suffix("_o") {
            Some(base) if base == address_port => {
                delayed(&mut builder, base, result, step.latency - asked_in)
            }
            _ => result,
        };
        builder.output(name, result);
    }
    builder.finish()
}
