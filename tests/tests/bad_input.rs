//! Bad input gets one clear message and exit code 2, and leaves no half-written output.

use std::fs;
use std::path::Path;

use tests::command_line::{contents, stepwell, workspace};

const MAP: &str = "procedural:spikes:64:1";
const RAYS: &str = "u,v,du,dv\n0.5,0.5,0.25,0.125\n";

/// A folder with a sound scene, rays and an old hit file, in which `stepwell` is run.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Bench {
        let bench = Bench {
            folder: tempfile::tempdir().unwrap(),
        };
        let scene = fs::read_to_string(workspace().join("scenes/small.toml")).unwrap();
        bench.write("scene.toml", scene);
        bench.write("rays.csv", RAYS);
        bench.write("hits.csv", "old");
        bench
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path().join(name), text).unwrap();
    }

    /// The sound scene with `old` replaced, as `scene.toml`.
    fn change_scene(&self, old: &str, new: &str) {
        let path = self.path().join("scene.toml");
        let scene = fs::read_to_string(&path).unwrap();
        assert!(scene.contains(old), "{scene}");
        fs::write(path, scene.replacen(old, new, 1)).unwrap();
    }

    /// Runs a command line that must be refused with one line that has all of `expected`, and
    /// without a trace.
    fn refuses(&self, command_line: &str, expected: &[&str]) {
        let state = || {
            let files = contents(self.path()).into_iter();
            files
                .map(|path| (fs::read(&path).ok(), path))
                .collect::<Vec<_>>()
        };
        let before = state();
        let assert = stepwell()
            .args(command_line.split_whitespace())
            .current_dir(self.path())
            .assert()
            .code(2)
            .stdout("");
        let message = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
        assert!(
            message.starts_with("stepwell: "),
            "{command_line}: {message}"
        );
        assert_eq!(
            message.trim_end().lines().count(),
            1,
            "{command_line}: {message}"
        );
        for part in expected {
            assert!(
                message.contains(part),
                "{command_line}: `{part}` is not in {message}"
            );
        }
        assert!(
            before == state(),
            "{command_line} has left something behind"
        );
    }

    /// Rays that must be refused, whether from a file or from standard input.
    fn refuses_rays(&self, rays: impl AsRef<[u8]>, expected: &[&str]) {
        self.write("rays.csv", &rays);
        let mut in_file = vec!["rays rays.csv"];
        in_file.extend(expected);
        for output in ["", "-o hits.csv", "-o new.csv", "-o new.csv --json"] {
            self.refuses(
                &format!("trace --map {MAP} --rays rays.csv {output}"),
                &in_file,
            );
        }
        let assert = stepwell()
            .args(["trace", "--map", MAP, "--rays", "-"])
            .write_stdin(rays.as_ref())
            .assert()
            .code(2)
            .stdout("");
        let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(message.contains("rays standard input"), "{message}");
    }
}

#[test]
fn sound_input_is_taken() {
    let bench = Bench::new();
    for command_line in [
        "render scene.toml -o pictures",
        "plan scene.toml",
        "trace --map procedural:spikes:64:1 --rays rays.csv -o hits.csv",
    ] {
        stepwell()
            .args(command_line.split_whitespace())
            .current_dir(bench.path())
            .assert()
            .code(0)
            .stderr("");
    }
}

