//! Faults planted in a waveform, and what the comparison says of them.

use hdl_gen::netlist::Meaning;
use hdl_gen::wave::{
    Cause, Dependency, DiffOptions, DiffReport, EarlierSignal, LogicWord, SideOptions,
    SignalDeclaration, UnitInputs, WaveError, Waveform, Writer, WriterOptions, diff, diff_files,
};
use proptest::prelude::*;
use rtl_model::float::FloatFormat;

const FORMAT: FloatFormat = FloatFormat::E7F16;
/// Places of the signals in a row of values.
const A: usize = 0;
const SUM: usize = 1;
const DOUBLED: usize = 2;
const INDEX: usize = 3;
const ELSEWHERE: usize = 4;

/// A small pipeline: `a` enters `step`, `sum` is `a` of two cycles ago and one, `doubled` is `sum`
/// of a cycle ago, `index` counts, and of `elsewhere` nobody knows what it is computed from.
fn declarations() -> Vec<SignalDeclaration> {
    let declare = |path: &[&str], name: &str, width, meaning| SignalDeclaration {
        path: path.iter().map(|&scope| scope.to_owned()).collect(),
        name: name.to_owned(),
        width,
        meaning,
    };
    let float = Meaning::Float(FORMAT);
    vec![
        declare(&["traverse", "step"], "a", 24, float),
        declare(&["traverse", "step"], "sum", 24, float),
        declare(&["traverse", "step"], "doubled", 24, float),
        declare(&["traverse", "walk"], "index", 6, Meaning::Signed),
        declare(&["traverse"], "elsewhere", 16, Meaning::Bits),
    ]
}

fn earlier(signal: &str, cycles_back: u32) -> EarlierSignal {
    EarlierSignal {
        signal: signal.to_owned(),
        cycles_back,
    }
}

fn options() -> WriterOptions {
    WriterOptions {
        shadows: true,
        dependencies: vec![
            Dependency {
                signal: "traverse.step.sum".to_owned(),
                inputs: vec![earlier("traverse.step.a", 2)],
            },
            Dependency {
                signal: "traverse.step.doubled".to_owned(),
                inputs: vec![earlier("traverse.step.sum", 0)],
            },
        ],
        unit_inputs: vec![UnitInputs {
            unit: "traverse.walk".to_owned(),
            inputs: vec!["traverse.step.a".to_owned()],
        }],
        ..WriterOptions::default()
    }
}

type Row = (bool, Vec<LogicWord>);

/// Three cycles in reset, then 37 in which everything moves.
fn rows() -> Vec<Row> {
    (0..40_u64)
        .map(|cycle| {
            let float = |n: u64| FORMAT.one() + n * 0x123;
            let values = [
                float(cycle),
                float(cycle + 500),
                float(cycle + 900),
                cycle & 63,
                cycle,
            ];
            (cycle >= 3, values.map(LogicWord::known).to_vec())
        })
        .collect()
}

fn written(rows: &[Row], options: &WriterOptions) -> String {
    let mut writer = Writer::new(Vec::new(), &declarations(), options).unwrap();
    for (reset_n, values) in rows {
        writer.cycle(*reset_n, values).unwrap();
    }
    String::from_utf8(writer.finish().unwrap()).unwrap()
}

fn golden() -> String {
    written(&rows(), &options())
}

/// Another run, without annotations, with some values changed: (cycle, signal, bits to flip).
fn faulty(flips: &[(usize, usize, u64)]) -> String {
    let mut rows = rows();
    for &(cycle, signal, bits) in flips {
        rows[cycle].1[signal].value ^= bits;
    }
    written(&rows, &WriterOptions::default())
}

fn compare_with(golden: &str, other: &str, options: &DiffOptions) -> Result<DiffReport, WaveError> {
    let golden = Waveform {
        name: "golden.vcd".to_owned(),
        input: golden.as_bytes(),
    };
    let other = Waveform {
        name: "other.vcd".to_owned(),
        input: other.as_bytes(),
    };
    diff(golden, other, options)
}

