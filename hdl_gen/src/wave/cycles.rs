//! A VCD's value changes as cycles: for each, the values its signals have settled to.

use super::logic::words_for;
use super::reader::Reader;
use super::{LogicWord, WaveError};
use std::collections::HashMap;
use std::io::BufRead;
use std::ops::Range;
use vcd::{Command, IdCode, Value};

/// How the cycles of a waveform are numbered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CycleNumbers {
    /// By time: the first rising edge at time t begins cycle `t / period`, rounded down, where the
    /// period is the time between the first two rising edges.
    #[default]
    ByTime,
    /// The first rising edge begins the cycle of this number.
    FromFirstEdge(u64),
}

/// One cycle of a waveform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cycle {
    pub number: u64,
    /// When its rising edge was, in femtoseconds.
    pub begin_fs: u128,
}

/// Femtoseconds as ns; exact for every time a simulation has.
pub(crate) fn nanoseconds(femtoseconds: u128) -> f64 {
    femtoseconds as f64 / 1e6
}

/// The slots of the watched variables in a flat array of words.
#[derive(Debug)]
struct Slots {
    /// For every code in the header, its slot, if it is watched.
    by_code: HashMap<IdCode, Option<usize>>,
    /// For every slot, its words and its width.
    places: Vec<(Range<usize>, u32)>,
}

/// Reads the changes of one waveform and stops at the end of every cycle.
///
/// All changes of one time are taken together: a clock that falls and rises in no time is no edge.
/// The value 1 that a clock begins with is a rising edge.
pub(crate) struct CycleSampler<R> {
    reader: Reader<R>,
    slots: Slots,
    clock_slot: usize,
    numbers: CycleNumbers,
    /// Values as of the last time that was taken in whole.
    settled: Vec<LogicWord>,
    /// Values of the time that is being read.
    incoming: Vec<LogicWord>,
    /// Slots that changed in the time that is being read.
    pending: Vec<usize>,
    time: u128,
    /// The cycle whose end has not been seen: its edge, and whether the clock has fallen since.
    open: Option<(u128, bool)>,
    first_edge: Option<u128>,
    first_fall: Option<u128>,
    period_fs: Option<u128>,
    last: Option<Cycle>,
    /// Slots that changed since [`CycleSampler::clear_changed`].
    changed: Vec<usize>,
    is_changed: Vec<bool>,
    /// Cycle numbers left out between cycles.
    pub gaps: u64,
    ended: bool,
}

impl<R: BufRead> CycleSampler<R> {
    /// Watches some variables (indices into the header's); returns the slot of each.
    pub(crate) fn new(
        reader: Reader<R>,
        clock: usize,
        watched: &[usize],
        numbers: CycleNumbers,
    ) -> (CycleSampler<R>, Vec<usize>) {
        let header = &reader.header;
        let mut slots = Slots {
            by_code: header.variables.iter().map(|v| (v.code, None)).collect(),
            places: Vec::new(),
        };
        let mut words = 0;
        let mut slot_of = |variable: usize| {
            let variable = &header.variables[variable];
            // Every code of the header is in the map.
            *slots
                .by_code
                .entry(variable.code)
                .or_default()
                .get_or_insert_with(|| {
                    let place = words..words + words_for(variable.width);
                    words = place.end;
                    slots.places.push((place, variable.width));
                    slots.places.len() - 1
                })
        };
        let clock_slot = slot_of(clock);
        let watched = watched.iter().map(|&variable| slot_of(variable)).collect();
        let mut unknown = Vec::new();
        for (_, width) in &slots.places {
            for word in 0..words_for(*width) as u32 {
                unknown.push(LogicWord::X.low_bits(width - word * 64));
            }
        }
        let count = slots.places.len();
        let sampler = CycleSampler {
            reader,
            slots,
            clock_slot,
            numbers,
            settled: unknown.clone(),
            incoming: unknown,
            pending: Vec::new(),
            time: 0,
            open: None,
            first_edge: None,
            first_fall: None,
            period_fs: None,
            last: None,
            changed: (0..count).collect(),
            is_changed: vec![true; count],
            gaps: 0,
            ended: false,
        };
        (sampler, watched)
    }

    /// The clock's period, once two edges have been seen.
    pub(crate) fn period_fs(&self) -> Option<u128> {
        self.period_fs
    }

    /// The settled value of a slot, the least significant word first.
    pub(crate) fn value(&self, slot: usize) -> &[LogicWord] {
        &self.settled[self.slots.places[slot].0.clone()]
    }

    /// The slots that changed since they were last cleared; at first, all of them.
    pub(crate) fn changed(&self) -> &[usize] {
        &self.changed
    }

    /// Forgets which slots changed.
    pub(crate) fn clear_changed(&mut self) {
        for slot in self.changed.drain(..) {
            self.is_changed[slot] = false;
        }
    }

