//! Fixed-point operators on the command line, as a user asks for them.

use serde_json::Value;
use std::process::Output;
use tests::command_line::{stepwell, workspace};

fn run(arguments: &[&str]) -> Output {
    stepwell()
        .current_dir(workspace())
        .args(arguments)
        .output()
        .expect("stepwell runs")
}

fn verify(arguments: &[&str], expected_code: i32) -> Value {
    let all = [&["verify", "--sim", "embedded", "--json"], arguments].concat();
    let output = run(&all);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(expected_code),
        "{all:?}: {errors}"
    );
    serde_json::from_slice(&output.stdout).expect("JSON alone on standard output")
}

#[test]
fn every_operator_agrees_in_formats_of_its_own() {
    for operator in [
        "add",
        "sub",
        "mul",
        "div",
        "reciprocal",
        "negate",
        "convert",
        "shift_left",
        "shift_right",
    ] {
        let unit = format!("fixed_{operator}");
        let wrapping = [
            "--unit",
            &unit,
            "--format",
            "q4.4",
            "--result-format",
            "q3.6",
            "--rounding",
            "rup",
            "--overflow",
            "wrap",
            "--flags",
        ];
        let summary = verify(&wrapping, 0);
        assert_eq!(summary["mismatches"], 0, "{unit}");
        assert_eq!(summary["exhaustive"], true, "{unit}");
        let name = summary["unit"].as_str().unwrap();
        assert!(name.starts_with(&unit), "{name}");
        assert!(name.contains("to_q3_6_flags_rup_wrap"), "{name}");
    }
    let mixed = [
        "--unit",
        "fixed_cmp",
        "--format",
        "q4.4",
        "--b-format",
        "uq0.8",
    ];
    assert_eq!(verify(&mixed, 0)["format"], "q4.4 uq0.8");
    let from = ["--unit", "fixed_from_float", "--result-format", "q12.20"];
    assert_eq!(verify(&from, 0)["format"], "e7f16 to q12.20");
    let to = [
        "--unit",
        "fixed_to_float",
        "--format",
        "q12.20",
        "--policy",
        "full",
    ];
    assert_eq!(verify(&to, 0)["format"], "q12.20 to e7f16");
}

#[test]
fn a_planted_fault_is_found() {
    let faulty = [
        "--unit",
        "fixed_mul",
        "--format",
        "q4.4",
        "--plant-fault",
        "core.round_up:0",
    ];
    let summary = verify(&faulty, 1);
    assert!(summary["mismatches"].as_u64() > Some(0));
    let first = &summary["first_divergence"][0];
    assert_eq!(first["signal"], "result_o", "{first}");
}

#[test]
fn what_cannot_be_is_refused_with_the_way_out() {
    for (arguments, part) in [
        (
            &["--unit", "fixed_mul", "--format", "q40.40"][..],
            "80 bits in all",
        ),
        (
            &["--unit", "fixed_mul", "--format", "q20.20"],
            "64 are the most",
        ),
        (
            &["--unit", "fixed_mul", "--format", "e7f16"],
            "such as q4.12",
        ),
        (&["--unit", "fixed_add", "--policy", "full"], "--policy"),
        (
            &["--unit", "fixed_add", "--multiplier", "logic"],
            "--multiplier",
        ),
        (
            &["--unit", "fixed_negate", "--b-format", "q4.4"],
            "--b-format",
        ),
        (&["--unit", "fixed_cmp", "--rounding", "rup"], "--rounding"),
        (&["--unit", "float_add", "--overflow", "wrap"], "--overflow"),
        (
            &["--unit", "float_add", "--format", "q4.4"],
            "such as e7f16",
        ),
        (&["--unit", "fixed_plus"], "fixed_reciprocal"),
        (&["scenes/small.toml", "--format", "q4.4"], "format q4.4"),
    ] {
        let output = run(&[&["verify"], arguments].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(part), "{arguments:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(output.stdout.is_empty());
    }
}
