//! `stepwell render` and `stepwell plan`, and the examples that their help gives.

use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tests::command_line::{contents, stepwell, stepwell_path, workspace};

const PICTURES: [&str; 3] = ["depth.png", "shaded.png", "steps.png"];

fn scene(name: &str) -> std::path::PathBuf {
    workspace().join("scenes").join(name)
}

/// Renders the small scene into `folder`; its JSON summary.
fn render(folder: &Path, options: &[&str]) -> Value {
    let assert = stepwell()
        .arg("render")
        .arg(scene("small.toml"))
        .arg("-o")
        .arg(folder)
        .arg("--json")
        .args(options)
        .assert()
        .code(0)
        .stderr("");
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

/// Width and height of a PNG file, from its header.
fn size_of_png(path: &Path) -> (u32, u32) {
    let bytes = fs::read(path).unwrap();
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n", "{}", path.display());
    assert!(bytes.ends_with(b"IEND\xaeB`\x82"), "{}", path.display());
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

#[test]
fn the_small_scene_becomes_three_pictures_and_counts() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("not/there/yet");
    let summary = render(&folder, &[]);
    assert_eq!(contents(&folder), PICTURES.map(|name| folder.join(name)));
    assert_eq!(size_of_png(&folder.join("shaded.png")), (32, 24));
    // The others have a colour bar beside the frame, which is enlarged.
    for name in ["steps.png", "depth.png"] {
        let (width, height) = size_of_png(&folder.join(name));
        assert!(width > 320 && height > 240, "{name}: {width} x {height}");
    }

    assert_eq!(summary["schema"], "stepwell-render-1");
    assert_eq!(summary["scene"], "small");
    assert_eq!(summary["map"], "procedural:spikes:64:1");
    assert_eq!(summary["format"], "e7f16");
    assert_eq!(summary["method"], "oh");
    assert_eq!(summary["guards"], 0);
    let rays = summary["rays"].as_u64().unwrap();
    assert!((600..=32 * 24).contains(&rays), "{rays}");
    let mean = |of: &str| summary[of]["mean"].as_f64().unwrap();
    // From the root of 64 x 64 texels down to level 0 it is 7 steps, and some crossings.
    assert!(mean("crossings") > 0.0 && mean("steps") >= 7.0 + mean("crossings"));
    assert!(summary["steps"]["max"].as_f64().unwrap() > mean("steps"));
    assert!(summary["seconds"].as_f64().unwrap() > 0.0);
    let named: Vec<&str> = summary["pictures"]
        .as_array()
        .unwrap()
        .iter()
        .map(|path| path.as_str().unwrap())
        .collect();
    assert_eq!(named.len(), 3);
    for path in named {
        assert!(Path::new(path).is_file(), "{path}");
    }
}

#[test]
fn threads_change_no_pixel_and_no_count() {
    let home = tempfile::tempdir().unwrap();
    let runs = ["1", "2"].map(|threads| {
        let folder = home.path().join(threads);
        let mut summary = render(&folder, &["--threads", threads, "--size", "80x60"]);
        let summary = summary.as_object_mut().unwrap();
        summary.remove("seconds");
        summary.remove("pictures");
        let pictures = PICTURES.map(|name| fs::read(folder.join(name)).unwrap());
        (summary.clone(), pictures)
    });
    assert!(runs[0] == runs[1]);
}

#[test]
fn options_replace_what_the_scene_says() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("p");
    let plain = render(&folder, &[]);
    let former = fs::read(folder.join("shaded.png")).unwrap();
    let other = render(
        &folder,
        &[
            "--map",
            "procedural:bricks:32:5",
            "--white-is-low",
            "--format",
            "e5f10",
            "--method",
            "oh",
            "--camera",
            "front",
            "--size",
            "20x10",
        ],
    );
    assert_eq!(other["map"], "procedural:bricks:32:5");
    assert_eq!(other["format"], "e5f10");
    assert_eq!(size_of_png(&folder.join("shaded.png")), (20, 10));
    assert_ne!(fs::read(folder.join("shaded.png")).unwrap(), former);
    assert_eq!(contents(&folder).len(), 3);
    assert_ne!(plain["rays"], other["rays"]);
    let exact = render(&folder, &["--format", "exact"]);
    assert_eq!(
        (&exact["rays"], &exact["format"]),
        (&plain["rays"], &Value::from("exact"))
    );
    assert_eq!(exact["guards"], 0);
}