fn compare(golden: &str, other: &str) -> Result<DiffReport, WaveError> {
    compare_with(golden, other, &DiffOptions::default())
}

#[test]
fn equal_waveforms_agree_and_say_on_what() {
    let report = compare(&golden(), &faulty(&[])).unwrap();
    assert!(report.agreed);
    assert_eq!((report.signals_compared, report.cycles_compared), (5, 37));
    assert_eq!(
        (report.first_cycle_compared, report.last_cycle_compared),
        (3, 39)
    );
    assert_eq!(report.cycles_in_reset, 3);
    assert!(
        report.first_divergence.is_none() && report.notes.is_empty(),
        "{report}"
    );
    assert!(
        report
            .to_string()
            .contains("compared 5 signals in 37 cycles (3 to 39)")
    );
    assert_eq!(report.golden.signals_only_here, 0, "shadows are no signals");
}

#[test]
fn a_flipped_bit_is_found_where_it_was_planted() {
    for bit in [0, 5, 15] {
        let report = compare(&golden(), &faulty(&[(20, SUM, 1 << bit)])).unwrap();
        assert!(!report.agreed);
        assert_eq!((report.differing_pairs, report.signals_differing), (1, 1));
        let divergence = report.first_divergence.as_ref().unwrap();
        assert_eq!((divergence.cycle, divergence.signals_total), (20, 1));
        let signal = &divergence.signals[0];
        assert_eq!((signal.cycle, signal.time_ns), (20, 200.0));
        assert_eq!(
            (&signal.unit[..], &signal.signal[..]),
            ("traverse.step", "sum")
        );
        assert_eq!(signal.meaning, "float e7f16");
        assert_eq!(signal.ulps, Some(1 << bit));
        assert_eq!(signal.cause, Cause::First);
        let bits = FORMAT.one() + 520 * 0x123;
        assert_eq!(signal.golden.hex, format!("{bits:#08x}"));
        assert_eq!(signal.other.hex, format!("{:#08x}", bits ^ 1 << bit));
        assert_eq!(signal.golden.decoded, Some(FORMAT.to_f64(bits).to_string()));
        let text = report.to_string();
        assert!(
            text.contains("first in cycle 20, at 200 ns, in 1 signal"),
            "{text}"
        );
        assert!(
            text.contains("inputs equal: this is a first cause"),
            "{text}"
        );
    }
}

#[test]
fn effects_are_told_from_causes() {
    // `doubled` takes `sum` in the same cycle; `index` stands in a unit whose inputs are equal;
    // of `elsewhere` nothing is known. All of them differ in cycle 9, and some go on to.
    let other = faulty(&[
        (9, DOUBLED, 1),
        (9, SUM, 0x80_0000),
        (9, INDEX, 0x20),
        (9, ELSEWHERE, 7),
        (12, SUM, 1),
    ]);
    let report = compare(&golden(), &other).unwrap();
    assert_eq!((report.differing_pairs, report.signals_differing), (5, 4));
    let divergence = report.first_divergence.unwrap();
    let causes: Vec<(&str, &Cause)> = divergence
        .signals
        .iter()
        .map(|signal| (&signal.signal[..], &signal.cause))
        .collect();
    assert_eq!(causes[0], ("sum", &Cause::First));
    let unit = "traverse.walk".to_owned();
    assert_eq!(causes[1], ("index", &Cause::WithinUnit { unit }));
    assert!(matches!(causes[2], ("elsewhere", Cause::Unknown { .. })));
    let signal = "traverse.step.sum".to_owned();
    assert_eq!(
        causes[3],
        ("doubled", &Cause::EffectOf { signal, cycle: 9 })
    );

    let index = &divergence.signals[1];
    assert_eq!(index.golden.decoded.as_deref(), Some("9"));
    assert_eq!(
        index.other.decoded.as_deref(),
        Some("-23"),
        "6 bits, signed"
    );
    // From x to -x: twice the way to zero.
    let magnitude = FORMAT.one() + 509 * 0x123;
    assert_eq!(divergence.signals[0].ulps, Some(2 * magnitude));
}

