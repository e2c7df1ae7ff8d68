//! `stepwell emit` of a machine: what a stranger does with it in Icarus and Verilator, and waveforms
//! of machines.

use std::fs;
use std::path::Path;
use std::process::Command;
use tests::command_line::{stepwell, tool_is_there, workspace};

const SCENE: &str = "scenes/machine-paper.toml";
/// A frame whose rays take a few thousand cycles in Icarus.
const SMALL: [&str; 7] = [
    "--size",
    "8x6",
    "--map",
    "procedural:rocks:64:1",
    "--stalls",
    "--seed",
    "7",
];
const BENCH: &str = "testbench_paper_machine";

fn run(arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = stepwell();
    let output = command.current_dir(workspace()).args(arguments).output();
    let output = output.expect("stepwell runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    (output.status.code(), text)
}

fn emitted(folder: &Path) {
    emitted_scene(&[SCENE], folder);
}

fn emitted_scene(scene: &[&str], folder: &Path) {
    let place = folder.to_str().expect("a path");
    let (code, said) = run(&[&["emit"], scene, &["-o", place], &SMALL[..]].concat());
    assert_eq!(code, Some(0), "{said}");
}

/// Runs a shell command among the testbench's files; what it printed.
fn shell(folder: &Path, command: &str) -> String {
    let output = Command::new("sh")
        .args(["-c", command])
        .current_dir(folder.join("testbench"))
        .output()
        .expect("a shell");
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// The last line of a testbench that is a verdict.
fn verdict(said: &str) -> String {
    let mut lines = said.lines().rev();
    let line = lines.find(|line| line.starts_with("PASS ") || line.starts_with("FAIL "));
    line.unwrap_or_else(|| panic!("no verdict: {said}"))
        .to_owned()
}

/// The line with one hexadecimal digit changed.
fn damage(folder: &Path, file: &str, line: usize) {
    let path = folder.join("testbench").join(file);
    let text = fs::read_to_string(&path).expect("vectors");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let last = lines[line].pop().expect("a digit");
    let digit = last.to_digit(16).expect("a hexadecimal digit") ^ 1;
    lines[line].push(char::from_digit(digit, 16).expect("a digit"));
    fs::write(path, lines.join("\n") + "\n").expect("written");
}

#[test]
fn a_stranger_runs_a_machine_in_icarus() {
    if !tool_is_there("icarus") {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    emitted(folder);
    let compile = "iverilog -g2005 -Wall -Wno-timescale -o run ../rtl/*.v *.v";
    assert_eq!(shell(folder, compile), "", "Icarus compiles it silently");
    let said = shell(folder, "vvp -n run +vcd=wave.vcd");
    let passed = verdict(&said);
    assert!(passed.starts_with("PASS "), "{said}");
    assert!(said.contains("lines_fetched "), "{said}");

    // Its waveform is the golden machine's, cycle for cycle, but for what was never written.
    let waves = folder.join("waves");
    let waves = waves.to_str().expect("a path");
    let verify = [
        &[
            "verify", SCENE, "--sim", "embedded", "--vcd", "0:700", "-o", waves,
        ],
        &SMALL[..],
    ];
    let (code, said) = run(&verify.concat());
    assert_eq!(code, Some(0), "{said}");
    let golden = format!("{waves}/golden.vcd");
    let icarus = folder.join("testbench/wave.vcd");
    let icarus = icarus.to_str().expect("a path");
    let compared = ["wavediff", &golden, icarus, "--other-first-cycle", "0"];
    let (code, said) = run(&[&compared[..], &["--excuse-unknown"]].concat());
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("in 701 cycles (0 to 700)"), "{said}");
    // The x of a register that was not written yet is one by default.
    let (code, said) = run(&compared);
    assert_eq!(code, Some(1), "{said}");

    // Faults: another cycle count, another hit, another height.
    let recompile = format!("{compile} -P {BENCH}.CYCLES=1000 && vvp -n run");
    let said = verdict(&shell(folder, &recompile));
    assert!(said.contains("the golden machine's are 1000"), "{said}");
    shell(folder, compile);
    damage(folder, "hits.hex", 3);
    let said = shell(folder, "vvp -n run");
    assert!(verdict(&said).starts_with("FAIL "), "{said}");
    assert!(
        said.contains("vector 3: guard expected 1 found 0"),
        "{said}"
    );
    damage(folder, "hits.hex", 3);
    // Level 0 of the pyramid, which every walk ends at, is the upper part of the memory.
    let lines = fs::read_to_string(folder.join("testbench/memory.hex")).expect("a memory");
    let lines = lines.lines().count();
    for line in lines / 4..lines {
        damage(folder, "memory.hex", line);
    }
    let said = verdict(&shell(folder, "vvp -n run"));
    assert!(said.starts_with("FAIL "), "{said}");
}

#[test]
fn a_stranger_runs_the_exact_machine_too() {
    if !tool_is_there("icarus") {
        return;
    }
    for method in ["bounded-quad", "bounded-block"] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let folder = folder.path();
        let scene = ["scenes/machine-exact.toml", "--method", method];
        emitted_scene(&scene, folder);
        let compile = "iverilog -g2005 -Wall -Wno-timescale -o run ../rtl/*.v *.v";
        assert_eq!(shell(folder, compile), "", "Icarus compiles it silently");
        let said = verdict(&shell(folder, "vvp -n run +vcd=wave.vcd"));
        assert!(said.starts_with("PASS "), "{method}: {said}");

        let waves = folder.join("waves");
        let waves = waves.to_str().expect("a path");
        let verify = [
            &["verify"],
            &scene[..],
            &["--sim", "embedded", "--vcd", "0:400", "-o", waves],
            &SMALL[..],
        ];
        let (code, said) = run(&verify.concat());
        assert_eq!(code, Some(0), "{said}");
        let golden = format!("{waves}/golden.vcd");
        let icarus = folder.join("testbench/wave.vcd");
        let icarus = icarus.to_str().expect("a path");
        let compared = ["wavediff", &golden, icarus, "--other-first-cycle", "0"];
        let (code, said) = run(&[&compared[..], &["--excuse-unknown"]].concat());
        assert_eq!(code, Some(0), "{method}: {said}");

        damage(folder, "hits.hex", 3);
        let said = verdict(&shell(folder, "vvp -n run"));
        assert!(said.starts_with("FAIL "), "{method}: {said}");
    }
}

#[test]
fn a_stranger_runs_a_machine_in_verilator() {
    if !tool_is_there("verilator") {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    emitted(folder.path());
    let command = format!(
        "verilator --binary --timing -Wno-fatal --top-module {BENCH} {BENCH}.v -y ../rtl >log 2>&1 \
         && obj_dir/V{BENCH}"
    );
    let said = verdict(&shell(folder.path(), &command));
    assert!(said.starts_with("PASS "), "{said}");
}

/// A planted fault: `wavediff` names the unit that it is in, before all that it leads to.
#[test]
fn waveforms_of_a_machine_name_the_first_divergent_unit() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let waves = folder.path().to_str().expect("a path");
    let verify = [
        &[
            "verify", SCENE, "--sim", "embedded", "--vcd", "0:700", "-o", waves,
        ],
        &SMALL[..],
    ]
    .concat();
    let files = ["golden.vcd", "hardware.vcd"].map(|name| format!("{waves}/{name}"));
    let (code, said) = run(&verify);
    assert_eq!(code, Some(0), "{said}");
    let (code, said) = run(&["wavediff", &files[0], &files[1]]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("in 701 cycles"), "{said}");

    let fault = ["--plant-fault", "height_cache.fetch_pointer:0"];
    let (code, said) = run(&[&verify[..], &fault].concat());
    assert_eq!(code, Some(1), "{said}");
    let (code, said) = run(&["wavediff", &files[0], &files[1], "--signals", "1"]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("paper_machine.height_cache."), "{said}");
}

#[test]
fn a_waveform_becomes_a_picture() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let waves = folder.path().to_str().expect("a path");
    let verify = [
        &[
            "verify", SCENE, "--sim", "embedded", "--vcd", "260:330", "-o", waves,
        ],
        &SMALL[..],
    ];
    assert_eq!(run(&verify.concat()).0, Some(0));
    let (file, picture) = (format!("{waves}/golden.vcd"), format!("{waves}/waves.png"));
    let wave = |signals: &str| {
        run(&[
            "wave",
            &file,
            "--from",
            "270",
            "--to",
            "300",
            "--signals",
            signals,
            "-o",
            &picture,
        ])
    };
    let (code, said) = wave("ray_valid_i,admits,paper_loop.t_s0");
    assert_eq!(code, Some(0), "{said}");
    // The width in the header of a PNG.
    let drawn = fs::read(&picture).expect("a picture");
    let width = u32::from_be_bytes([drawn[16], drawn[17], drawn[18], drawn[19]]);
    assert!(drawn.starts_with(b"\x89PNG") && width > 31 * 20, "{width}");

    let (code, said) = wave("admit");
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("near it: ") && said.lines().count() == 1,
        "{said}"
    );
    let (code, said) = wave("count");
    assert!(
        code == Some(2) && said.contains("name more of its path"),
        "{said}"
    );
}
