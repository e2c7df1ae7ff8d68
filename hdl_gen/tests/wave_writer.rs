//! What the writer writes, read by a parser that shares nothing with it.

use hdl_gen::netlist::Meaning;
use hdl_gen::wave::{LogicWord, SignalDeclaration, WaveError, Writer, WriterOptions};
use proptest::prelude::*;
use rtl_model::fixed::{Fixed, FixedFormat};
use rtl_model::float::FloatFormat;
use std::io::Cursor;
use wellen::simple::Waveform;

fn declaration(path: &[&str], name: &str, width: u32, meaning: Meaning) -> SignalDeclaration {
    SignalDeclaration {
        path: path.iter().map(|&scope| scope.to_owned()).collect(),
        name: name.to_owned(),
        width,
        meaning,
    }
}

/// Of every kind, in nested scopes, and not in the order of the scopes.
fn declarations() -> Vec<SignalDeclaration> {
    vec![
        declaration(&["traverse"], "valid_o", 1, Meaning::Bits),
        declaration(
            &["traverse", "step"],
            "t",
            24,
            Meaning::Float(FloatFormat::E7F16),
        ),
        declaration(&["traverse", "hit"], "i", 9, Meaning::Signed),
        declaration(&["traverse", "step"], "wide", 64, Meaning::Signed),
        declaration(&["traverse"], "count", 64, Meaning::Bits),
        declaration(&["traverse"], "q", 12, Meaning::Fixed(FixedFormat::q(5, 7))),
    ]
}

fn write(options: &WriterOptions, cycles: &[(bool, Vec<LogicWord>)]) -> Vec<u8> {
    let mut writer = Writer::new(Vec::new(), &declarations(), options).unwrap();
    for (reset_n, values) in cycles {
        writer.cycle(*reset_n, values).unwrap();
    }
    writer.finish().unwrap()
}

/// The value of a variable at a time, as the other parser prints it.
fn value_at(waveform: &mut Waveform, path: &[&str], name: &str, time: u64) -> String {
    let variable = waveform
        .hierarchy()
        .lookup_var(path, name)
        .unwrap_or_else(|| panic!("no {name} in {path:?}"));
    let signal = waveform.hierarchy()[variable].signal_ref();
    waveform.load_signals(&[signal]);
    let index = waveform.time_table().partition_point(|&t| t <= time) - 1;
    let signal = waveform.get_signal(signal).unwrap();
    let offset = signal.get_offset(index as u32).unwrap();
    signal.get_value_at(&offset, 0).to_string()
}

fn binary(value: u64, width: usize) -> String {
    format!("{value:0width$b}")
}

proptest! {
    #[test]
    fn another_parser_reads_the_same_values(
        rows in prop::collection::vec((any::<bool>(), any::<[u64; 6]>(), any::<u8>()), 1..40),
        first_cycle in 0_u64..1_000_000,
        period_ns in 2_u64..20,
    ) {
        let widths = [1, 24, 9, 64, 64, 12];
        let cycles: Vec<(bool, Vec<LogicWord>)> = rows
            .iter()
            .map(|(reset_n, words, repeats)| {
                let values = words.iter().zip(widths).enumerate().map(|(index, (word, width))| {
                    // Some values stay small, so that signals also repeat; some are unknown.
                    let word = if repeats >> index & 1 == 1 { word & 1 } else { *word };
                    if word % 7 == 3 { LogicWord::X } else { (word & u64::MAX >> (64 - width)).into() }
                });
                (*reset_n, values.collect())
            })
            .collect();
        let options = WriterOptions { first_cycle, period_ns, shadows: true, ..WriterOptions::default() };
        let text = write(&options, &cycles);
        let mut waveform = wellen::simple::read_from_reader(Cursor::new(text)).unwrap();
        for (index, (reset_n, values)) in cycles.iter().enumerate() {
            let begin = (first_cycle + index as u64) * period_ns;
            let settled = begin + period_ns - 1;
            prop_assert_eq!(value_at(&mut waveform, &["traverse"], "clk_i", begin), "1");
            prop_assert_eq!(value_at(&mut waveform, &["traverse"], "clk_i", settled), "0");
            prop_assert_eq!(value_at(&mut waveform, &["traverse"], "rst_ni", settled), binary(u64::from(*reset_n), 1));
            for (declaration, value) in declarations().iter().zip(values) {
                let path: Vec<&str> = declaration.path.iter().map(String::as_str).collect();
                let width = declaration.width as usize;
                // At the edge already, and still at the end.
                for time in [begin, settled] {
                    let read = value_at(&mut waveform, &path, &declaration.name, time);
                    let expected = match value.as_known() {
                        Some(known) => binary(known, width),
                        None => "x".repeat(width),
                    };
                    prop_assert_eq!(read, expected);
                }
                let shadow = |waveform: &mut Waveform, suffix: &str| {
                    value_at(waveform, &path, &format!("{}{suffix}", declaration.name), settled)
                };
                match (declaration.meaning, value.as_known()) {
                    (Meaning::Bits, _) => {}
                    (Meaning::Float(format), known) => {
                        let read: f64 = shadow(&mut waveform, "_real").parse().unwrap();
                        let expected = known.map_or(f64::NAN, |bits| format.to_f64(bits));
                        prop_assert!(read == expected || read.is_nan() && expected.is_nan());
                    }
                    (Meaning::Fixed(format), known) => {
                        let read: f64 = shadow(&mut waveform, "_real").parse().unwrap();
                        let expected = known.map_or(f64::NAN, |bits| Fixed::new(format, bits).to_f64());
                        prop_assert!(read == expected || read.is_nan() && expected.is_nan());
                    }
                    (Meaning::Signed, known) => {
                        let read = shadow(&mut waveform, "_int");
                        let expected = match known {
                            None => "x".repeat(read.len()),
                            Some(bits) if width == 64 => binary(bits, 64),
                            Some(bits) => {
                                let value = (bits as i32) << 23 >> 23;
                                binary(u64::from(value as u32), 32)
                            }
                        };
                        prop_assert_eq!(read, expected);
                    }
                }
            }
        }
    }
}

