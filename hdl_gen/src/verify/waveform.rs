//! The waveforms of a run, golden and simulated, with the same hierarchy and the same names.

use super::golden::{GoldenRun, History};
use super::traverse::driven_words;
use crate::netlist::Meaning;
use crate::units::{CycleWords, TraverseUnit};
use crate::wave::{
    ConformOptions, CycleNumbers, Dependency, EarlierSignal, LogicWord, Samples, SignalDeclaration,
    UnitInputs, WaveError, Writer, WriterOptions,
};
use rtl_model::machine::CycleInputs;
use std::io::{BufRead, Write};
use std::ops::{ControlFlow, RangeInclusive};

/// A clock period, in nanoseconds.
pub(super) const PERIOD_NS: u64 = 10;

/// The unit's input ports but clock and reset: those that are driven, and the memory's answer.
fn input_ports(unit: &TraverseUnit) -> impl Iterator<Item = String> {
    let driven = unit.driven_ports().into_iter();
    driven.chain([unit.height_port()])
}

/// The signals of a traverse unit's waveform: its input ports, then its probes.
pub fn waveform_signals(unit: &TraverseUnit) -> Vec<SignalDeclaration> {
    let ports = input_ports(unit).map(|name| {
        let wire = unit.design.input(&name).expect("a driven port is an input");
        let node = unit.design.node(wire);
        SignalDeclaration {
            path: vec![unit.design.name.clone()],
            name,
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
            || input_ports(unit).any(|port| path == format!("traverse.{port}"))
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
    let ports = input_ports(unit)
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

/// What a waveform shows of a cycle: the input ports, then the probes.
fn shown(inputs: &CycleInputs, height: u16, probes: impl Iterator<Item = u64>) -> Vec<LogicWord> {
    let ports = driven_words(inputs).into_iter().chain([height.into()]);
    ports.chain(probes).map(LogicWord::from).collect()
}

/// The synchronous memory's answers: each cycle's address gives the next cycle's height.
struct Heights<'a> {
    memory: &'a [u16],
    /// The place of the address among the probes.
    address: usize,
    answer: Option<u16>,
}

impl<'a> Heights<'a> {
    fn new(unit: &TraverseUnit, memory: &'a [u16]) -> Heights<'a> {
        let is_address = |probe: &crate::units::Probe| probe.name == "height_address_o";
        let address = unit.probes.iter().position(is_address);
        Heights {
            memory,
            address: address.expect("the unit has a memory"),
            answer: None,
        }
    }

    /// The height in a cycle with these probes. Before cycle 0 the address is that of the idle
    /// ray, as it is in it.
    fn next(&mut self, probes: &[u64]) -> u16 {
        let asked = self.memory[probes[self.address] as usize];
        self.answer.replace(asked).unwrap_or(asked)
    }
}

/// Writes the waveform of a golden run, from the first to the last cycle of `window` as far as the
/// run has them: every signal the golden model knows, under the names and in the hierarchy of the
/// Verilog, with the values of floats and signed integers beside their bits, and what each signal
/// is computed from in comments. Returns the output and the cycles written.
///
/// # Errors
/// If the window holds no cycle of the run, or the output cannot be written.
pub fn golden_waveform<W: Write>(
    unit: &TraverseUnit,
    run: &GoldenRun<'_>,
    window: RangeInclusive<u64>,
    output: W,
) -> Result<(W, u64), WaveError> {
    let options = waveform_options(unit, *window.start());
    let mut writer = Writer::new(output, &waveform_signals(unit), &options)?;
    let mut history = History::new(unit.latency.step);
    let mut heights = Heights::new(unit, run.pyramid.memory());
    let (mut cycle, mut written) = (0, 0);
    let mut outcome = Ok(());
    run.run(
        unit.configuration.format,
        |inputs, _, words: &CycleWords| {
            history.push(&words.0);
            let probes: Vec<u64> = unit
                .probes
                .iter()
                .map(|probe| history.expected(probe))
                .collect();
            let height = heights.next(&probes);
            if window.contains(&cycle) {
                outcome = writer.cycle(true, &shown(inputs, height, probes.into_iter()));
                written += 1;
            }
            cycle += 1;
            match outcome.is_ok() && cycle <= *window.end() {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        },
    );
    outcome?;
    if written == 0 {
        return Err(WaveError::CycleNumber {
            cycle: *window.start(),
            reason: format!("the run has {cycle} cycles, counted from 0"),
        });
    }
    Ok((writer.finish()?, written))
}

/// Writes what the embedded simulator shows, cycle by cycle.
pub struct SimulatedWaveform<'a, W: Write> {
    writer: Writer<W>,
    window: RangeInclusive<u64>,
    heights: Heights<'a>,
    outcome: Result<(), WaveError>,
}

impl<'a, W: Write> SimulatedWaveform<'a, W> {
    /// A waveform of a window of cycles of a unit with this memory.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn new(
        unit: &TraverseUnit,
        memory: &'a [u16],
        window: RangeInclusive<u64>,
        output: W,
    ) -> Result<Self, WaveError> {
        let options = waveform_options(unit, *window.start());
        let writer = Writer::new(output, &waveform_signals(unit), &options)?;
        let heights = Heights::new(unit, memory);
        Ok(SimulatedWaveform {
            writer,
            window,
            heights,
            outcome: Ok(()),
        })
    }

    /// Takes a cycle, in the form in which [`super::run_embedded`] shows it.
    pub fn observe(&mut self, cycle: u64, inputs: &CycleInputs, probes: &[u64]) {
        let height = self.heights.next(probes);
        if self.outcome.is_ok() && self.window.contains(&cycle) {
            let values = shown(inputs, height, probes.iter().copied());
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

/// Writes the cycles of a window out of a simulator's waveform in the golden one's form. Returns
/// the output and the cycles written.
///
/// # Errors
/// If the waveform cannot be read, lacks a signal or the window, or the output cannot be written.
pub fn conform_window<W: Write>(
    unit: &TraverseUnit,
    raw: impl BufRead,
    simulator: &ConformOptions,
    window: RangeInclusive<u64>,
    output: W,
) -> Result<(W, u64), WaveError> {
    let signals = waveform_signals(unit);
    let options = waveform_options(unit, *window.start());
    conform_signals(&signals, &options, raw, simulator, window, output)
}

/// The same of any design's signals, to be written with these options.
pub(super) fn conform_signals<W: Write>(
    signals: &[SignalDeclaration],
    options: &WriterOptions,
    raw: impl BufRead,
    simulator: &ConformOptions,
    window: RangeInclusive<u64>,
    output: W,
) -> Result<(W, u64), WaveError> {
    let mut samples = Samples::open(raw, signals, simulator)?;
    let mut writer = Writer::new(output, signals, options)?;
    let mut written = 0;
    while let Some(cycle) = samples.next_cycle()? {
        if cycle > *window.end() {
            break;
        }
        if window.contains(&cycle) {
            writer.skip_to(cycle)?;
            writer.cycle(samples.reset_n(), samples.values())?;
            written += 1;
        }
    }
    if written == 0 {
        return Err(WaveError::CycleNumber {
            cycle: *window.start(),
            reason: format!("{} does not reach it", simulator.name),
        });
    }
    Ok((writer.finish()?, written))
}

/// How Verilator's own waveform is read.
pub fn verilator_waveform() -> ConformOptions {
    ConformOptions {
        name: "Verilator's waveform".to_owned(),
        // The scope Verilator wraps around every design.
        strip: "TOP".to_owned(),
        rename: Vec::new(),
        clock: "TOP.clk_i".to_owned(),
        reset: Some("TOP.rst_ni".to_owned()),
        cycles: CycleNumbers::ByTime,
        writer: WriterOptions::default(),
    }
}

/// A value as a person reads it.
pub fn decoded_value(meaning: Meaning, width: u32, value: u64) -> String {
    crate::wave::decoded(meaning, width, LogicWord::from(value)).unwrap_or_default()
}

/// How many representable numbers two numbers of a signal lie apart; `None` for signals that are
/// none, and where a value is no number.
pub fn units_in_the_last_place(meaning: Meaning, a: u64, b: u64) -> Option<u64> {
    crate::wave::steps_between(meaning, a, b)
}