#[test]
fn inputs_are_looked_up_in_the_cycle_they_were_sampled_in() {
    // `a` differs in cycle 2, in reset, where nothing is compared; `sum` shows it in cycle 4.
    let report = compare(&golden(), &faulty(&[(2, A, 4), (4, SUM, 4)])).unwrap();
    assert_eq!(report.differing_pairs, 1);
    let divergence = report.first_divergence.unwrap();
    assert_eq!(divergence.cycle, 4);
    assert_eq!(
        divergence.signals[0].cause,
        Cause::EffectOf {
            signal: "traverse.step.a".to_owned(),
            cycle: 2
        }
    );
    // A window that begins after the input was sampled cannot tell.
    let window = |rows: &[Row], options: WriterOptions| {
        written(
            &rows[10..],
            &WriterOptions {
                first_cycle: 10,
                ..options
            },
        )
    };
    let mut bad = rows();
    bad[11].1[SUM].value ^= 1;
    let report = compare(&window(&rows(), options()), &window(&bad, options())).unwrap();
    let divergence = report.first_divergence.unwrap();
    assert_eq!(divergence.cycle, 11);
    let Cause::Unknown { reason } = &divergence.signals[0].cause else {
        panic!("{divergence:?}");
    };
    assert!(reason.contains("cycle 9 of traverse.step.a"), "{reason}");
}

#[test]
fn nan_has_no_distance() {
    let mut bad = rows();
    bad[20].1[SUM] = LogicWord::known(FORMAT.quiet_nan());
    let report = compare(&golden(), &written(&bad, &WriterOptions::default())).unwrap();
    let divergence = report.first_divergence.unwrap();
    assert_eq!(divergence.signals[0].ulps, None);
    assert_eq!(divergence.signals[0].other.decoded.as_deref(), Some("nan"));
}

#[test]
fn nothing_counts_until_both_have_left_reset() {
    // The other stays in reset two cycles longer, and differs while it does.
    let mut late = rows();
    for cycle in [0, 3, 4] {
        late[cycle].0 = false;
        late[cycle].1[SUM].value ^= 1;
    }
    let report = compare(&golden(), &written(&late, &options())).unwrap();
    assert!(report.agreed, "{report}");
    assert_eq!(
        (report.cycles_in_reset, report.first_cycle_compared),
        (5, 5)
    );

    // A reset of both in the middle is passed over.
    let with_reset = |flips: u64| {
        let mut rows = rows();
        rows[20].0 = false;
        rows[20].1[SUM].value ^= flips;
        written(&rows, &options())
    };
    let report = compare(&with_reset(0), &with_reset(1)).unwrap();
    assert!(report.agreed, "{report}");
    assert_eq!((report.cycles_in_reset, report.cycles_compared), (4, 36));

    // A reset of one alone is a disagreement.
    let report = compare(&golden(), &with_reset(0)).unwrap();
    assert!(!report.agreed);
    assert_eq!((report.reset_disagreements, report.differing_pairs), (1, 0));
    assert!(
        report.to_string().contains("in 1 cycle one is in reset"),
        "{report}"
    );

    // Reset that is never left leaves nothing to compare.
    let mut held: Vec<Row> = rows();
    held.iter_mut().for_each(|row| row.0 = false);
    let error = compare(&golden(), &written(&held, &options())).unwrap_err();
    assert!(matches!(error, WaveError::NothingCompared(_)));
    assert!(error.to_string().contains("rst_ni"), "{error}");
}

