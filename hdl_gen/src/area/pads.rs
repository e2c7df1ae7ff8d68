//! Modules with more ports than a package has pads: what is placed of them.

use std::collections::HashMap;

use serde_json::Value;

/// Signals for which the largest package of an ECP5, CABGA756 with 365 pads, has room; some pads have
/// other duties.
const PADS: usize = 340;

/// The port of the clock, which keeps its pad.
const CLOCK: &str = "clk_i";

/// A mapped netlist that fits the pads, out of one with a layer of registers (of kind `kind`, from
/// `data` to `out`) at every port. None where it fits as it is.
///
/// The registers of the first layer are chained, each taking what the one before it holds, and one pad
/// feeds the first of them; the last layer's drive nothing. So all that is measured stays as it was:
/// no cell comes or goes, and every path between two of the inner layers is still there.
///
/// # Errors
/// What is wrong with the text.
pub(super) fn fitted(
    text: &str,
    top: &str,
    (kind, data, out): (&str, &str, &str),
) -> Result<Option<String>, String> {
    let mut design: Value = serde_json::from_str(text).map_err(|problem| problem.to_string())?;
    let module = &mut design["modules"][top];
    let ports = module["ports"].as_object().ok_or("it has no ports")?;
    let bits_of = |port: &Value| port["bits"].as_array().cloned().unwrap_or_default();
    if ports
        .values()
        .map(|port| bits_of(port).len())
        .sum::<usize>()
        <= PADS
    {
        return Ok(None);
    }
    let entering: Vec<Value> = ports
        .iter()
        .filter(|(name, port)| port["direction"] == "input" && *name != CLOCK)
        .flat_map(|(_, port)| bits_of(port))
        .collect();
    let clock = ports.get(CLOCK).cloned().ok_or("it has no clock")?;

    let cells = module["cells"].as_object_mut().ok_or("it has no cells")?;
    let taking: HashMap<String, String> = cells
        .iter()
        .filter(|(_, cell)| cell["type"] == kind)
        .map(|(name, cell)| (cell["connections"][data][0].to_string(), name.clone()))
        .collect();
    // An input that nothing depends on has no register.
    let layer: Vec<(Value, String)> = entering
        .into_iter()
        .filter_map(|bit| Some((bit.clone(), taking.get(&bit.to_string())?.clone())))
        .collect();
    let Some((first, _)) = layer.first() else {
        return Err("no register takes an input".to_owned());
    };
    let serial = serde_json::json!({"direction": "input", "bits": [first]});
    for pair in layer.windows(2) {
        let held = cells[&pair[0].1]["connections"][out][0].clone();
        cells[&pair[1].1]["connections"][data][0] = held;
    }
    module["ports"] = serde_json::json!({CLOCK: clock, "serial_i": serial});
    Ok(Some(design.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// A module that moves so many bits: a layer before and one behind.
    fn moves(bits: u64) -> String {
        let mut cells = serde_json::Map::new();
        for bit in 0..bits {
            let (taken, held, given) = (10 + bit, 10_000 + bit, 20_000 + bit);
            let register = |d, q| json!({"type": "FF", "connections": {"D": [d], "Q": [q]}});
            cells.insert(format!("before_{bit}"), register(taken, held));
            cells.insert(format!("behind_{bit}"), register(held, given));
        }
        let range = |from: u64| (from..from + bits).collect::<Vec<_>>();
        json!({"modules": {"top": {"cells": cells, "ports": {
            "clk_i": {"direction": "input", "bits": [2]},
            "a_i": {"direction": "input", "bits": range(10)},
            "b_o": {"direction": "output", "bits": range(20_000)},
        }}}})
        .to_string()
    }

    #[test]
    fn what_fits_stays_and_what_does_not_is_chained() {
        let fitted = |bits| fitted(&moves(bits), "top", ("FF", "D", "Q")).unwrap();
        assert_eq!(fitted(100), None);
        let design: Value = serde_json::from_str(&fitted(200).unwrap()).unwrap();
        let module = &design["modules"]["top"];
        assert_eq!(module["ports"]["clk_i"]["bits"], json!([2]));
        assert_eq!(module["ports"]["serial_i"]["bits"], json!([10]));
        assert_eq!(module["ports"].as_object().unwrap().len(), 2);
        let cells = module["cells"].as_object().unwrap();
        assert_eq!(cells.len(), 400);
        let takes = |cell: &str| cells[cell]["connections"]["D"][0].as_u64().unwrap();
        assert_eq!(takes("before_0"), 10);
        for bit in 1..200 {
            assert_eq!(takes(&format!("before_{bit}")), 10_000 + bit - 1);
            assert_eq!(takes(&format!("behind_{bit}")), 10_000 + bit);
        }
    }

    #[test]
    fn what_is_no_netlist_is_refused() {
        for text in ["", "{}", r#"{"modules": {"top": {"ports": {}}}}"#] {
            let ports = ("FF", "D", "Q");
            let answer = fitted(text, "top", ports);
            assert!(answer.is_err() || answer == Ok(None), "{text}");
        }
        let no_registers = moves(200).replace("\"FF\"", "\"LUT\"");
        assert!(fitted(&no_registers, "top", ("FF", "D", "Q")).is_err());
    }
}
