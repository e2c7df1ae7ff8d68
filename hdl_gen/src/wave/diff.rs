//! Compares two waveforms, cycle by cycle.

use super::annotations::Annotations;
use super::cause::{Agreement, Causes};
use super::cycles::{Cycle, CycleNumbers, CycleSampler, nanoseconds};
use super::error::{Names, SideNames};
use super::logic::hexadecimal;
use super::pairing::{Side, by_name, only_in, outermost, pair_sides, scope_named};
use super::reader::{Header, Reader};
use super::report::{
    DiffReport, DivergingSignal, FirstDivergence, SideReport, ValueReport, WidthMismatch,
};
use super::signal::Dependency;
use super::{CLOCK_NAME, LogicWord, RESET_NAME, UnitInputs, WaveError, decoded, steps_between};
use crate::netlist::Meaning;
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// A VCD to compare: what it is called in messages, and where it is read from.
#[derive(Debug)]
pub struct Waveform<R> {
    /// The file's name.
    pub name: String,
    /// Its content.
    pub input: R,
}

/// What the caller knows of one side.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SideOptions {
    /// The scope, with points, that stands for the whole: what is below it is compared, under
    /// names without it. Where none is given it is found (`TOP`, `testbench`).
    pub scope: Option<String>,
    /// How its cycles are numbered.
    pub cycles: CycleNumbers,
}

/// How two waveforms are compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiffOptions {
    /// Of the first.
    pub golden: SideOptions,
    /// Of the second.
    pub other: SideOptions,
    /// How signals are meant, by the names they pair by; goes before what the files say.
    pub meanings: Vec<(String, Meaning)>,
    /// How many signals of the first divergence are reported in full.
    pub signals_shown: usize,
    /// Takes x in the first waveform for "need not be compared". A register without reset holds
    /// nothing the model can name until it is first written, and a two-valued simulator shows
    /// some value there.
    pub excuse_golden_unknown: bool,
}

impl Default for DiffOptions {
    /// Scopes found, cycles by time, 20 signals shown, x equal to x alone.
    fn default() -> DiffOptions {
        DiffOptions {
            golden: SideOptions::default(),
            other: SideOptions::default(),
            meanings: Vec::new(),
            signals_shown: 20,
            excuse_golden_unknown: false,
        }
    }
}

/// [`diff`] of two files.
///
/// # Errors
/// As [`diff`], or if a file cannot be opened.
pub fn diff_files(
    golden: &Path,
    other: &Path,
    options: &DiffOptions,
) -> Result<DiffReport, WaveError> {
    let open = |path: &Path| {
        let name = path.display().to_string();
        match File::open(path) {
            Ok(file) => Ok(Waveform {
                name,
                input: BufReader::with_capacity(1 << 16, file),
            }),
            Err(source) => Err(WaveError::Read { name, source }),
        }
    };
    diff(open(golden)?, open(other)?, options)
}

