//! `stepwell eval`, by which strangers check the golden arithmetic with tools of their own.

use std::fs;

use assert_cmd::assert::Assert;
use rtl_model::float::{Flags, FloatFormat, Operation, Policy, Rounding};
use serde_json::Value;
use tests::command_line::{contents, stepwell};

fn eval(operands: &str, options: &[&str]) -> Assert {
    stepwell()
        .args(["eval", "--operands", "-"])
        .args(options)
        .write_stdin(operands)
        .assert()
}

fn results(operands: &str, options: &[&str]) -> String {
    let assert = eval(operands, options).code(0).stderr("");
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

/// Worked by hand, from docs/numerics.md.
#[test]
fn results_and_flags_are_those_of_the_definition() {
    let options = ["--op", "div", "--rounding", "rup", "--policy", "full"];
    assert_eq!(
        results(
            "3f0000 408000\n3F0000 000000\n0 0\n000001 400000\n",
            &options
        ),
        "3F0000 408000 3D5556 01\n3F0000 000000 7F0000 08\n000000 000000 7F8000 10\n\
         000001 400000 000001 03\n"
    );
    assert_eq!(
        results("7effff 7effff\n", &["--op", "mul", "--rounding", "rtz"]),
        "7EFFFF 7EFFFF 7EFFFF 05\n"
    );
    assert_eq!(
        results(
            "38 08 8\n",
            &["--op", "fused_multiply_add", "--format", "e4f3"]
        ),
        "38 08 08 10 00\n"
    );
}

#[test]
fn words_have_as_many_digits_as_their_widths() {
    // One bit for the truth, 8 digits of an i32, 4 of bfloat16.
    assert_eq!(
        results("3f0000 400000\n", &["--op", "lt"]),
        "3F0000 400000 1 00\n"
    );
    assert_eq!(
        results("bf8000\n", &["--op", "to_i32_exact"]),
        "BF8000 FFFFFFFE 01\n"
    );
    assert_eq!(
        results("1\n", &["--op", "from_u8", "--format", "bfloat16"]),
        "01 3F80 00\n"
    );
    assert_eq!(
        results(
            "3ff0000000000000\n",
            &["--op", "to_half", "--format", "double"]
        ),
        "3FF0000000000000 3C00 00\n"
    );
}

#[test]
fn a_second_word_is_ignored_where_there_is_one_operand() {
    assert_eq!(
        results("400000 1\n408000\n", &["--op", "sqrt"]),
        "400000 000001 3F6A0A 01\n408000 3FBB68 01\n"
    );
}

/// Every operator in every policy and rounding, by the library.
#[test]
fn the_command_answers_as_the_library_does() {
    let mut operations = Operation::PLAIN.to_vec();
    for name in ["to_i16_exact", "from_u32", "to_e8f23", "less_equal_quiet"] {
        operations.push(name.parse().unwrap());
    }
    let mut state = 1_u64;
    let words: Vec<[u64; 3]> = (0..50)
        .map(|_| {
            [(); 3].map(|()| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                state >> 40
            })
        })
        .collect();
    let mut raised = Flags::NONE;
    for operation in operations {
        for policy in Policy::ALL {
            let rounding = Rounding::ALL[operation.to_string().len() % 4];
            let count = operation.operands(FloatFormat::E7F16).len();
            let mut operands = String::new();
            let mut expected = Vec::new();
            for &words in &words {
                let line: Vec<String> = words[..count]
                    .iter()
                    .map(|word| format!("{word:x}"))
                    .collect();
                operands += &(line.join(" ") + "\n");
                let arithmetic = FloatFormat::E7F16.arithmetic(policy, rounding);
                let answer = operation.evaluate(arithmetic, words);
                raised |= answer.flags;
                expected.push((answer.bits, u64::from(answer.flags.bits())));
            }
            let options = [
                "--op",
                &operation.to_string(),
                "--rounding",
                rounding.name(),
                "--policy",
                policy.name(),
            ];
            let text = results(&operands, &options);
            let actual: Vec<(u64, u64)> = text
                .lines()
                .map(|line| {
                    let words: Vec<u64> = line
                        .split(' ')
                        .map(|word| u64::from_str_radix(word, 16).unwrap())
                        .collect();
                    (words[count], words[count + 1])
                })
                .collect();
            assert_eq!(actual, expected, "{options:?}");
        }
    }
    assert!(raised.contains(Flags::INVALID | Flags::INEXACT | Flags::OVERFLOW));
}

