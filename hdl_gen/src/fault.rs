//! Planted faults: a design with one bit of one signal inverted, to see that a check sees it. A
//! comparison that never failed on purpose has proven nothing.

use std::sync::Arc;

use crate::nearest::{did_you_mean, nearest_names};
use crate::netlist::{Meaning, Module, Node, Operation, Wire};

/// Why a fault was not planted.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum FaultError {
    /// No signal has this path.
    #[error(
        "design {top} has no signal `{path}`{}; \
         a path is SIGNAL, INSTANCE.SIGNAL or MODULE.SIGNAL",
        did_you_mean(near)
    )]
    NoSuchSignal {
        /// The top module.
        top: String,
        /// The path asked for.
        path: String,
        /// Paths like it.
        near: Vec<String>,
    },
    /// The signal is narrower than that.
    #[error("signal `{path}` has bits 0 to {}, not bit {bit}", width - 1)]
    NoSuchBit {
        /// The path asked for.
        path: String,
        /// The bit asked for.
        bit: u32,
        /// Bits of the signal.
        width: u32,
    },
}

/// A copy of the design in which one bit of a signal is inverted for all that read it: an Xor
/// stands between the signal and its users. A register keeps its value and its users see it
/// inverted; a signal that is an output port is inverted there too.
///
/// The path is `signal` of the top, `instance.signal` from the top down, or `module.signal`. A
/// module that is used several times is faulty in all of them, as its one file is; its header
/// says so. The signal itself shows the fault, in waveforms and comparisons too; what it would be
/// without is called `<signal>_sound`. An input port keeps its value and its name.
///
/// # Errors
/// [`FaultError::NoSuchSignal`], which names paths like it, and [`FaultError::NoSuchBit`].
pub fn plant(top: &Arc<Module>, path: &str, bit: u32) -> Result<Arc<Module>, FaultError> {
    let Some((module, target)) = find(top, path) else {
        let known = known_paths(top);
        return Err(FaultError::NoSuchSignal {
            top: top.name.clone(),
            path: path.to_owned(),
            near: nearest_names(path, known.iter().map(String::as_str)),
        });
    };
    let width = match target {
        Target::Signal(wire) => module.width(wire),
        Target::Output(index) => module.width(module.outputs[index].1),
    };
    if bit >= width {
        let path = path.to_owned();
        return Err(FaultError::NoSuchBit { path, bit, width });
    }
    let faulty = Arc::new(with_fault(&module, target, bit, path));
    Ok(replaced(top, &module.name, &faulty))
}

/// What is inverted.
#[derive(Clone, Copy)]
enum Target {
    /// A node, for all its users.
    Signal(Wire),
    /// An output port whose driver has another name: the port alone.
    Output(usize),
}

fn find_in(module: &Module, name: &str) -> Option<Target> {
    let named = |node: &Node| node.name.as_deref() == Some(name);
    if let Some(index) = module.nodes.iter().position(named) {
        return Some(Target::Signal(Wire(index as u32)));
    }
    let index = module.outputs.iter().position(|(port, _)| port == name)?;
    let driver = module.outputs[index].1;
    Some(match module.node(driver).name {
        // An unnamed driver is the port's own signal.
        None => Target::Signal(driver),
        Some(_) => Target::Output(index),
    })
}

fn find(top: &Arc<Module>, path: &str) -> Option<(Arc<Module>, Target)> {
    let (scope, name) = path.rsplit_once('.').unwrap_or(("", path));
    let mut module = Some(top.clone());
    for instance in scope.split('.').filter(|part| !part.is_empty()) {
        module = module.and_then(|module| {
            let found = module.instances.iter().find(|other| other.name == instance);
            found.map(|found| found.module.clone())
        });
    }
    let by_instance = module.and_then(|module| find_in(&module, name).map(|t| (module, t)));
    by_instance.or_else(|| {
        let modules = top.hierarchy();
        let module = modules.into_iter().find(|module| module.name == scope)?;
        find_in(&module, name).map(|target| (module, target))
    })
}

