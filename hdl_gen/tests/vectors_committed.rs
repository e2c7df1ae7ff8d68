//! The vectors in `vectors/`: are they the golden model's, and would a testbench notice if not?

use hdl_gen::netlist::Module;
use hdl_gen::operators::{FloatOperator, OperatorConfiguration, stream_unit};
use hdl_gen::vectors::{Manifest, ManifestFile, VectorPlan, VectorSet, write_vectors};
use hdl_gen::verify::{Icarus, run_vectors_embedded};
use rtl_model::float::{FloatFormat, Rounding};
use rtl_model::scene::Scene;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// Of the files, not of the folders: the corpus has its own test.
fn file_names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    let files = entries.filter(|entry| entry.file_type().unwrap().is_file());
    files
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect()
}

#[test]
fn the_committed_vectors_are_those_the_golden_model_gives_today() {
    let committed = repository("vectors");
    let fresh = tempfile::tempdir().unwrap();
    let plan = VectorPlan::for_scene(Scene::load(&repository("scenes/small.toml")).unwrap());
    write_vectors(&plan, fresh.path()).unwrap();
    assert_eq!(
        file_names(&committed),
        file_names(fresh.path()),
        "vectors/ has other files than are made today; run `make vectors` and commit what changes"
    );
    let mut bytes = 0;
    for name in file_names(fresh.path()) {
        let (old, new) = (committed.join(&name), fresh.path().join(&name));
        let (old, new) = (fs::read(old).unwrap(), fs::read(new).unwrap());
        bytes += new.len();
        assert!(
            old == new,
            "vectors/{name} is not what is made today; run `make vectors` and look at what changed"
        );
    }
    assert!(bytes < 400_000, "{bytes} bytes are too many to commit");
}

#[test]
fn the_manifest_describes_every_file_bit_by_bit() {
    let folder = repository("vectors");
    let manifest = Manifest::read(&folder).unwrap();
    let mut names = BTreeSet::from([Manifest::FILE.to_owned()]);
    for file in &manifest.files {
        let set = file.read(&folder).unwrap();
        assert_eq!(set.vectors.len() as u64, file.vectors, "{}", file.file);
        assert!(file.fields.iter().all(|field| !field.meaning.is_empty()));
        names.insert(file.file.clone());
    }
    assert_eq!(names, file_names(&folder));
}

/// The adder's vectors as committed, with their entry, and the unit they are for.
fn adder() -> (ManifestFile, VectorSet, Arc<Module>) {
    let folder = repository("vectors");
    let manifest = Manifest::read(&folder).unwrap();
    let file = manifest.file("float_add_e7f16_rne.hex").unwrap().clone();
    let set = file.read(&folder).unwrap();
    let format = FloatFormat::E7F16;
    let core =
        OperatorConfiguration::new(FloatOperator::Add, format, Rounding::NearestEven).build(2);
    let unit = stream_unit(&core);
    assert_eq!(unit.name, file.unit);
    (file, set, unit)
}

#[test]
fn one_wrong_bit_in_a_file_is_noticed() {
    let (file, set, _) = adder();
    let folder = tempfile::tempdir().unwrap();
    let mut text = set.to_hex();
    let place = text.len() / 2;
    let other = if text.as_bytes()[place] == b'0' {
        "1"
    } else {
        "0"
    };
    text.replace_range(place..=place, other);
    fs::write(folder.path().join(&file.file), text).unwrap();
    let message = file.read(folder.path()).unwrap_err().to_string();
    assert!(message.contains("SHA-256"), "{message}");
    assert!(message.contains("make vectors"), "{message}");
    fs::remove_file(folder.path().join(&file.file)).unwrap();
    let message = file.read(folder.path()).unwrap_err().to_string();
    assert!(message.contains("float_add_e7f16_rne.hex"), "{message}");
}

#[test]
fn a_testbench_names_the_vector_with_a_wrong_bit() {
    let (_, mut set, unit) = adder();
    let count = set.vectors.len() as u64;
    let vector = 211;
    *set.vectors[vector].last_mut().unwrap() ^= 1 << 7;
    let embedded = run_vectors_embedded(&unit, &set).unwrap();
    let mut verdicts = vec![embedded];
    match Icarus::find() {
        Ok(icarus) => verdicts.push(icarus.run_vectors(&unit, &set).unwrap()),
        Err(missing) => {
            let strict = std::env::var("CI").is_ok_and(|value| value == "true");
            assert!(!strict, "{missing}");
            println!("{missing}: this check is left out");
        }
    }
    for verdict in verdicts {
        assert!(!verdict.passed, "{verdict:?}");
        assert_eq!((verdict.agreed, verdict.vectors), (count - 1, count));
        let [difference] = &verdict.differences[..] else {
            panic!("{verdict:?}");
        };
        assert_eq!(difference.vector, vector as u64);
        assert_eq!(difference.field, "result_o");
        let bits = |hex: &str| u64::from_str_radix(hex, 16).unwrap();
        assert_eq!(bits(&difference.expected) ^ bits(&difference.found), 1 << 7);
    }
}

#[test]
fn damaged_manifests_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let message = |text: &str| {
        fs::write(folder.path().join(Manifest::FILE), text).unwrap();
        Manifest::read(folder.path()).unwrap_err().to_string()
    };
    assert!(message("{").contains("manifest.json"));
    let text = fs::read_to_string(repository("vectors/manifest.json")).unwrap();
    assert!(message(&text.replace("vectors-1", "vectors-9")).contains("stepwell-vectors-9"));
    assert!(message(&text.replacen("\"lsb\": 48", "\"lsb\": 47", 1)).contains("`a_i`"));
    assert!(message(&text.replacen("float e7f16", "float e99f16", 1)).contains("e99f16"));
    fs::remove_file(folder.path().join(Manifest::FILE)).unwrap();
    let missing = Manifest::read(folder.path()).unwrap_err().to_string();
    assert!(missing.contains("make vectors"), "{missing}");
}
