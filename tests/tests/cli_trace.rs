//! `stepwell trace`, by which strangers check the golden model: its files, its numbers, its bits.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use rtl_model::exact::exact_hit;
use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::frame::walk_rays;
use rtl_model::maps::{Channel, HeightMap, MapSource, Pyramid};
use rtl_model::ray::{self, Ray};
use rtl_model::scene::{Crossing, Method, Walk, WalkFormat};
use rtl_model::units::traverse::{Hit, Status};
use serde_json::Value;
use tests::command_line::{contents, stepwell};

const MAP: &str = "procedural:spikes:64:1";
const HEADER: &str = "i,j,t,u,v,steps,crossings,status";

fn map() -> HeightMap {
    let source: MapSource = MAP.parse().unwrap();
    source.load(Channel::Grey, false).unwrap()
}

/// Rays of all directions, and among them those that are hard: on texel borders, through corners,
/// along an axis, straight down, and beyond the first repeat.
fn rays(count: u32) -> Vec<Ray<f64>> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut rays: Vec<Ray<f64>> = (0..count)
        .map(|_| Ray {
            u: 4.0 * random() - 2.0,
            v: random(),
            du: 2.0 * random() - 1.0,
            dv: 2.0 * random() - 1.0,
        })
        .collect();
    for (u, v) in [
        (0.0, 0.0),
        (0.5, 0.25),
        (1.0 / 64.0, 63.0 / 64.0),
        (-0.5, 7.0),
    ] {
        for (du, dv) in [
            (0.0, 0.0),
            (0.5, 0.0),
            (0.0, -0.5),
            (-0.75, 0.75),
            (1.0, 1.0),
        ] {
            rays.push(Ray { u, v, du, dv });
        }
    }
    rays
}

fn decimal(value: f64) -> String {
    format!("{value:?}")
}

/// As C's `%a` writes it.
fn hexadecimal(value: f64) -> String {
    let bits = value.to_bits();
    let sign = if value.is_sign_negative() { "-" } else { "" };
    if value == 0.0 {
        return format!("{sign}0x0p+0");
    }
    let exponent = (bits >> 52 & 0x7ff) as i64 - 1023;
    format!("{sign}0x1.{:013x}p{exponent:+}", bits & ((1 << 52) - 1))
}

fn ray_file(rays: &[Ray<f64>], number: fn(f64) -> String) -> String {
    let mut text = "u,v,du,dv\n".to_owned();
    for ray in rays {
        let ray = ray.map(number);
        writeln!(text, "{},{},{},{}", ray.u, ray.v, ray.du, ray.dv).unwrap();
    }
    text
}

/// The hit file for a ray file given on standard input.
fn trace(rays: &str, options: &[&str]) -> String {
    let assert = stepwell()
        .args(["trace", "--map", MAP, "--rays", "-"])
        .args(options)
        .write_stdin(rays)
        .assert()
        .code(0)
        .stderr("");
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

fn parse_hits(text: &str) -> Vec<Hit<f64>> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(HEADER));
    lines
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let [i, j, t, u, v, steps, crossings, status] = fields[..] else {
                panic!("{line}");
            };
            Hit {
                i: i.parse().unwrap(),
                j: j.parse().unwrap(),
                t: t.parse().unwrap(),
                u: u.parse().unwrap(),
                v: v.parse().unwrap(),
                steps: steps.parse().unwrap(),
                crossings: crossings.parse().unwrap(),
                status: match status {
                    "hit" => Status::Hit,
                    "guard" => Status::Guard,
                    _ => panic!("{line}"),
                },
            }
        })
        .collect()
}

#[test]
fn exact_hits_are_those_of_the_definition() {
    let (map, rays) = (map(), rays(400));
    let hits = parse_hits(&trace(&ray_file(&rays, decimal), &["--format", "exact"]));
    assert_eq!(hits.len(), rays.len());
    for (ray, hit) in rays.into_iter().zip(hits) {
        let ray = ray::check(ray, map.size()).unwrap();
        let truth = exact_hit(&map, ray).unwrap();
        assert_eq!((hit.i, hit.j), (truth.i, truth.j), "{ray:?}");
        assert_eq!(hit.status, Status::Hit);
        assert!((hit.t - truth.t.to_f64()).abs() <= f64::EPSILON, "{ray:?}");
        assert!((hit.u - (ray.u + hit.t * ray.du)).abs() < 1e-14, "{ray:?}");
        assert!((hit.v - (ray.v + hit.t * ray.dv)).abs() < 1e-14, "{ray:?}");
    }
}