#[test]
fn an_outer_scope_is_stripped_from_either_side() {
    let wrapped = faulty(&[(20, SUM, 1)])
        .replace(
            "$scope module traverse $end",
            "$scope module TOP $end\n$var wire 1 ! clk_i $end\n$var wire 1 \" rst_ni $end\n\
             $var wire 16 ( elsewhere $end\n$scope module traverse $end",
        )
        .replace("$enddefinitions", "$upscope $end\n$enddefinitions");
    for (golden, other, swapped) in [
        (golden(), wrapped.clone(), false),
        (wrapped, golden(), true),
    ] {
        let report = compare(&golden, &other).unwrap();
        let (outer, inner) = if swapped {
            (&report.golden, &report.other)
        } else {
            (&report.other, &report.golden)
        };
        assert_eq!(
            (&outer.stripped_scope[..], &inner.stripped_scope[..]),
            ("TOP", "")
        );
        assert_eq!(outer.signals_only_here, 0, "{:?}", outer.examples_only_here);
        assert_eq!(report.signals_compared, 5);
        let divergence = report.first_divergence.as_ref().unwrap();
        assert_eq!(
            (divergence.cycle, &divergence.signals[0].unit[..]),
            (20, "traverse.step")
        );
        assert_eq!(
            divergence.signals[0].cause,
            Cause::First,
            "annotations follow the stripping"
        );
        assert_eq!(divergence.signals[0].ulps, Some(1));
        assert!(report.notes[0].contains("`TOP`"), "{:?}", report.notes);
    }
}

#[test]
fn no_common_signals_is_explained_and_has_a_way_out() {
    let other = faulty(&[(20, SUM, 1)]).replace("module traverse", "module device");
    let error = compare(&golden(), &other).unwrap_err();
    assert!(matches!(error, WaveError::NoCommonSignals { .. }));
    let message = error.to_string();
    for part in [
        "golden.vcd: top scopes `traverse`",
        "other.vcd: top scopes `device`",
        "`device.elsewhere`",
        "--other-scope",
    ] {
        assert!(message.contains(part), "{message}");
    }
    // The way out.
    let scope = |scope: &str| SideOptions {
        scope: Some(scope.to_owned()),
        ..SideOptions::default()
    };
    let options = DiffOptions {
        golden: scope("traverse"),
        other: scope("device"),
        ..DiffOptions::default()
    };
    let report = compare_with(&golden(), &other, &options).unwrap();
    assert_eq!(report.signals_compared, 5);
    let divergence = report.first_divergence.unwrap();
    assert_eq!(
        (&divergence.signals[0].unit[..], divergence.cycle),
        ("step", 20)
    );

    let options = DiffOptions {
        other: scope("nowhere"),
        ..DiffOptions::default()
    };
    let error = compare_with(&golden(), &other, &options).unwrap_err();
    assert!(error.to_string().contains("`device.step`"), "{error}");
}

#[test]
fn signals_of_one_side_and_of_two_widths_are_told() {
    let other = faulty(&[]).replace("$var wire 24 # a [23:0]", "$var wire 24 # b [23:0]");
    let report = compare(&golden(), &other).unwrap();
    assert!(report.agreed);
    assert_eq!(report.signals_compared, 4);
    assert_eq!(report.golden.examples_only_here, ["traverse.step.a"]);
    assert_eq!(report.other.examples_only_here, ["traverse.step.b"]);
    assert!(
        report
            .to_string()
            .contains("1 signal only in other.vcd: traverse.step.b\n")
    );

    let other = faulty(&[]).replace("$var wire 24 # a [23:0]", "$var wire 25 # a [24:0]");
    let report = compare(&golden(), &other).unwrap();
    assert!(!report.agreed, "a signal of two widths is no agreement");
    assert_eq!(report.width_mismatches[0].signal, "traverse.step.a");
}

