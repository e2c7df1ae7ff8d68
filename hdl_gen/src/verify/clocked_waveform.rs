//! The waveforms of a clocked unit's run: golden, and of each simulator, with the same hierarchy
//! and the same names.

use std::io::{BufRead, Write};
use std::ops::{ControlFlow, RangeInclusive};

use super::clocked::ClockedRun;
use super::divergence::Comparison;
use super::golden::History;
use super::waveform::{PERIOD_NS, conform_signals};
use crate::simulate::SimulateError;
use crate::wave::{
    ConformOptions, LogicWord, SignalDeclaration, UnitInputs, WaveError, Writer, WriterOptions,
};

/// The output of a waveform and the cycles written, or why it could not be written.
pub type WrittenWaveform<W> = Result<(W, u64), WaveError>;

impl ClockedRun<'_> {
    /// The signals of the unit's waveform: the ports driven, then what is compared.
    pub fn waveform_signals(&self) -> Vec<SignalDeclaration> {
        let ports = self.driven.iter().map(|&name| {
            let wire = self.unit.input(name).expect("a driven port is an input");
            let node = self.unit.node(wire);
            SignalDeclaration {
                path: vec![self.unit.name.clone()],
                name: name.to_owned(),
                width: node.width,
                meaning: node.meaning,
            }
        });
        let probes = self.probes.iter().map(|probe| SignalDeclaration {
            path: probe.scope.clone(),
            name: probe.name.clone(),
            width: probe.width,
            meaning: probe.meaning,
        });
        ports.chain(probes).collect()
    }

    fn waveform_options(&self, first_cycle: u64) -> WriterOptions {
        let top = &self.unit.name;
        let ports = self.driven.iter().map(|port| format!("{top}.{port}"));
        WriterOptions {
            period_ns: PERIOD_NS,
            first_cycle,
            shadows: true,
            dependencies: Vec::new(),
            unit_inputs: vec![UnitInputs {
                unit: top.clone(),
                inputs: ports.collect(),
            }],
        }
    }

    /// Writes the waveform of the golden run, from the first to the last cycle of `window` as far as
    /// the run has them: every port that is driven and every signal that is compared, under the
    /// names and in the hierarchy of the Verilog, with the values of floats and signed integers
    /// beside their bits. Returns the output and the cycles written.
    ///
    /// # Errors
    /// If the window holds no cycle of the run, or the output cannot be written.
    pub fn golden_waveform<W: Write>(
        &self,
        window: RangeInclusive<u64>,
        output: W,
    ) -> WrittenWaveform<W> {
        let mut wave = self.window(window, output)?;
        let longest = self.probes.iter().map(|probe| probe.delay).max();
        let mut history = History::new(longest.unwrap_or(0));
        let mut golden = Vec::new();
        let _ = (self.traffic)(&mut |driven, words| {
            history.push(words);
            golden.clear();
            let expected = self.probes.iter().map(|probe| history.expected(probe));
            golden.extend(expected);
            wave.take(driven, &golden)
        });
        wave.finish("the golden run")
    }

    /// Runs the unit in the embedded simulator, as [`ClockedRun::embedded`], and writes the waveform
    /// of what it shows, as [`ClockedRun::golden_waveform`] writes the golden one.
    ///
    /// # Errors
    /// The outer one: if the netlist cannot be simulated. The inner one: as of the golden waveform.
    pub fn embedded_waveform<W: Write>(
        &self,
        window: RangeInclusive<u64>,
        output: W,
    ) -> Result<(Comparison, WrittenWaveform<W>), SimulateError> {
        let mut wave = self.window(window, output);
        let comparison = self.embedded_observed(|driven, found| {
            if let Ok(wave) = &mut wave {
                // Beyond the window the comparison goes on.
                let _ = wave.take(driven, found);
            }
        })?;
        let written = wave.and_then(|wave| wave.finish("the embedded simulator's run"));
        Ok((comparison, written))
    }

    /// Writes the cycles of a window out of a simulator's waveform in the golden one's form. Returns
    /// the output and the cycles written.
    ///
    /// # Errors
    /// If the waveform cannot be read, lacks a signal or the window, or the output cannot be written.
    pub fn conform_waveform<W: Write>(
        &self,
        raw: impl BufRead,
        simulator: &ConformOptions,
        window: RangeInclusive<u64>,
        output: W,
    ) -> WrittenWaveform<W> {
        let signals = self.waveform_signals();
        let options = self.waveform_options(*window.start());
        conform_signals(&signals, &options, raw, simulator, window, output)
    }

    fn window<W: Write>(
        &self,
        window: RangeInclusive<u64>,
        output: W,
    ) -> Result<WaveWindow<W>, WaveError> {
        let options = self.waveform_options(*window.start());
        Ok(WaveWindow {
            writer: Writer::new(output, &self.waveform_signals(), &options)?,
            window,
            cycle: 0,
            written: 0,
            outcome: Ok(()),
        })
    }
}

/// The cycles of a window on their way into a file.
struct WaveWindow<W: Write> {
    writer: Writer<W>,
    window: RangeInclusive<u64>,
    /// The number of the next cycle taken.
    cycle: u64,
    written: u64,
    outcome: Result<(), WaveError>,
}

impl<W: Write> WaveWindow<W> {
    /// Takes a cycle; breaks behind the window, or where the output cannot be written.
    fn take(&mut self, driven: &[u64], probes: &[u64]) -> ControlFlow<()> {
        if self.outcome.is_ok() && self.window.contains(&self.cycle) {
            let words = driven.iter().chain(probes);
            let values: Vec<LogicWord> = words.map(|&word| LogicWord::from(word)).collect();
            self.outcome = self.writer.cycle(true, &values);
            self.written += 1;
        }
        self.cycle += 1;
        match self.outcome.is_ok() && self.cycle <= *self.window.end() {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    }

    fn finish(self, run: &str) -> WrittenWaveform<W> {
        self.outcome?;
        if self.written == 0 {
            return Err(WaveError::CycleNumber {
                cycle: *self.window.start(),
                reason: format!("{run} has {} cycles, counted from 0", self.cycle),
            });
        }
        Ok((self.writer.finish()?, self.written))
    }
}
