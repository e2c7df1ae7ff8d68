//! The tools that read Verilog, where they are installed.
#![allow(dead_code)] // every test program uses its own part of it

use std::process::Command;
use std::sync::Arc;

use hdl_gen::emit::write_design;
use hdl_gen::netlist::Module;
use hdl_gen::verify::Verilator;

/// Is the tool there? A missing one is told and the test passes over it, but not where CI=true.
pub fn has_tool(tool: &str) -> bool {
    let found = Command::new(tool).arg("-V").output().is_ok();
    let strict = std::env::var("CI").is_ok_and(|value| value == "true");
    assert!(
        found || !strict,
        "{tool} is not installed, and CI must have it"
    );
    if !found {
        println!("{tool} is not installed: this check is left out");
    }
    found
}

/// Verilator as a simulator, under the same rule as [`has_tool`].
pub fn verilator() -> Option<Verilator> {
    match Verilator::find() {
        Ok(verilator) => Some(verilator),
        Err(missing) => {
            let strict = std::env::var("CI").is_ok_and(|value| value == "true");
            assert!(!strict, "{missing}");
            println!("{missing}: this check is left out");
            None
        }
    }
}

/// Runs a tool and answers its standard output; anything else than plain success is a failure.
pub fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let (out, err) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(output.status.success(), "{command:?}\n{out}\n{err}");
    out.into_owned()
}

/// What Verilator's lint, all warnings on, has to say of a design; nothing is best.
pub fn lint(design: &Arc<Module>, waivers: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let paths = write_design(design, folder.path()).unwrap();
    let output = Command::new("verilator")
        .args(["--lint-only", "-Wall", "--top-module", &design.name])
        .args(waivers)
        .args(&paths)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.success() || !said.is_empty(),
        "verilator failed without a word"
    );
    said
}