/// Compares two waveforms: every signal that both have, in every cycle that both have and in which
/// neither is in reset, by the values settled at the cycle's end.
///
/// Signals pair by hierarchical name; an outer scope that only one side has is stripped. Clocks,
/// resets and decoded shadows are not compared. The outermost `clk_i` tells the cycles and the
/// outermost `rst_ni`, if there is one, the reset. Up to the cycle in which both have left reset
/// nothing is compared, later only what is not in reset on both sides. A bit that is x or z on one
/// side differs from everything but itself.
///
/// Both files are read once, side by side; memory does not grow with their length.
///
/// # Errors
/// If a file cannot be read or is no whole VCD, has no clock, or if nothing could be compared: no
/// common signals, no common cycles out of reset, no known value.
pub fn diff(
    golden: Waveform<impl BufRead>,
    other: Waveform<impl BufRead>,
    options: &DiffOptions,
) -> Result<DiffReport, WaveError> {
    let golden = Reader::open(&golden.name, golden.input)?;
    let other = Reader::open(&other.name, other.input)?;
    let scope_of = |reader_name: &str, header: &Header, side: &SideOptions| {
        let scope = side.scope.as_deref();
        scope
            .map(|scope| scope_named(reader_name, header, scope))
            .transpose()
    };
    let (golden_side, other_side) = pair_sides(
        &golden.header,
        &other.header,
        scope_of(&golden.name, &golden.header, &options.golden)?,
        scope_of(&other.name, &other.header, &options.other)?,
    );
    let (pairs, width_mismatches) = paired(&golden, &golden_side, &other, &other_side)?;
    let (causes, meanings) = annotated(
        (&golden, &golden_side),
        (&other, &other_side),
        &pairs,
        options,
    )?;
    let golden_report = side_report(&golden, &golden_side, &other_side, &options.golden);
    let other_report = side_report(&other, &other_side, &golden_side, &options.other);

    let golden = Track::new(
        golden,
        &golden_side,
        &pairs,
        |pair| pair.golden,
        &options.golden,
    )?;
    let other = Track::new(
        other,
        &other_side,
        &pairs,
        |pair| pair.other,
        &options.other,
    )?;
    Comparison {
        agreements: vec![Agreement::Equal; pairs.len()],
        ever_differed: vec![false; pairs.len()],
        pairs,
        meanings,
        causes,
        options,
        golden,
        other,
        report: DiffReport {
            schema: DiffReport::SCHEMA,
            agreed: false,
            golden: golden_report,
            other: other_report,
            signals_compared: 0,
            cycles_compared: 0,
            first_cycle_compared: 0,
            last_cycle_compared: 0,
            cycles_in_reset: 0,
            differing_pairs: 0,
            partly_unknown_pairs: 0,
            signals_differing: 0,
            reset_disagreements: 0,
            width_mismatches,
            first_divergence: None,
            notes: Vec::new(),
        },
    }
    .run()
}

/// A signal that both have.
#[derive(Debug)]
struct Pair {
    name: String,
    width: u32,
    /// Indices into the headers' variables.
    golden: usize,
    other: usize,
}

/// Pairs the signals of both sides by name.
fn paired<G: BufRead, O: BufRead>(
    golden: &Reader<G>,
    golden_side: &Side,
    other: &Reader<O>,
    other_side: &Side,
) -> Result<(Vec<Pair>, Vec<WidthMismatch>), WaveError> {
    let there = by_name(other_side);
    let (mut pairs, mut mismatches) = (Vec::new(), Vec::new());
    for (name, index) in &golden_side.signals {
        let Some(&other_index) = there.get(name.as_str()) else {
            continue;
        };
        let width = golden.header.variables[*index].width;
        let other_width = other.header.variables[other_index].width;
        if width == other_width {
            pairs.push(Pair {
                name: name.clone(),
                width,
                golden: *index,
                other: other_index,
            });
        } else {
            mismatches.push(WidthMismatch {
                signal: name.clone(),
                golden_width: width,
                other_width,
            });
        }
    }
    if pairs.is_empty() && mismatches.is_empty() {
        return Err(WaveError::NoCommonSignals {
            golden: Box::new(side_names(golden, golden_side)),
            other: Box::new(side_names(other, other_side)),
        });
    }
    Ok((pairs, mismatches))
}

fn side_names<R>(reader: &Reader<R>, side: &Side) -> SideNames {
    SideNames {
        name: reader.name.clone(),
        top_scopes: Names(reader.header.top_scopes()),
        signals: side.names(),
    }
}

/// What the options and both headers say of the pairs; the golden header goes before the other.
fn annotated<G: BufRead, O: BufRead>(
    (golden, golden_side): (&Reader<G>, &Side),
    (other, other_side): (&Reader<O>, &Side),
    pairs: &[Pair],
    options: &DiffOptions,
) -> Result<(Causes, Vec<Meaning>), WaveError> {
    let golden_says = Annotations::read(&golden.name, &golden.header.comments)?;
    let other_says = Annotations::read(&other.name, &other.header.comments)?;
    let mut merged = Annotations::default();
    // The later goes before the earlier.
    for (says, side) in [(other_says, other_side), (golden_says, golden_side)] {
        let prefix = side.stripped.iter().map(|scope| format!("{scope}."));
        let prefix: String = prefix.collect();
        let short = |name: String| match name.strip_prefix(&prefix) {
            Some(below) => below.to_owned(),
            None => name,
        };
        let meanings = says.meanings.into_iter();
        merged
            .meanings
            .extend(meanings.map(|(name, m)| (short(name), m)));
        for dependency in says.dependencies {
            let mut inputs = dependency.inputs;
            for input in &mut inputs {
                input.signal = short(std::mem::take(&mut input.signal));
            }
            merged.dependencies.push(Dependency {
                signal: short(dependency.signal),
                inputs,
            });
        }
        merged
            .unit_inputs
            .extend(says.unit_inputs.into_iter().map(|unit| UnitInputs {
                unit: short(unit.unit),
                inputs: unit.inputs.into_iter().map(short).collect(),
            }));
    }
    let mut meanings: HashMap<&str, Meaning> = HashMap::new();
    for (name, meaning) in merged.meanings.iter().chain(&options.meanings) {
        meanings.insert(name, *meaning);
    }
    let of_pair = |pair: &Pair| match meanings.get(pair.name.as_str()) {
        // A format of another width cannot be how these bits are meant.
        Some(Meaning::Float(format)) if format.width() != pair.width => Meaning::Bits,
        Some(&meaning) => meaning,
        None => Meaning::Bits,
    };
    let of_pairs = pairs.iter().map(of_pair).collect();
    let names = pairs.iter().enumerate();
    let pair_by_name = names
        .map(|(index, pair)| (pair.name.clone(), index))
        .collect();
    Ok((Causes::new(merged, pair_by_name), of_pairs))
}

