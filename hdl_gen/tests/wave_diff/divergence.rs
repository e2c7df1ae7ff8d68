//! Where waveforms part, by how much, and why.

use crate::pipeline::{
    A, DOUBLED, ELSEWHERE, FORMAT, INDEX, Row, SUM, compare, compare_with, faulty, golden, options,
    rows, written,
};
use hdl_gen::wave::{Cause, DiffOptions, LogicWord, WaveError, WriterOptions};
use proptest::prelude::*;

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

proptest! {
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
