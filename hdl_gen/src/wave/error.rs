//! What can go wrong with a waveform.

use std::fmt;
use thiserror::Error;

/// Why a waveform could not be written, read or compared.
#[derive(Debug, Error)]
pub enum WaveError {
    /// A file could not be opened or read.
    #[error("{name}: {source}")]
    Read {
        /// The file.
        name: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The output could not be written.
    #[error("the waveform could not be written: {0}")]
    Write(#[source] std::io::Error),
    /// Not the syntax of VCD.
    #[error("{name}, line {line}: {reason}; is it a VCD file, and whole?")]
    Syntax {
        /// The file.
        name: String,
        /// Counted from 1.
        line: u64,
        /// What is wrong there.
        reason: String,
    },
    /// The file ends in the middle of a declaration or a value.
    #[error(
        "{name}, line {line}: the file ends in the middle of a line or of its header; \
         was the simulator stopped before it closed the file? Simulate again"
    )]
    Truncated {
        /// The file.
        name: String,
        /// Counted from 1.
        line: u64,
    },
    /// A header line of ours that does not read back.
    #[error("{name}: `$comment {text}`: {reason}; remove the line or write the waveform anew")]
    Annotation {
        /// The file.
        name: String,
        /// The comment.
        text: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A signal that no waveform can hold.
    #[error("signal `{signal}`: {reason}")]
    Declaration {
        /// Its full name.
        signal: String,
        /// Why not.
        reason: String,
    },
    /// Options of a writer that contradict each other or the format.
    #[error("waveform options: {0}")]
    Options(String),
    /// Not one value a signal.
    #[error("cycle {cycle}: {given} values for {expected} signals")]
    ValueCount {
        /// The cycle.
        cycle: u64,
        /// Values given.
        given: usize,
        /// Signals declared.
        expected: usize,
    },
    /// A value with bits beyond its signal's width.
    #[error("cycle {cycle}: the value {value:#x} of `{signal}` has more than {width} bits")]
    ValueWidth {
        /// The cycle.
        cycle: u64,
        /// The signal's full name.
        signal: String,
        /// The value.
        value: u64,
        /// The signal's width.
        width: u32,
    },
    /// Cycles out of order, or beyond what a VCD time can say.
    #[error("cycle {cycle} cannot be written: {reason}")]
    CycleNumber {
        /// The cycle.
        cycle: u64,
        /// Why not.
        reason: String,
    },
    /// Declared signals that the simulator's waveform lacks.
    #[error(
        "{name}: {missing} of the design's signals are not in it: {missing:#}; check the scope \
         to strip (`{strip}`), and that the simulator traces to full depth and keeps the names"
    )]
    MissingSignals {
        /// The file.
        name: String,
        /// The scope that was stripped.
        strip: String,
        /// Their names, as looked for under the stripped scope.
        missing: Names,
    },
    /// A declared signal of another width in the simulator's waveform.
    #[error("{name}: `{signal}` is {found} bits wide, and {declared} in the design")]
    Width {
        /// The file.
        name: String,
        /// Its full name.
        signal: String,
        /// Bits in the file.
        found: u32,
        /// Bits declared.
        declared: u32,
    },
    /// No clock or reset of the name or path given.
    #[error("{name}: no one-bit signal `{signal}` to tell cycles by; it has {has:#}")]
    NoClock {
        /// The file.
        name: String,
        /// What was looked for.
        signal: String,
        /// Some signals that are there.
        has: Names,
    },
    /// A signal that is asked for by a name that means none, or several.
    #[error("{name}: signal `{signal}`: {reason}")]
    NoSignal {
        /// The file.
        name: String,
        /// The name.
        signal: String,
        /// What is the matter, and the way out.
        reason: String,
    },
    /// None of the cycles asked for.
    #[error("{name}: no cycle from {first} to {last} is in it")]
    NoWindow {
        /// The file.
        name: String,
        /// The first.
        first: u64,
        /// The last.
        last: u64,
    },
    /// Two rising edges too near to each other to be two cycles.
    #[error(
        "{name}: the clock rises at {time_ns} ns, less than half a period after the edge before; \
         cycles can be told apart only by a steady clock"
    )]
    IrregularClock {
        /// The file.
        name: String,
        /// Time of the later edge.
        time_ns: f64,
    },
    /// The clock never made a whole cycle.
    #[error("{name}: the clock makes no whole cycle, so there is nothing to sample")]
    NoCycles {
        /// The file.
        name: String,
    },
    /// The two waveforms share no signal.
    #[error(
        "no signal is in both waveforms, so nothing was compared.\n  {golden}\n  {other}\n\
         Signals pair by hierarchical name. If one design stands in different scopes, name the \
         scope that stands for it on each side (--golden-scope, --other-scope)."
    )]
    NoCommonSignals {
        /// What the first has.
        golden: Box<SideNames>,
        /// What the second has.
        other: Box<SideNames>,
    },
    /// A scope to strip that is not there.
    #[error("{name}: no scope `{scope}`; its scopes are {has:#}")]
    NoScope {
        /// The file.
        name: String,
        /// The scope.
        scope: String,
        /// Scopes that are there.
        has: Names,
    },
    /// Signals in common, but no value of any of them could be compared.
    #[error("nothing was compared: {0}")]
    NothingCompared(String),
}

/// What one waveform has, for people to see why it does not pair with another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SideNames {
    /// The file.
    pub name: String,
    /// Its outermost scopes.
    pub top_scopes: Names,
    /// Its signals.
    pub signals: Names,
}

impl fmt::Display for SideNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: top scopes {:#}; signals {:#}",
            self.name, self.top_scopes, self.signals
        )
    }
}

/// A list of names, of which a message shows the first few. `{}` gives how many there are, `{:#}`
/// the names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names(pub Vec<String>);

impl Names {
    const SHOWN: usize = 12;
}

impl fmt::Display for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !f.alternate() {
            return write!(f, "{}", self.0.len());
        }
        if self.0.is_empty() {
            return f.write_str("none");
        }
        for (index, name) in self.0.iter().take(Names::SHOWN).enumerate() {
            write!(f, "{}`{name}`", if index == 0 { "" } else { ", " })?;
        }
        match self.0.len().saturating_sub(Names::SHOWN) {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}
