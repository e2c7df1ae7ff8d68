//! What a comparison of two waveforms found, for programs and for people.

use super::Cause;
use serde::Serialize;
use std::fmt;

/// What a comparison of two waveforms found.
///
/// As JSON it has the `schema` `stepwell-wavediff-1`.
#[derive(Clone, Debug, Serialize)]
pub struct DiffReport {
    /// The name and version of this form.
    pub schema: &'static str,
    /// No value differs, no signal has two widths, and the resets go together.
    pub agreed: bool,
    /// The first waveform.
    pub golden: SideReport,
    /// The second waveform.
    pub other: SideReport,
    /// Signals in both, clock, reset and decoded shadows aside.
    pub signals_compared: usize,
    /// Cycles compared: in both waveforms, and out of reset.
    pub cycles_compared: u64,
    /// The first of them.
    pub first_cycle_compared: u64,
    /// The last of them.
    pub last_cycle_compared: u64,
    /// Cycles in both waveforms that were passed over because of reset.
    pub cycles_in_reset: u64,
    /// (signal, cycle) pairs that differ.
    pub differing_pairs: u64,
    /// (signal, cycle) pairs that agree but for bits that are unknown on both sides, or in the
    /// golden waveform if those are excused.
    pub partly_unknown_pairs: u64,
    /// Signals that differ in any cycle.
    pub signals_differing: usize,
    /// Cycles, after both first left reset, in which one is in reset and the other is not.
    pub reset_disagreements: u64,
    /// Signals of different widths; they are not compared further.
    pub width_mismatches: Vec<WidthMismatch>,
    /// The first cycle with a difference.
    pub first_divergence: Option<FirstDivergence>,
    /// What else should be known: different time spans, stripped scopes, gaps.
    pub notes: Vec<String>,
}

/// One side of a comparison.
#[derive(Clone, Debug, Serialize)]
pub struct SideReport {
    /// The file.
    pub name: String,
    /// The scope that was stripped from its names; empty if none.
    pub stripped_scope: String,
    /// The first cycle it has.
    pub first_cycle: u64,
    /// The last cycle it has.
    pub last_cycle: u64,
    /// How many signals only it has.
    pub signals_only_here: usize,
    /// Some of them.
    pub examples_only_here: Vec<String>,
}

/// A signal that is not equally wide in both.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct WidthMismatch {
    /// Its full name.
    pub signal: String,
    /// Bits in the first.
    pub golden_width: u32,
    /// Bits in the second.
    pub other_width: u32,
}

/// The first cycle in which a signal differs.
#[derive(Clone, Debug, Serialize)]
pub struct FirstDivergence {
    /// The cycle.
    pub cycle: u64,
    /// When it begins in the first waveform.
    pub golden_time_ns: f64,
    /// When it begins in the second.
    pub other_time_ns: f64,
    /// How many signals differ in it.
    pub signals_total: usize,
    /// Those that are shown: likely causes first.
    pub signals: Vec<DivergingSignal>,
}

/// A signal that differs in the first cycle with a difference.
#[derive(Clone, Debug, Serialize)]
pub struct DivergingSignal {
    /// The cycle.
    pub cycle: u64,
    /// When it begins in the first waveform.
    pub time_ns: f64,
    /// The scopes it stands in.
    pub unit: String,
    /// Its name in its module.
    pub signal: String,
    /// Bits.
    pub width: u32,
    /// How its bits are read: `unsigned`, `signed` or `float eXfY`.
    pub meaning: String,
    /// The value in the first.
    pub golden: ValueReport,
    /// The value in the second.
    pub other: ValueReport,
    /// Of floats: how many representable values one steps over from one to the other (see
    /// [`super::steps_between`]); none with NaN or unknown bits.
    pub ulps: Option<u64>,
    /// What its inputs say.
    pub cause: Cause,
}

