//! Cutting combinational logic into clock cycles.
//!
//! [`pipelined`] finds the shortest stage that a number of stages allows (binary search; whether a
//! time suffices is told by placing every operation as early as it can stand), then moves
//! operations over the cuts to save registers. What an operation takes is told in one place,
//! [`delay`]. Wiring (slices, joins, constants) stands in no stage: it is rebuilt where it is
//! used, so a register holds exactly the bits that are read behind it and never a constant.

mod delay;
mod registers;
mod schedule;

use std::sync::Arc;

pub use delay::{Delay, LEVEL, delay, longest_path};

use crate::netlist::{Module, Operation, Wire};
use registers::Rebuild;
use schedule::Dataflow;

/// The name of the clock enable that a pipelined module has.
pub const ENABLE: &str = "enable_i";

/// Cuts a combinational module into `latency` clock cycles: `latency - 1` cuts inside and a
/// register at every output lie on every path from an input to an output; inputs are not
/// registered. The input `enable_i`, the first, is the clock enable: while it is 0 every register
/// holds. Data registers have no reset.
///
/// A value `x` that is read in a later stage s than the one it is computed in is there called
/// `x_s<s>`, the stages counted from 1; the register of the output `y_o` is `y_registered`. The
/// sections keep their titles behind `stage <s>: `; one that is cut appears in both stages.
///
/// Latency 0 gives the module unchanged but for its name.
///
/// # Panics
/// If the module has registers or instances of other modules, or an input named `enable_i`.
pub fn pipelined(combinational: &Arc<Module>, latency: u32, name: &str) -> Arc<Module> {
    let module = combinational.as_ref();
    assert!(
        !module.is_clocked() && module.instances.is_empty(),
        "{}: only combinational modules without instances can be cut",
        module.name
    );
    if latency == 0 {
        if module.name == name {
            return combinational.clone();
        }
        return Arc::new(Module {
            name: name.to_owned(),
            ..module.clone()
        });
    }
    assert!(
        module.input(ENABLE).is_none(),
        "{}: the input {ENABLE} is added by the pipeline",
        module.name
    );
    let module = without_unused(combinational);
    let dataflow = Dataflow::new(&module);
    let period = dataflow.shortest_period(latency);
    let stages = dataflow.schedule(period, latency);
    let mut rebuild = Rebuild::new(&module, name, &dataflow, &stages, latency);
    rebuild.describe(format!(
        "longest stage: {:.1} levels of logic as estimated, of {:.1} in all",
        f64::from(period) / f64::from(LEVEL),
        f64::from(longest_path(&module)) / f64::from(LEVEL)
    ));
    rebuild.finish()
}

/// The module without the operations that no output depends on; ports stay.
pub fn without_unused(module: &Arc<Module>) -> Arc<Module> {
    assert!(
        !module.is_clocked() && module.instances.is_empty(),
        "{}: only combinational modules without instances",
        module.name
    );
    let mut used: Vec<bool> = module
        .nodes
        .iter()
        .map(|node| node.operation == Operation::Input)
        .collect();
    for (_, wire) in &module.outputs {
        used[wire.index()] = true;
    }
    for index in (0..used.len()).rev() {
        if used[index] {
            for operand in module.nodes[index].operation.operands() {
                used[operand.index()] = true;
            }
        }
    }
    let mut place = vec![Wire(0); used.len()];
    let mut nodes = Vec::new();
    for (index, node) in module
        .nodes
        .iter()
        .enumerate()
        .filter(|&(index, _)| used[index])
    {
        place[index] = Wire(u32::try_from(nodes.len()).expect("fewer than before"));
        let mut node = node.clone();
        node.operation = node.operation.map_operands(|wire| place[wire.index()]);
        nodes.push(node);
    }
    Arc::new(Module {
        nodes,
        inputs: module
            .inputs
            .iter()
            .map(|wire| place[wire.index()])
            .collect(),
        outputs: module
            .outputs
            .iter()
            .map(|(name, wire)| (name.clone(), place[wire.index()]))
            .collect(),
        ..module.as_ref().clone()
    })
}
