//! `stepwell paper`: the papers' tables beside ours.

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
fn a_table_is_shown_judged_and_saved() {
    let Some(maps) = maps() else { return };
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("table");
    let assert = stepwell()
        .args(["paper", "table4", "--method", "oh", "--screen", "256x192"])
        .args(["--json", "--maps"])
        .arg(&maps)
        .arg("-o")
        .arg(&folder)
        .assert()
        .code(0)
        .stderr("");
    let summary: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    assert_eq!(summary["schema"], "stepwell-paper-1");
    assert_eq!(
        (&summary["table"], &summary["agreed"]),
        (&"table4".into(), &true.into())
    );
    assert_eq!(
        (&summary["mismatches"], &summary["guards"]),
        (&0.into(), &0.into())
    );
    assert!(summary["rays"].as_u64().unwrap() > 600_000);
    let cells = summary["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 21);
    for cell in cells {
        let [paper, ours, ratio] = ["paper", "ours", "ratio"].map(|key| cell[key].as_f64());
        assert!((ours.unwrap() / paper.unwrap() - ratio.unwrap()).abs() < 1e-9);
        assert!((ratio.unwrap() - 1.0).abs() < 0.1, "{cell}");
    }
    let mean = summary["methods"][0]["mean_absolute_deviation"].as_f64();
    assert!((0.001..0.03).contains(&mean.unwrap()), "{mean:?}");

    let names = ["table4.csv", "table4.json", "table4.png"];
    assert_eq!(contents(&folder), names.map(|name| folder.join(name)));
    let csv = fs::read_to_string(folder.join("table4.csv")).unwrap();
    assert_eq!(csv.lines().count(), 22);
    assert!(csv.contains("\noh,rocks,front,11.6,,"), "{csv}");
}

#[test]
fn a_table_that_misses_its_limits_is_a_disagreement() {
    let Some(maps) = maps() else { return };
    // A frame so small that its means are not those of the paper.
    let assert = stepwell()
        .args([
            "paper", "table2", "--method", "oh", "--screen", "6x4", "--maps",
        ])
        .arg(&maps)
        .assert()
        .code(1);
    let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(
        text.contains("MISSED") && text.contains("\nmissed:"),
        "{text}"
    );
}

#[test]
fn without_maps_the_way_out_is_said() {
    let home = tempfile::tempdir().unwrap();
    for named in [false, true] {
        let mut command = stepwell();
        command
            .args(["paper", "table4", "--method", "oh"])
            .current_dir(home.path())
            .env_remove(MAPS_VARIABLE)
            .env_remove("CI");
        if named {
            command.args(["--maps", "nowhere"]);
        }
        let assert = command.assert().code(2).stdout("");
        let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(
            message.contains("--maps") && message.contains("rocks_NM_height.tga"),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn methods_that_a_table_does_not_have_are_refused() {
    let assert = stepwell()
        .args(["paper", "table2", "--method", "block"])
        .assert()
        .code(2);
    let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(message.contains("table 2 has oh, tevs"), "{message}");
}