/// A value, twice.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ValueReport {
    /// In hexadecimal; `x` and `z` for unknown and undriven digits, `X` and `Z` if partly so.
    pub hex: String,
    /// As a number; none if a bit is unknown or there are more than 64.
    pub decoded: Option<String>,
}

impl DiffReport {
    /// The name and version of its form as JSON.
    pub const SCHEMA: &'static str = "stepwell-wavediff-1";
}

impl fmt::Display for ValueReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.decoded {
            Some(decoded) => write!(f, "{}  {decoded}", self.hex),
            None => f.write_str(&self.hex),
        }
    }
}

impl fmt::Display for DivergingSignal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let point = if self.unit.is_empty() { "" } else { "." };
        writeln!(
            f,
            "  {}{point}{}  ({} bits, {})",
            self.unit, self.signal, self.width, self.meaning
        )?;
        writeln!(f, "    golden  {}", self.golden)?;
        writeln!(f, "    other   {}", self.other)?;
        write!(f, "    ")?;
        if let Some(ulps) = self.ulps {
            write!(f, "{ulps} ulp apart; ")?;
        }
        writeln!(f, "{}", self.cause)
    }
}

/// "1 signal", "2 signals".
fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

impl fmt::Display for DiffReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.agreed { "agree" } else { "disagree" };
        writeln!(f, "{} and {} {verdict}", self.golden.name, self.other.name)?;
        if let Some(divergence) = &self.first_divergence {
            self.write_divergence(f, divergence)?;
        }
        if self.reset_disagreements > 0 {
            writeln!(
                f,
                "in {} one is in reset and the other is not",
                counted(self.reset_disagreements, "cycle")
            )?;
        }
        for mismatch in &self.width_mismatches {
            writeln!(
                f,
                "{} has {} bits in golden and {} in other",
                mismatch.signal, mismatch.golden_width, mismatch.other_width
            )?;
        }
        writeln!(
            f,
            "compared {} in {} ({} to {}), passed over {} in reset",
            counted(self.signals_compared as u64, "signal"),
            counted(self.cycles_compared, "cycle"),
            self.first_cycle_compared,
            self.last_cycle_compared,
            self.cycles_in_reset
        )?;
        if self.partly_unknown_pairs > 0 {
            writeln!(
                f,
                "of {} some bits are unknown and were not compared",
                counted(self.partly_unknown_pairs, "value")
            )?;
        }
        for side in [&self.golden, &self.other] {
            side.write_only_here(f)?;
        }
        for note in &self.notes {
            writeln!(f, "note: {note}")?;
        }
        Ok(())
    }
}

impl DiffReport {
    fn write_divergence(
        &self,
        f: &mut fmt::Formatter<'_>,
        divergence: &FirstDivergence,
    ) -> fmt::Result {
        write!(
            f,
            "\nfirst in cycle {}, at {} ns",
            divergence.cycle, divergence.golden_time_ns
        )?;
        if divergence.other_time_ns != divergence.golden_time_ns {
            write!(f, " ({} ns in other)", divergence.other_time_ns)?;
        }
        writeln!(
            f,
            ", in {}:\n",
            counted(divergence.signals_total as u64, "signal")
        )?;
        for signal in &divergence.signals {
            write!(f, "{signal}")?;
        }
        match divergence.signals_total - divergence.signals.len() {
            0 => {}
            more => writeln!(f, "  and {more} more")?,
        }
        writeln!(
            f,
            "\nin all, {} differ, in {}",
            counted(self.differing_pairs, "value"),
            counted(self.signals_differing as u64, "signal")
        )
    }
}

impl SideReport {
    fn write_only_here(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.signals_only_here == 0 {
            return Ok(());
        }
        write!(
            f,
            "{} only in {}: {}",
            counted(self.signals_only_here as u64, "signal"),
            self.name,
            self.examples_only_here.join(", ")
        )?;
        let shown = self.examples_only_here.len();
        writeln!(
            f,
            "{}",
            if shown < self.signals_only_here {
                ", ..."
            } else {
                ""
            }
        )
    }
}
