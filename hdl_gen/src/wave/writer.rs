//! Writes a waveform from a stream of values, one a signal a cycle.

use super::annotations::{dependency_line, is_full_name, meaning_line, unit_inputs_line};
use super::decode::real_text;
use super::logic::binary;
use super::scopes::Scope;
use super::signal::joined;
use super::{
    CLOCK_NAME, Dependency, INTEGER_SHADOW_SUFFIX, LogicWord, REAL_SHADOW_SUFFIX, RESET_NAME,
    SignalDeclaration, UnitInputs, WaveError,
};
use crate::netlist::Meaning;
use rtl_model::fixed::{Fixed, FixedFormat};
use rtl_model::float::FloatFormat;
use std::collections::HashSet;
use std::io::Write;
use vcd::{IdCode, TimescaleUnit, VarType};

/// How a waveform is written, and what is said of it beside its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriterOptions {
    /// The clock's period in ns, at least 2. The clock rises at the beginning of a cycle and falls
    /// half a period (rounded down) later.
    pub period_ns: u64,
    /// The number of the first cycle written: where a window into a long run begins. Cycle c
    /// begins at `c * period_ns`.
    pub first_cycle: u64,
    /// Adds a VCD real `<name>_real` to every float and a VCD integer `<name>_int` to every signed
    /// signal, holding the decoded value. While a bit is unknown, the real is NaN and the integer
    /// all x.
    pub shadows: bool,
    /// What signals are computed from; written as comments.
    pub dependencies: Vec<Dependency>,
    /// What enters units; written as comments.
    pub unit_inputs: Vec<UnitInputs>,
}

impl Default for WriterOptions {
    /// 10 ns, from cycle 0, raw bits alone.
    fn default() -> WriterOptions {
        WriterOptions {
            period_ns: 10,
            first_cycle: 0,
            shadows: false,
            dependencies: Vec::new(),
            unit_inputs: Vec::new(),
        }
    }
}

/// The numbers that a real variable shows.
#[derive(Clone, Copy, Debug)]
enum RealOf {
    Float(FloatFormat),
    Fixed(FixedFormat),
}

impl RealOf {
    /// The number, or the `f64` nearest to it where it has too many bits for one.
    fn to_f64(self, bits: u64) -> f64 {
        match self {
            RealOf::Float(format) => format.to_f64(bits),
            RealOf::Fixed(format) => Fixed::new(format, bits).to_f64(),
        }
    }
}

/// A VCD variable that shows a signal's decoded value.
#[derive(Clone, Copy, Debug)]
enum Shadow {
    Real(RealOf, IdCode),
    /// With the integer's width: 32 bits, or 64 where the signal has more than 32.
    Integer(u32, IdCode),
}

#[derive(Debug)]
struct Track {
    id: IdCode,
    width: u32,
    last: Option<LogicWord>,
    shadow: Option<Shadow>,
}

/// Writes a VCD cycle by cycle, only what changes, with the clock `clk_i` and the reset `rst_ni` in
/// the outermost scope.
///
/// Times are in ns. The output holds no date: equal runs give equal files.
#[derive(Debug)]
pub struct Writer<W: Write> {
    output: W,
    /// Full names, for messages.
    names: Vec<String>,
    tracks: Vec<Track>,
    clock: IdCode,
    reset: Track,
    period_ns: u64,
    next_cycle: u64,
    /// Has a cycle been written?
    begun: bool,
    /// What is being written, so that the output sees few large writes.
    buffer: String,
}

