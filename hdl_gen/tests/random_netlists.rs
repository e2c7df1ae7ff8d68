//! Random designs: the embedded simulator, Icarus and Verilator agree in every output in every
//! cycle, and the emitted Verilog passes Verilator's lint with all warnings on.

#[path = "common/bench.rs"]
mod bench;
mod common;
#[path = "common/random.rs"]
mod random;
#[path = "common/tools.rs"]
mod tools;

use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use bench::{embedded, stimuli, write_bench};
use hdl_gen::fault::plant;
use hdl_gen::netlist::Module;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use tools::{has_tool, lint, run};

/// The same cases in every run, unless PROPTEST_RNG_SEED or PROPTEST_CASES ask for others.
fn config(cases: u32) -> Config {
    let mut config = Config {
        // Every case starts two tools.
        max_shrink_iters: 200,
        failure_persistence: None,
        ..Config::default()
    };
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(5);
    }
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = cases;
    }
    config
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

/// The comparison can fail: faults in the Verilog, none in the embedded simulator.
#[test]
fn icarus_sees_planted_faults() {
    if !has_tool("iverilog") {
        return;
    }
    let good = [common::normalised_difference()];
    let stimuli = stimuli(&good, 100, 3);
    let expected = embedded(&good, &stimuli);
    let answers = |design: Arc<Module>| {
        let folder = tempfile::tempdir().unwrap();
        icarus(folder.path(), &[design], &stimuli)
    };
    assert_eq!(answers(good[0].clone()), expected);
    for path in ["difference", "tag_i", "counter.count_o", "valid_o"] {
        let faulty = plant(&good[0], path, 0).unwrap();
        assert_ne!(answers(faulty.clone()), expected, "{path}");
        let same_fault = embedded(std::slice::from_ref(&faulty), &stimuli);
        assert_eq!(answers(faulty), same_fault, "{path}");
    }
}

/// Random logic compares numbers that Verilator can work out to be 0 or the greatest, such as
/// `a < (b - b)`, and Verilator is right to ask what for: a fault of the design, not of its text.
const RANDOM_WAIVERS: [&str; 2] = ["-Wno-UNSIGNED", "-Wno-CMPCONST"];

#[test]
fn lint_finds_nothing() {
    if !has_tool("verilator") {
        return;
    }
    proptest!(config(40), |(design in random::design("r"))| {
        let found = lint(&design.0, &RANDOM_WAIVERS);
        prop_assert!(found.is_empty(), "{}", found);
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
