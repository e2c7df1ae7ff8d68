//! The corpus in `vectors/fp24`: is it the golden arithmetic's, is it right by its own independent
//! oracle, and would that see a wrong line?

use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use hdl_gen::corpus::{CorpusManifest, CorpusPlan, write_corpus};
use rtl_model::float::{Flags, FloatFormat, Policy, Rounding};

/// What stands beside the corpus and is written by hand.
const BY_HAND: [&str; 2] = ["README.md", "oracle.py"];

fn committed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/fp24")
}

fn file_names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    let names = entries.map(|entry| entry.file_name().into_string().unwrap());
    // Python keeps what it compiled.
    names.filter(|name| name != "__pycache__").collect()
}

fn manifest(folder: &Path) -> CorpusManifest {
    let text = fs::read_to_string(folder.join(CorpusManifest::FILE)).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn the_committed_corpus_is_what_the_golden_model_gives_today() {
    let committed = committed();
    let fresh = tempfile::tempdir().unwrap();
    let plan = CorpusPlan::for_format(FloatFormat::E7F16);
    let written = write_corpus(&plan, fresh.path()).unwrap();
    assert_eq!(written, manifest(fresh.path()));
    let mut expected = file_names(fresh.path());
    expected.extend(BY_HAND.map(str::to_owned));
    assert_eq!(
        expected,
        file_names(&committed),
        "run `make vectors` and commit what changes"
    );
    let mut bytes = 0;
    for name in file_names(fresh.path()) {
        let old = fs::read(committed.join(&name)).unwrap();
        let new = fs::read(fresh.path().join(&name)).unwrap();
        bytes += new.len();
        assert!(
            old == new,
            "vectors/fp24/{name} is not what is made today; run `make vectors` and look at what \
             changed"
        );
    }
    assert!(bytes < 3_500_000, "{bytes} bytes are too many to commit");
}

/// Every operator under every rounding and policy, and every flag of each raised somewhere.
#[test]
fn the_corpus_covers_what_there_is() {
    let folder = committed();
    let manifest = manifest(&folder);
    for operation in CorpusPlan::for_format(FloatFormat::E7F16).operations() {
        let name = operation.to_string();
        let files = manifest.files.iter().filter(|file| file.operator == name);
        let combinations: BTreeSet<(&str, &str)> = files
            .map(|file| (file.rounding.as_str(), file.policy.as_str()))
            .collect();
        let roundings = if operation.rounds() {
            Rounding::ALL.len()
        } else {
            1
        };
        assert_eq!(combinations.len(), roundings * Policy::ALL.len(), "{name}");
    }
    let raised = |operator: &str| {
        let mut raised = Flags::NONE;
        for file in manifest
            .files
            .iter()
            .filter(|file| file.operator == operator)
        {
            let text = fs::read_to_string(folder.join(&file.file)).unwrap();
            assert_eq!(text.lines().count() as u64, file.lines);
            for line in text.lines() {
                let words: Vec<&str> = line.split(' ').collect();
                assert_eq!(words.len(), file.columns.len());
                for (word, column) in words.iter().zip(&file.columns) {
                    let digits = column.width.div_ceil(4) as usize;
                    assert_eq!(word.len(), digits, "{}: {line}", file.file);
                }
                let flags = words.last().unwrap();
                raised |= Flags::from_bits(u8::from_str_radix(flags, 16).unwrap());
            }
        }
        raised
    };
    let rounded = Flags::INEXACT | Flags::UNDERFLOW | Flags::OVERFLOW | Flags::INVALID;
    for operator in ["add", "sub", "mul", "fused_multiply_add", "from_e8f23"] {
        assert_eq!(raised(operator), rounded, "{operator}");
    }
    assert_eq!(raised("div"), rounded | Flags::DIVIDE_BY_ZERO);
    assert_eq!(raised("sqrt"), Flags::INEXACT | Flags::INVALID);
    assert_eq!(raised("round_to_integral"), Flags::INVALID);
    assert_eq!(raised("to_i32_exact"), Flags::INEXACT | Flags::INVALID);
    assert_eq!(raised("less_than_quiet"), Flags::INVALID);
}

/// Python 3 with these arguments, or none if it is not installed: in CI that is a failure.
fn python(arguments: &[&Path]) -> Option<Output> {
    let output = Command::new("python3")
        .arg("-B")
        .args(arguments)
        .output()
        .ok();
    if output.is_none() {
        assert!(
            env::var("CI").is_err(),
            "python3 is not installed, and the corpus has not been recomputed"
        );
        println!("python3 is not installed: this part is left out");
    }
    output
}

#[test]
fn the_independent_oracle_agrees_with_every_line() {
    let oracle = committed().join("oracle.py");
    let Some(output) = python(&[&oracle]) else {
        return;
    };
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let lines: u64 = manifest(&committed())
        .files
        .iter()
        .map(|file| file.lines)
        .sum();
    let sum = format!(
        "{lines} lines of {} files",
        manifest(&committed()).files.len()
    );
    assert!(text.contains(&sum), "{text}");
}

/// In formats with few bits, with more fraction than range, and wide ones; and any can be written.
#[test]
fn the_independent_oracle_agrees_in_other_formats() {
    let small = |format| CorpusPlan {
        lines: 150,
        lines_of_others: 60,
        seed: 2,
        ..CorpusPlan::for_format(format)
    };
    let oracle = committed().join("oracle.py");
    for (exponent_bits, fraction_bits) in [(4, 3), (2, 5), (5, 10), (8, 23), (11, 52), (2, 52)] {
        let folder = tempfile::tempdir().unwrap();
        let plan = small(FloatFormat::new(exponent_bits, fraction_bits));
        write_corpus(&plan, folder.path()).unwrap();
        let Some(output) = python(&[&oracle, folder.path()]) else {
            return;
        };
        let text = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{}: {text}", plan.format);
        assert!(text.contains(" 0 differ"), "{text}");
    }
    for exponent_bits in FloatFormat::EXPONENT_BITS {
        for fraction_bits in FloatFormat::FRACTION_BITS.step_by(7) {
            let folder = tempfile::tempdir().unwrap();
            let plan = small(FloatFormat::new(exponent_bits, fraction_bits));
            let manifest = write_corpus(&plan, folder.path()).unwrap();
            assert_eq!(manifest.files.len(), 130, "{}", plan.format);
        }
    }
}

/// A wrong result, a wrong flag, a changed file and a missing one, each in a copy of one file.
#[test]
fn the_independent_oracle_sees_a_wrong_line() {
    let oracle = committed().join("oracle.py");
    let name = "mul_rne_full.txt";
    let original = fs::read_to_string(committed().join(name)).unwrap();
    let entry = manifest(&committed())
        .files
        .into_iter()
        .find(|file| file.file == name)
        .unwrap();
    let run = |text: &str, keep_digest: bool| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), text).unwrap();
        let mut entry = entry.clone();
        if !keep_digest {
            entry.sha256 = hdl_gen::corpus::file_digest(text);
        }
        let manifest = CorpusManifest {
            files: vec![entry],
            ..manifest(&committed())
        };
        let manifest = serde_json::to_string(&manifest).unwrap();
        fs::write(folder.path().join(CorpusManifest::FILE), manifest).unwrap();
        python(&[&oracle, folder.path()]).map(|output| {
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            (output.status.code(), text)
        })
    };
    let Some((code, _)) = run(&original, false) else {
        return;
    };
    assert_eq!(code, Some(0));
    // The 700th line with its last result digit, then its last flag digit, changed.
    let line = original.lines().nth(699).unwrap();
    let changed = |place: usize| {
        let mut bytes = line.as_bytes().to_vec();
        bytes[place] = if bytes[place] == b'1' { b'0' } else { b'1' };
        let new = String::from_utf8(bytes).unwrap();
        original.replacen(line, &new, 1)
    };
    for text in [changed(line.len() - 4), changed(line.len() - 1)] {
        let (code, said) = run(&text, false).unwrap();
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains("mul_rne_full.txt:"), "{said}");
    }
    let (code, said) = run(&changed(line.len() - 1), true).unwrap();
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("digest"), "{said}");
    let short: Vec<&str> = original.lines().take(100).collect();
    let (code, said) = run(&(short.join("\n") + "\n"), false).unwrap();
    assert_eq!(code, Some(1), "{said}");
    let empty = tempfile::tempdir().unwrap();
    assert_eq!(
        python(&[&oracle, empty.path()]).unwrap().status.code(),
        Some(2)
    );
}
