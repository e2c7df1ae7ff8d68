//! A simulator's waveform, brought to the golden waveform's hierarchy, signals and times.

use super::cycles::{CycleNumbers, CycleSampler};
use super::error::Names;
use super::reader::{Header, Reader};
use super::{LogicWord, SignalDeclaration, WaveError, Writer, WriterOptions};
use std::collections::HashMap;
use std::io::{BufRead, Write};

/// Where things are in the simulator's waveform, and how it is written anew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConformOptions {
    /// What the file is called in messages.
    pub name: String,
    /// The scope, with points, that holds the design's: `TOP` of Verilator, `testbench` of a
    /// testbench; empty where the design is outermost.
    pub strip: String,
    /// Renames scopes or signals, after the scope is stripped; the first that fits is taken.
    pub rename: Vec<Rename>,
    /// The clock's full name in the file, `TOP.clk_i`.
    pub clock: String,
    /// The full name of the reset, active low; without one, the written reset is always 1.
    pub reset: Option<String>,
    /// How the file's cycles are numbered.
    pub cycles: CycleNumbers,
    /// Period, shadows and annotations of what is written. The number of the first cycle is the
    /// file's, not this one.
    pub writer: WriterOptions,
}

/// One name for another: of a signal, or of a scope and so of all below it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rename {
    /// As the simulator has it, with points, without the stripped scope: `dut`.
    pub raw: String,
    /// As the design has it: `traverse`.
    pub conformed: String,
}

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConformReport {
    /// Signals, clock and reset aside.
    pub signals: usize,
    /// Cycles.
    pub cycles: u64,
    /// The number of the first.
    pub first_cycle: u64,
}

/// Reads a simulator's VCD, keeps the declared signals, and writes the value each has settled to
/// in every cycle as [`Writer`] does.
///
/// # Errors
/// If the file cannot be read or is not a VCD, declared signals are missing or of another width
/// (all missing ones are named together), the clock is not there or makes no whole cycle, or the
/// output cannot be written. The output is then incomplete: write to a temporary file.
pub fn conform<W: Write>(
    raw: impl BufRead,
    output: W,
    declarations: &[SignalDeclaration],
    options: &ConformOptions,
) -> Result<(W, ConformReport), WaveError> {
    let mut samples = Samples::open(raw, declarations, options)?;
    let Some(mut cycle) = samples.next_cycle()? else {
        return Err(WaveError::NoCycles {
            name: options.name.clone(),
        });
    };
    let mut report = ConformReport {
        signals: declarations.len(),
        cycles: 0,
        first_cycle: cycle,
    };
    let writer_options = WriterOptions {
        first_cycle: cycle,
        ..options.writer.clone()
    };
    let mut writer = Writer::new(output, declarations, &writer_options)?;
    loop {
        writer.skip_to(cycle)?;
        writer.cycle(samples.reset_n(), samples.values())?;
        report.cycles += 1;
        match samples.next_cycle()? {
            Some(next) => cycle = next,
            None => return Ok((writer.finish()?, report)),
        }
    }
}

/// The declared signals of a simulator's VCD, cycle by cycle, each with the value it has settled
/// to: what [`conform`] writes, for those who compare it at once.
pub struct Samples<R> {
    sampler: CycleSampler<R>,
    slots: Vec<usize>,
    reset_slot: Option<usize>,
    values: Vec<LogicWord>,
    reset_n: LogicWord,
}

impl<R: BufRead> Samples<R> {
    /// Reads the header and finds the signals. Of the options, those of the writer are not read.
    ///
    /// # Errors
    /// As [`conform`].
    pub fn open(
        raw: R,
        declarations: &[SignalDeclaration],
        options: &ConformOptions,
    ) -> Result<Samples<R>, WaveError> {
        let reader = Reader::open(&options.name, raw)?;
        let names = conformed_names(&reader.header, options);
        let mut watched = find_declared(&reader.header, &names, declarations, options)?;
        let clock = find_bit(&reader, &options.clock)?;
        if let Some(reset) = &options.reset {
            watched.push(find_bit(&reader, reset)?);
        }
        let (sampler, mut slots) = CycleSampler::new(reader, clock, &watched, options.cycles);
        let reset_slot = options.reset.as_ref().and_then(|_| slots.pop());
        Ok(Samples {
            sampler,
            values: vec![LogicWord::X; slots.len()],
            slots,
            reset_slot,
            reset_n: LogicWord::X,
        })
    }

