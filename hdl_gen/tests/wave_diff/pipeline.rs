//! The waveforms the tests plant faults in.

use hdl_gen::netlist::Meaning;
use hdl_gen::wave::{
    Dependency, DiffOptions, DiffReport, EarlierSignal, LogicWord, SignalDeclaration, UnitInputs,
    WaveError, Waveform, Writer, WriterOptions, diff,
};
use rtl_model::float::FloatFormat;

pub const FORMAT: FloatFormat = FloatFormat::E7F16;
/// Places of the signals in a row of values.
pub const A: usize = 0;
pub const SUM: usize = 1;
pub const DOUBLED: usize = 2;
pub const INDEX: usize = 3;
pub const ELSEWHERE: usize = 4;

/// A small pipeline: `a` enters `step`, `sum` is `a` of two cycles ago and one, `doubled` is `sum`
/// of a cycle ago, `index` counts, and of `elsewhere` nobody knows what it is computed from.
pub fn declarations() -> Vec<SignalDeclaration> {
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

pub fn earlier(signal: &str, cycles_back: u32) -> EarlierSignal {
    EarlierSignal {
        signal: signal.to_owned(),
        cycles_back,
    }
}

pub fn options() -> WriterOptions {
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

pub type Row = (bool, Vec<LogicWord>);

/// Three cycles in reset, then 37 in which everything moves.
pub fn rows() -> Vec<Row> {
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

pub fn written(rows: &[Row], options: &WriterOptions) -> String {
    let mut writer = Writer::new(Vec::new(), &declarations(), options).unwrap();
    for (reset_n, values) in rows {
        writer.cycle(*reset_n, values).unwrap();
    }
    String::from_utf8(writer.finish().unwrap()).unwrap()
}

pub fn golden() -> String {
    written(&rows(), &options())
}

/// Another run, without annotations, with some values changed: (cycle, signal, bits to flip).
pub fn faulty(flips: &[(usize, usize, u64)]) -> String {
    let mut rows = rows();
    for &(cycle, signal, bits) in flips {
        rows[cycle].1[signal].value ^= bits;
    }
    written(&rows, &WriterOptions::default())
}

pub fn compare_with(
    golden: &str,
    other: &str,
    options: &DiffOptions,
) -> Result<DiffReport, WaveError> {
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

pub fn compare(golden: &str, other: &str) -> Result<DiffReport, WaveError> {
    compare_with(golden, other, &DiffOptions::default())
}
