//! Scenes with a machine, as a user runs them.

use serde_json::Value;
use tests::command_line::{stepwell, workspace};

/// Runs with `--json`, checks the exit code, and reads the answer.
fn answer(arguments: &str, expected_code: i32) -> Value {
    let output = stepwell()
        .current_dir(workspace())
        .args(arguments.split(' '))
        .arg("--json")
        .output()
        .expect("stepwell runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(expected_code),
        "{arguments}: {errors}"
    );
    serde_json::from_slice(&output.stdout).expect("JSON alone on standard output")
}

const MACHINES: [(&str, &str); 3] = [
    ("scenes/machine-paper.toml", "paper"),
    ("scenes/machine-exact.toml", "exact"),
    ("scenes/machine-exact.toml --method bounded-quad", "exact"),
];

#[test]
fn machines_are_verified_with_and_without_stalls() {
    for (scene, name) in MACHINES {
        for stalls in ["", " --stalls"] {
            let found = answer(
                &format!("verify {scene} --size 20x12 --sim embedded{stalls}"),
                0,
            );
            assert_eq!(found["machine"], name);
            for count in ["mismatches", "lost", "duplicated", "hits_differing"] {
                assert_eq!(found[count], 0, "{scene}{stalls}: {count}");
            }
            assert_eq!(found["rays"], found["rays_sent"]);
            assert!(found["cycles_compared"].as_u64() > found["rays"].as_u64());
        }
    }
}

#[test]
fn a_fault_in_the_exact_machine_is_found() {
    let found = answer(
        "verify scenes/machine-exact.toml --size 20x12 --sim embedded --plant-fault admits:0",
        1,
    );
    assert!(found["mismatches"].as_u64() > Some(0));
    let first = &found["first_divergence"][0];
    assert_eq!(first["signal"], "admits", "{first}");
}

#[test]
fn a_machine_is_rendered_with_its_counts() {
    let folder = tempfile::tempdir().expect("a folder");
    for (scene, name) in MACHINES {
        let output = folder.path().join(name);
        let found = answer(
            &format!(
                "render {scene} --size 40x24 --machine -o {}",
                output.display()
            ),
            0,
        );
        assert_eq!(found["machine"], name);
        assert!(found["cache_hit_rate"].as_f64() > Some(0.3), "{found}");
        assert!(output.join("occupancy.png").is_file());
        let refusals = found.get("refusals");
        assert_eq!(refusals.is_some(), name == "exact", "{found}");
    }
}

#[test]
fn a_scene_that_no_machine_walks_is_refused() {
    for (arguments, way_out) in [
        (
            "verify scenes/machine-exact.toml --method oh --sim embedded",
            "bounded-quad",
        ),
        (
            "verify scenes/machine-exact.toml --map procedural:rocks:8:1 --sim embedded",
            "16 texels",
        ),
    ] {
        let output = stepwell()
            .current_dir(workspace())
            .args(arguments.split(' '))
            .output()
            .expect("stepwell runs");
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(way_out), "{errors}");
    }
}
