//! `stepwell verify` and `stepwell wavediff`, as a user runs them.

use serde_json::Value;
use std::path::Path;
use std::process::Output;
use tests::command_line::{real_map, stepwell, tool_is_there, workspace};

fn run(arguments: &[&str]) -> Output {
    stepwell()
        .current_dir(workspace())
        .args(arguments)
        .output()
        .expect("stepwell runs")
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("an exit code")
}

/// Runs with `--json`, checks the exit code, and reads the summary.
fn summary(arguments: &[&str], expected_code: i32) -> Value {
    let mut all = vec!["verify"];
    all.extend(arguments);
    all.push("--json");
    let output = run(&all);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(code(&output), expected_code, "{all:?}: {errors}");
    serde_json::from_slice(&output.stdout).expect("JSON alone on standard output")
}

fn agreed(arguments: &[&str], simulator: &str) -> Value {
    let summary = summary(arguments, 0);
    assert_eq!(summary["schema"], "stepwell-verify-1");
    assert_eq!(summary["simulator"], simulator);
    assert_eq!(summary["mismatches"], 0);
    assert_eq!(summary["guards"], 0);
    for count in ["rays", "cycles", "signals_compared", "cycles_compared"] {
        assert!(
            summary[count].as_u64() > Some(0),
            "{count}: {}",
            summary[count]
        );
    }
    assert_eq!(summary["rays"], summary["rays_sent"]);
    summary
}

#[test]
fn the_first_scene_agrees_under_verilator() {
    if !tool_is_there("verilator") {
        return;
    }
    let summary = agreed(&["scenes/first.toml"], "verilator");
    assert!(summary["rays"].as_u64() > Some(50_000));
    assert!(summary["signals_compared"].as_u64() > Some(300));
}

#[test]
fn the_real_rocks_agree_at_every_camera() {
    let Some(map) = real_map("rocks_NM_height.tga") else {
        return;
    };
    if !tool_is_there("verilator") {
        return;
    }
    for scene in [
        "scenes/front.toml",
        "scenes/oblique.toml",
        "scenes/grazing.toml",
    ] {
        let map = map.to_str().expect("a readable path");
        let arguments = [
            scene,
            "--map",
            map,
            "--channel",
            "alpha",
            "--size",
            "320x240",
        ];
        agreed(&arguments, "verilator");
    }
}

#[test]
fn all_simulators_agree_on_a_small_frame() {
    let embedded = agreed(&["scenes/small.toml", "--sim", "embedded"], "embedded");
    for simulator in ["verilator", "icarus"] {
        if tool_is_there(simulator) {
            let other = agreed(&["scenes/small.toml", "--sim", simulator], simulator);
            for same in ["rays", "cycles", "signals_compared", "netlist_digest"] {
                assert_eq!(embedded[same], other[same], "{simulator}: {same}");
            }
        }
    }
}

/// A planted fault must be found, and the report must say where.
fn finds(fault: &str, simulator: &str, unit: &str) {
    let arguments = [
        "scenes/small.toml",
        "--sim",
        simulator,
        "--plant-fault",
        fault,
    ];
    let summary = summary(&arguments, 1);
    assert!(summary["mismatches"].as_u64() > Some(0), "{fault}");
    let first = &summary["first_divergence"][0];
    assert_eq!(first["unit"], unit, "{fault}: {first}");
    assert!(
        first["cycle"].is_u64() && first["signal"].is_string(),
        "{fault}: {first}"
    );
    assert_ne!(first["expected"], first["found"], "{fault}");
    // Registers of the loop depend on themselves a trip before: there the cause may stay open.
    if unit == "traverse.step" {
        assert_eq!(first["first_cause"], true, "{fault}: {first}");
    }
    // A fault in a signal the golden model knows is named by that very signal.
    if let Some(signal) = fault
        .strip_prefix("step.")
        .and_then(|rest| rest.split(':').next())
        && signal.contains("_s")
        && unit == "traverse.step"
    {
        assert_eq!(first["signal"], signal, "{fault}: {first}");
    }
}