#[test]
fn the_common_window_is_compared_and_the_rest_told() {
    let window = |from: usize, to: usize, options: WriterOptions| {
        let first_cycle = from as u64;
        written(
            &rows()[from..to],
            &WriterOptions {
                first_cycle,
                ..options
            },
        )
    };
    let report = compare(&golden(), &window(10, 20, options())).unwrap();
    assert!(report.agreed);
    assert_eq!(
        (report.first_cycle_compared, report.last_cycle_compared),
        (10, 19)
    );
    assert!(
        report.notes[0].contains("cycles 0 to 39"),
        "{:?}",
        report.notes
    );
    assert!(
        report.notes[0].contains("cycles 10 to 19"),
        "{:?}",
        report.notes
    );

    let error = compare(&window(5, 10, options()), &window(20, 30, options())).unwrap_err();
    assert!(matches!(error, WaveError::NothingCompared(_)));
    assert!(error.to_string().contains("cycles 20 to 29"), "{error}");

    // Another clock period: cycles pair by their number, and it is said.
    let slow = WriterOptions {
        period_ns: 14,
        ..options()
    };
    let mut bad = rows();
    bad[30].1[SUM].value ^= 1;
    let report = compare(&golden(), &written(&bad, &slow)).unwrap();
    let divergence = report.first_divergence.as_ref().unwrap();
    assert_eq!((divergence.cycle, divergence.other_time_ns), (30, 420.0));
    assert!(
        report.notes[0].contains("a period of 10 ns"),
        "{:?}",
        report.notes
    );
}

#[test]
fn unknown_bits_differ_unless_both_are_unknown() {
    let with_unknown = |cycle: usize, value: LogicWord| {
        let mut rows = rows();
        rows[cycle].1[ELSEWHERE] = value;
        written(&rows, &options())
    };
    let x = with_unknown(20, LogicWord::X);
    let z = with_unknown(
        20,
        LogicWord {
            value: u64::MAX,
            unknown: u64::MAX,
        },
    );
    let one_x = with_unknown(
        20,
        LogicWord {
            value: 20,
            unknown: 1 << 15,
        },
    );

    let report = compare(&x, &x).unwrap();
    assert!(report.agreed);
    assert_eq!(report.partly_unknown_pairs, 1);
    for (left, right, hex) in [
        (&golden(), &x, "0xxxxx"),
        (&golden(), &z, "0xzzzz"),
        (&golden(), &one_x, "0xX014"),
        (&x, &z, "0xzzzz"),
        (&z, &x, "0xxxxx"),
        (&x, &golden(), "0x0014"),
    ] {
        let report = compare(left, right).unwrap();
        assert!(!report.agreed);
        let divergence = report.first_divergence.unwrap();
        assert_eq!(
            (divergence.cycle, &divergence.signals[0].other.hex[..]),
            (20, hex)
        );
    }

    // x in the golden waveform may be excused, x in the other never.
    let excusing = DiffOptions {
        excuse_golden_unknown: true,
        ..DiffOptions::default()
    };
    let report = compare_with(&x, &golden(), &excusing).unwrap();
    assert!(report.agreed);
    assert_eq!(report.partly_unknown_pairs, 1);
    assert!(!compare_with(&golden(), &x, &excusing).unwrap().agreed);
    // Of a word with one unknown bit, the others still count.
    let mut rows = rows();
    rows[20].1[ELSEWHERE] = LogicWord::known(0x8000 | 21);
    let report = compare_with(&one_x, &written(&rows, &options()), &excusing).unwrap();
    assert_eq!(report.differing_pairs, 1);

    // Where nothing at all is known, nothing has been compared.
    let unknown: Vec<Row> = vec![(true, vec![LogicWord::X; 5]); 40];
    let unknown = written(&unknown, &options());
    let error = compare(&unknown, &unknown).unwrap_err();
    assert!(matches!(error, WaveError::NothingCompared(_)), "{error}");
}