    /// Reads on to the end of the next cycle: then every value is the one it settled to in it.
    ///
    /// The last cycle of a file counts if the clock fell in it.
    pub(crate) fn next_cycle(&mut self) -> Result<Option<Cycle>, WaveError> {
        // What ended the cycle returned before.
        self.settle();
        while !self.ended {
            match self.reader.next_command()? {
                Some(Command::Timestamp(time)) => {
                    let time = u128::from(time) * self.reader.header.time_unit_fs;
                    if time < self.time {
                        return Err(self.reader.syntax("time runs backward"));
                    }
                    if time == self.time {
                        continue;
                    }
                    let ended = self.take_time()?;
                    self.time = time;
                    if ended.is_some() {
                        return Ok(ended);
                    }
                }
                Some(Command::ChangeScalar(code, value)) => {
                    self.change(code, 1, std::iter::once(value))?;
                }
                Some(Command::ChangeVector(code, vector)) => {
                    self.change(code, vector.len(), vector.iter())?;
                }
                Some(
                    Command::ChangeReal(..)
                    | Command::ChangeString(..)
                    | Command::Begin(_)
                    | Command::End(_)
                    | Command::Comment(_),
                ) => {}
                Some(_) => return Err(self.reader.syntax("a declaration after the header")),
                None => {
                    self.ended = true;
                    // The cycle that the very last time ends, then the one it may leave open.
                    if let Some(cycle) = self.take_time()? {
                        return Ok(Some(cycle));
                    }
                }
            }
        }
        match self.open.take() {
            Some((begin, true)) => self.number(begin).map(Some),
            _ => Ok(None),
        }
    }

    /// Takes in the changes of the time that ends. If they begin a cycle and so end another, the
    /// ended one is returned, *before* the changes are taken in; they are on the next call.
    fn take_time(&mut self) -> Result<Option<Cycle>, WaveError> {
        let clock = self.slots.places[self.clock_slot].0.start;
        let is_high = |word: LogicWord| word.as_known() == Some(1);
        let (before, after) = (is_high(self.settled[clock]), is_high(self.incoming[clock]));
        if !before && after {
            let edge = self.time;
            if self.period_fs.is_none()
                && let Some(first) = self.first_edge
            {
                self.period_fs = Some(edge - first);
            }
            self.first_edge.get_or_insert(edge);
            if let Some((begin, _)) = self.open.replace((edge, false)) {
                return self.number(begin).map(Some);
            }
        } else if before
            && !after
            && let Some((_, fallen)) = &mut self.open
        {
            *fallen = true;
            self.first_fall.get_or_insert(self.time);
        }
        self.settle();
        Ok(None)
    }

    /// Makes the changes of the time that ended the present values.
    fn settle(&mut self) {
        for slot in self.pending.drain(..) {
            let words = self.slots.places[slot].0.clone();
            if self.settled[words.clone()] == self.incoming[words.clone()] {
                continue;
            }
            self.settled[words.clone()].copy_from_slice(&self.incoming[words]);
            if !self.is_changed[slot] {
                self.is_changed[slot] = true;
                self.changed.push(slot);
            }
        }
    }

    /// Takes note of a new value, its most significant bit first. Bits that are left out are 0, or
    /// x or z if the first one given is.
    fn change(
        &mut self,
        code: IdCode,
        count: usize,
        bits: impl Iterator<Item = Value>,
    ) -> Result<(), WaveError> {
        let slot = match self.slots.by_code.get(&code) {
            None => {
                let reason = format!("a value of `{code}`, which no variable is declared as");
                return Err(self.reader.syntax(reason));
            }
            Some(None) => return Ok(()),
            Some(&Some(slot)) => slot,
        };
        let (place, width) = self.slots.places[slot].clone();
        if count == 0 || count > width as usize {
            let reason = format!("{count} bits for a variable of {width}");
            return Err(self.reader.syntax(reason));
        }
        let words = &mut self.incoming[place];
        let mut bit = count as u32;
        for (index, value) in bits.enumerate() {
            if index == 0 && bit < width {
                let filler = match value {
                    Value::V1 => Value::V0,
                    other => other,
                };
                for left_out in bit..width {
                    words[(left_out / 64) as usize].set(left_out % 64, filler);
                }
            }
            bit -= 1;
            words[(bit / 64) as usize].set(bit % 64, value);
        }
        self.pending.push(slot);
        Ok(())
    }

    /// Gives the cycle that began at this edge its number.
    fn number(&mut self, begin: u128) -> Result<Cycle, WaveError> {
        let first = self.first_edge.unwrap_or(begin);
        // A file of a single cycle never says its period: twice the time its clock is high is the
        // nearest there is.
        let twice_high = self.first_fall.map(|fall| 2 * (fall - first));
        let period = self.period_fs.or(twice_high).unwrap_or(1).max(1);
        let base = match self.numbers {
            CycleNumbers::ByTime => first / period,
            CycleNumbers::FromFirstEdge(number) => u128::from(number),
        };
        let number = base + (begin - first + period / 2) / period;
        let number = u64::try_from(number)
            .map_err(|_| self.reader.syntax("more cycles than 64 bits count"))?;
        if let Some(last) = self.last {
            if number <= last.number {
                return Err(WaveError::IrregularClock {
                    name: self.reader.name.clone(),
                    time_ns: nanoseconds(begin),
                });
            }
            self.gaps += number - last.number - 1;
        }
        let cycle = Cycle {
            number,
            begin_fs: begin,
        };
        self.last = Some(cycle);
        Ok(cycle)
    }
}
