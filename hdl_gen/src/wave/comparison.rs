//! Two waveforms read side by side, cycle by cycle.

use super::cause::{Agreement, Causes};
use super::cycles::{Cycle, CycleSampler, nanoseconds};
use super::diff::{DiffOptions, Pair, SideOptions};
use super::logic::hexadecimal;
use super::pairing::{Side, outermost};
use super::reader::Reader;
use super::report::{DiffReport, DivergingSignal, FirstDivergence, ValueReport};
use super::{CLOCK_NAME, LogicWord, RESET_NAME, WaveError, decoded, steps_between};
use crate::netlist::Meaning;
use std::io::BufRead;

/// One waveform on its way through the comparison.
pub(crate) struct Track<R> {
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
    pub(crate) fn new(
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

/// Two waveforms side by side, and what has been found so far.
pub(crate) struct Comparison<'a, G, O> {
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

impl<'a, G: BufRead, O: BufRead> Comparison<'a, G, O> {
    /// With one meaning a pair, and a report that has all that is known beforehand.
    pub(crate) fn new(
        golden: Track<G>,
        other: Track<O>,
        pairs: Vec<Pair>,
        meanings: Vec<Meaning>,
        causes: Causes,
        options: &'a DiffOptions,
        report: DiffReport,
    ) -> Comparison<'a, G, O> {
        Comparison {
            agreements: vec![Agreement::Equal; pairs.len()],
            ever_differed: vec![false; pairs.len()],
            pairs,
            meanings,
            causes,
            options,
            golden,
            other,
            report,
        }
    }

    /// Compares to the end of both.
    pub(crate) fn run(mut self) -> Result<DiffReport, WaveError> {
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
                self.options,
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
        let ulps = match (golden[0].as_known(), other[0].as_known()) {
            (Some(a), Some(b)) => steps_between(meaning, a, b),
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
                Meaning::Fixed(format) => format!("fixed {format}"),
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
        report.agreed = report.differing_pairs == 0
            && report.reset_disagreements == 0
            && report.width_mismatches.is_empty();
        self.note_what_differs_besides();
        Ok(self.report)
    }

    /// Notes different clocks, stripped scopes and gaps.
    fn note_what_differs_besides(&mut self) {
        let report = &mut self.report;
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
    }
}

/// Compares two values of one width, four-valued.
fn agreement(golden: &[LogicWord], other: &[LogicWord], options: &DiffOptions) -> Agreement {
    let mut all_known = true;
    let excuse = |unknown: u64, is_excused: bool| if is_excused { unknown } else { 0 };
    for (golden, other) in golden.iter().zip(other) {
        let excused = excuse(golden.unknown, options.excuse_golden_unknown)
            | excuse(other.unknown, options.excuse_other_unknown);
        let difference = (golden.value ^ other.value) | (golden.unknown ^ other.unknown);
        if difference & !excused != 0 {
            return Agreement::Differs;
        }
        all_known &= golden.unknown | other.unknown == 0;
    }
    if all_known {
        Agreement::Equal
    } else {
        Agreement::AsFarAsKnown
    }
}
