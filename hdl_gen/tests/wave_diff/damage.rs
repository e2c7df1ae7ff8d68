//! Files that are no waveforms, or no longer.

use crate::pipeline::{compare, golden};
use hdl_gen::wave::{DiffOptions, Waveform, diff, diff_files};
use proptest::prelude::*;

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
}
