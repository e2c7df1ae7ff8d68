//! The ports and registers of a declaration, built and checked by name.

use std::collections::HashMap;
use std::sync::Arc;

use crate::netlist::{Builder, Meaning, Module, Wire};
use crate::units::Probe;
use rtl_model::machine::{Declared, DeclaredKind};

/// The signals of a unit under construction.
pub(super) struct DeclaredSignals {
    declared: Vec<Declared>,
    wires: HashMap<String, Wire>,
}

impl DeclaredSignals {
    /// Builds the input ports.
    pub(super) fn new(builder: &mut Builder, declared: Vec<Declared>) -> DeclaredSignals {
        let inputs = declared
            .iter()
            .filter(|one| one.kind == DeclaredKind::Input);
        let wires = inputs
            .map(|one| (one.name.clone(), builder.input(&one.name, one.width)))
            .collect();
        DeclaredSignals { declared, wires }
    }

    fn declared(&self, name: &str) -> &Declared {
        let found = self.declared.iter().find(|one| one.name == name);
        found.unwrap_or_else(|| panic!("`{name}` is not declared"))
    }

    /// A signal built so far.
    pub(super) fn get(&self, name: &str) -> Wire {
        *self
            .wires
            .get(name)
            .unwrap_or_else(|| panic!("`{name}` is not built yet"))
    }

    /// A declared register, to be connected later.
    pub(super) fn register(&mut self, builder: &mut Builder, name: &str) -> Wire {
        let one = self.declared(name);
        let DeclaredKind::Register(reset) = one.kind else {
            panic!("`{name}` is declared as no register");
        };
        let register = builder.register(one.width, None, reset);
        builder.name(register, name);
        self.wires.insert(name.to_owned(), register);
        register
    }

    /// Gives a signal its declared name.
    pub(super) fn wire(&mut self, builder: &mut Builder, name: &str, wire: Wire) -> Wire {
        let one = self.declared(name);
        assert!(
            one.kind == DeclaredKind::Wire && one.width == builder.width(wire),
            "`{name}` is declared as {one:?}"
        );
        self.wires.insert(name.to_owned(), wire);
        builder.name(wire, name)
    }

    /// A declared output port.
    pub(super) fn output(&mut self, builder: &mut Builder, name: &str, wire: Wire) {
        let one = self.declared(name);
        assert!(
            one.kind == DeclaredKind::Output && one.width == builder.width(wire),
            "`{name}` is declared as {one:?}"
        );
        self.wires.insert(name.to_owned(), wire);
        builder.output(name, wire);
    }

    /// The module, in which nothing declared is missing and nothing named is undeclared.
    pub(super) fn finish(self, builder: Builder) -> Arc<Module> {
        let module = builder.finish();
        for one in &self.declared {
            assert!(
                self.wires.contains_key(&one.name),
                "{}: `{}` is declared and not built",
                module.name,
                one.name
            );
        }
        for name in module.nodes.iter().filter_map(|node| node.name.as_ref()) {
            assert!(
                self.declared.iter().any(|one| &one.name == name),
                "{}: `{name}` is built and not declared",
                module.name
            );
        }
        module
    }
}

/// Probes for all declared signals that are no inputs, of an instance at `scope` (the top module
/// first), whose words in a cycle stand from `first_word` on, as
/// [`rtl_model::machine::ClockedUnit::observe`] appends them.
pub fn declared_probes(declared: &[Declared], scope: &[&str], first_word: usize) -> Vec<Probe> {
    let observed = declared
        .iter()
        .filter(|one| one.kind != DeclaredKind::Input);
    let probe = |(place, one): (usize, &Declared)| Probe {
        scope: scope.iter().map(|&part| part.to_owned()).collect(),
        name: one.name.clone(),
        width: one.width,
        meaning: Meaning::Bits,
        word: first_word + place,
        delay: 0,
        sources: Vec::new(),
    };
    observed.enumerate().map(probe).collect()
}

/// The sum of a word and one bit.
pub(super) fn plus_bit(builder: &mut Builder, word: Wire, bit: Wire) -> Wire {
    let bit = builder.zero_extend(bit, builder.width(word));
    builder.add(word, bit)
}

/// One more, modulo 2^width.
pub(super) fn next_number(builder: &mut Builder, word: Wire) -> Wire {
    let one = builder.constant(1, builder.width(word));
    builder.add(word, one)
}

/// A count that one bit lets grow and another shrink, by one.
pub(super) fn up_and_down(builder: &mut Builder, count: Wire, up: Wire, down: Wire) {
    let width = builder.width(count);
    let step = builder.sign_extend(down, width);
    let one = builder.constant(1, width);
    let step = builder.or(step, one);
    let stepped = builder.add(count, step);
    let changes = builder.xor(up, down);
    builder.connect_enabled(count, stepped, changes);
}
