//! A height cache that never makes anybody wait: a lookup in every cycle, answered a fixed number
//! of cycles later with the heights, or with the news that they are on their way.
//!
//! Direct mapped, lines of 16 heights. The low bits of a line's number are its index, the rest its
//! tag. In the cycle of a lookup the tag and the heights at the index are read into registers,
//! behind which the tag is compared. A miss takes note of the line, unless a line of its index is
//! noted already or there is no room; the lines noted are fetched one after the other, and arrive in
//! that order.
//!
//! A line stays noted until it has been hit once, so that none is pushed out before it has served:
//! who looks up again until he hits gets on, whatever others ask for and however fast the memory
//! is. Who asks for a line must therefore come back for it, or its slot is never free again.

mod shape;
#[cfg(test)]
mod tests;

use super::declaration::{ClockedUnit, Declared};

use shape::{COUNTER_BITS, MOST_PENDING, WORD_BITS};
pub use shape::{CacheAnswer, HeightCacheShape, LINE_HEIGHTS};

/// What a height cache's input ports carry in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeightCacheInputs {
    /// A lookup, of which note is taken where the cache is ready.
    pub lookup_valid: bool,
    /// Its address: the line's number, then, for one height, its place in the line.
    pub lookup_address: u64,
    /// The line that is asked for is taken note of.
    pub fetch_ready: bool,
    /// A beat arrives. Beats are taken at once, and come in the order of the lines asked for.
    pub beat_valid: bool,
    /// Its heights, the first in the low bits.
    pub beat_data: u64,
}

/// What a height cache's output ports carry in a cycle; none follows an input within the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeightCacheOutputs {
    /// Lookups are answered. Low only after reset, for as many cycles as there are lines: the
    /// tags are cleared.
    pub lookup_ready: bool,
    /// This is the answer to the lookup of [`HeightCacheShape::latency`] cycles ago.
    pub answer_valid: bool,
    /// The heights are those that were looked up; else they are of no use.
    pub hit: bool,
    /// The height, or the words of the line; the rest zero.
    pub heights: [u64; 4],
    /// A line is asked for.
    pub fetch_valid: bool,
    /// Its number.
    pub fetch_line: u64,
}

/// What was read for a lookup.
#[derive(Clone, Copy, Debug, Default)]
struct Read {
    valid: bool,
    address: u64,
    collided: bool,
    /// The line that stood at the index, by its tag, and whether it was one.
    stored_valid: bool,
    stored_tag: u64,
    words: [u64; 4],
}

/// A line that is noted.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    /// It has not been hit since it was noted.
    valid: bool,
    /// It is whole and can be hit.
    filled: bool,
    line: u64,
}

/// A height cache.
///
/// A line becomes visible in the cycle after the one in which its last beat arrives. With its
/// first beat the line that stood at its index is gone. A lookup of an index that is written in
/// the same cycle misses. A line counts as noted until it is hit, and so until every lookup that
/// could not yet see it has been answered: none is fetched twice.
#[derive(Clone, Debug)]
pub struct HeightCache {
    shape: HeightCacheShape,
    /// Valid and tag of every index.
    tags: Vec<(bool, u64)>,
    /// The words of every index, `beats` each.
    words: Vec<u64>,
    swept: u32,
    /// Lookups by their age, the youngest first; `latency` of them.
    reads: [Read; 2],
    /// The last lines noted, by their number modulo `pending`.
    slots: [Slot; MOST_PENDING],
    /// Lines noted, asked for and filled since reset.
    noted: u64,
    asked: u64,
    filled: u64,
    beat: u32,
    hits: u64,
    misses: u64,
}

impl HeightCache {
    /// A cache after its reset, its memories full of zeros.
    ///
    /// # Panics
    /// If the shape is none that can be built.
    pub fn new(shape: HeightCacheShape) -> HeightCache {
        shape.check();
        HeightCache {
            tags: vec![(false, 0); shape.lines as usize],
            words: vec![0; (shape.lines * shape.beats()) as usize],
            swept: 0,
            reads: [Read {
                collided: true,
                ..Read::default()
            }; 2],
            slots: [Slot::default(); MOST_PENDING],
            noted: 0,
            asked: 0,
            filled: 0,
            beat: 0,
            hits: 0,
            misses: 0,
            shape,
        }
    }