#[test]
fn a_planted_fault_in_every_unit_is_found() {
    for (fault, unit) in [
        ("valid_s3:0", "traverse"),
        ("setup.mirrored_u:2", "traverse"),
        ("traverse_setup.root_i:0", "traverse"),
        ("float_exact_below_e7f16_l0.result:20", "traverse"),
        ("step.next_t_s9:0", "traverse.step"),
        ("step.node_address_s0:1", "traverse"),
        (
            "float_from_integer_e7f16_v17x6_rtz_l1.result_registered:0",
            "traverse.step",
        ),
        (
            "float_from_integer_e7f16_v17x7_rtz_l1.result_registered:3",
            "traverse.step",
        ),
        (
            "depth_from_height_e7f16_h8_l1.result_registered:7",
            "traverse.step",
        ),
        (
            "float_sub_e7f16_rtz_l2.result_registered:0",
            "traverse.step",
        ),
        (
            "float_sub_e7f16_rup_l2.result_registered:0",
            "traverse.step",
        ),
        (
            "float_add_e7f16_rne_l2.result_registered:0",
            "traverse.step",
        ),
        (
            "float_mul_e7f16_rtz_l1.result_registered:0",
            "traverse.step",
        ),
        (
            "float_div_e7f16_rtz_l2.result_registered:0",
            "traverse.step",
        ),
        (
            "float_less_than_e7f16_l1.result_registered:0",
            "traverse.step",
        ),
        (
            "float_less_equal_e7f16_l1.result_registered:0",
            "traverse.step",
        ),
        ("float_ulps_up_e7f16_u1_l0.result:0", "traverse.step"),
        ("float_ulps_up_e7f16_u3_l0.result:0", "traverse.step"),
    ] {
        finds(fault, "embedded", unit);
    }
}

#[test]
fn a_planted_fault_is_found_under_the_tools() {
    for simulator in ["verilator", "icarus"] {
        if tool_is_there(simulator) {
            finds("step.exit_depth_u_s5:0", simulator, "traverse.step");
        }
    }
}

#[test]
fn an_unknown_fault_is_refused() {
    for fault in ["step.no_such_signal:0", "step.next_t_s9:24"] {
        let output = run(&[
            "verify",
            "scenes/small.toml",
            "--sim",
            "embedded",
            "--plant-fault",
            fault,
        ]);
        assert_eq!(code(&output), 2, "{fault}");
        assert!(output.stdout.is_empty(), "{fault}");
    }
}

#[test]
fn operators_agree() {
    for unit in [
        "float_add",
        "float_sub",
        "float_mul",
        "float_div",
        "float_cmp",
    ] {
        let arguments = ["--unit", unit, "--format", "e4f3", "--sim", "embedded"];
        let summary = agreed(&arguments, "embedded");
        assert_eq!(summary["rays"], 65536, "{unit}");
        assert_eq!(summary["exhaustive"], true, "{unit}");
    }
}

#[test]
fn operators_agree_however_they_are_asked_for() {
    let mut cores = Vec::new();
    for options in [
        "--unit float_add",
        "--unit float_add --latency 3",
        "--unit float_add --rounding rtz",
        "--unit float_mul --rounding rup --multiplier logic",
        "--unit float_div --radix 4 --latency 2",
    ] {
        let mut arguments: Vec<&str> = options.split_whitespace().collect();
        arguments.extend(["--format", "e3f2", "--sim", "embedded"]);
        let summary = agreed(&arguments, "embedded");
        assert_eq!(summary["exhaustive"], true, "{options}");
        let core = summary["core_digest"]
            .as_str()
            .expect("a digest")
            .to_owned();
        assert_ne!(summary["netlist_digest"], core, "{options}");
        assert!(!cores.contains(&core), "{options}");
        cores.push(core);
    }
}

