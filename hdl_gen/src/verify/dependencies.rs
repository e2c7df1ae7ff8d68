//! What each signal of a waveform is computed from, read off the netlist.

use crate::netlist::{Instance, Module, Operation, Wire};
use crate::pipeline::ENABLE;
use crate::units::TraverseUnit;
use crate::wave::{Dependency, EarlierSignal, SignalDeclaration};
use std::collections::{BTreeSet, HashSet};

/// For every declared signal of the unit the declared signals it is computed from, and of how many
/// cycles before: back through logic, operators and registers to the nearest ones. With it a
/// comparison of waveforms tells the signal that went wrong from those that followed it.
pub(super) fn traverse_dependencies(
    unit: &TraverseUnit,
    declarations: &[SignalDeclaration],
) -> Vec<Dependency> {
    let top = unit.design.as_ref();
    let is_step = |(_, instance): &(usize, &Instance)| instance.name == "step";
    let Some((place, step)) = top.instances.iter().enumerate().find(is_step) else {
        return Vec::new();
    };
    let tracer = Tracer {
        top,
        step: &step.module,
        step_inputs: &step.inputs,
        step_place: place,
        declared: declarations
            .iter()
            .map(SignalDeclaration::full_name)
            .collect(),
        deepest: unit.latency + 1,
    };
    declarations
        .iter()
        .filter_map(|declaration| tracer.dependency(declaration))
        .collect()
}

/// One of the two modules that have declared signals.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Scope {
    Top,
    Step,
}

struct Tracer<'a> {
    top: &'a Module,
    step: &'a Module,
    /// What the step's instance is given, in the order of its inputs.
    step_inputs: &'a [Wire],
    step_place: usize,
    /// Full names.
    declared: HashSet<String>,
    /// Registers in a row, at most.
    deepest: u32,
}

#[derive(Default)]
struct Found {
    sources: BTreeSet<(String, u32)>,
    seen: HashSet<(Scope, Wire, u32)>,
}

impl Tracer<'_> {
    fn module(&self, scope: Scope) -> &Module {
        match scope {
            Scope::Top => self.top,
            Scope::Step => self.step,
        }
    }

    fn full_name(&self, scope: Scope, name: &str) -> String {
        match scope {
            Scope::Top => format!("{}.{name}", self.top.name),
            Scope::Step => format!("{}.step.{name}", self.top.name),
        }
    }

    fn dependency(&self, declaration: &SignalDeclaration) -> Option<Dependency> {
        let scope = match declaration.path.len() {
            1 => Scope::Top,
            _ => Scope::Step,
        };
        let module = self.module(scope);
        let mut found = Found::default();
        let is_named =
            |node: &crate::netlist::Node| node.name.as_deref() == Some(declaration.name.as_str());
        if let Some(index) = module.nodes.iter().position(is_named) {
            let wire = Wire(u32::try_from(index).ok()?);
            self.operands(scope, wire, 0, &mut found);
        } else {
            let driver = module.output(&declaration.name)?;
            self.sources(scope, driver, 0, &mut found);
        }
        if found.sources.is_empty() {
            return None;
        }
        let earlier = |(signal, cycles_back)| EarlierSignal {
            signal,
            cycles_back,
        };
        Some(Dependency {
            signal: declaration.full_name(),
            inputs: found.sources.into_iter().map(earlier).collect(),
        })
    }

    /// Notes the wire's signal if it is declared, else what it is computed from.
    fn sources(&self, scope: Scope, wire: Wire, back: u32, found: &mut Found) {
        if back > self.deepest || !found.seen.insert((scope, wire, back)) {
            return;
        }
        if let Some(name) = &self.module(scope).node(wire).name {
            let full_name = self.full_name(scope, name);
            if self.declared.contains(&full_name) {
                found.sources.insert((full_name, back));
                return;
            }
        }
        self.operands(scope, wire, back, found);
    }

    /// Notes what the wire's operation reads.
    fn operands(&self, scope: Scope, wire: Wire, back: u32, found: &mut Found) {
        let module = self.module(scope);
        match &module.node(wire).operation {
            Operation::Input if scope == Scope::Step => {
                let port = module.inputs.iter().position(|&input| input == wire);
                if let Some(&outside) = port.and_then(|port| self.step_inputs.get(port)) {
                    self.sources(Scope::Top, outside, back, found);
                }
            }
            Operation::InstanceOutput { instance, output } => {
                if scope == Scope::Top && *instance == self.step_place {
                    let inside = self.step.outputs[*output].1;
                    self.sources(Scope::Step, inside, back, found);
                    return;
                }
                let instance = &module.instances[*instance];
                let inner = &instance.module;
                for (&outside, &port) in instance.inputs.iter().zip(&inner.inputs) {
                    if inner.node(port).name.as_deref() != Some(ENABLE) {
                        self.sources(scope, outside, back + inner.latency, found);
                    }
                }
            }
            Operation::Register { next, enable, .. } => {
                for &operand in next.iter().chain(enable) {
                    self.sources(scope, operand, back + 1, found);
                }
            }
            operation => {
                for operand in operation.operands() {
                    self.sources(scope, operand, back, found);
                }
            }
        }
    }
}
