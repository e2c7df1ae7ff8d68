//! The waveforms of a run, golden and simulated, with the same hierarchy and the same names.

use super::golden::{GoldenRun, History};
use crate::netlist::Meaning;
use crate::units::{CycleWords, TraverseUnit};
use crate::wave::{
    ConformOptions, ConformReport, CycleNumbers, Dependency, EarlierSignal, LogicWord,
    SignalDeclaration, UnitInputs, WaveError, Writer, WriterOptions, conform,
};
use rtl_model::machine::CycleInputs;
use rtl_model::readings::HasFormat;
use std::fmt::Debug;
use std::io::{BufRead, Write};
use std::ops::{ControlFlow, RangeInclusive};

/// A clock period, in nanoseconds.
const PERIOD_NS: u64 = 10;

/// The signals of a traverse unit's waveform: its input ports, then its probes.
pub fn waveform_signals(unit: &TraverseUnit) -> Vec<SignalDeclaration> {
    let ports = super::traverse::DRIVEN.iter().map(|&name| {
        let wire = unit.design.input(name).expect("a driven port is an input");
        let node = unit.design.node(wire);
        SignalDeclaration {
            path: vec![unit.design.name.clone()],
            name: name.to_owned(),
            width: node.width,
            meaning: node.meaning,
        }
    });
    let probes = unit.probes.iter().map(|probe| SignalDeclaration {
        path: probe.scope.clone(),
        name: probe.name.clone(),
        width: probe.width,
        meaning: probe.meaning,
    });
    ports.chain(probes).collect()
}

/// How a traverse unit's waveforms are written: decoded shadows beside the bits, and with every
/// signal what it is computed from, so that a first cause can be told from its effects.
pub fn waveform_options(unit: &TraverseUnit, first_cycle: u64) -> WriterOptions {
    let known = |path: &str| {
        unit.probes.iter().any(|probe| probe.path() == path)
            || super::traverse::DRIVEN
                .iter()
                .any(|port| path == format!("traverse.{port}"))
    };
    let dependency = |probe: &crate::units::Probe| {
        // A value that also depends on what the waveform does not show has no known cause.
        let all_known = probe.sources.iter().all(|(path, _)| known(path));
        (all_known && !probe.sources.is_empty()).then(|| Dependency {
            signal: probe.path(),
            inputs: probe
                .sources
                .iter()
                .map(|(path, cycles)| EarlierSignal {
                    signal: path.clone(),
                    cycles_back: *cycles,
                })
                .collect(),
        })
    };
    let ports = super::traverse::DRIVEN
        .iter()
        .map(|port| format!("traverse.{port}"))
        .collect();
    WriterOptions {
        period_ns: PERIOD_NS,
        first_cycle,
        shadows: true,
        dependencies: unit.probes.iter().filter_map(dependency).collect(),
        unit_inputs: vec![UnitInputs {
            unit: "traverse".to_owned(),
            inputs: ports,
        }],
    }
}

/// The words of a cycle's input ports, as a waveform has them.
fn port_words(inputs: &CycleInputs<u64>) -> impl Iterator<Item = LogicWord> {
    super::traverse::driven_words(inputs)
        .into_iter()
        .map(LogicWord::from)
}

/// Writes the golden machine's waveform of a window of cycles.
///
/// # Errors
/// If the output cannot be written.
pub fn golden_waveform<H: HasFormat + Debug, W: Write>(
    unit: &TraverseUnit,
    run: &GoldenRun<'_>,
    format: H,
    window: RangeInclusive<u64>,
    output: W,
) -> Result<W, WaveError> {
    let options = waveform_options(unit, *window.start());
    let mut writer = Writer::new(output, &waveform_signals(unit), &options)?;
    let mut history = History::new(unit.latency);
    let mut cycle = 0;
    let mut outcome = Ok(());
    run.run(format, |inputs, _, words: &CycleWords| {
        history.push(words);
        if window.contains(&cycle) {
            let probes = unit
                .probes
                .iter()
                .map(|probe| LogicWord::from(history.expected(probe)));
            let values: Vec<_> = port_words(inputs).chain(probes).collect();
            outcome = writer.cycle(true, &values);
        }
        cycle += 1;
        match outcome.is_ok() && cycle <= *window.end() {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    });
    outcome?;
    writer.finish()
}

/// Writes what the embedded simulator shows, cycle by cycle.
pub struct SimulatedWaveform<W: Write> {
    writer: Writer<W>,
    window: RangeInclusive<u64>,
    outcome: Result<(), WaveError>,
}

impl<W: Write> SimulatedWaveform<W> {
    /// A waveform of a window of cycles.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn new(
        unit: &TraverseUnit,
        window: RangeInclusive<u64>,
        output: W,
    ) -> Result<Self, WaveError> {
        let options = waveform_options(unit, *window.start());
        let writer = Writer::new(output, &waveform_signals(unit), &options)?;
        Ok(SimulatedWaveform {
            writer,
            window,
            outcome: Ok(()),
        })
    }

    /// Takes a cycle, in the form in which [`super::run_embedded`] shows it.
    pub fn observe(&mut self, cycle: u64, inputs: &CycleInputs<u64>, probes: &[u64]) {
        if self.outcome.is_ok() && self.window.contains(&cycle) {
            let probes = probes.iter().map(|&value| LogicWord::from(value));
            let values: Vec<_> = port_words(inputs).chain(probes).collect();
            self.outcome = self.writer.cycle(true, &values);
        }
    }

    /// The finished waveform.
    ///
    /// # Errors
    /// If it could not be written.
    pub fn finish(self) -> Result<W, WaveError> {
        self.outcome?;
        self.writer.finish()
    }
}

/// Brings Verilator's own waveform into the golden one's form.
///
/// # Errors
/// If it cannot be read, lacks a signal, or the output cannot be written.
pub fn conform_verilator<W: Write>(
    unit: &TraverseUnit,
    raw: impl BufRead,
    first_cycle: u64,
    output: W,
) -> Result<(W, ConformReport), WaveError> {
    let options = ConformOptions {
        name: "Verilator's waveform".to_owned(),
        // The scope Verilator wraps around every design.
        strip: "TOP".to_owned(),
        rename: Vec::new(),
        clock: "TOP.clk_i".to_owned(),
        reset: Some("TOP.rst_ni".to_owned()),
        cycles: CycleNumbers::ByTime,
        writer: waveform_options(unit, first_cycle),
    };
    conform(raw, output, &waveform_signals(unit), &options)
}

/// A value as a person reads it.
pub fn decoded_value(meaning: Meaning, width: u32, value: u64) -> String {
    crate::wave::decoded(meaning, width, LogicWord::from(value)).unwrap_or_default()
}

/// How many representable numbers two floats of a signal lie apart; `None` for other signals, and
/// where a value is no number.
pub fn units_in_the_last_place(meaning: Meaning, a: u64, b: u64) -> Option<u64> {
    match meaning {
        Meaning::Float(format) => crate::wave::steps_between(format, a, b),
        Meaning::Bits | Meaning::Signed => None,
    }
}
