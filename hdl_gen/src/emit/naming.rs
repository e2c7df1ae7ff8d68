//! Names for the signals that were given none.

use std::collections::HashSet;

use crate::identifier::is_identifier;
use crate::netlist::{Module, Operation, Wire};

/// Names made of others stay below this length; a number is easier to follow than a sentence.
const LONGEST: usize = 36;

/// The names a module uses already.
pub(super) fn taken_names(module: &Module) -> HashSet<String> {
    let nodes = module.nodes.iter().filter_map(|node| node.name.as_ref());
    let outputs = module.outputs.iter().map(|(name, _)| name);
    let instances = module.instances.iter().map(|instance| &instance.name);
    let constants = module.localparams.iter().map(|constant| &constant.name);
    let memories = module.memories.iter().map(|memory| &memory.name);
    let mut taken: HashSet<String> = nodes
        .chain(outputs)
        .chain(instances)
        .chain(constants)
        .chain(memories)
        .cloned()
        .collect();
    taken.extend(["clk_i".to_owned(), "rst_ni".to_owned(), module.name.clone()]);
    taken
}

/// The wanted name, or the first of `name_2`, `name_3` that nothing has; then it is taken.
pub(super) fn unique(taken: &mut HashSet<String>, wanted: String) -> String {
    let mut name = wanted.clone();
    let mut number = 2;
    while taken.contains(&name) || !is_identifier(&name) {
        name = format!("{wanted}_{number}");
        number += 1;
    }
    taken.insert(name.clone());
    name
}

/// The name without the mark of a port.
pub(super) fn without_suffix(name: &str) -> &str {
    name.strip_suffix("_i")
        .or_else(|| name.strip_suffix("_o"))
        .unwrap_or(name)
}

/// The name of what a register takes.
pub(super) fn next_of(register: &str) -> String {
    let name = without_suffix(register);
    format!("{}_next", name.strip_suffix("_q").unwrap_or(name))
}

/// A name for an unnamed node from its operation and the short names of its operands; where these
/// have none, from the name of what reads it in the end; else from its operation and number.
/// `reader` is that name, and whether it is a slice of this very node.
pub(super) fn derived_name(
    module: &Module,
    wire: Wire,
    reader: Option<(&str, bool)>,
    short: impl Fn(Wire) -> Option<String>,
) -> String {
    if let Some((name, true)) = reader {
        return format!("{}_wide", without_suffix(name));
    }
    let reader = reader.map(|(name, _)| name).map(without_suffix);
    let reader = reader.map(|name| name.strip_suffix("_q").unwrap_or(name));
    let node = module.node(wire);
    from_operands(module, &node.operation, short)
        .filter(|name| name.len() <= LONGEST && is_identifier(name))
        .or_else(|| reader.map(|name| format!("{name}_{}", noun(&node.operation))))
        .unwrap_or_else(|| format!("{}_n{}", noun(&node.operation), wire.index()))
}

fn from_operands(
    module: &Module,
    operation: &Operation,
    short: impl Fn(Wire) -> Option<String>,
) -> Option<String> {
    let two =
        |a: &Wire, word: &str, b: &Wire| Some(format!("{}_{word}_{}", short(*a)?, short(*b)?));
    let one = |a: &Wire, word: &str| Some(format!("{}_{word}", short(*a)?));
    match operation {
        Operation::Not(a) => Some(format!("not_{}", short(*a)?)),
        Operation::And(a, b) => two(a, "and", b),
        Operation::Or(a, b) => two(a, "or", b),
        Operation::Xor(a, b) => two(a, "xor", b),
        Operation::Add(a, b) => two(a, "plus", b),
        Operation::Subtract(a, b) => two(a, "minus", b),
        Operation::Multiply(a, b) | Operation::MultiplySigned(a, b) => two(a, "times", b),
        Operation::Equal(a, b) => two(a, "equals", b),
        Operation::LessThan(a, b) => two(a, "below", b),
        Operation::ShiftLeft(a, _) => one(a, "shifted_left"),
        Operation::ShiftRight(a, _) => one(a, "shifted_right"),
        Operation::Mux { select, .. } => Some(format!("chosen_by_{}", short(*select)?)),
        Operation::Concat(parts) => match parts[..] {
            [zeros, ref a] if module.node(zeros).operation == Operation::Constant(0) => {
                one(a, "extended")
            }
            [ref a, ref b] => two(a, "and_then", b),
            _ => None,
        },
        Operation::SignExtend(a) => one(a, "extended"),
        Operation::AnyBit(a) => one(a, "any"),
        Operation::AllBits(a) => one(a, "all"),
        Operation::Register { next, .. } => next.and_then(short).map(|name| registered(&name)),
        Operation::MemoryRead { memory, .. } => {
            Some(format!("{}_word", module.memory(*memory).name))
        }
        Operation::InstanceOutput { instance, output } => {
            let instance = &module.instances[*instance];
            let port = without_suffix(&instance.module.outputs[*output].0);
            Some(format!("{}_{port}", instance.name))
        }
        Operation::Input | Operation::Constant(_) | Operation::Slice { .. } => None,
    }
}

/// `x` becomes `x_q`, `x_q` becomes `x_q2`, `x_q2` becomes `x_q3`: cycles behind x.
fn registered(name: &str) -> String {
    match name.rsplit_once("_q") {
        Some((base, "")) => format!("{base}_q2"),
        Some((base, count)) => match count.parse::<u32>() {
            Ok(count) => format!("{base}_q{}", count.saturating_add(1)),
            Err(_) => format!("{name}_q"),
        },
        None => format!("{name}_q"),
    }
}

/// What a node is, in a word.
fn noun(operation: &Operation) -> &'static str {
    match operation {
        Operation::Input => "input",
        Operation::Constant(_) => "constant",
        Operation::Not(_) => "inverse",
        Operation::And(..) => "and",
        Operation::Or(..) => "or",
        Operation::Xor(..) => "xor",
        Operation::Add(..) => "sum",
        Operation::Subtract(..) => "difference",
        Operation::Multiply(..) | Operation::MultiplySigned(..) => "product",
        Operation::ShiftLeft(..) | Operation::ShiftRight(..) => "shifted",
        Operation::Equal(..) => "equal",
        Operation::LessThan(..) => "below",
        Operation::Mux { .. } => "chosen",
        Operation::Concat(_) => "joined",
        Operation::Slice { .. } => "bits",
        Operation::SignExtend(_) => "extended",
        Operation::AnyBit(_) => "any",
        Operation::AllBits(_) => "all",
        Operation::Register { .. } => "q",
        Operation::MemoryRead { .. } => "word",
        Operation::InstanceOutput { .. } => "output",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_count_their_cycles() {
        assert_eq!(registered("sum"), "sum_q");
        assert_eq!(registered("sum_q"), "sum_q2");
        assert_eq!(registered("sum_q9"), "sum_q10");
        assert_eq!(registered("is_quiet"), "is_quiet_q");
    }

    #[test]
    fn taken_names_get_a_number() {
        let mut taken = HashSet::from(["a".to_owned(), "a_2".to_owned()]);
        assert_eq!(unique(&mut taken, "a".to_owned()), "a_3");
        assert_eq!(unique(&mut taken, "a".to_owned()), "a_4");
        assert_eq!(unique(&mut taken, "reg".to_owned()), "reg_2");
    }
}
