//! The testbench of a whole machine, with a memory behind its AXI4 read port.

use std::fmt::Write as _;

use rtl_model::machine::StallPattern;

use super::filled_in;
use crate::netlist::Module;
use crate::vectors::{MachineSurroundings, MachineVectors, VectorSet};
use crate::verify::ClockedRun;

const TEXT: &str = include_str!("../../../testbenches/verilog/testbench_machine.v.in");

/// Bytes of a beat of the memory.
const BEAT_BYTES: u32 = 8;

/// The file `testbench_NAME.v` of a machine, for these vectors of its golden run.
pub fn machine_testbench(
    run: &ClockedRun<'_>,
    surroundings: &MachineSurroundings,
    vectors: &MachineVectors,
) -> String {
    let unit: &Module = run.unit;
    let seed = |pattern: &StallPattern| format!("{:04x}", pattern.state().unwrap_or(0));
    let memory = &surroundings.memory;
    let [addresses, beats] = memory.stall_patterns();
    let width = |port: &str| {
        let wire = unit.input(port).or(unit.output(port));
        let wire = wire.unwrap_or_else(|| panic!("{port}: a port of every machine"));
        unit.width(wire).to_string()
    };
    let cycles = vectors.last_hit + 1;
    // The longest run that a 32-bit integer of Verilog counts.
    let integer = |cycles: u64| cycles.min(i32::MAX as u64).to_string();
    let counters = counters(unit);
    let fields = |set: &VectorSet, before: &str| {
        let names = set
            .fields
            .iter()
            .map(|field| format!("{before}_{}", field.name));
        names.collect::<Vec<_>>()
    };
    let (ray_fields, hit_fields) = (fields(&vectors.rays, "ray"), fields(&vectors.hits, "hit"));
    let expected_fields = fields(&vectors.hits, "expected");
    let mut ports = String::new();
    for name in &ray_fields {
        let _ = writeln!(ports, "        .{name}_i ({name}),");
    }
    for name in hit_fields
        .iter()
        .chain(counters.iter().map(|(name, _)| name))
    {
        let _ = writeln!(ports, "        .{name}_o ({name}),");
    }
    let mut differences = String::new();
    for ((field, found), expected) in vectors
        .hits
        .fields
        .iter()
        .zip(&hit_fields)
        .zip(&expected_fields)
    {
        let _ = writeln!(
            differences,
            "            if ({found} !== {expected})\n                $display(\"vector %0d: {} expected \
             %h found %h\", hit_id, {expected}, {found});",
            field.name
        );
    }
    let mut said = String::new();
    for (name, _) in &counters {
        let _ = writeln!(said, "            $display(\"{name} %0d\", {name});");
    }
    let declared = |kind: &str, names: &[String], set: &VectorSet| {
        let widths = set.fields.iter().map(|field| field.width);
        declarations(kind, names.iter().map(String::as_str).zip(widths))
    };
    let counted = counters.iter().map(|(name, width)| (name.as_str(), *width));
    filled_in(
        TEXT,
        &[
            ("TOP", &unit.name),
            ("VERSION", env!("CARGO_PKG_VERSION")),
            ("VECTORS", &vectors.rays.vectors.len().to_string()),
            ("CYCLES", &integer(cycles)),
            ("WATCHDOG", &integer(4 * cycles + 4096)),
            ("RAY_SEED", &seed(&surroundings.gaps)),
            ("HIT_SEED", &seed(&surroundings.stalls)),
            ("RECEIVER_STARTS", &integer(surroundings.receiver_starts)),
            ("ADDRESS_SEED", &seed(&addresses)),
            ("BEAT_SEED", &seed(&beats)),
            ("LATENCY", &memory.latency.to_string()),
            (
                "BEAT_CYCLES",
                &(BEAT_BYTES / memory.bytes_per_cycle).to_string(),
            ),
            ("OUTSTANDING", &memory.outstanding.to_string()),
            ("WORDS", &vectors.memory.vectors.len().to_string()),
            ("RESET_CYCLES", &run.reset_cycles.to_string()),
            ("ID_BITS", &width("ray_id_i")),
            ("AXI_ID_BITS", &width("mem_rid_i")),
            ("RAY_BITS", &vectors.rays.width().to_string()),
            ("HIT_BITS", &vectors.hits.width().to_string()),
            (
                "RAY_DECLARATIONS",
                &declared("reg", &ray_fields, &vectors.rays),
            ),
            (
                "HIT_DECLARATIONS",
                &declared("wire", &hit_fields, &vectors.hits),
            ),
            (
                "EXPECTED_DECLARATIONS",
                &declared("reg", &expected_fields, &vectors.hits),
            ),
            ("COUNTER_DECLARATIONS", &declarations("wire", counted)),
            ("FIELD_PORTS", &ports),
            ("RAY_FIELDS", &ray_fields.join(", ")),
            ("HIT_FIELDS", &hit_fields.join(", ")),
            ("EXPECTED_FIELDS", &expected_fields.join(", ")),
            ("DIFFERENCES", &differences),
            ("COUNTERS", &said),
        ],
    )
}

/// What else the machine tells: names without the `_o` of the port, and widths.
fn counters(unit: &Module) -> Vec<(String, u32)> {
    let outputs = unit.outputs.iter().filter(|(name, _)| {
        let known = ["ray_", "hit_", "mem_", "error_o"];
        !known.iter().any(|start| name.starts_with(start))
    });
    let told = outputs.map(|(name, wire)| {
        let name = name.strip_suffix("_o").unwrap_or(name);
        (name.to_owned(), unit.width(*wire))
    });
    told.collect()
}

/// A declaration a line.
fn declarations<'n>(kind: &str, signals: impl Iterator<Item = (&'n str, u32)>) -> String {
    let mut text = String::new();
    for (name, width) in signals {
        let range = match width {
            1 => String::new(),
            _ => format!("[{}:0] ", width - 1),
        };
        let _ = writeln!(text, "    {kind} {range}{name};");
    }
    text
}
