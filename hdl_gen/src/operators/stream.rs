//! A handshake around a pipelined operator.

use std::sync::Arc;

use crate::netlist::{Builder, Meaning, Module};
use crate::pipeline::ENABLE;

/// The name that the pipelined core has as an instance in its [`stream_unit`].
pub(crate) const CORE_INSTANCE: &str = "core";

/// Wraps a pipelined core as a stream unit `<core>_unit`: `valid_i`, `ready_o` and the core's
/// inputs on one side, `valid_o`, `ready_i` and its outputs on the other. A transfer happens on a
/// side in a cycle in which its valid and ready are both 1.
///
/// The whole pipe advances together: whenever the result at its end is taken or there is none.
/// A row of valid bits, the only registers with a reset, says which places hold a result. So a
/// stalled unit keeps every value and its order, at one enable and no buffer; its `ready_o`
/// depends on `ready_i` in the same cycle.
///
/// # Panics
/// If the core has latency 0 or no clock enable: wires need no handshake.
pub fn stream_unit(core: &Arc<Module>) -> Arc<Module> {
    assert!(
        core.latency > 0 && core.input(ENABLE).is_some(),
        "{}: a stream unit needs a pipelined core with the input {ENABLE}",
        core.name
    );
    let mut builder = Builder::new(format!("{}_unit", core.name));
    builder.describe(format!("{} behind valid/ready handshakes", core.name));
    builder.describe("stalls as a whole: it advances when its last result is taken or it has none");
    for line in &core.description {
        builder.describe(line);
    }
    builder.set_latency(core.latency);
    let depth = builder.localparam(
        "DEPTH",
        core.latency.into(),
        "places of the pipeline, each with a valid bit",
    );
    let depth = u32::try_from(depth).expect("a latency");

    let valid_i = builder.input("valid_i", 1);
    let mut inputs = Vec::new();
    for &input in &core.inputs {
        let node = core.node(input);
        let name = node.name.as_deref().expect("an input has a name");
        if name == ENABLE {
            inputs.push(None);
        } else {
            let wire = builder.input(name, node.width);
            inputs.push(Some(builder.mean(wire, node.meaning)));
        }
    }
    let ready_i = builder.input("ready_i", 1);

    builder.section("flow control");
    // Advances where its own last place lets it: the enable is connected behind the register.
    let valid = builder.register(depth, None, Some(0));
    builder.name(valid, "valid_places");
    let last_is_valid = builder.bit(valid, depth - 1);
    builder.name(last_is_valid, "last_is_valid");
    let last_is_empty = builder.not(last_is_valid);
    let advance = builder.or(ready_i, last_is_empty);
    builder.name(advance, "advance");
    let moved = if depth > 1 {
        let kept = builder.slice(valid, depth - 2, 0);
        builder.concat(&[kept, valid_i])
    } else {
        valid_i
    };
    let next = builder.mux(advance, moved, valid);
    builder.connect(valid, next);

    builder.section("core");
    let inputs: Vec<_> = inputs
        .into_iter()
        .map(|input| input.unwrap_or(advance))
        .collect();
    let results = builder.instance(CORE_INSTANCE, core, &inputs);
    builder.output("ready_o", advance);
    builder.output("valid_o", last_is_valid);
    for (&result, (name, wire)) in results.iter().zip(&core.outputs) {
        let base = name.strip_suffix("_o").unwrap_or(name);
        builder.name(result, format!("core_{base}"));
        let meaning: Meaning = core.node(*wire).meaning;
        builder.mean(result, meaning);
        builder.output(name, result);
    }
    builder.finish()
}