fn side_report<R>(
    reader: &Reader<R>,
    side: &Side,
    opposite: &Side,
    options: &SideOptions,
) -> SideReport {
    let only_here = only_in(side, opposite, options.scope.is_some());
    SideReport {
        name: reader.name.clone(),
        stripped_scope: side.stripped.join("."),
        first_cycle: 0,
        last_cycle: 0,
        signals_only_here: only_here.len(),
        examples_only_here: only_here.into_iter().take(5).collect(),
    }
}

/// One waveform on its way through the comparison.
struct Track<R> {
    sampler: CycleSampler<R>,
    /// For every pair, its slot.
    slots: Vec<usize>,
    /// For every slot, its pairs.
    pairs_of: Vec<Vec<usize>>,
    reset_slot: Option<usize>,
    first: Cycle,
    now: Option<Cycle>,
    last: Cycle,
}

impl<R: BufRead> Track<R> {
    /// Reads to the end of the first cycle.
    fn new(
        reader: Reader<R>,
        side: &Side,
        pairs: &[Pair],
        variable: impl Fn(&Pair) -> usize,
        options: &SideOptions,
    ) -> Result<Track<R>, WaveError> {
        let name = reader.name.clone();
        let Some(clock) = outermost(&reader.header, &side.stripped, CLOCK_NAME) else {
            return Err(WaveError::NoClock {
                name,
                signal: CLOCK_NAME.to_owned(),
                has: side.names(),
            });
        };
        let reset = outermost(&reader.header, &side.stripped, RESET_NAME);
        let watched: Vec<usize> = pairs.iter().map(variable).chain(reset).collect();
        let (mut sampler, mut slots) = CycleSampler::new(reader, clock, &watched, options.cycles);
        let reset_slot = reset.and_then(|_| slots.pop());
        let mut pairs_of = vec![Vec::new(); sampler.changed().len()];
        for (pair, &slot) in slots.iter().enumerate() {
            pairs_of[slot].push(pair);
        }
        let Some(first) = sampler.next_cycle()? else {
            return Err(WaveError::NoCycles { name });
        };
        Ok(Track {
            sampler,
            slots,
            pairs_of,
            reset_slot,
            first,
            now: Some(first),
            last: first,
        })
    }

    fn advance(&mut self) -> Result<(), WaveError> {
        self.now = self.sampler.next_cycle()?;
        if let Some(now) = self.now {
            self.last = now;
        }
        Ok(())
    }

    fn value(&self, pair: usize) -> &[LogicWord] {
        self.sampler.value(self.slots[pair])
    }

    /// Is it out of reset? A reset whose level is unknown has not been left. None where there is
    /// no reset.
    fn is_running(&self) -> Option<bool> {
        let slot = self.reset_slot?;
        Some(self.sampler.value(slot)[0].as_known() == Some(1))
    }
}

struct Comparison<'a, G, O> {
    pairs: Vec<Pair>,
    meanings: Vec<Meaning>,
    agreements: Vec<Agreement>,
    ever_differed: Vec<bool>,
    causes: Causes,
    options: &'a DiffOptions,
    golden: Track<G>,
    other: Track<O>,
    report: DiffReport,
}

