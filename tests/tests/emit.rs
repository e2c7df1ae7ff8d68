//! `stepwell emit` and `stepwell vectors`, and what a stranger does with what they write.

use std::fs;
use std::path::Path;
use std::process::Command;
use tests::command_line::{contents, stepwell, tool_is_there, workspace};

fn emit(arguments: &[&str], folder: &Path) {
    stepwell()
        .current_dir(workspace())
        .arg("emit")
        .args(arguments)
        .arg("-o")
        .arg(folder)
        .assert()
        .success();
}

/// Compiles all that was emitted with Icarus, as the help says, and runs it.
fn verdict(folder: &Path) -> String {
    let run = |program: &str, arguments: &[&str]| {
        let output = Command::new("sh")
            .arg("-c")
            .arg(format!("{program} {}", arguments.join(" ")))
            .current_dir(folder.join("testbench"))
            .output()
            .expect("a shell");
        String::from_utf8_lossy(&output.stdout).into_owned()
            + &String::from_utf8_lossy(&output.stderr)
    };
    let said = run(
        "iverilog",
        &[
            "-g2005",
            "-Wall",
            "-Wno-timescale",
            "-o",
            "run",
            "../rtl/*.v",
            "*.v",
        ],
    );
    assert_eq!(said, "", "Icarus compiles it silently");
    run("vvp", &["-n", "run"])
}

#[test]
fn a_stranger_runs_what_was_emitted() {
    if !tool_is_there("icarus") {
        return;
    }
    for arguments in [
        &["scenes/small.toml"][..],
        &["--unit", "float_add", "--rounding", "rup"],
        &["--unit", "float_cmp"],
        &["--unit", "traverse_step", "--vectors", "100"],
    ] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        emit(arguments, folder.path());
        let said = verdict(folder.path());
        assert!(said.contains("PASS "), "{arguments:?}: {said}");

        // One flipped bit of an expected value, and the stranger is told.
        let vectors =
            ["hits.hex", "vectors.hex"].map(|name| folder.path().join("testbench").join(name));
        let file = vectors
            .iter()
            .find(|file| file.exists())
            .expect("expected values");
        let text = fs::read_to_string(file).expect("vectors");
        let last = text.trim_end().len() - 1;
        let digit = u8::from_str_radix(&text[last..=last], 16).expect("a hexadecimal digit");
        let flipped = format!("{}{:x}\n", &text[..last], digit ^ 1);
        fs::write(file, flipped).expect("written");
        let said = verdict(folder.path());
        assert!(said.contains("FAIL "), "{arguments:?}: {said}");
    }
}

#[test]
fn emitting_again_gives_the_same_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let texts = || -> Vec<_> {
        emit(&["scenes/small.toml"], folder.path());
        let files = contents(folder.path())
            .into_iter()
            .filter(|path| path.is_file());
        files
            .map(|path| (path.clone(), fs::read_to_string(path).expect("text")))
            .collect()
    };
    let first = texts();
    assert!(first.len() > 20);
    assert_eq!(first, texts());
}

#[test]
fn a_folder_that_cannot_be_written_is_named_before_the_work() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("written");
    for command in [
        &["emit", "scenes/small.toml"][..],
        &["verify", "scenes/small.toml", "--sim", "embedded"],
        &["vectors"],
    ] {
        let output = stepwell()
            .current_dir(workspace())
            .args(command)
            .arg("-o")
            .arg(file.join("below"))
            .output()
            .expect("stepwell runs");
        assert_eq!(output.status.code(), Some(2), "{command:?}");
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(
            message.contains("file") && message.lines().count() == 1,
            "{command:?}: {message}"
        );
        assert_eq!(contents(folder.path()).len(), 1, "{command:?}");
    }
}