#[test]
fn a_table_is_printed_for_people_and_the_folder_is_named_for_the_scene() {
    let home = tempfile::tempdir().unwrap();
    let assert = stepwell()
        .arg("render")
        .arg(scene("small.toml").canonicalize().unwrap())
        .current_dir(home.path())
        .assert()
        .code(0)
        .stderr("");
    let table = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    for expected in [
        "small",
        "32 x 24 pixels",
        "oh in e7f16",
        "mean",
        "guards     0",
    ] {
        assert!(table.contains(expected), "{expected}: {table}");
    }
    let folder = home.path().join("out/small");
    assert_eq!(contents(&folder), PICTURES.map(|name| folder.join(name)));
}

#[test]
fn the_plan_names_the_units_and_why() {
    let run = |options: &[&str]| {
        let mut command = stepwell();
        command.arg("plan").arg(scene("small.toml")).args(options);
        let assert = command.assert().code(0).stderr("");
        String::from_utf8(assert.get_output().stdout.clone()).unwrap()
    };
    let plan: Value = serde_json::from_str(&run(&["--json"])).unwrap();
    assert_eq!(plan["schema"], "stepwell-plan-1");
    let units = plan["units"].as_array().unwrap();
    let names: Vec<&str> = units
        .iter()
        .map(|unit| unit["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["traverse_setup", "traverse_step", "traverse"]);
    assert_eq!(plan["effects"], Value::Array(Vec::new()));
    assert_eq!(
        (&plan["number_bits"], &plan["root_level"]),
        (&24.into(), &6.into())
    );
    let text = run(&[]);
    for name in names {
        assert!(text.contains(name), "{text}");
    }
    // What no hardware has is not said to be built.
    let exact: Value = serde_json::from_str(&run(&["--json", "--format", "exact"])).unwrap();
    assert_eq!(exact["units"], Value::Array(Vec::new()));
    assert!(run(&["--format", "exact"]).contains("no hardware has it"));

    let home = tempfile::tempdir().unwrap();
    let rendered = render(&home.path().join("p"), &[]);
    assert_eq!(plan["rays"], rendered["rays"]);
}

#[test]
fn the_examples_of_the_help_work_as_pasted() {
    let help = |command: &[&str]| {
        let assert = stepwell().args(command).arg("--help").assert().code(0);
        String::from_utf8(assert.get_output().stdout.clone()).unwrap()
    };
    let bin = stepwell_path().parent().unwrap();
    let path = env::join_paths(
        std::iter::once(bin.to_owned()).chain(env::split_paths(&env::var_os("PATH").unwrap())),
    )
    .unwrap();
    for command in ["render", "trace", "plan"] {
        let help = help(&[command]);
        let (_, example) = help.split_once("Example:\n").expect("an example");
        // Short enough that nothing breaks its lines.
        assert!(example.lines().all(|line| line.len() <= 78), "{example}");
        // Run where the scenes are, but where nothing is spoilt.
        let home = tempfile::tempdir().unwrap();
        let scenes = home.path().join("scenes");
        fs::create_dir(&scenes).unwrap();
        for file in contents(&workspace().join("scenes")) {
            fs::copy(&file, scenes.join(file.file_name().unwrap())).unwrap();
        }
        let output = Command::new("sh")
            .args(["-e", "-c", example])
            .env("PATH", &path)
            .current_dir(home.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{example}: {output:?}");
        assert!(
            !output.stdout.is_empty() && output.stderr.is_empty(),
            "{output:?}"
        );
    }
}