/// Every path that finds a signal, by instances and by modules.
fn known_paths(top: &Arc<Module>) -> Vec<String> {
    fn by_instance(module: &Module, prefix: &str, paths: &mut Vec<String>) {
        paths.extend(names(module).map(|name| format!("{prefix}{name}")));
        for instance in &module.instances {
            let inside = format!("{prefix}{}.", instance.name);
            by_instance(&instance.module, &inside, paths);
        }
    }
    fn names(module: &Module) -> impl Iterator<Item = &String> {
        let nodes = module.nodes.iter().filter_map(|node| node.name.as_ref());
        nodes.chain(module.outputs.iter().map(|(name, _)| name))
    }
    let mut paths = Vec::new();
    by_instance(top, "", &mut paths);
    for module in top.hierarchy() {
        paths.extend(names(&module).map(|name| format!("{}.{name}", module.name)));
    }
    paths
}

/// The module with the constant and the Xor behind the signal's node, so that operands still
/// stand before those that read them; all later wires move up by two.
fn with_fault(module: &Module, target: Target, bit: u32, path: &str) -> Module {
    let wire = match target {
        Target::Signal(wire) => wire,
        Target::Output(index) => module.outputs[index].1,
    };
    let moved = |other: Wire| {
        if other > wire {
            Wire(other.0 + 2)
        } else {
            other
        }
    };
    let (mask, inverted) = (Wire(wire.0 + 1), Wire(wire.0 + 2));
    let seen = |other: Wire| match target {
        Target::Signal(_) if other == wire => inverted,
        _ => moved(other),
    };
    let original = module.node(wire);
    let mut nodes = Vec::with_capacity(module.nodes.len() + 2);
    for (index, node) in module.nodes.iter().enumerate() {
        nodes.push(Node {
            operation: node.operation.map_operands(seen),
            ..node.clone()
        });
        if index == wire.index() {
            let added = |operation, name, meaning| Node {
                operation,
                width: original.width,
                name,
                section: original.section,
                meaning,
            };
            let takes_name = matches!(target, Target::Signal(_))
                && !matches!(original.operation, Operation::Input);
            let mut name = None;
            if let (true, Some(sound)) = (takes_name, nodes.last_mut()) {
                name = sound.name.take();
                sound.name = name.as_ref().map(|name| format!("{name}_sound"));
            }
            nodes.push(added(Operation::Constant(1 << bit), None, Meaning::Bits));
            nodes.push(added(Operation::Xor(wire, mask), name, original.meaning));
        }
    }
    let mut faulty = module.clone();
    faulty
        .description
        .push(format!("FAULT PLANTED: bit {bit} of `{path}` is inverted."));
    faulty.nodes = nodes;
    faulty
        .inputs
        .iter_mut()
        .for_each(|input| *input = moved(*input));
    for (index, (_, driver)) in faulty.outputs.iter_mut().enumerate() {
        *driver = match target {
            Target::Output(output) if output == index => inverted,
            _ => seen(*driver),
        };
    }
    for write in faulty.memories.iter_mut().flat_map(|m| &mut m.write) {
        *write = write.map_operands(seen);
    }
    for instance in &mut faulty.instances {
        instance
            .inputs
            .iter_mut()
            .for_each(|input| *input = seen(*input));
    }
    faulty
}

/// The hierarchy with one module replaced; what does not use it is shared with the original.
fn replaced(module: &Arc<Module>, name: &str, by: &Arc<Module>) -> Arc<Module> {
    if module.name == name {
        return by.clone();
    }
    let instances: Vec<Arc<Module>> = module
        .instances
        .iter()
        .map(|instance| replaced(&instance.module, name, by))
        .collect();
    let changed = instances
        .iter()
        .zip(&module.instances)
        .any(|(new, old)| !Arc::ptr_eq(new, &old.module));
    if !changed {
        return module.clone();
    }
    let mut copy = Module::clone(module);
    for (instance, new) in copy.instances.iter_mut().zip(instances) {
        instance.module = new;
    }
    Arc::new(copy)
}