    /// What it is built as.
    pub fn shape(&self) -> &HeightCacheShape {
        &self.shape
    }

    /// Lookups answered with heights.
    pub fn hits(&self) -> u64 {
        self.hits
    }

    /// Lookups answered without.
    pub fn misses(&self) -> u64 {
        self.misses
    }

    /// Lines noted to be fetched.
    pub fn fetches(&self) -> u64 {
        self.noted
    }

    fn index(&self, line: u64) -> usize {
        // Lines and slots are powers of two.
        (line & u64::from(self.shape.lines - 1)) as usize
    }

    fn line(&self, address: u64) -> u64 {
        address >> self.shape.offset_bits()
    }

    fn slot(&self, count: u64) -> usize {
        (count & u64::from(self.shape.pending - 1)) as usize
    }

    /// The lookup that is answered in this cycle.
    fn answered(&self) -> &Read {
        &self.reads[self.shape.latency as usize - 1]
    }

    fn is_hit(&self, read: &Read) -> bool {
        let tag = self.line(read.address) >> self.shape.index_bits();
        read.valid && !read.collided && read.stored_valid && read.stored_tag == tag
    }

    /// Is a hit in this cycle one of the line in this slot? The first of an index whose line is
    /// whole is.
    fn is_hit_of(&self, slot: &Slot) -> bool {
        let index = self.index(self.line(self.answered().address));
        slot.valid && slot.filled && self.index(slot.line) == index
    }

    /// What the output ports carry in this cycle.
    pub fn outputs(&self) -> HeightCacheOutputs {
        let read = self.answered();
        let heights = match self.shape.answer {
            CacheAnswer::Line => read.words,
            CacheAnswer::Height => {
                let in_word = WORD_BITS / self.shape.height_bits;
                let place = read.address as u32 % in_word;
                let height = read.words[0] >> (place * self.shape.height_bits);
                [height & ((1 << self.shape.height_bits) - 1), 0, 0, 0]
            }
        };
        HeightCacheOutputs {
            lookup_ready: self.swept == self.shape.lines,
            answer_valid: read.valid,
            hit: self.is_hit(read),
            heights,
            fetch_valid: self.asked < self.noted,
            fetch_line: self.slots[self.slot(self.asked)].line,
        }
    }

    /// Is a line of this index noted?
    fn is_noted(&self, index: usize) -> bool {
        let mut slots = self.slots.iter();
        slots.any(|slot| slot.valid && self.index(slot.line) == index)
    }

    /// The rising edge at the end of a cycle.
    pub fn clock(&mut self, inputs: &HeightCacheInputs) {
        let outputs = self.outputs();
        let answered = *self.answered();
        // What of the past is decided in this cycle.
        let looked_up = self.line(answered.address);
        let notes = self.notes();
        self.hits += u64::from(outputs.hit);
        self.misses += u64::from(outputs.answer_valid && !outputs.hit);

        if outputs.hit {
            for slot in 0..self.slots.len() {
                self.slots[slot].valid &= !self.is_hit_of(&self.slots[slot]);
            }
        }
        self.look_up(inputs, outputs.lookup_ready);
        self.take_beat(inputs);
        self.asked += u64::from(outputs.fetch_valid && inputs.fetch_ready);
        if notes {
            let slot = self.slot(self.noted);
            self.slots[slot] = Slot {
                valid: true,
                filled: false,
                line: looked_up,
            };
            self.noted += 1;
        }
    }

    /// Is the line of the lookup that is answered in this cycle taken note of?
    fn notes(&self) -> bool {
        let answered = self.answered();
        let room = !self.slots[self.slot(self.noted)].valid;
        let missed = answered.valid && !self.is_hit(answered);
        missed && room && !self.is_noted(self.index(self.line(answered.address)))
    }

    /// The index that is written in this cycle: a tag is cleared, or a beat arrives.
    fn written(&self, inputs: &HeightCacheInputs) -> Option<usize> {
        if self.swept < self.shape.lines {
            return Some(self.swept as usize);
        }
        let filling = self.slots[self.slot(self.filled)].line;
        inputs.beat_valid.then(|| self.index(filling))
    }

