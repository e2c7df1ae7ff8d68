//! Random designs: the embedded simulator, Icarus and Verilator agree in every output in every
//! cycle, and the emitted Verilog passes Verilator's lint with all warnings on.

#[path = "common/bench.rs"]
mod bench;
#[path = "common/random.rs"]
mod random;

use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use bench::{embedded, has_tool, run, stimuli, write_bench};
use hdl_gen::emit::write_design;
use hdl_gen::netlist::Module;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, TestRunner};

fn config(cases: u32) -> Config {
    Config {
        cases,
        // Every case starts two tools.
        max_shrink_iters: 200,
        failure_persistence: None,
        ..Config::default()
    }
}

/// What Icarus prints; it must have nothing to complain of.
fn icarus(dir: &Path, designs: &[Arc<Module>], stimuli: &bench::Stimuli) -> Vec<String> {
    write_bench(dir, designs, stimuli, true);
    let files = std::fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let sources = files.filter(|path| path.extension().is_some_and(|end| end == "v"));
    let mut compile = Command::new("iverilog");
    compile.args(["-g2005", "-Wall", "-Wno-timescale", "-o", "bench.vvp"]);
    let compiled = compile.args(sources).current_dir(dir).output().unwrap();
    let complaints = String::from_utf8_lossy(&compiled.stderr);
    assert!(
        compiled.status.success() && complaints.is_empty(),
        "{complaints}"
    );
    let text = run(Command::new("vvp")
        .args(["-n", "bench.vvp"])
        .current_dir(dir));
    text.lines().map(str::to_owned).collect()
}

fn lint(dir: &Path, design: &Arc<Module>) -> Result<(), String> {
    let paths = write_design(design, dir).unwrap();
    let output = Command::new("verilator")
        .args(["--lint-only", "-Wall", "--top-module", &design.name])
        .args(&paths)
        .output()
        .unwrap();
    let complaints = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.success() && complaints.is_empty() {
        Ok(())
    } else {
        let texts = paths
            .iter()
            .map(|path| std::fs::read_to_string(path).unwrap());
        Err(format!("{complaints}\n{}", texts.collect::<String>()))
    }
}

#[test]
fn icarus_agrees_with_the_embedded_simulator() {
    if !has_tool("iverilog") {
        return;
    }
    proptest!(config(40), |(design in random::design("r"), seed: u64)| {
        let folder = tempfile::tempdir().unwrap();
        let designs = [design.0];
        let stimuli = stimuli(&designs, 40, seed);
        let expected = embedded(&designs, &stimuli);
        let answered = icarus(folder.path(), &designs, &stimuli);
        prop_assert_eq!(answered, expected);
    });
}

#[test]
fn lint_finds_nothing() {
    if !has_tool("verilator") {
        return;
    }
    proptest!(config(40), |(design in random::design("r"))| {
        let folder = tempfile::tempdir().unwrap();
        let found = lint(folder.path(), &design.0);
        prop_assert!(found.is_ok(), "{}", found.unwrap_err());
    });
}

/// Many designs in one executable, since it takes seconds to build one.
#[test]
fn verilator_agrees_with_the_embedded_simulator() {
    if !has_tool("verilator") {
        return;
    }
    let prefixes = ["a", "b", "c", "d", "e", "f", "g", "h"];
    let mut runner = TestRunner::deterministic();
    let designs: Vec<Arc<Module>> = prefixes
        .iter()
        .map(|prefix| {
            random::design(prefix)
                .new_tree(&mut runner)
                .unwrap()
                .current()
                .0
        })
        .collect();
    let stimuli = stimuli(&designs, 400, 1);
    let folder = tempfile::tempdir().unwrap();
    write_bench(folder.path(), &designs, &stimuli, false);
    run(Command::new("verilator")
        .args([
            "--binary",
            "-Wno-fatal",
            "-Wno-lint",
            "--x-initial",
            "0",
            "--x-assign",
            "0",
        ])
        .args([
            "-O0",
            "-CFLAGS",
            "-O0",
            "--top-module",
            "testbench",
            "-y",
            ".",
            "testbench.v",
        ])
        .current_dir(folder.path()));
    let program = folder.path().join("obj_dir/Vtestbench");
    let text = run(Command::new(program).current_dir(folder.path()));
    let lines = text.lines().filter(|line| !line.starts_with('-'));
    let answered: Vec<String> = lines.map(str::to_owned).collect();
    let expected = embedded(&designs, &stimuli);
    assert_eq!(answered.len(), expected.len());
    for (cycle, (answered, expected)) in answered.iter().zip(&expected).enumerate() {
        assert_eq!(answered, expected, "cycle {cycle}");
    }
}