impl<W: Write> Writer<W> {
    /// Writes the header: scopes in the order the declarations bring them up, and in each scope
    /// its signals in their order.
    ///
    /// # Errors
    /// If a declaration cannot be (see [`SignalDeclaration`]), two have one name, they share no
    /// outermost scope, the options contradict themselves, or the output cannot be written.
    pub fn new(
        output: W,
        declarations: &[SignalDeclaration],
        options: &WriterOptions,
    ) -> Result<Writer<W>, WaveError> {
        let top = check_declarations(declarations, options.shadows)?;
        check_options(options)?;
        let mut header = vcd::Writer::new(Vec::new());
        let mut ids = IdCode::FIRST;
        let mut tracks: Vec<Track> = Vec::new();
        let mut next_id = || {
            let id = ids;
            ids = ids.next();
            id
        };
        let (clock, reset) = (next_id(), next_id());
        for declaration in declarations {
            let id = next_id();
            let shadow = match declaration.meaning {
                Meaning::Float(format) if options.shadows => {
                    Some(Shadow::Real(RealOf::Float(format), next_id()))
                }
                Meaning::Fixed(format) if options.shadows => {
                    Some(Shadow::Real(RealOf::Fixed(format), next_id()))
                }
                Meaning::Signed if options.shadows => {
                    let width = if declaration.width > 32 { 64 } else { 32 };
                    Some(Shadow::Integer(width, next_id()))
                }
                _ => None,
            };
            tracks.push(Track {
                id,
                width: declaration.width,
                last: None,
                shadow,
            });
        }
        let mut write_header = || -> std::io::Result<()> {
            header.version(concat!("stepwell ", env!("CARGO_PKG_VERSION")))?;
            header.timescale(1, TimescaleUnit::NS)?;
            let meanings = declarations.iter().filter_map(meaning_line);
            let units = options.unit_inputs.iter().map(unit_inputs_line);
            let dependencies = options.dependencies.iter().map(dependency_line);
            for line in meanings.chain(units).chain(dependencies) {
                // One line each, so that they can be searched for.
                writeln!(header.writer(), "$comment {line} $end")?;
            }
            header.add_module(top)?;
            header.var_def(VarType::Wire, 1, clock, CLOCK_NAME, None)?;
            header.var_def(VarType::Wire, 1, reset, RESET_NAME, None)?;
            for scope in &Scope::of(declarations).children {
                write_scope_content(&mut header, scope, declarations, &tracks)?;
            }
            header.upscope()?;
            header.enddefinitions()
        };
        // Into memory: what can fail is the output, and that is written to below.
        write_header().map_err(WaveError::Write)?;
        let mut writer = Writer {
            output,
            names: declarations
                .iter()
                .map(SignalDeclaration::full_name)
                .collect(),
            tracks,
            clock,
            reset: Track {
                id: reset,
                width: 1,
                last: None,
                shadow: None,
            },
            period_ns: options.period_ns,
            next_cycle: options.first_cycle,
            begun: false,
            buffer: String::new(),
        };
        let text = std::mem::take(header.writer());
        writer.output.write_all(&text).map_err(WaveError::Write)?;
        Ok(writer)
    }

    /// The number of the cycle that [`Writer::cycle`] writes next.
    pub fn next_cycle(&self) -> u64 {
        self.next_cycle
    }

    /// Leaves out the cycles before this one: nothing is said of them, the clock rests at 0.
    ///
    /// # Errors
    /// If the cycle is behind [`Writer::next_cycle`].
    pub fn skip_to(&mut self, cycle: u64) -> Result<(), WaveError> {
        if cycle < self.next_cycle {
            return Err(WaveError::CycleNumber {
                cycle,
                reason: format!("cycles up to {} are written", self.next_cycle - 1),
            });
        }
        self.next_cycle = cycle;
        Ok(())
    }

    /// Writes one cycle: the level of `rst_ni` (0 is reset) and one value a declared signal, in
    /// their order.
    ///
    /// # Errors
    /// If there are more or fewer values than signals, a value has bits beyond its signal's width
    /// (unknown bits beyond it are cut), the cycle's time is beyond 64 bits of ns, or the output
    /// cannot be written.
    pub fn cycle(
        &mut self,
        reset_n: impl Into<LogicWord>,
        values: &[LogicWord],
    ) -> Result<(), WaveError> {
        let cycle = self.next_cycle;
        if values.len() != self.tracks.len() {
            return Err(WaveError::ValueCount {
                cycle,
                given: values.len(),
                expected: self.tracks.len(),
            });
        }
        for ((value, track), name) in values.iter().zip(&self.tracks).zip(&self.names) {
            let beyond = value.value & !value.unknown;
            if value.low_bits(track.width).value & beyond != beyond {
                return Err(WaveError::ValueWidth {
                    cycle,
                    signal: name.clone(),
                    value: value.value,
                    width: track.width,
                });
            }
        }
        let begin = self.time_of(cycle)?;
        // The end of the cycle must be a time too, for `finish`.
        self.time_of(cycle.saturating_add(1))?;
        let first = !self.begun;
        self.begun = true;
        self.buffer += &format!("#{begin}\n");
        if first {
            self.buffer += "$dumpvars\n";
        }
        self.buffer += &format!("1{}\n", self.clock);
        self.reset
            .write_change(&mut self.buffer, reset_n.into().low_bits(1));
        for (track, value) in self.tracks.iter_mut().zip(values) {
            track.write_change(&mut self.buffer, value.low_bits(track.width));
        }
        if first {
            self.buffer += "$end\n";
        }
        self.buffer += &format!("#{}\n0{}\n", begin + self.period_ns / 2, self.clock);
        self.next_cycle = cycle + 1;
        self.flush_buffer()
    }

    /// Ends the waveform at the end of the last cycle and gives the output back, flushed.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn finish(mut self) -> Result<W, WaveError> {
        if self.begun {
            let end = self.time_of(self.next_cycle)?;
            self.buffer += &format!("#{end}\n");
            self.flush_buffer()?;
        }
        self.output.flush().map_err(WaveError::Write)?;
        Ok(self.output)
    }

    fn flush_buffer(&mut self) -> Result<(), WaveError> {
        self.output
            .write_all(self.buffer.as_bytes())
            .map_err(WaveError::Write)?;
        self.buffer.clear();
        Ok(())
    }

    fn time_of(&self, cycle: u64) -> Result<u64, WaveError> {
        cycle
            .checked_mul(self.period_ns)
            .filter(|_| cycle < u64::MAX)
            .ok_or_else(|| WaveError::CycleNumber {
                cycle,
                reason: format!(
                    "at {} ns a cycle its time is beyond 64 bits",
                    self.period_ns
                ),
            })
    }
}