#[test]
fn maps_that_are_missing_or_of_a_wrong_size() {
    let bench = Bench::new();
    bench.write("wide.pgm", [b"P5 4 3 255\n".as_slice(), &[7; 12]].concat());
    bench.write("odd.pgm", [b"P5 3 3 255\n".as_slice(), &[7; 9]].concat());
    bench.write("text.png", "no picture");
    bench.write("grey.pgm", [b"P5 2 2 255\n".as_slice(), &[7; 4]].concat());
    for (map, expected) in [
        ("none.png", ["none.png", "no such file", "check the path"]),
        (
            "wide.pgm",
            ["wide", "4 x 3 texels are not a square", "2 x 2"],
        ),
        ("odd.pgm", ["odd", "not a power of two", "2 x 2 or 4 x 4"]),
        ("text.png", ["text.png", "not a PNG", "convert"]),
        (
            "procedural:rocks:100:1",
            ["--map", "not a power of two", "64 x 64 or 128 x 128"],
        ),
        (
            "procedural:sand:64:1",
            ["--map", "`sand`", "there are bricks"],
        ),
    ] {
        bench.refuses(
            &format!("render scene.toml --map {map} -o pictures"),
            &expected,
        );
        bench.refuses(&format!("plan scene.toml --map {map}"), &expected);
        bench.refuses(
            &format!("trace --map {map} --rays rays.csv -o hits.csv"),
            &expected,
        );
    }
    bench.refuses(
        "trace --map grey.pgm --channel alpha --rays rays.csv",
        &["grey.pgm", "no alpha channel", "--channel grey"],
    );
    bench.change_scene("procedural:spikes:64:1", "none.tga");
    bench.refuses("render scene.toml -o pictures", &["none.tga: no such file"]);
}

#[test]
fn options_that_do_not_exist() {
    let bench = Bench::new();
    for (options, expected) in [
        (
            "--method maximum",
            ["--method", "unknown method `maximum`", "there is texel, oh"],
        ),
        (
            "--format f32",
            ["--format", "unknown format `f32`", "such as e7f16"],
        ),
        (
            "--format e7f99",
            ["--format", "99 fraction bits", "2 to 52"],
        ),
        ("--threads 0", ["--threads", "`0`", "1 to 1024"]),
    ] {
        bench.refuses(
            &format!("render scene.toml -o pictures {options}"),
            &expected,
        );
        bench.refuses(
            &format!("trace --map {MAP} --rays rays.csv -o hits.csv {options}"),
            &expected,
        );
    }
    bench.refuses(
        "render scene.toml -o pictures --size 320",
        &["--size", "`320` is not a size", "such as 320x240"],
    );
    bench.refuses(
        &format!("trace --map {MAP} --rays rays.csv --channel blue"),
        &["--channel", "unknown channel `blue`", "alpha, red, grey"],
    );
    bench.refuses(
        &format!("trace --map {MAP} --rays rays.csv --json"),
        &["--json", "give the hits a file with -o"],
    );
    // What the parser of the command line finds has its own customary words.
    for command_line in [
        "",
        "rendr",
        "render",
        "render scene.toml --camera top",
        "trace --rays r",
    ] {
        stepwell()
            .args(command_line.split_whitespace())
            .current_dir(bench.path())
            .assert()
            .code(2)
            .stdout("");
    }
}

#[test]
fn scenes_that_are_none() {
    let refuses = |old: &str, new: &str, expected: &[&str]| {
        let bench = Bench::new();
        bench.change_scene(old, new);
        let mut in_scene = vec!["scene scene.toml", "line"];
        in_scene.extend(expected);
        bench.refuses("render scene.toml -o pictures", &in_scene);
        bench.refuses("plan scene.toml", &in_scene);
    };
    refuses("[map]", "[map", &[]);
    refuses(
        "[map]",
        "[map]\ncolour = 3",
        &["unknown field `colour`", "`source`"],
    );
    refuses(
        "[frame]",
        "[effects]\nsoft_shadows = true\n[frame]",
        &["unknown effect `soft_shadows`"],
    );
    refuses(
        "\"oh\"",
        "\"maximum\"",
        &["unknown method `maximum`", "there is texel, oh"],
    );
    refuses(
        "\"e7f16\"",
        "\"quarter\"",
        &["unknown format `quarter`", "such as e7f16"],
    );
    refuses("width = 32", "width = 0", &["0 pixels", "1 to 8192"]);
    let bench = Bench::new();
    bench.refuses("render none.toml", &["scene none.toml", "no such file"]);
    bench.write("bytes.toml", [0xff, 0xfe, 0]);
    bench.refuses("render bytes.toml", &["scene bytes.toml", "cannot be read"]);
}

#[test]
fn a_camera_too_low_names_its_pixel() {
    let bench = Bench::new();
    bench.change_scene("depth_scale = 25.0", "depth_scale = 1e9");
    bench.refuses(
        "render scene.toml -o pictures",
        &["pixel (", "`d", "depth_scale"],
    );
    bench.refuses("plan scene.toml", &["pixel ("]);
}

