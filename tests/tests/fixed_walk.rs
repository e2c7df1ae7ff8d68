//! Fixed point on the command line: the format chosen from the rays and said with its reason, rays
//! beyond a format counted, and every hit the exact one.

use std::fs;
use std::path::Path;

use rtl_model::exact::exact_hit;
use rtl_model::maps::{Channel, MapSource, Pyramid};
use rtl_model::ray::{self, Ray};
use rtl_model::ray_format::RayFormat;
use serde_json::Value;
use tests::command_line::{stepwell, workspace};

fn render(folder: &Path, options: &[&str]) -> (Value, String) {
    let assert = stepwell()
        .arg("render")
        .arg(workspace().join("scenes/small.toml"))
        .arg("-o")
        .arg(folder)
        .arg("--json")
        .args(options)
        .assert()
        .code(0);
    let output = assert.get_output();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    (serde_json::from_slice(&output.stdout).unwrap(), told)
}

#[test]
fn the_format_is_chosen_from_the_rays_and_said_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    for method in ["oh", "mixed-coherent", "block"] {
        let (summary, told) = render(folder.path(), &["--format", "fixed", "--method", method]);
        assert_eq!((&summary["guards"], told.as_str()), (&0.into(), ""));
        let format = &summary["ray_format"];
        assert_eq!(summary["format"], format["slopes"]);
        assert_eq!(format["entries"], "uq6.12");
        assert_eq!(format["saturated"], 0);
        let reasons = format["reasons"].to_string();
        for part in ["interval arithmetic", "12 of an entry and 8 of a height"] {
            assert!(reasons.contains(part), "{reasons}");
        }
        assert_eq!(summary["early_bound"]["depth"], 0.0);
    }
    let (summary, _) = render(folder.path(), &["--format", "e7f16"]);
    assert_eq!(summary.get("ray_format"), None);
    assert!(summary["early_bound"]["missed_texels"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_plan_says_how_wide_each_signal_must_be() {
    let plan = |format: &str| -> Value {
        let assert = stepwell()
            .arg("plan")
            .arg(workspace().join("scenes/small.toml"))
            .args(["--json", "--method", "drobot", "--format", format])
            .assert()
            .code(0);
        serde_json::from_slice(&assert.get_output().stdout).unwrap()
    };
    let fixed = plan("fixed");
    let bits = |name: &str| {
        let signals = fixed["signals"].as_array().unwrap();
        let signal = signals.iter().find(|signal| signal["name"] == name);
        signal.unwrap_or_else(|| panic!("{name} is not there"))["bits"]
            .as_u64()
            .unwrap()
    };
    // An entry of 6 + 12 bits, mirrored or not; a height; a position no wider than its register.
    assert_eq!(bits("mirrored_u"), 19);
    assert_eq!(bits("node_depth"), 9);
    assert!(bits("position_u") > 20 && bits("position_u") <= 36);
    assert_eq!(fixed["reasons"].as_array().unwrap().len(), 3);
    assert_eq!(plan("e7f16").get("signals"), None);
}

#[test]
fn rays_beyond_a_format_are_saturated_counted_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let (chosen, _) = render(folder.path(), &["--format", "fixed"]);
    let (wider, told) = render(folder.path(), &["--format", "q8.20"]);
    assert_eq!(
        (&wider["ray_format"]["saturated"], told.as_str()),
        (&0.into(), "")
    );
    // The answer does not depend on the integer bits, if no ray is saturated.
    assert_eq!(chosen["steps"], wider["steps"]);
    // Slopes below 1/4 texel: none of the walk's formats is so narrow with these rays.
    let options = ["--format", "q1.20", "--map", "procedural:spikes:1024:1"];
    let (narrow, told) = render(folder.path(), &options);
    let saturated = narrow["ray_format"]["saturated"].as_u64().unwrap();
    assert!(saturated > 0 && saturated <= narrow["rays"].as_u64().unwrap());
    assert!(
        told.contains(&format!("{saturated} of ")) && told.contains("--format fixed"),
        "{told}"
    );
}

#[test]
fn traced_rays_have_the_exact_hits_of_the_quantised_ones() {
    let folder = tempfile::tempdir().unwrap();
    let (rays_file, hits_file) = (folder.path().join("r.csv"), folder.path().join("h.csv"));
    let mut rays = Vec::new();
    let mut text = "u,v,du,dv\n".to_owned();
    for n in 0..500 {
        let n = f64::from(n);
        let ray = Ray {
            u: (n * 0.37).sin(),
            v: (n * 0.91).cos(),
            du: (n * 1.3).sin() * 3.0,
            dv: if n % 7.0 == 0.0 { 0.0 } else { (n * 2.1).cos() },
        };
        text += &format!("{},{},{},{}\n", ray.u, ray.v, ray.du, ray.dv);
        rays.push(ray);
    }
    fs::write(&rays_file, text).unwrap();
    let source = "procedural:spikes:64:1";
    let map = source.parse::<MapSource>().unwrap();
    let map = map.load(Channel::Grey, false).unwrap();
    let format = RayFormat::within_reach(&Pyramid::new(&map));
    for (method, name) in [("tevs", "fixed"), ("quad", "fixed"), ("drobot", "q8.20")] {
        let assert = stepwell()
            .args([
                "trace", "--map", source, "--format", name, "--method", method,
            ])
            .arg("--rays")
            .arg(&rays_file)
            .arg("-o")
            .arg(&hits_file)
            .assert()
            .code(0);
        let table = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
        for part in ["ray format", "saturated", "early by", "the very texel"] {
            assert!(table.contains(part), "{table}");
        }
        let hits = fs::read_to_string(&hits_file).unwrap();
        assert_eq!(hits.lines().count(), rays.len() + 1);
        for (line, ray) in hits.lines().skip(1).zip(&rays) {
            let fields: Vec<&str> = line.split(',').collect();
            let ray = ray::check(*ray, map.size()).unwrap();
            let truth = exact_hit(&map, format.entered(&format.quantise(ray))).unwrap();
            assert_eq!(
                (fields[0], fields[1]),
                (&*truth.i.to_string(), &*truth.j.to_string())
            );
            let t: f64 = fields[2].parse().unwrap();
            assert!(truth.t.compare_with(t).is_ge() && truth.t.compare_with(t.next_up()).is_lt());
            assert_eq!(fields[7], "hit");
        }
    }
}

#[test]
fn a_format_without_a_walk_is_refused_with_the_way_out() {
    for (format, part) in [
        ("q8.4", "such as q8.20; or take `fixed`"),
        ("q8.40", "take fewer bits, or `fixed`"),
        ("uq8.20", "a slope has a sign"),
    ] {
        let assert = stepwell()
            .args([
                "trace",
                "--map",
                "procedural:flat:4:9",
                "--rays",
                "-",
                "--format",
                format,
            ])
            .write_stdin("u,v,du,dv\n0,0,0,0\n")
            .assert()
            .code(2)
            .stdout("");
        let message = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(message.contains(part), "{message}");
    }
}