#[test]
fn only_changes_are_written() {
    let row = |t: u64| (true, [1, t, 3, 4, 5, 6].map(LogicWord::known).to_vec());
    let text = write(&WriterOptions::default(), &[row(7), row(7), row(8)]);
    let text = String::from_utf8(text).unwrap();
    let (_, changes) = text.split_once("$enddefinitions $end\n").unwrap();
    let count = |line: &str| changes.lines().filter(|&l| l == line).count();
    assert_eq!(count("b000000000000000000000111 $"), 1, "{changes}");
    assert_eq!(count("b000000000000000000001000 $"), 1);
    assert_eq!(count("1!"), 3, "the clock rises every cycle");
    assert!(
        changes.ends_with("#30\n"),
        "the last cycle has its full length"
    );
    assert!(text.contains("$comment stepwell-float traverse.step.t e7f16 $end"));
    assert!(text.contains("$comment stepwell-fixed traverse.q q5.7 $end"));
    assert!(!text.contains("_real"), "shadows were not asked for");
}

#[test]
fn a_window_can_leave_cycles_out_but_not_go_back() {
    let mut writer = Writer::new(Vec::new(), &declarations(), &WriterOptions::default()).unwrap();
    let values = [LogicWord::known(0); 6];
    writer.cycle(true, &values).unwrap();
    writer.skip_to(10).unwrap();
    writer.cycle(true, &values).unwrap();
    assert!(matches!(
        writer.skip_to(10),
        Err(WaveError::CycleNumber { cycle: 10, .. })
    ));
    let text = String::from_utf8(writer.finish().unwrap()).unwrap();
    assert!(text.contains("#5\n") && text.contains("#100\n") && text.ends_with("#110\n"));
}

#[test]
fn what_cannot_be_written_is_refused_by_name() {
    let open = |declarations: &[SignalDeclaration], options: &WriterOptions| {
        Writer::new(Vec::new(), declarations, options)
            .map(|_| ())
            .unwrap_err()
            .to_string()
    };
    let bits = |path: &[&str], name: &str, width| declaration(path, name, width, Meaning::Bits);
    let default = WriterOptions::default();
    let shadows = WriterOptions {
        shadows: true,
        ..WriterOptions::default()
    };
    let float = declaration(&["top"], "a", 24, Meaning::Float(FloatFormat::E7F16));
    let cases = [
        (vec![bits(&[], "a", 1)], &default, "stands in no scope"),
        (vec![bits(&["top"], "a b", 1)], &default, "without spaces"),
        (vec![bits(&["top"], "a$end", 1)], &default, "without spaces"),
        (vec![bits(&["top"], "a", 65)], &default, "1 to 64 bits"),
        (vec![bits(&["top"], "a", 0)], &default, "1 to 64 bits"),
        (
            vec![bits(&["top"], "a", 1), bits(&["pot"], "b", 1)],
            &default,
            "under `top`",
        ),
        (
            vec![bits(&["top"], "a", 1), bits(&["top"], "a", 2)],
            &default,
            "named `top.a`",
        ),
        (
            vec![bits(&["top"], "clk_i", 1)],
            &default,
            "named `top.clk_i`",
        ),
        (
            vec![float.clone(), bits(&["top"], "a_real", 1)],
            &shadows,
            "named `top.a_real`",
        ),
        (
            vec![declaration(&["top"], "a", 23, float.meaning)],
            &default,
            "e7f16 has 24",
        ),
        (vec![], &default, "without signals"),
        (
            vec![float],
            &WriterOptions {
                period_ns: 1,
                ..default.clone()
            },
            "at least 2",
        ),
    ];
    for (declarations, options, expected) in cases {
        let message = open(&declarations, options);
        assert!(message.contains(expected), "{message}");
    }

    let mut writer = Writer::new(Vec::new(), &declarations(), &default).unwrap();
    let zeros = [LogicWord::known(0); 6];
    assert!(matches!(
        writer.cycle(true, &zeros[..4]),
        Err(WaveError::ValueCount { given: 4, .. })
    ));
    let mut beyond = zeros;
    beyond[2] = LogicWord::known(512);
    assert!(matches!(
        writer.cycle(true, &beyond),
        Err(WaveError::ValueWidth {
            width: 9,
            value: 512,
            ..
        })
    ));
    writer.skip_to(u64::MAX / 10).unwrap();
    assert!(matches!(
        writer.cycle(true, &zeros),
        Err(WaveError::CycleNumber { .. })
    ));
}
