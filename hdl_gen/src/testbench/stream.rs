//! The testbench of a unit behind handshakes.

use std::fmt::Write;

use super::filled_in;
use crate::netlist::Module;
use crate::vectors::{Role, VectorSet};

const TEXT: &str = include_str!("../../../testbenches/verilog/testbench_stream.v.in");

/// The file `testbench_<unit>.v`: the testbench of a unit with the handshakes of
/// [`crate::operators::stream_unit`], for vectors whose fields are named as its ports. `file` is
/// where it looks for them, unless told otherwise.
///
/// # Panics
/// If the unit has no handshakes, or a field is no port of it.
pub fn stream_testbench(unit: &Module, set: &VectorSet, file: &str) -> String {
    let result_bits = set.width_of(Role::Output);
    let mut connections = Vec::new();
    let mut differences = String::new();
    let mut operands = String::new();
    let mut operand_ports = String::new();
    for (field, low) in set.fields.iter().zip(set.low_bits()) {
        let name = &field.name;
        let port = match field.role {
            Role::Output => unit.output(name),
            Role::Input | Role::Memory => unit.input(name),
        };
        let port = port.unwrap_or_else(|| panic!("{}: no port {name}", unit.name));
        assert_eq!(unit.width(port), field.width, "{}: {name}", unit.name);
        if field.role == Role::Output {
            let bits = bits(low, field.width);
            connections.push(format!("        .{name} (results{bits}),"));
            let _ = write!(
                differences,
                "            if (results{bits} !== expected{bits})\n                \
                 $display(\"vector %0d: {name} expected %h found %h\",\n                         \
                 received, expected{bits}, results{bits});\n"
            );
        } else {
            let bits_of_operand = bits(low - result_bits, field.width);
            connections.push(format!("        .{name} (operands{bits_of_operand}),"));
            let _ = write!(operands, " {name} %h");
            let _ = write!(
                operand_ports,
                ",\n                     expected{}",
                bits(low, field.width)
            );
        }
    }
    let _ = write!(
        differences,
        "            $display(\"    operands{operands}\"{operand_ports});"
    );
    filled_in(
        TEXT,
        &[
            ("UNIT", &unit.name),
            ("FILE", file),
            ("VERSION", env!("CARGO_PKG_VERSION")),
            ("VECTORS", &set.vectors.len().to_string()),
            ("LATENCY", &unit.latency.to_string()),
            ("OPERAND_BITS", &(set.width() - result_bits).to_string()),
            ("RESULT_BITS", &result_bits.to_string()),
            ("CONNECTIONS", &connections.join("\n")),
            ("DIFFERENCES", &differences),
        ],
    )
}

/// A selection of bits.
fn bits(low: u32, width: u32) -> String {
    match width {
        1 => format!("[{low}]"),
        _ => format!("[{}:{low}]", low + width - 1),
    }
}
