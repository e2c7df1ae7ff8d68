//! `stepwell paper offset`: what crossing a border by an offset costs.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;
use tests::command_line::{contents, stepwell, workspace};

use rtl_model::calibration::{MAPS_VARIABLE, real_maps};

/// The folder of the real maps; none where there are none, which is said.
fn maps() -> Option<PathBuf> {
    let found = real_maps(workspace()).expect("in CI the real maps are there");
    if found.is_none() {
        println!("left out, no real height maps: set {MAPS_VARIABLE} to their folder");
    }
    found
}

#[test]
fn offsets_stand_beside_the_index() {
    let Some(maps) = maps() else { return };
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("table");
    let assert = stepwell()
        .args([
            "paper",
            "offset",
            "--screen",
            "32x24",
            "--map-size",
            "256,1024",
        ])
        .args([
            "--format",
            "f64,e7f16",
            "--offset",
            "0.0001,0.5",
            "--json",
            "--maps",
        ])
        .arg(&maps)
        .arg("-o")
        .arg(&folder)
        .assert()
        .code(0)
        .stderr("");
    let summary: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(summary["schema"], "stepwell-paper-offset-1");
    assert_eq!(summary["mismatches"], 0);
    let cases = summary["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 2 * 2 * 3);
    let share = |format: &str, size: u32, crossing: &str, key: &str| {
        let case = cases.iter().find(|case| {
            case["format"] == format && case["map_size"] == size && case["crossing"] == crossing
        });
        let case = case.unwrap_or_else(|| panic!("no {format} {size} {crossing}"));
        assert!(case["rays"].as_u64().unwrap() > 10_000, "{case}");
        case[key].as_f64().unwrap()
    };
    for size in [256, 1024] {
        for format in ["f64", "e7f16"] {
            assert_eq!(share(format, size, "index", "hangs"), 0.0);
            assert_eq!(share(format, size, "index", "late"), 0.0);
            // Half a texel steps over the corners of one ray in eight.
            let wrong = share(format, size, "offset:0.5", "wrong_percent");
            assert!((10.0..14.0).contains(&wrong), "{format} {size}: {wrong} %");
        }
        assert_eq!(share("f64", size, "index", "wrong"), 0.0);
        assert_eq!(share("f64", size, "offset:0.0001", "hangs"), 0.0);
        let hangs = share("e7f16", size, "offset:0.0001", "hangs_percent");
        assert!((50.0..80.0).contains(&hangs), "{size}: {hangs} %");
    }
    let names = ["offset.csv", "offset.json", "offset.png"];
    assert_eq!(contents(&folder), names.map(|name| folder.join(name)));
    let csv = fs::read_to_string(folder.join("offset.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + cases.len());
}

#[test]
fn what_makes_no_table_is_refused() {
    for (arguments, expected) in [
        (["--method", "block"], "only by methods that look at a node"),
        (["--offset", "2"], "at most 1"),
        (["--maps", "/nowhere"], "/nowhere"),
    ] {
        let assert = stepwell()
            .args(["paper", "offset"])
            .args(arguments)
            .assert()
            .code(2);
        let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(message.contains(expected), "{message}");
    }
    let Some(maps) = maps() else { return };
    for (arguments, expected) in [
        (["--map-size", "128"], "256 texels on a side"),
        (["--format", "fixed"], "fixed"),
    ] {
        let assert = stepwell()
            .args(["paper", "offset", "--screen", "4x3", "--maps"])
            .arg(&maps)
            .args(arguments)
            .assert()
            .code(2);
        let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(message.contains(expected), "{message}");
    }
}
