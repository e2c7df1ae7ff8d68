//! The emitted Verilog as other people's tools read it: Verilator's lint with all warnings on and
//! none waived, Icarus Verilog, Yosys. None of them may have anything to say.
//!
//! Read are the traverse unit for maps of 2 x 2, 256 x 256 and 4096 x 4096 texels with heights of
//! 8 and of 16 bits, and every operator of e7f16 behind its handshakes, in every rounding.

#[path = "common/operators.rs"]
mod operators;
#[path = "common/tools.rs"]
mod tools;

use std::process::Command;
use std::sync::Arc;

use hdl_gen::datapath::OperatorLatencies;
use hdl_gen::emit::{verilog, write_design};
use hdl_gen::netlist::Module;
use hdl_gen::operators::{OperatorConfiguration, stream_unit};
use hdl_gen::units::{TraverseUnit, UnitConfiguration};
use rayon::prelude::*;
use rtl_model::float::FloatFormat;
use rtl_model::units::traverse_step::TraverseShape;

const FORMAT: FloatFormat = FloatFormat::E7F16;

/// Every design that is read, with what tells it from the others of its name.
fn designs() -> Vec<(String, Arc<Module>)> {
    let mut designs = Vec::new();
    for root_level in [1, 8, 12] {
        for height_bits in [8, 16] {
            let unit = TraverseUnit::build(UnitConfiguration::oh(
                TraverseShape {
                    root_level,
                    height_bits,
                },
                FORMAT,
            ));
            let size = 1 << root_level;
            let label = format!("traverse, {size} x {size}, {height_bits} bits");
            designs.push((label, unit.design));
        }
    }
    for (operator, rounding) in operators::every_operator(FORMAT) {
        let latency = OperatorLatencies::PAPER.of_operator(operator);
        let unit =
            stream_unit(&OperatorConfiguration::new(operator, FORMAT, rounding).build(latency));
        designs.push((unit.name.clone(), unit));
    }
    designs
}

/// The lines without their comments.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .map(|line| line.split("//").next().unwrap_or_default())
}

/// Is the word among those of the line?
fn says(line: &str, word: &str) -> bool {
    line.split(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_')
        .any(|found| found == word)
}

#[test]
fn no_file_waives_a_warning_or_sets_a_value_before_time() {
    let mut clocked = 0;
    for (label, design) in designs() {
        for module in design.hierarchy() {
            let name = &module.name;
            let text = verilog(&module, "0");
            for waiver in ["lint_off", "verilator", "translate_off", "full_case"] {
                assert!(!text.contains(waiver), "{label}, {name}: {waiver}");
            }
            for line in code(&text) {
                assert!(!says(line, "initial"), "{label}, {name}: {line}");
                // The only processes are registers: what has no clock can be no latch.
                if says(line, "always") {
                    clocked += 1;
                    assert_eq!(
                        line.trim(),
                        "always @(posedge clk_i) begin",
                        "{label}, {name}"
                    );
                }
            }
        }
    }
    assert!(clocked > 0, "a unit without a register is no unit");
}

/// What Verilator's lint says, all warnings on.
fn lint(top: &str, paths: &[String]) -> String {
    let mut command = Command::new("verilator");
    command.args(["--lint-only", "-Wall", "--top-module", top]);
    said(command.args(paths))
}

/// What Icarus Verilog says when it elaborates, all warnings on.
fn icarus(top: &str, paths: &[String]) -> String {
    let mut command = Command::new("iverilog");
    command.args(["-g2005", "-Wall", "-t", "null", "-s", top]);
    said(command.args(paths))
}

/// What Yosys says when it makes registers and logic of the text: any warning is an error, and so
/// are a latch and a design without a flip-flop.
fn yosys(top: &str, paths: &[String]) -> String {
    let script = format!(
        "read_verilog {}; hierarchy -check -top {top}; proc; check -assert; \
         select -assert-none t:$dlatch*; select -assert-min 1 t:$dff t:$dffe t:$sdff t:$sdffe",
        paths.join(" "),
    );
    said(Command::new("yosys").args(["-q", "-e", ".*", "-p", &script]))
}

/// All that a tool prints, and how it ended if it failed.
fn said(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let mut said = String::from_utf8_lossy(&output.stdout).into_owned();
    said.push_str(&String::from_utf8_lossy(&output.stderr));
    if !output.status.success() {
        said.push_str(&output.status.to_string());
    }
    said
}

/// The tool must say nothing of any design; but of `source`, a faulty one, something with
/// `objection` in it: else its silence would mean nothing.
fn expect_silence(
    tool: &str,
    read: impl Fn(&str, &[String]) -> String + Sync,
    source: &str,
    objection: &str,
) {
    if !tools::has_tool(tool) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("faulty.v");
    std::fs::write(&path, source).unwrap();
    let found = read("faulty", &[path.display().to_string()]);
    assert!(found.contains(objection), "{tool} of a fault: {found}");

    designs().par_iter().for_each(|(label, design)| {
        let folder = tempfile::tempdir().unwrap();
        let paths = write_design(design, folder.path()).unwrap();
        let paths: Vec<String> = paths
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        assert_eq!(read(&design.name, &paths), "", "{tool} of {label}");
    });
}

/// A latch beside a flip-flop.
const LATCH: &str = "\
module faulty (input wire clk_i, input wire open_i, input wire d_i, output reg q_o, output reg r_o);
    always @* if (open_i) q_o = d_i;
    always @(posedge clk_i) r_o <= d_i;
endmodule
";

/// A port that is connected to a word of another width.
const WRONG_WIDTH: &str = "\
module part (input wire [3:0] d_i, output wire [3:0] q_o);
    assign q_o = d_i;
endmodule
module faulty (input wire [7:0] d_i, output wire [3:0] q_o);
    part inner (.d_i(d_i), .q_o(q_o));
endmodule
";

#[test]
fn verilators_lint_has_nothing_to_say() {
    expect_silence("verilator", lint, LATCH, "LATCH");
}

#[test]
fn icarus_has_nothing_to_say() {
    expect_silence("iverilog", icarus, WRONG_WIDTH, "Port 1 (d_i) of part");
}

#[test]
fn yosys_finds_no_latch_and_nothing_to_warn_of() {
    expect_silence("yosys", yosys, LATCH, "latch");
}