#[test]
fn json_has_a_schema() {
    let report = compare(&golden(), &faulty(&[(20, SUM, 1)])).unwrap();
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["schema"], "stepwell-wavediff-1");
    assert_eq!(json["agreed"], false);
    assert_eq!(
        json["first_divergence"]["signals"][0]["cause"]["verdict"],
        "first"
    );
    assert_eq!(json["first_divergence"]["signals"][0]["ulps"], 1);
}

#[test]
fn files_that_are_no_waveforms_are_refused_by_name() {
    let good = golden();
    let refuse = |text: &str| compare(&good, text).unwrap_err().to_string();
    for (text, part) in [
        ("", "other.vcd, line 1: the file ends"),
        ("\u{0}\u{1}ELF", "other.vcd, line 1"),
        ("{ \"json\": true }\n", "other.vcd, line 1"),
        (&good[..good.len() / 3], "other.vcd, line"),
        (
            "$scope module a $end\n$enddefinitions $end\n",
            "scopes open",
        ),
        ("$upscope $end\n", "no scope open"),
        ("$timescale 0 ns $end\n", "timescale of 0"),
        (
            "$scope module a $end $var wire 4000000000 ! a $end\n",
            "4000000000 bits",
        ),
        (&"$scope module a $end\n".repeat(100_000), "256 deep"),
        (&format!("{good}#5\n"), "time runs backward"),
        (&format!("{good}#99999\n1~~~\n"), "no variable"),
        (
            &format!("{good}#99999\nb11 !\n"),
            "2 bits for a variable of 1",
        ),
        (&good.replace("a [23:0]", "a [23:"), "other.vcd, line"),
        (&good.replace("a@-2", "a@2"), "NAME@-N"),
        (&good.replace(" clk_i", " clock"), "`clk_i`"),
        (&good.replace("\n1!", "\n0!"), "no whole cycle"),
    ] {
        let message = refuse(text);
        assert!(message.contains(part), "{message} does not say {part}");
    }
    let absent = std::path::Path::new("no/such/file.vcd");
    let error = diff_files(absent, absent, &DiffOptions::default()).unwrap_err();
    assert!(error.to_string().contains("no/such/file.vcd"), "{error}");
}

proptest! {
    #[test]
    fn damage_never_panics_and_is_never_agreement_on_nothing(
        cut in any::<prop::sample::Index>(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
    ) {
        let mut bytes = golden().into_bytes();
        bytes.truncate(cut.index(bytes.len() * 2).min(bytes.len()));
        for (place, byte) in &damage {
            if !bytes.is_empty() {
                let place = place.index(bytes.len());
                bytes[place] = *byte;
            }
        }
        let golden = golden();
        let waveform = |input| Waveform { name: "file".to_owned(), input };
        let compared = diff(waveform(golden.as_bytes()), waveform(&bytes), &DiffOptions::default());
        if let Ok(report) = compared {
            prop_assert!(report.cycles_compared > 0);
            prop_assert!(report.signals_compared + report.width_mismatches.len() > 0);
            // What has been cut off is told, but for the time that ends the last cycle.
            let is_whole = bytes.len() + "#400\n".len() >= golden.len();
            prop_assert!(is_whole || !report.notes.is_empty() || !report.agreed);
        }
    }

    #[test]
    fn every_planted_difference_is_counted(
        flips in prop::collection::btree_map((3_usize..40, 0_usize..5), 0_u32..6, 1..12),
    ) {
        let planted: Vec<_> = flips.iter().map(|(&(cycle, signal), &bit)| (cycle, signal, 1 << bit)).collect();
        let report = compare(&golden(), &faulty(&planted)).unwrap();
        prop_assert_eq!(report.differing_pairs, planted.len() as u64);
        let first = planted.iter().map(|flip| flip.0).min().unwrap();
        let in_first: Vec<usize> = planted.iter().filter(|flip| flip.0 == first).map(|flip| flip.1).collect();
        let divergence = report.first_divergence.unwrap();
        prop_assert_eq!(divergence.cycle, first as u64);
        prop_assert_eq!(divergence.signals_total, in_first.len());
    }
}
