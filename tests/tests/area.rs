//! `stepwell area`, as a user runs it.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;
use tests::command_line::{stepwell, workspace};

/// Runs with a cache of its own.
fn run(arguments: &[&str], cache: &Path) -> Output {
    stepwell()
        .current_dir(workspace())
        .args(arguments)
        .env("STEPWELL_CACHE", cache)
        .output()
        .expect("stepwell runs")
}

/// Are the tools there? `make tools` installs them; in CI they must be.
fn tools_are_there() -> bool {
    let there = workspace().join(".venv/synthesis/installed").exists();
    let strict = std::env::var("CI").is_ok_and(|value| value == "true");
    assert!(there || !strict, "`make tools` has not been run");
    if !there {
        println!("`make tools` has not been run: this check is left out");
    }
    there
}

fn units(arguments: &str, cache: &Path) -> Vec<Value> {
    let arguments: Vec<&str> = arguments.split(' ').chain(["--json"]).collect();
    let output = run(&arguments, cache);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON alone");
    assert_eq!(report["schema"], "stepwell-area-1");
    report["units"].as_array().expect("a list").clone()
}

#[test]
fn figures_are_plausible_the_same_again_and_of_the_netlist_that_is_verified() {
    if !tools_are_there() {
        return;
    }
    let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let arguments = "area --unit float_cmp --format e4f3 --latency 1 --seeds 1";
    let folder = first.path().join("out");
    let out = folder.to_str().expect("a readable path");
    let figures = units(&format!("{arguments} -o {out}"), first.path());
    // From tools that start afresh, and then out of the cache.
    assert_eq!(units(arguments, second.path()), figures);
    assert_eq!(units(arguments, first.path()), figures);

    let unit = &figures[0];
    let number = |key: &str| {
        unit[key]
            .as_f64()
            .unwrap_or_else(|| panic!("{key}: {unit}"))
    };
    assert_eq!(
        (&unit["unit"], &unit["latency"]),
        (&"float_cmp".into(), &1.into())
    );
    assert_eq!((&unit["format"], &unit["dsp"]), (&"e4f3".into(), &0.into()));
    assert_eq!(number("ff"), 4.0, "a register for each relation");
    assert!((10.0..60.0).contains(&number("lut4_taken")), "{unit}");
    assert!(
        number("lut4_taken") >= number("lut4") + 2.0 * number("carry"),
        "{unit}"
    );
    assert!((100.0..500.0).contains(&number("fmax_mhz")), "{unit}");
    assert!((8.0..40.0).contains(&number("lut6")), "{unit}");
    assert!((0.05..0.3).contains(&number("kge")), "{unit}");
    assert!(
        (number("um2") / 24000.0 - number("kge")).abs() < 0.001,
        "{unit}"
    );
    assert!(
        unit["tools"]["yosys"]
            .as_str()
            .is_some_and(|yosys| yosys.contains("0.70"))
    );

    let csv = fs::read_to_string(folder.join("area.csv")).unwrap();
    let (titles, values) = csv.trim_end().split_once('\n').expect("two lines");
    assert_eq!(titles.split(',').count(), values.split(',').count());
    assert!(
        // No method, crossing or map: it is an operator.
        values.starts_with("float_cmp,float_cmp_e4f3_l1,,,,e4f3,"),
        "{values}"
    );
    assert!(folder.join("area.json").exists());

    let verified = "verify --unit float_cmp --format e4f3 --sim embedded --json --latency";
    for (latency, same) in [("1", true), ("2", false)] {
        let arguments: Vec<&str> = verified.split(' ').chain([latency]).collect();
        let output = run(&arguments, first.path());
        let summary: Value = serde_json::from_slice(&output.stdout).expect("JSON alone");
        assert_eq!(summary["mismatches"], 0);
        for digest in ["netlist_digest", "core_digest"] {
            assert_eq!(
                summary[digest] == unit[digest],
                same,
                "{digest} of {latency} cycles"
            );
        }
    }
}

#[test]
fn what_cannot_be_measured_is_refused_in_one_line() {
    let cache = tempfile::tempdir().unwrap();
    for (arguments, variable, expected) in [
        ("area", "NONE", "a SCENE with a table [machine]"),
        (
            "area scenes/first.toml --latencies 2,2,8,1,2",
            "NONE",
            "--latencies are of a machine of kind paper",
        ),
        ("area --unit float_ad", "NONE", "float_add"),
        ("area --unit traverse", "NONE", "traverse_step"),
        ("area scenes/first.toml", "NONE", "[machine]"),
        (
            "area scenes/machine-paper.toml --rounding rtz",
            "NONE",
            "of operators",
        ),
        (
            "area scenes/machine-paper.toml",
            "STEPWELL_YOSYS",
            "make tools",
        ),
        ("area --unit float_add --method oh", "NONE", "of steps"),
        (
            "area --unit traverse_step --rounding rtz",
            "NONE",
            "of operators",
        ),
        (
            "area --unit traverse_step --method relief --format fixed",
            "NONE",
            "fixed point",
        ),
        (
            "area --unit float_add --format exact",
            "NONE",
            "no hardware",
        ),
        (
            "area --unit float_add --format e7f40",
            "NONE",
            "fraction bits",
        ),
        ("area --unit float_cmp", "STEPWELL_YOSYS", "make tools"),
        ("area --unit float_cmp", "STEPWELL_LIBERTY", "make tools"),
    ] {
        let output = stepwell()
            .current_dir(workspace())
            .args(arguments.split(' '))
            .env(variable, "/nowhere/at/all")
            .env("STEPWELL_CACHE", cache.path())
            .output()
            .expect("stepwell runs");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
        assert!(output.stdout.is_empty(), "{arguments}");
        // Without any tool it is Yosys that is named, whatever the variable.
        assert!(message.contains(expected), "{arguments}: {message}");
        assert_eq!(message.lines().count(), 1, "{arguments}: {message}");
    }
}