#[test]
fn results_go_to_a_file_with_a_summary_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let operands = folder.path().join("operands");
    let output = folder.path().join("results");
    fs::write(&operands, "3f0000 408000\n3f0000 0\n\n\n").unwrap();
    let run = |extra: &[&str]| {
        let assert = stepwell()
            .args(["eval", "--op", "div", "--operands"])
            .arg(&operands)
            .arg("-o")
            .arg(&output)
            .args(extra)
            .assert()
            .code(0);
        let text = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
        let results = fs::read_to_string(&output).unwrap();
        assert_eq!(
            results,
            "3F0000 408000 3D5555 01\n3F0000 000000 7F0000 08\n"
        );
        text
    };
    assert!(run(&[]).contains("divide by zero  1"));
    let summary: Value = serde_json::from_str(&run(&["--json"])).unwrap();
    assert_eq!(summary["schema"], "stepwell-eval-1");
    assert_eq!(summary["operations"], 2);
    assert_eq!(summary["raised"]["inexact"], 1);
    assert_eq!(summary["raised"]["divide_by_zero"], 1);
    assert_eq!(summary["format"], "e7f16");
    assert!(summary["mismatches"].is_null());
}

#[test]
fn bad_operands_are_named_and_leave_no_file() {
    for (operands, message) in [
        (
            "3f0000 408000\n3f0000\n",
            "line 2: 1 operand; this operator has 2",
        ),
        ("3f0000 4080g0\n", "line 1: `4080g0` is not hexadecimal"),
        (
            "3f0000 1408000\n",
            "line 1: `1408000` has more than 24 bits",
        ),
        ("3f0000 408000 1\n", "line 1: more than 2 words"),
        ("3f0000 408000\n\n3f0000 408000\n", "line 2: blank"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("results");
        let assert = stepwell()
            .args(["eval", "--op", "add", "--operands", "-", "-o"])
            .arg(&output)
            .write_stdin(operands)
            .assert()
            .code(2)
            .stdout("");
        let stderr = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
        assert!(stderr.contains(message), "{stderr}");
        assert!(stderr.contains("standard input"), "{stderr}");
        assert!(contents(folder.path()).is_empty());
    }
    // What came before the bad line has been answered, where nobody waits for a file.
    eval("3f0000 3f0000\nx y\n", &["--op", "add"])
        .code(2)
        .stdout("3F0000 3F0000 400000 00\n");
}

#[test]
fn bad_options_are_named_with_the_way_out() {
    for (options, message) in [
        (
            &["--op", "plus"][..],
            "--op: unknown operator `plus`: there are add",
        ),
        (
            &["--op", "add", "--format", "e99f1"],
            "2 to 11 are supported",
        ),
        (&["--op", "add", "--format", "q"], "such as e7f16"),
        (&["--op", "add", "--rounding", "up"], "rne, rtz, rup, rdn"),
        (&["--op", "add", "--policy", "ieee"], "flush or full"),
        (
            &["--op", "add", "--json"],
            "give the results a file with -o",
        ),
    ] {
        let assert = eval("", options).code(2).stdout("");
        let stderr = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
        assert!(stderr.contains(message), "{options:?}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
    }
    let assert = stepwell()
        .args(["eval", "--op", "add", "--operands", "no such file"])
        .assert()
        .code(2);
    let stderr = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
    assert!(stderr.contains("no such file: cannot be read"), "{stderr}");
}

#[test]
fn fixed_point_is_evaluated_in_formats_of_its_own() {
    assert_eq!(
        results("30 10\n7F 01\n", &["--op", "add", "--format", "q4.4"]),
        "30 10 40 00\n7F 01 7F 05\n"
    );
    let mixed = [
        "--op",
        "mul",
        "--format",
        "q4.4",
        "--b-format",
        "uq0.16",
        "--result-format",
        "q12.20",
        "--rounding",
        "rdn",
    ];
    assert_eq!(results("F0 8000\n", &mixed), "F0 8000 FFF80000 00\n");
    let wrapping = [
        "--op",
        "shift_left",
        "--format",
        "q4.4",
        "--overflow",
        "wrap",
    ];
    assert_eq!(results("11 3\n", &wrapping), "11 03 88 05\n");
    assert_eq!(
        results("3D5555\n", &["--op", "from_e7f16", "--format", "q4.12"]),
        "3D5555 0555 01\n"
    );
    assert_eq!(
        results("F000\n", &["--op", "to_e7f16", "--format", "q4.12"]),
        "F000 BF0000 00\n"
    );
    assert_eq!(
        results("0000\n", &["--op", "reciprocal", "--format", "q4.12"]),
        "0000 7FFF 08\n"
    );
}

#[test]
fn options_of_fixed_point_are_refused_where_they_say_nothing() {
    for (options, part) in [
        (&["--op", "add", "--overflow", "wrap"][..], "--overflow"),
        (
            &["--op", "sqrt", "--format", "q4.4"],
            "of fixed-point numbers there are add",
        ),
        (&["--op", "add", "--format", "q40.40"], "80 bits in all"),
        (
            &["--op", "negate", "--format", "q4.4", "--b-format", "q4.4"],
            "no second number",
        ),
    ] {
        let output = eval("00 00\n", options).code(2).get_output().clone();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains(part), "{message}");
        assert!(output.stdout.is_empty());
    }
}
