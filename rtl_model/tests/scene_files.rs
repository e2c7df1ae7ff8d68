//! Scene files: those of the repository are read, and wrong ones are refused with line and reason.

use std::fs;
use std::path::Path;

use rtl_model::calibration;
use rtl_model::maps::{Channel, MapSource};
use rtl_model::scene::{Scene, SceneError, WalkFormat};

const SOUND: &str = r#"name = "sound"
[map]
source = "maps/stones.png"
channel = "red"
[surface]
side = 200
depth_scale = 10.0
repeat = 4.0
[camera]
eye = [0.0, 10.0, -50.0]
elevation_deg = 20.0
azimuth_deg = 0.0
fov_y_deg = 45.0
[light]
direction = [0.0, 0.0, 1.0]
[frame]
width = 32
height = 24
[walk]
method = "oh"
format = "f64"
[effects]
"#;

fn read(text: &str) -> Result<Scene, SceneError> {
    Scene::from_toml(text, Path::new("scenes/a.toml"))
}

#[test]
fn the_scenes_of_the_repository_are_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        assert_eq!(path.extension(), Some("toml".as_ref()), "{path:?}");
        let scene = Scene::load(&path).unwrap();
        assert_eq!(path.file_stem(), Some(scene.name.as_ref()));
        let map = scene.load_map().unwrap();
        let rays = scene.view().rays(map.size()).unwrap();
        assert!(rays.iter().flatten().count() > rays.len() / 10, "{path:?}");
        names.push(scene.name);
    }
    for expected in ["first", "front", "oblique", "grazing", "small"] {
        assert!(names.iter().any(|name| name == expected), "{expected}");
    }
}

#[test]
fn every_field_is_read() {
    let scene = read(SOUND).unwrap();
    assert_eq!(scene.name, "sound");
    assert_eq!(
        scene.map.source,
        MapSource::File("scenes/maps/stones.png".into())
    );
    assert_eq!(
        (scene.map.channel, scene.map.white_is_low),
        (Channel::Red, false)
    );
    assert_eq!(
        (scene.surface.side, scene.surface.depth_scale),
        (200.0, 10.0)
    );
    assert_eq!(scene.surface.repeat, 4.0);
    assert_eq!(scene.camera.eye, [0.0, 10.0, -50.0]);
    assert_eq!(
        (scene.camera.elevation_deg, scene.camera.azimuth_deg),
        (20.0, 0.0)
    );
    assert_eq!(scene.camera.fov_y_deg, 45.0);
    assert_eq!(scene.light.direction, [0.0, 0.0, 1.0]);
    assert_eq!((scene.frame.width, scene.frame.height), (32, 24));
    assert_eq!(scene.walk.format, WalkFormat::F64);
}

#[test]
fn a_preset_stands_for_the_camera() {
    let numbers = SOUND.find("eye").unwrap()..SOUND.find("[light]").unwrap();
    let mut text = SOUND.to_owned();
    text.replace_range(numbers, "preset = \"grazing\"\n");
    assert_eq!(read(&text).unwrap().camera, calibration::GRAZING);
}

/// What is replaced in the sound scene, by what, and what the message must say.
const FAULTS: [(&str, &str, &[&str]); 26] = [
    (
        "name = \"sound\"",
        "name = \"../sound\"",
        &["line 1", "letters, digits"],
    ),
    (
        "name = \"sound\"",
        "title = \"sound\"",
        &["line 1", "unknown field `title`"],
    ),
    (
        "maps/stones.png",
        "procedural:stones:4:1",
        &["line 3", "bricks, rocks"],
    ),
    ("maps/stones.png", "", &["line 3", "no height map is named"]),
    ("\"red\"", "\"blue\"", &["line 4", "alpha, red, grey"]),
    ("side = 200", "side = 0", &["line 6", "above 0"]),
    ("side = 200", "side = \"wide\"", &["line 6", "expected"]),
    ("side = 200\n", "", &["missing field `side`"]),
    (
        "depth_scale = 10.0",
        "depth_scale = nan",
        &["line 7", "NaN"],
    ),
    (
        "depth_scale = 10.0",
        "depth = 10.0",
        &["line 7", "depth_scale"],
    ),
    ("repeat = 4.0", "repeat = -inf", &["line 8", "above 0"]),
    (
        "[0.0, 10.0, -50.0]",
        "[0.0, 0.0, -50.0]",
        &["line 10", "above the surface"],
    ),
    ("[0.0, 10.0, -50.0]", "[0.0, 10.0]", &["line 10", "3"]),
    (
        "[0.0, 10.0, -50.0]",
        "[nan, 10.0, 0.0]",
        &["line 10", "finite"],
    ),
    (
        "elevation_deg = 20.0",
        "elevation_deg = 91",
        &["line 11", "-90"],
    ),
    (
        "azimuth_deg = 0.0",
        "azimuth_deg = inf",
        &["line 12", "finite"],
    ),
    (
        "fov_y_deg = 45.0",
        "fov_y_deg = 180.0",
        &["line 13", "below 180"],
    ),
    ("fov_y_deg = 45.0\n", "", &["missing fov_y_deg", "preset"]),
    ("fov_y_deg = 45.0", "preset = \"front\"", &["remove `eye`"]),
    (
        "fov_y_deg = 45.0",
        "preset = \"side\"",
        &["line 13", "front, oblique, grazing"],
    ),
    (
        "[0.0, 0.0, 1.0]",
        "[0.0, 1.0, 0.0]",
        &["line 15", "below the surface"],
    ),
    ("width = 32", "width = 0", &["line 17", "1 to 8192"]),
    ("height = 24", "height = 10000", &["line 18", "1 to 8192"]),
    (
        "\"oh\"",
        "\"best\"",
        &["line 20", "unknown method `best`: there is texel, oh"],
    ),
    ("\"f64\"", "\"e7f60\"", &["line 21", "2 to 52"]),
    (
        "[effects]",
        "[effects]\nshadows = true",
        &["line 22", "`shadows`", "no effects yet"],
    ),
];

#[test]
fn faults_are_named_with_line_and_way_out() {
    for (sound, faulty, expected) in FAULTS {
        assert!(SOUND.contains(sound), "{sound}");
        let message = read(&SOUND.replacen(sound, faulty, 1))
            .unwrap_err()
            .to_string();
        for part in [&["scenes/a.toml"], expected].concat() {
            assert!(
                message.contains(part),
                "{faulty}: no `{part}` in: {message}"
            );
        }
    }
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("nowhere.toml");
    let message = Scene::load(&nowhere).unwrap_err().to_string();
    assert!(message.contains("nowhere.toml: no such file"), "{message}");
    let message = Scene::load(folder.path()).unwrap_err().to_string();
    assert!(message.contains("cannot be read"), "{message}");
}