    /// Reads what stands at a lookup's index, before this cycle's beat is written.
    fn look_up(&mut self, inputs: &HeightCacheInputs, ready: bool) {
        let line = self.line(inputs.lookup_address);
        let index = self.index(line);
        let mut read = Read {
            valid: inputs.lookup_valid && ready,
            address: inputs.lookup_address,
            collided: self.written(inputs) == Some(index),
            // The registers behind the memories keep what they hold in a collision.
            ..self.reads[0]
        };
        if !read.collided {
            (read.stored_valid, read.stored_tag) = self.tags[index];
            let beats = self.shape.beats() as usize;
            let words = &self.words[index * beats..][..beats];
            match self.shape.answer {
                CacheAnswer::Line => read.words[..beats].copy_from_slice(words),
                CacheAnswer::Height => {
                    let place = inputs.lookup_address as usize % LINE_HEIGHTS as usize;
                    read.words[0] = words[place * beats / LINE_HEIGHTS as usize];
                }
            }
        }
        self.reads = [read, self.reads[0]];
    }

    /// Writes a beat, or clears a tag.
    fn take_beat(&mut self, inputs: &HeightCacheInputs) {
        if self.swept < self.shape.lines {
            self.tags[self.swept as usize] = (false, 0);
            self.swept += 1;
            return;
        }
        if !inputs.beat_valid {
            return;
        }
        let slot = self.slot(self.filled);
        let line = self.slots[slot].line;
        let index = self.index(line);
        let beats = self.shape.beats();
        self.words[index * beats as usize + self.beat as usize] = inputs.beat_data;
        let last = self.beat + 1 == beats;
        self.tags[index] = (last, line >> self.shape.index_bits());
        self.beat = (self.beat + 1) % beats;
        self.slots[slot].filled = last;
        self.filled += u64::from(last);
    }
}

impl HeightCacheInputs {
    fn of_words(words: &[u64]) -> HeightCacheInputs {
        HeightCacheInputs {
            lookup_valid: words[0] != 0,
            lookup_address: words[1],
            fetch_ready: words[2] != 0,
            beat_valid: words[3] != 0,
            beat_data: words[4],
        }
    }
}

impl ClockedUnit for HeightCache {
    fn declaration(&self) -> Vec<Declared> {
        self.shape.declaration()
    }

    fn observe(&self, driven: &[u64], words: &mut Vec<u64>) {
        let inputs = HeightCacheInputs::of_words(driven);
        let outputs = self.outputs();
        words.extend([
            u64::from(outputs.lookup_ready),
            outputs.answer_valid.into(),
            outputs.hit.into(),
        ]);
        words.extend(&outputs.heights[..self.shape.words_read() as usize]);
        words.extend([u64::from(outputs.fetch_valid), outputs.fetch_line]);
        if self.shape.counters {
            let counter = |count: u64| count & ((1 << COUNTER_BITS) - 1);
            words.extend([self.hits, self.misses, self.noted].map(counter));
        }
        let written = self.written(&inputs);
        let looked_up = self.index(self.line(inputs.lookup_address));
        let fills = inputs.beat_valid && self.beat + 1 == self.shape.beats();
        let collides = written == Some(looked_up);
        words.extend([written.is_some(), collides, fills, self.notes()].map(u64::from));
        words.push(self.swept.into());
        for read in &self.reads[..self.shape.latency as usize] {
            words.extend([
                u64::from(read.valid),
                read.address,
                read.collided.into(),
                read.stored_valid.into(),
                read.stored_tag,
            ]);
            words.extend(&read.words[..self.shape.words_read() as usize]);
        }
        for slot in &self.slots[..self.shape.pending as usize] {
            let serves = outputs.hit && self.is_hit_of(slot);
            let bits = [slot.valid, slot.filled, serves].map(u64::from);
            words.extend(bits.into_iter().chain([slot.line]));
        }
        for count in [self.noted, self.asked, self.filled] {
            words.push(self.slot(count) as u64);
        }
        words.push(self.noted - self.asked);
        words.push(self.beat.into());
    }

    fn clock(&mut self, driven: &[u64]) {
        HeightCache::clock(self, &HeightCacheInputs::of_words(driven));
    }
}