#[test]
fn rays_that_are_none() {
    let bench = Bench::new();
    let line = |ray: &str| format!("{RAYS}{ray}\n0.5,0.5,0.5,0.5\n");
    for (ray, expected) in [
        ("0.5,nan,0,0", ["line 3", "`v` is NaN", "finite"]),
        ("0.5,0.5,0,-inf", ["line 3", "`dv` is -inf", "finite"]),
        (
            "0.5,0.5,1e999,0",
            ["line 3", "`du` is `1e999`", "largest f64"],
        ),
        ("0.5,0.5,half,0", ["line 3", "`du` is `half`", "hex float"]),
        ("0x1.8,0x1p,0,0", ["line 3", "`v` is `0x1p`", "hex float"]),
        ("0.5,0.5,,0", ["line 3", "`du` is missing", "u,v,du,dv"]),
        (
            "0.5,0.5,0",
            ["line 3", "3 fields, `dv` is missing", "u,v,du,dv"],
        ),
        ("0.5", ["line 3", "1 field, `v` is missing", "u,v,du,dv"]),
        ("0.5,0.5,0,0,0", ["line 3", "5 fields", "u,v,du,dv"]),
        ("", ["line 3", "blank", "u,v,du,dv"]),
        ("0.5,0.5,1e6,0", ["line 3", "`du` is 1000000", "steeper"]),
    ] {
        bench.refuses_rays(line(ray), &expected);
    }
    bench.refuses_rays("", &["empty", "u,v,du,dv"]);
    bench.refuses_rays("0.5,0.5,0,0\n", &["line 1", "`0.5,0.5,0,0`", "u,v,du,dv"]);
    bench.refuses_rays("u,v,dv,du\n", &["line 1", "`u,v,dv,du`", "u,v,du,dv"]);
    bench.refuses_rays(b"u,v,du,dv\n0.5,0.5,\xff,0\n", &["line 2", "UTF-8"]);
    bench.refuses_rays(
        "u,v,du,dv\n".to_owned() + &"1".repeat(1 << 17),
        &["line 2", "longer than"],
    );
    bench.refuses(
        &format!("trace --map {MAP} --rays none.csv"),
        &["rays none.csv", "No such file"],
    );
    bench.write("rays.csv", "u,v,du,dv\n0.5,0.5,7,0\n");
    bench.refuses(
        &format!("trace --map {MAP} --rays rays.csv --format e2f12"),
        &["line 2", "`du` is 7", "e2f12 cannot hold", "3.9995"],
    );
    bench.refuses(
        &format!("trace --map {MAP} --rays rays.csv --format e4f3"),
        &[
            "line 2",
            "`du` is 7",
            "448 texels",
            "the 2 that e4f3 tells apart",
        ],
    );
}

/// The tests may run as the one who may write everywhere, so the places are such as nobody can.
#[test]
fn outputs_that_cannot_be_written() {
    let bench = Bench::new();
    bench.write("file", "in the way");
    fs::create_dir_all(bench.path().join("taken/steps.png")).unwrap();
    for (folder, expected) in [
        ("file", "it is a file"),
        ("file/pictures", "cannot be written"),
        ("file/more/pictures", "cannot be written"),
        ("taken", "steps.png in it is a folder"),
    ] {
        let expected = [&format!("output folder {folder}"), expected, "-o"];
        bench.refuses(&format!("render scene.toml -o {folder}"), &expected);
        bench.refuses(&format!("render scene.toml -o {folder} --json"), &expected);
    }
    for (file, expected) in [
        ("file/hits.csv", "cannot be written"),
        ("none/hits.csv", "cannot be written"),
        ("taken", "it is a folder"),
    ] {
        bench.refuses(
            &format!("trace --map {MAP} --rays rays.csv -o {file}"),
            &["output ", file, expected, "-o"],
        );
    }
    #[cfg(target_os = "linux")]
    bench.refuses(
        "render scene.toml -o /proc/stepwell/pictures",
        &["output folder /proc/stepwell/pictures", "cannot be written"],
    );
}