#[test]
fn hits_read_back_to_the_bits_of_the_model() {
    let rays = rays(2000);
    let map = map();
    let pyramid = Pyramid::new(&map);
    let text = ray_file(&rays, decimal);
    for format in ["e7f16", "e5f10", "f64", "exact"] {
        let walk = Walk {
            method: Method::Oh,
            crossing: Crossing::Index,
            format: format.parse().unwrap(),
        };
        let rays = if format == "exact" {
            &rays[..100]
        } else {
            &rays[..]
        };
        let text: String = text
            .lines()
            .take(rays.len() + 1)
            .map(|line| line.to_owned() + "\n")
            .collect();
        let expected = walk_rays(walk, &pyramid, rays, &|_| ()).unwrap();
        let hits = parse_hits(&trace(&text, &["--format", format]));
        let bits = |hit: &Hit<f64>| [hit.t, hit.u, hit.v].map(f64::to_bits);
        assert_eq!(hits, expected, "{format}");
        assert!(
            hits.iter().map(bits).eq(expected.iter().map(bits)),
            "{format}"
        );
        if let WalkFormat::Float(float) = walk.format {
            for value in hits.iter().flat_map(|hit| [hit.t, hit.u, hit.v]) {
                assert!(is_in(float, value), "{value} is not of {format}");
            }
        }
    }
}

/// Is it a number of the format, to the last bit?
fn is_in(format: FloatFormat, value: f64) -> bool {
    let held = format.to_f64(format.from_f64(Rounding::NearestEven, value));
    held.to_bits() == value.to_bits()
}

#[test]
fn threads_change_no_bit() {
    let text = ray_file(&rays(5000), decimal);
    for format in ["e7f16", "f64"] {
        let all = trace(&text, &["--format", format]);
        assert_eq!(all.lines().count(), 5021);
        for threads in ["1", "2", "3"] {
            assert_eq!(
                trace(&text, &["--format", format, "--threads", threads]),
                all
            );
        }
    }
}

#[test]
fn e7f16_and_oh_are_what_is_walked_unless_told() {
    let text = ray_file(&rays(300), decimal);
    let plain = trace(&text, &[]);
    assert_eq!(
        trace(&text, &["--format", "e7f16", "--method", "oh"]),
        plain
    );
    assert_ne!(trace(&text, &["--format", "f64"]), plain);
    assert_ne!(trace(&text, &["--white-is-low"]), plain);
}

#[test]
fn rays_are_read_however_they_are_written() {
    let rays = rays(300);
    let plain = ray_file(&rays, decimal);
    let hits = trace(&plain, &[]);
    for other in [
        ray_file(&rays, hexadecimal),
        plain.replace('\n', "\r\n"),
        plain.replace(',', " , "),
        format!("\u{feff}{plain}"),
        plain.trim_end().to_owned(),
        format!("{plain}\n\n"),
    ] {
        assert_eq!(trace(&other, &[]), hits, "{}", &other[..60]);
    }
}

#[test]
fn no_rays_have_no_hits() {
    assert_eq!(trace("u,v,du,dv\n", &[]), format!("{HEADER}\n"));
}

#[test]
fn a_hit_file_is_what_standard_output_is_and_replaces_the_old_one() {
    let folder = tempfile::tempdir().unwrap();
    let (rays_file, hits_file) = (folder.path().join("r.csv"), folder.path().join("h.csv"));
    for count in [50, 20] {
        let text = ray_file(&rays(count), decimal);
        fs::write(&rays_file, &text).unwrap();
        let assert = run_on_files(&rays_file, &hits_file, &[]);
        let table = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
        for expected in [MAP, "oh in e7f16", "guards", "h.csv"] {
            assert!(table.contains(expected), "{table}");
        }
        assert_eq!(fs::read_to_string(&hits_file).unwrap(), trace(&text, &[]));
    }
    assert_eq!(contents(folder.path()), [hits_file, rays_file]);
}

fn run_on_files(rays: &Path, hits: &Path, options: &[&str]) -> assert_cmd::assert::Assert {
    stepwell()
        .args(["trace", "--map", MAP, "--rays"])
        .arg(rays)
        .arg("-o")
        .arg(hits)
        .args(options)
        .assert()
        .code(0)
        .stderr("")
}

#[test]
fn the_json_summary_is_alone_on_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let (rays_file, hits_file) = (folder.path().join("r.csv"), folder.path().join("h.csv"));
    fs::write(&rays_file, ray_file(&rays(50), decimal)).unwrap();
    let assert = run_on_files(&rays_file, &hits_file, &["--json", "--format", "e5f10"]);
    let summary: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let hits = parse_hits(&fs::read_to_string(&hits_file).unwrap());
    let sum = |of: fn(&Hit<f64>) -> u32| hits.iter().map(|hit| u64::from(of(hit))).sum::<u64>();
    assert_eq!(summary["schema"], "stepwell-trace-1");
    assert_eq!(summary["rays"], 70);
    assert_eq!(summary["guards"], 0);
    assert_eq!(summary["format"], "e5f10");
    assert_eq!(summary["method"], "oh");
    assert_eq!(summary["map"], MAP);
    assert_eq!(summary["steps"]["total"], sum(|hit| hit.steps));
    assert_eq!(summary["crossings"]["total"], sum(|hit| hit.crossings));
    assert_eq!(
        summary["steps"]["max"],
        hits.iter().map(|hit| hit.steps).max().unwrap()
    );
    assert!(summary["seconds"].as_f64().unwrap() > 0.0);
    // Nothing was compared, and it does not pretend to.
    for key in [
        "mismatches",
        "cycles",
        "signals_compared",
        "cycles_compared",
        "simulator",
    ] {
        assert_eq!(summary.get(key), Some(&Value::Null), "{key}");
    }
}
