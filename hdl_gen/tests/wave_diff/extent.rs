//! What is compared at all: scopes, signals, cycles out of reset.

use crate::pipeline::{Row, SUM, compare, compare_with, faulty, golden, options, rows, written};
use hdl_gen::wave::{Cause, DiffOptions, SideOptions, WaveError, WriterOptions};

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
fn two_waveforms_wrapped_in_two_ways_still_pair() {
    let wrapped = |text: String, outer: &str| {
        let opened = format!("$scope module {outer} $end\n$scope module traverse $end");
        text.replace("$scope module traverse $end", &opened)
            .replace("$enddefinitions", "$upscope $end\n$enddefinitions")
    };
    let other = wrapped(faulty(&[(20, SUM, 1)]), "testbench");
    let report = compare(&wrapped(golden(), "TOP"), &other).unwrap();
    assert_eq!(report.golden.stripped_scope, "TOP");
    assert_eq!(report.other.stripped_scope, "testbench");
    assert_eq!((report.signals_compared, report.differing_pairs), (5, 1));
}
