//! The registers between which a module is measured.

use std::sync::Arc;

use crate::netlist::{Builder, Module};

/// Layers of registers before the module, and as many behind it.
pub const LAYERS: usize = 2;

/// The module with two layers of registers before every input and behind every output.
///
/// Of each pair the layer at the module ends the paths that are measured, wherever placement puts
/// it; the other stands between it and the pads, so that their place draws on nothing. The
/// registers have neither enable nor reset.
pub fn between_registers(core: &Arc<Module>) -> Arc<Module> {
    let mut builder = Builder::new(format!("{}_measured", core.name));
    builder.describe(format!(
        "{} between two layers of registers on each side, for measuring",
        core.name
    ));
    builder.set_latency(core.latency + 2 * LAYERS as u32);
    let inputs: Vec<_> = core
        .inputs
        .iter()
        .map(|&input| {
            let node = core.node(input);
            let name = node.name.as_deref().expect("an input has a name");
            (name, builder.input(name, node.width))
        })
        .collect();
    builder.section("registers before");
    let inputs: Vec<_> = inputs
        .into_iter()
        .map(|(name, mut wire)| {
            for layer in 1..=LAYERS {
                wire = builder.registered(wire, None, None);
                builder.name(wire, format!("before_{name}_{layer}"));
            }
            wire
        })
        .collect();
    builder.section("the module measured");
    let results = builder.instance("core", core, &inputs);
    builder.section("registers behind");
    for (mut wire, (name, _)) in results.into_iter().zip(&core.outputs) {
        builder.name(wire, format!("core_{name}"));
        for layer in 1..=LAYERS {
            wire = builder.registered(wire, None, None);
            builder.name(wire, format!("behind_{name}_{layer}"));
        }
        builder.output(name, wire);
    }
    builder.finish()
}