#[test]
fn what_is_said_of_an_operator_is_refused_of_anything_else() {
    for (subject, option) in [
        ("verify scenes/small.toml", "--policy full"),
        ("verify scenes/small.toml", "--latency 2"),
        ("verify --unit traverse_step", "--flags"),
        ("verify --unit traverse", "--radix 4"),
        ("emit scenes/small.toml -o out/none", "--rounding rtz"),
        (
            "emit --unit traverse_step -o out/none",
            "--multiplier logic",
        ),
    ] {
        let arguments: Vec<&str> = subject.split(' ').chain(option.split(' ')).collect();
        let output = run(&arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        let message = String::from_utf8_lossy(&output.stderr);
        let named = option.split(' ').next().expect("an option");
        assert!(
            message.contains(named) && message.contains("--unit"),
            "{message}"
        );
        assert!(!workspace().join("out/none").exists(), "{arguments:?}");
    }
}

#[test]
fn a_missing_simulator_is_named() {
    for (variable, simulator) in [
        ("STEPWELL_VERILATOR", "verilator"),
        ("STEPWELL_IVERILOG", "icarus"),
    ] {
        let output = stepwell()
            .current_dir(workspace())
            .args(["verify", "scenes/small.toml", "--sim", simulator])
            .env(variable, "/nowhere/at/all")
            .output()
            .expect("stepwell runs");
        assert_eq!(code(&output), 2, "{simulator}");
        assert!(output.stdout.is_empty(), "{simulator}");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(message.contains("install"), "{message}");
    }
}

fn waveforms(folder: &Path, simulator: &str, fault: Option<&str>) -> (String, String) {
    let folder_name = folder.to_str().expect("a readable path");
    let mut arguments = vec![
        "verify",
        "scenes/small.toml",
        "--sim",
        simulator,
        "--vcd",
        "40:240",
        "-o",
        folder_name,
    ];
    if let Some(fault) = fault {
        arguments.extend(["--plant-fault", fault]);
    }
    let output = run(&arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(code(&output), i32::from(fault.is_some()), "{errors}");
    let path = |name: &str| {
        folder
            .join(name)
            .to_str()
            .expect("a readable path")
            .to_owned()
    };
    (path("golden.vcd"), path("hardware.vcd"))
}

#[test]
fn waveforms_of_every_simulator_are_the_golden_one() {
    for simulator in ["embedded", "verilator", "icarus"] {
        if simulator != "embedded" && !tool_is_there(simulator) {
            continue;
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (golden, hardware) = waveforms(folder.path(), simulator, None);
        let output = run(&["wavediff", &golden, &hardware, "--json"]);
        assert_eq!(code(&output), 0, "{simulator}");
        let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(report["cycles_compared"], 201, "{simulator}");
        assert!(
            report["signals_compared"].as_u64() > Some(300),
            "{simulator}"
        );
    }
}

#[test]
fn wavediff_names_the_first_cause() {
    // A fault that the idle unit does not show: the late node of a descending ray.
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (golden, _) = waveforms(folder.path(), "embedded", None);
    let text = std::fs::read_to_string(&golden).expect("a waveform");
    let faulty = folder.path().join("faulty.vcd");
    // The last change of the depth behind stage 9, with its lowest bit inverted.
    let code_of = |name: &str| {
        let line = text
            .lines()
            .find(|line| line.contains("$var") && line.contains(name));
        line.and_then(|line| line.split_whitespace().nth(3))
            .expect("a declared signal")
            .to_owned()
    };
    let suffix = format!(" {}", code_of(" next_t_s9 "));
    let place = text.rfind(&suffix).expect("a change of the signal");
    let bit = place - 1;
    let flipped = if text.as_bytes()[bit] == b'0' {
        "1"
    } else {
        "0"
    };
    let changed = format!("{}{flipped}{}", &text[..bit], &text[bit + 1..]);
    std::fs::write(&faulty, changed).expect("written");
    let output = run(&[
        "wavediff",
        &golden,
        faulty.to_str().expect("a readable path"),
    ]);
    assert_eq!(code(&output), 1);
    let report = String::from_utf8_lossy(&output.stdout);
    assert!(report.contains("traverse.step.next_t_s9"), "{report}");
    assert!(report.contains("1 ulp"), "{report}");
    assert!(report.contains("first cause"), "{report}");
}