impl<G: BufRead, O: BufRead> Comparison<'_, G, O> {
    fn run(mut self) -> Result<DiffReport, WaveError> {
        let mut left_reset = false;
        let mut common_cycles = 0;
        while let (Some(golden), Some(other)) = (self.golden.now, self.other.now) {
            if golden.number < other.number {
                self.golden.advance()?;
                continue;
            }
            if other.number < golden.number {
                self.other.advance()?;
                continue;
            }
            common_cycles += 1;
            self.update_agreements();
            self.causes.remember(golden.number, &self.agreements);
            let golden_runs = self.golden.is_running();
            let other_runs = self.other.is_running();
            // A side without a reset follows the other.
            let golden_is_up = golden_runs.or(other_runs).unwrap_or(true);
            let other_is_up = other_runs.or(golden_runs).unwrap_or(true);
            left_reset |= golden_is_up && other_is_up;
            if !left_reset || !golden_is_up && !other_is_up {
                self.report.cycles_in_reset += 1;
            } else {
                if golden_is_up != other_is_up {
                    self.report.reset_disagreements += 1;
                }
                self.count_cycle(golden, other);
            }
            self.golden.advance()?;
            self.other.advance()?;
        }
        // To the end of both: a damaged rest is an error, and the spans are to be told.
        while self.golden.now.is_some() {
            self.golden.advance()?;
        }
        while self.other.now.is_some() {
            self.other.advance()?;
        }
        self.finish(common_cycles)
    }

    /// Compares the signals that changed on either side since the last common cycle.
    fn update_agreements(&mut self) {
        let golden_changed = self.golden.sampler.changed().iter();
        let other_changed = self.other.sampler.changed().iter();
        let stale = golden_changed
            .flat_map(|&slot| &self.golden.pairs_of[slot])
            .chain(other_changed.flat_map(|&slot| &self.other.pairs_of[slot]));
        for &pair in stale {
            self.agreements[pair] = agreement(
                self.golden.value(pair),
                self.other.value(pair),
                self.options.excuse_golden_unknown,
            );
        }
        self.golden.sampler.clear_changed();
        self.other.sampler.clear_changed();
    }

    fn count_cycle(&mut self, golden: Cycle, other: Cycle) {
        if self.report.cycles_compared == 0 {
            self.report.first_cycle_compared = golden.number;
        }
        self.report.last_cycle_compared = golden.number;
        self.report.cycles_compared += 1;
        let mut differing = 0;
        for (agreement, ever) in self.agreements.iter().zip(&mut self.ever_differed) {
            match agreement {
                Agreement::Equal => {}
                Agreement::AsFarAsKnown => self.report.partly_unknown_pairs += 1,
                Agreement::Differs => {
                    *ever = true;
                    differing += 1;
                }
            }
        }
        self.report.differing_pairs += differing;
        if differing > 0 && self.report.first_divergence.is_none() {
            self.report.first_divergence = Some(self.divergence(golden, other));
        }
    }

    fn divergence(&self, golden: Cycle, other: Cycle) -> FirstDivergence {
        let differing = (0..self.pairs.len()).filter(|&p| self.agreements[p] == Agreement::Differs);
        let mut signals: Vec<DivergingSignal> = differing
            .map(|pair| self.diverging_signal(pair, golden))
            .collect();
        signals.sort_by_key(|signal| signal.cause.rank());
        let signals_total = signals.len();
        signals.truncate(self.options.signals_shown);
        FirstDivergence {
            cycle: golden.number,
            golden_time_ns: nanoseconds(golden.begin_fs),
            other_time_ns: nanoseconds(other.begin_fs),
            signals_total,
            signals,
        }
    }

    fn diverging_signal(&self, index: usize, cycle: Cycle) -> DivergingSignal {
        let (pair, meaning) = (&self.pairs[index], self.meanings[index]);
        let (golden, other) = (self.golden.value(index), self.other.value(index));
        let (unit, signal) = pair.name.rsplit_once('.').unwrap_or(("", &pair.name));
        let report = |words: &[LogicWord]| ValueReport {
            hex: hexadecimal(words, pair.width),
            decoded: match words {
                [word] => decoded(meaning, pair.width, *word),
                _ => None,
            },
        };
        let ulps = match (meaning, golden[0].as_known(), other[0].as_known()) {
            (Meaning::Float(format), Some(a), Some(b)) => steps_between(format, a, b),
            _ => None,
        };
        DivergingSignal {
            cycle: cycle.number,
            time_ns: nanoseconds(cycle.begin_fs),
            unit: unit.to_owned(),
            signal: signal.to_owned(),
            width: pair.width,
            meaning: match meaning {
                Meaning::Bits => "unsigned".to_owned(),
                Meaning::Signed => "signed".to_owned(),
                Meaning::Float(format) => format!("float {format}"),
            },
            golden: report(golden),
            other: report(other),
            ulps,
            cause: self.causes.of(&pair.name, unit, cycle.number),
        }
    }

    fn finish(mut self, common_cycles: u64) -> Result<DiffReport, WaveError> {
        let report = &mut self.report;
        for (side, (first, last)) in [
            (&mut report.golden, (self.golden.first, self.golden.last)),
            (&mut report.other, (self.other.first, self.other.last)),
        ] {
            (side.first_cycle, side.last_cycle) = (first.number, last.number);
        }
        report.signals_compared = self.pairs.len();
        report.signals_differing = self.ever_differed.iter().filter(|&&ever| ever).count();
        let spans = format!(
            "{} has cycles {} to {}, {} has cycles {} to {}",
            report.golden.name,
            report.golden.first_cycle,
            report.golden.last_cycle,
            report.other.name,
            report.other.first_cycle,
            report.other.last_cycle
        );
        if common_cycles == 0 {
            return Err(WaveError::NothingCompared(format!(
                "no cycle is in both waveforms: {spans}; write the same window, or number one \
                 side's cycles from its first edge"
            )));
        }
        if report.cycles_compared == 0 {
            return Err(WaveError::NothingCompared(format!(
                "in all {common_cycles} common cycles `{RESET_NAME}` is 0 or unknown on a side: \
                 {spans}; write a window that reaches beyond reset"
            )));
        }
        let all_pairs = report.cycles_compared * self.pairs.len() as u64;
        if report.width_mismatches.is_empty()
            && report.differing_pairs == 0
            && report.partly_unknown_pairs == all_pairs
        {
            return Err(WaveError::NothingCompared(format!(
                "every signal has unknown bits in all {} cycles; does reset reach the design?",
                report.cycles_compared
            )));
        }
        if (report.golden.first_cycle, report.golden.last_cycle)
            != (report.other.first_cycle, report.other.last_cycle)
        {
            report
                .notes
                .push(format!("{spans}: only what both have was compared"));
        }
        let periods = (
            self.golden.sampler.period_fs(),
            self.other.sampler.period_fs(),
        );
        if let (Some(golden), Some(other)) = periods
            && golden != other
        {
            report.notes.push(format!(
                "the clocks differ: a period of {} ns in {}, of {} ns in {}",
                nanoseconds(golden),
                report.golden.name,
                nanoseconds(other),
                report.other.name
            ));
        }
        let gaps = [self.golden.sampler.gaps, self.other.sampler.gaps];
        for (side, gaps) in [&report.golden, &report.other].into_iter().zip(gaps) {
            if !side.stripped_scope.is_empty() {
                let (name, scope) = (&side.name, &side.stripped_scope);
                let note = format!("names of {name} are taken without the scope `{scope}`");
                report.notes.push(note);
            }
            if gaps > 0 {
                let note = format!("{}: {gaps} cycles are left out within it", side.name);
                report.notes.push(note);
            }
        }
        report.agreed = report.differing_pairs == 0
            && report.reset_disagreements == 0
            && report.width_mismatches.is_empty();
        Ok(self.report)
    }
}

/// Compares two values of one width, four-valued.
fn agreement(golden: &[LogicWord], other: &[LogicWord], excuse_golden_unknown: bool) -> Agreement {
    let mut all_known = true;
    for (golden, other) in golden.iter().zip(other) {
        let excused = if excuse_golden_unknown {
            golden.unknown
        } else {
            0
        };
        let difference = (golden.value ^ other.value) | (golden.unknown ^ other.unknown);
        if difference & !excused != 0 {
            return Agreement::Differs;
        }
        all_known &= golden.unknown == 0;
    }
    if all_known {
        Agreement::Equal
    } else {
        Agreement::AsFarAsKnown
    }
}