impl Track {
    /// Writes the value and its shadow, if they differ from what was written last.
    fn write_change(&mut self, text: &mut String, value: LogicWord) {
        if self.last == Some(value) {
            return;
        }
        self.last = Some(value);
        *text += &if self.width == 1 {
            format!("{}{}\n", value.digit(0) as char, self.id)
        } else {
            format!("b{} {}\n", binary(&[value], self.width), self.id)
        };
        match self.shadow {
            None => {}
            Some(Shadow::Real(format, id)) => {
                let real = value
                    .as_known()
                    .map_or(f64::NAN, |bits| format.to_f64(bits));
                *text += &format!("r{} {id}\n", real_text(real));
            }
            Some(Shadow::Integer(width, id)) => {
                let extended = match value.as_known() {
                    Some(bits) => {
                        LogicWord::known(super::two_s_complement(self.width, bits) as u64)
                    }
                    None => LogicWord::X,
                };
                *text += &format!("b{} {id}\n", binary(&[extended], width));
            }
        }
    }
}

/// Writes what stands in a scope, and the scopes below it whole.
fn write_scope_content(
    header: &mut vcd::Writer<Vec<u8>>,
    scope: &Scope,
    declarations: &[SignalDeclaration],
    tracks: &[Track],
) -> std::io::Result<()> {
    for &signal in &scope.signals {
        let (declaration, track) = (&declarations[signal], &tracks[signal]);
        let name = &declaration.name;
        header.var_def(
            VarType::Wire,
            track.width,
            track.id,
            name,
            index_of(track.width),
        )?;
        match track.shadow {
            None => {}
            Some(Shadow::Real(_, id)) => {
                let shadow = format!("{name}{REAL_SHADOW_SUFFIX}");
                header.var_def(VarType::Real, 64, id, &shadow, None)?;
            }
            Some(Shadow::Integer(width, id)) => {
                let shadow = format!("{name}{INTEGER_SHADOW_SUFFIX}");
                header.var_def(VarType::Integer, width, id, &shadow, None)?;
            }
        }
    }
    for child in &scope.children {
        header.add_module(&child.name)?;
        write_scope_content(header, child, declarations, tracks)?;
        header.upscope()?;
    }
    Ok(())
}

/// The range simulators print after a vector's name.
fn index_of(width: u32) -> Option<vcd::ReferenceIndex> {
    (width > 1).then(|| vcd::ReferenceIndex::Range(width as i32 - 1, 0))
}

/// Checks every declaration and their names together; returns the outermost scope.
fn check_declarations(
    declarations: &[SignalDeclaration],
    shadows: bool,
) -> Result<&str, WaveError> {
    for declaration in declarations {
        declaration.check()?;
    }
    let Some(first) = declarations.first() else {
        return Err(WaveError::Options(
            "a waveform without signals; declare at least one".to_owned(),
        ));
    };
    let top = &first.path[..1];
    let mut names: HashSet<String> =
        HashSet::from([joined(top, CLOCK_NAME), joined(top, RESET_NAME)]);
    for declaration in declarations {
        let wrong = |reason: String| WaveError::Declaration {
            signal: declaration.full_name(),
            reason,
        };
        if declaration.path[..1] != *top {
            return Err(wrong(format!(
                "it does not stand under `{}`, as the first signal does",
                top[0]
            )));
        }
        let suffix = match declaration.meaning {
            Meaning::Float(_) | Meaning::Fixed(_) if shadows => Some(REAL_SHADOW_SUFFIX),
            Meaning::Signed if shadows => Some(INTEGER_SHADOW_SUFFIX),
            _ => None,
        };
        let full = declaration.full_name();
        for name in suffix
            .map(|s| format!("{full}{s}"))
            .into_iter()
            .chain([full])
        {
            if let Some(name) = names.replace(name) {
                return Err(wrong(format!("two variables would be named `{name}`")));
            }
        }
    }
    Ok(&top[0])
}

fn check_options(options: &WriterOptions) -> Result<(), WaveError> {
    if options.period_ns < 2 {
        return Err(WaveError::Options(format!(
            "a clock period of {} ns; it is a whole number of ns, at least 2",
            options.period_ns
        )));
    }
    let units = options
        .unit_inputs
        .iter()
        .flat_map(|unit| std::iter::once(&unit.unit).chain(&unit.inputs));
    let dependencies = options.dependencies.iter().flat_map(|dependency| {
        std::iter::once(&dependency.signal)
            .chain(dependency.inputs.iter().map(|input| &input.signal))
    });
    match units.chain(dependencies).find(|name| !is_full_name(name)) {
        Some(name) => Err(WaveError::Options(format!(
            "a dependency names `{name}`, which is no signal's name"
        ))),
        None => Ok(()),
    }
}