    /// Reads on to the end of the next cycle and answers its number; none at the end of the file.
    ///
    /// # Errors
    /// If the file is not a VCD, or its clock does not go steadily.
    pub fn next_cycle(&mut self) -> Result<Option<u64>, WaveError> {
        let Some(cycle) = self.sampler.next_cycle()? else {
            return Ok(None);
        };
        for (value, &slot) in self.values.iter_mut().zip(&self.slots) {
            *value = self.sampler.value(slot)[0];
        }
        let known_1 = LogicWord::known(1);
        let reset_slot = self.reset_slot;
        self.reset_n = reset_slot.map_or(known_1, |slot| self.sampler.value(slot)[0]);
        Ok(Some(cycle.number))
    }

    /// The values of this cycle, one a declaration.
    pub fn values(&self) -> &[LogicWord] {
        &self.values
    }

    /// The level of the reset in this cycle.
    pub fn reset_n(&self) -> LogicWord {
        self.reset_n
    }
}

/// Every variable that holds bits, by the name the design knows it under.
fn conformed_names(header: &Header, options: &ConformOptions) -> HashMap<String, usize> {
    let mut names = HashMap::new();
    for (index, variable) in header.variables.iter().enumerate() {
        let full = header.full_name(variable);
        if !variable.is_bits() {
            continue;
        }
        if let Some(below) = below(&full, &options.strip) {
            let renamed = options.rename.iter().find_map(|rename| {
                if below == rename.raw {
                    return Some(rename.conformed.clone());
                }
                let rest = below.strip_prefix(&rename.raw)?.strip_prefix('.')?;
                Some(format!("{}.{rest}", rename.conformed))
            });
            let name = renamed.unwrap_or_else(|| below.to_owned());
            names.entry(name).or_insert(index);
        }
    }
    names
}

/// A name without its leading scope; None if it does not stand there.
fn below<'a>(full: &'a str, scope: &str) -> Option<&'a str> {
    if scope.is_empty() {
        Some(full)
    } else {
        full.strip_prefix(scope)?.strip_prefix('.')
    }
}

/// The variable of every declared signal.
fn find_declared(
    header: &Header,
    names: &HashMap<String, usize>,
    declarations: &[SignalDeclaration],
    options: &ConformOptions,
) -> Result<Vec<usize>, WaveError> {
    let mut missing = Vec::new();
    let mut found = Vec::new();
    for declaration in declarations {
        let full = declaration.full_name();
        let Some(&index) = names.get(&full) else {
            missing.push(full);
            continue;
        };
        let width = header.variables[index].width;
        if width != declaration.width {
            return Err(WaveError::Width {
                name: options.name.clone(),
                signal: full,
                found: width,
                declared: declaration.width,
            });
        }
        found.push(index);
    }
    if missing.is_empty() {
        Ok(found)
    } else {
        Err(WaveError::MissingSignals {
            name: options.name.clone(),
            strip: options.strip.clone(),
            missing: Names(missing),
        })
    }
}

/// The one-bit variable of this full name.
fn find_bit<R: BufRead>(reader: &Reader<R>, full_name: &str) -> Result<usize, WaveError> {
    let header = &reader.header;
    let bits = || {
        let all = header.variables.iter().enumerate();
        all.filter(|(_, variable)| variable.is_bits() && variable.width == 1)
    };
    bits()
        .find(|(_, variable)| header.full_name(variable) == full_name)
        .map(|(index, _)| index)
        .ok_or_else(|| WaveError::NoClock {
            name: reader.name.clone(),
            signal: full_name.to_owned(),
            has: Names(
                bits()
                    .map(|(_, variable)| header.full_name(variable))
                    .collect(),
            ),
        })
}
