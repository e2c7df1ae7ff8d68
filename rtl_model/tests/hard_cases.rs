//! The corpus of hard cases: complete, and right by two routes that share nothing with a traversal.

use rayon::prelude::*;
use rtl_model::hard::{HardCase, HardFamily, PreparedCase};
use rtl_model::judge::{JudgeError, Judgement};
use rtl_model::scene::{Crossing, Method};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, fs};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/hard")
}

fn corpus() -> Vec<HardCase> {
    HardCase::load_folder(&folder()).unwrap()
}

#[test]
fn every_file_is_a_case_and_every_family_has_some() {
    let corpus = corpus();
    let files = fs::read_dir(folder()).unwrap();
    let files = files.map(|entry| entry.unwrap().file_name());
    let cases = files.filter(|name| name != "oracle.py" && name != "__pycache__");
    assert_eq!(cases.count(), corpus.len());
    for family in HardFamily::ALL {
        let cases = corpus.iter().filter(|case| case.family == family);
        assert!(cases.count() > 0, "{family}");
    }
}

/// On each axis, travelling each way and not at all: in every family but the one that is about the
/// last.
#[test]
fn every_family_travels_both_ways() {
    let corpus = corpus();
    for family in HardFamily::ALL {
        let cases = corpus.iter().filter(|case| case.family == family);
        let rays: Vec<_> = cases.flat_map(|case| &case.rays).collect();
        let has = |of: fn(f64, f64) -> bool| rays.iter().any(|ray| of(ray.ray.du, ray.ray.dv));
        assert!(
            has(|du, _| du > 0.0) && has(|du, _| du < 0.0),
            "{family}: u"
        );
        assert!(
            has(|_, dv| dv > 0.0) && has(|_, dv| dv < 0.0),
            "{family}: v"
        );
    }
}

#[test]
fn the_exact_reference_gives_every_expected_hit() {
    let mut rays = 0;
    for case in corpus() {
        for (number, ray) in case.rays.iter().enumerate() {
            let met = ray.met_in(&case.map).unwrap();
            assert_eq!(met, ray.expected, "{} ray {}", case.name, number + 1);
            rays += 1;
        }
    }
    assert!(rays >= 600, "{rays}");
}

/// Python's answer; none where there is no Python, which in CI is a failure.
fn oracle(arguments: &[&Path]) -> Option<Output> {
    let program = folder().join("oracle.py");
    let output = Command::new("python3")
        .arg(program)
        .args(arguments)
        .output();
    if output.is_err() {
        assert!(
            env::var("CI").is_err(),
            "python3 is not installed, and the cases have not been recomputed"
        );
        println!("python3 is not installed: this part is left out");
    }
    output.ok()
}

#[test]
fn the_independent_oracle_gives_every_expected_hit() {
    let Some(output) = oracle(&[]) else { return };
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let corpus = corpus();
    let rays: usize = corpus.iter().map(|case| case.rays.len()).sum();
    let sum = format!("{rays} rays of {} cases, 0 differ", corpus.len());
    assert!(text.contains(&sum), "{text}");
}

/// A height, a ray, and each part of an expectation, changed in a copy: both routes see it.
#[test]
fn a_planted_fault_is_seen_by_both_routes() {
    let name = "hit_a_height_step_beside_a_border";
    let text = fs::read_to_string(folder().join(name).with_extension("toml")).unwrap();
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join(name).with_extension("toml");
    for (from, to) in [
        ("52429", "52430"),
        ("du = \"1.25\"", "du = \"-1.25\""),
        ("i = 0", "i = 1"),
        ("j = 0", "j = 3"),
        ("depth = \"1/5\"", "depth = \"13106/65535\""),
        ("on = \"top\"", "on = \"side\""),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        fs::write(&path, changed).unwrap();
        let case = HardCase::load(&path).unwrap();
        let is_wrong =
            |ray: &rtl_model::hard::HardRay| ray.met_in(&case.map).unwrap() != ray.expected;
        assert!(case.rays.iter().any(is_wrong), "{from}: {to}");
        let Some(output) = oracle(&[&path]) else {
            return;
        };
        assert_eq!(output.status.code(), Some(1), "{from}: {to}");
    }
    for text in [
        text.replace("note", "remark"),
        text.replace("bits", "bit"),
        String::new(),
    ] {
        fs::write(&path, text.replace("[map]", "[map]\nremark = 1")).unwrap();
        assert!(HardCase::load(&path).is_err());
        let Some(output) = oracle(&[&path]) else {
            return;
        };
        assert_eq!(output.status.code(), Some(2));
    }
}

/// Method by method, format by format: what is promised is kept on every case.
#[test]
fn every_promise_is_kept() {
    let corpus = corpus();
    let formats = ["e7f16", "e8f23", "f64", "exact", "fixed"];
    let walked: u64 = corpus
        .par_iter()
        .map(|case| formats.map(|format| promises_kept(case, format)))
        .flatten_iter()
        .sum();
    // Sixteen safe methods in five formats, two more in fixed point, and three that sample in four.
    assert!(walked > (16 * 5 + 2 + 3 * 4) * 600, "{walked}");
}

/// Rays walked.
fn promises_kept(case: &HardCase, format: &str) -> u64 {
    let prepared = PreparedCase::new(case, format.parse().unwrap()).unwrap();
    let levels = [1, 3, 4].map(Method::MultiLevelDown);
    let methods = Method::ALL.into_iter().chain(levels);
    let assessments = methods.chain(Method::FIXED_ONLY).map(|method| {
        match prepared.assess(method, Crossing::Index) {
            Ok(assessment) => {
                let defects: Vec<_> = assessment.defects().collect();
                assert_eq!(defects, [], "{} by {method} in {format}", case.name);
                assessment.walked()
            }
            // Samplers do not walk in fixed point, bounds do nowhere else.
            Err(JudgeError::Walk(_)) if method.is_safe() == (format != "fixed") => {
                assert!(!method.is_safe() || Method::FIXED_ONLY.contains(&method));
                0
            }
            Err(other) => panic!("{}: {other}", case.name),
        }
    });
    assessments.sum()
}

/// Not every case is easy: a walk that rounds is wrong in some, and never late.
#[test]
fn the_corpus_tells_formats_apart() {
    let corpus = corpus();
    let mut early = 0;
    for case in &corpus {
        let prepared = PreparedCase::new(case, "e7f16".parse().unwrap()).unwrap();
        let assessment = prepared.assess(Method::Oh, Crossing::Index).unwrap();
        early += assessment.count(Judgement::Early);
        assert_eq!(
            assessment.has_passed(),
            assessment.walked() == assessment.count(Judgement::Right)
        );
    }
    assert!(early > 0);
}
