//! The built program, as a person runs it.

use std::env;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::OnceLock;

use assert_cmd::Command;
use rtl_model::calibration::{MAPS_VARIABLE, real_maps};

/// The folder of the workspace, where `scenes` is.
pub fn workspace() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// The program `stepwell`, built once for each test program, with the profile and into the folder
/// that the tests were built with. Cargo itself builds a package's binaries for that package's
/// own tests alone.
pub fn stepwell() -> Command {
    Command::new(stepwell_path())
}

/// Where that program is.
pub fn stepwell_path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(build)
}

fn build() -> PathBuf {
    // The test program is TARGET/PROFILE/deps/NAME.
    let program = env::current_exe().expect("a test program has a path");
    let profile_folder = program.ancestors().nth(2).expect("TARGET/PROFILE");
    let target = profile_folder.parent().expect("TARGET");
    let profile = match profile_folder.file_name().and_then(|name| name.to_str()) {
        Some("debug") => "dev",
        Some(profile) => profile,
        None => panic!("{} names no profile", profile_folder.display()),
    };
    let output = process::Command::new(env::var_os("CARGO").unwrap_or("cargo".into()))
        .args([
            "build",
            "--quiet",
            "--package",
            "stepwell",
            "--profile",
            profile,
        ])
        .arg("--target-dir")
        .arg(target)
        .current_dir(workspace())
        .output()
        .expect("cargo runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    profile_folder.join(format!("stepwell{}", env::consts::EXE_SUFFIX))
}

/// The paths of all that is in `folder`, at any depth, in order.
pub fn contents(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir().expect("a folder that can be read") {
            let path = entry.expect("an entry that can be read").path();
            if path.is_dir() {
                folders.push(path.clone());
            }
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Is the tool behind a `--sim` installed? Where it is not, says so in one line; in CI that is a
/// failure.
pub fn tool_is_there(simulator: &str) -> bool {
    let (program, argument) = match simulator {
        "icarus" => ("iverilog", "-V"),
        other => (other, "--version"),
    };
    let answer = process::Command::new(program).arg(argument).output();
    let is_there = answer.is_ok_and(|output| output.status.success());
    if !is_there {
        assert!(
            !in_ci(),
            "{program} is not installed: `make tools` installs it"
        );
        println!("{program} is not installed: this part is left out");
    }
    is_there
}

/// A real height map by its file name. Where there are none, says so in one line; in CI that is a
/// failure.
pub fn real_map(file: &str) -> Option<PathBuf> {
    let folder = real_maps(workspace()).expect("in CI the real height maps are there");
    if folder.is_none() {
        println!("no real height maps: this part is left out (set {MAPS_VARIABLE})");
    }
    folder.map(|folder| folder.join(file))
}

fn in_ci() -> bool {
    env::var("CI").is_ok_and(|value| value == "true")
}
