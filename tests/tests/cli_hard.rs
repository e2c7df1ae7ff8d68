//! `stepwell hard`, as a person runs it.

use assert_cmd::assert::Assert;
use std::fs;
use std::path::PathBuf;
use tests::command_line::{stepwell, workspace};

fn corpus() -> PathBuf {
    workspace().join("vectors/hard")
}

fn hard(arguments: &[&str]) -> Assert {
    let mut command = stepwell();
    command.current_dir(workspace()).arg("hard").args(arguments);
    command.assert()
}

fn text(output: &[u8]) -> String {
    String::from_utf8_lossy(output).into_owned()
}

#[test]
fn the_corpus_passes_in_the_formats_of_the_unit() {
    let assert = hard(&[
        "--method", "oh", "--format", "e7f16", "--format", "exact", "--json",
    ]);
    let output = assert.code(0).get_output().clone();
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["schema"], "stepwell-hard-1");
    assert_eq!(
        (&value["mismatches"], &value["guards"]),
        (&0.into(), &0.into())
    );
    let files = fs::read_dir(corpus()).unwrap();
    let files = files.filter(|entry| {
        let path = entry.as_ref().unwrap().path();
        path.extension().is_some_and(|ending| ending == "toml")
    });
    let cases = files.count();
    assert_eq!(value["cases"], cases);
    for (walk, format) in ["e7f16", "exact"].iter().enumerate() {
        let walk = &value["walks"][walk];
        assert_eq!(
            (&walk["format"], &walk["cases"]),
            (&(*format).into(), &cases.into())
        );
        assert_eq!((&walk["late"], &walk["guards"]), (&0.into(), &0.into()));
    }
    assert_eq!(value["walks"][1]["passed"], cases);
    assert!(value["rays"].as_u64().unwrap() >= 1200);
}

#[test]
fn a_table_and_files_say_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let assert = hard(&[
        "--method",
        "oh",
        "--format",
        "f64",
        "--family",
        "spike",
        "-o",
        output.to_str().unwrap(),
        "--rays",
    ]);
    let shown = text(&assert.code(0).get_output().stdout);
    assert!(shown.contains("cases walked"), "{shown}");
    let csv = fs::read_to_string(output.join("hard.csv")).unwrap();
    let lines: Vec<_> = csv.lines().collect();
    assert!(
        lines[0].starts_with("method,format,crossing,family,case,promise,right"),
        "{csv}"
    );
    assert!(
        lines[1..]
            .iter()
            .all(|line| line.starts_with("oh,f64,index,spike,")),
        "{csv}"
    );
    let json = fs::read_to_string(output.join("hard.json")).unwrap();
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(value["cases"], lines.len() - 1);
}

/// The methods that sample are in one table, and miss; those of fixed point alone are there too.
#[test]
fn methods_that_sample_show_their_misses_side_by_side() {
    let assert = hard(&["--format", "f64,fixed", "--json"]);
    let output = assert.code(0).get_output().clone();
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let walks = value["walks"].as_array().unwrap();
    let row = |method: &str, format: &str| {
        let mut rows = walks.iter();
        let row = rows.find(|row| row["method"] == method && row["format"] == format);
        row.unwrap_or_else(|| panic!("no row of {method} in {format}"))
    };
    for method in ["relief", "pom", "dig"] {
        let row = row(method, "f64");
        let count = |key: &str| row[key].as_u64().unwrap();
        assert!(count("rays") > 600 && count("right") > 0, "{row}");
        assert!(count("late") + count("wrong_early") > 50, "{row}");
        assert_eq!((count("defects"), count("guards")), (0, 0), "{row}");
    }
    for method in ["bounded-quad", "bounded-block"] {
        let row = row(method, "fixed");
        assert_eq!(row["right"], row["rays"], "{row}");
        assert!(row["rays"].as_u64().unwrap() > 600, "{row}");
    }
}

/// The expected depth of the first ray changed in a copy of a case: the command says so.
#[test]
fn a_planted_fault_gives_exit_code_1() {
    let name = "single_spike";
    let original = fs::read_to_string(corpus().join(name).with_extension("toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name).with_extension("toml");
    let place = folder.path().to_str().unwrap();
    let run = |text: String| {
        fs::write(&path, text).unwrap();
        hard(&["--corpus", place, "--method", "oh", "--format", "exact"])
    };
    run(original.clone()).code(0);
    let changed = original.replacen("\"7/16\"", "\"1/2\"", 1);
    assert_ne!(changed, original);
    let assert = run(changed).code(1);
    let shown = text(&assert.get_output().stdout);
    assert!(
        shown.contains("single_spike ray 1: the file expects another hit"),
        "{shown}"
    );
}

#[test]
fn bad_input_gets_one_message_and_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().to_str().unwrap();
    for (arguments, expected) in [
        (
            &["--corpus", "no/such/folder"][..],
            "name the folder of the corpus",
        ),
        (&["--corpus", empty], "no file NAME.toml"),
        (&["--case", "easy"], "has no such case"),
        (
            &["--case", "single_spike", "--family", "pit"],
            "no case is of both",
        ),
        (
            &["--family", "easy"],
            "unknown family `easy`: there is along-border",
        ),
        (&["--method", "oh", "--format", "e7"], "unknown format"),
        (
            &["--method", "dig", "--format", "fixed"],
            "nothing was compared",
        ),
    ] {
        let assert = hard(arguments).code(2);
        let message = text(&assert.get_output().stderr);
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    fs::write(
        folder.path().join("bad.toml"),
        "name = \"bad\"\nextra = 1\n",
    )
    .unwrap();
    let assert = hard(&["--corpus", empty]).code(2);
    let message = text(&assert.get_output().stderr);
    assert!(
        message.contains("bad.toml") && message.contains("unknown field `extra`"),
        "{message}"
    );
}
