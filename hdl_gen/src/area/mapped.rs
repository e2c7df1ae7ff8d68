//! A netlist that Yosys has mapped to the cells of a target, as its `write_json` gives it.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use serde_json::Value;

use super::wrapper::LAYERS;

/// Cells and ports of one flat module.
#[derive(Clone, Debug)]
pub struct MappedNetlist {
    cells: Vec<Cell>,
    ports: Vec<Port>,
}

#[derive(Clone, Debug, Deserialize)]
struct Design {
    modules: BTreeMap<String, Module>,
}

#[derive(Clone, Debug, Deserialize)]
struct Module {
    ports: BTreeMap<String, Port>,
    cells: BTreeMap<String, Cell>,
}

#[derive(Clone, Debug, Deserialize)]
struct Port {
    direction: String,
    bits: Vec<Value>,
}

#[derive(Clone, Debug, Deserialize)]
struct Cell {
    #[serde(rename = "type")]
    kind: String,
    connections: BTreeMap<String, Vec<Value>>,
}

impl MappedNetlist {
    /// Reads the module `top`.
    ///
    /// # Errors
    /// What is wrong with the text: it is not of this form, or has no such module.
    pub fn read(text: &str, top: &str) -> Result<MappedNetlist, String> {
        let mut design: Design =
            serde_json::from_str(text).map_err(|problem| problem.to_string())?;
        let module = design.modules.remove(top);
        let module = module.ok_or_else(|| format!("there is no module {top}"))?;
        Ok(MappedNetlist {
            cells: module.cells.into_values().collect(),
            ports: module.ports.into_values().collect(),
        })
    }

    /// How many cells there are of each kind.
    pub fn kinds(&self) -> BTreeMap<&str, u64> {
        let mut kinds = BTreeMap::new();
        for cell in &self.cells {
            *kinds.entry(cell.kind.as_str()).or_insert(0) += 1;
        }
        kinds
    }

    /// How many cells there are of these kinds together.
    pub fn count(&self, kinds: &[&str]) -> u64 {
        let of_kind = |cell: &&Cell| kinds.contains(&cell.kind.as_str());
        self.cells.iter().filter(of_kind).count() as u64
    }

    /// Registers that are not of the wrapper's layers: of kind `kind`, which takes its value at
    /// port `data` and gives it at port `out`.
    ///
    /// A layer is known by how it is connected, since names do not last: before the module it
    /// takes what the ports, or the layer before it, give; behind it it gives what the ports, or
    /// the layer behind it, take.
    pub fn registers_within(&self, kind: &str, data: &str, out: &str) -> u64 {
        let registers: Vec<(&Value, &Value)> = self
            .cells
            .iter()
            .filter(|cell| cell.kind == kind)
            .filter_map(|cell| {
                let bit = |port: &str| cell.connections.get(port)?.first();
                Some((bit(data)?, bit(out)?))
            })
            .collect();
        let ports = |direction: &str| -> BTreeSet<String> {
            let ports = self.ports.iter();
            let ports = ports.filter(|port| port.direction == direction);
            ports.flat_map(|port| &port.bits).filter_map(net).collect()
        };
        let mut wrapper = BTreeSet::new();
        let mut given = ports("input");
        let mut taken = ports("output");
        for _ in 0..LAYERS {
            let mut given_next = BTreeSet::new();
            let mut taken_next = BTreeSet::new();
            for (index, (data, out)) in registers.iter().enumerate() {
                if net(data).is_some_and(|net| given.contains(&net)) {
                    wrapper.insert(index);
                    given_next.extend(net(out));
                }
                if net(out).is_some_and(|net| taken.contains(&net)) {
                    wrapper.insert(index);
                    taken_next.extend(net(data));
                }
            }
            (given, taken) = (given_next, taken_next);
        }
        (registers.len() - wrapper.len()) as u64
    }
}

/// The net that a bit is, if it is no constant.
fn net(bit: &Value) -> Option<String> {
    bit.as_u64().map(|net| net.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Registers given as (data, out), nets 1 entering and 9 leaving.
    fn netlist(registers: &[(u64, u64)]) -> MappedNetlist {
        let mut cells = serde_json::Map::new();
        for (index, (data, out)) in registers.iter().enumerate() {
            let connections = json!({"D": [data], "Q": [out], "CE": ["1"]});
            let cell = json!({"type": "FF", "connections": connections});
            cells.insert(format!("r{index}"), cell);
        }
        cells.insert(
            "l".into(),
            json!({"type": "LUT", "connections": {"A": [3], "Z": [4]}}),
        );
        let ports = json!({
            "i": {"direction": "input", "bits": [1]},
            "o": {"direction": "output", "bits": [9, "0"]},
        });
        let text = json!({"modules": {"top": {"ports": ports, "cells": cells}}}).to_string();
        MappedNetlist::read(&text, "top").unwrap()
    }

    #[test]
    fn the_layers_around_are_not_counted() {
        let layers = [(1, 2), (2, 3), (7, 8), (8, 9)];
        let within = |registers: &[(u64, u64)]| netlist(registers).registers_within("FF", "D", "Q");
        assert_eq!(within(&layers), 0);
        assert_eq!(within(&[&layers[..], &[(4, 5)]].concat()), 1);
        // At either end of the module.
        assert_eq!(within(&[&layers[..], &[(3, 5), (6, 7)]].concat()), 2);
        assert_eq!(netlist(&layers).count(&["FF", "LUT"]), 5);
        assert_eq!(netlist(&layers).kinds()["LUT"], 1);
    }

    #[test]
    fn what_is_no_netlist_is_refused() {
        for text in [
            "",
            "{}",
            "[]",
            r#"{"modules": {"top": {}}}"#,
            r#"{"modules": 3}"#,
        ] {
            assert!(MappedNetlist::read(text, "top").is_err(), "{text}");
        }
        let other = r#"{"modules": {"other": {"ports": {}, "cells": {}}}}"#;
        assert!(MappedNetlist::read(other, "top").is_err());
        assert!(MappedNetlist::read(other, "other").is_ok());
    }
}
