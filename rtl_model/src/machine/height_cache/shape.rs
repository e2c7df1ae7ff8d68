//! What a height cache is built as: what its model and its Verilog share.

use super::super::declaration::{Declared, bits_for};

/// Heights of a line.
pub const LINE_HEIGHTS: u32 = 16;
/// Bits of a word of the cache's memories: a beat of the memory bus.
pub(super) const WORD_BITS: u32 = 64;
/// Bits of the counters, which run over.
pub(super) const COUNTER_BITS: u32 = 32;
/// The most lines that may be noted.
pub(super) const MOST_PENDING: usize = 8;

/// What a hit is answered with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CacheAnswer {
    /// One height: the low four bits of a lookup's address say which of the line's.
    Height,
    /// All heights of the line: a lookup's address is the line's number.
    Line,
}

/// What a height cache is built as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeightCacheShape {
    /// The module's name.
    pub name: String,
    /// Bits of a height: 8 or 16.
    pub height_bits: u32,
    /// Bits of a line's number: more than an index has.
    pub line_bits: u32,
    /// Lines that it holds, a power of two from 2 up.
    pub lines: u32,
    /// Lines that may be noted as missing and not yet have served: 2, 4 or 8.
    pub pending: u32,
    /// What a hit is answered with.
    pub answer: CacheAnswer,
    /// Cycles from a lookup to its answer: 1, or 2 with a second rank of registers behind the
    /// memories, for a higher clock.
    pub latency: u32,
    /// Counts hits, misses and lines asked for.
    pub counters: bool,
}

impl HeightCacheShape {
    /// # Panics
    /// If it is no cache that can be built.
    pub fn check(&self) {
        let name = &self.name;
        assert!(
            [8, 16].contains(&self.height_bits),
            "height cache {name}: heights of {} bits",
            self.height_bits
        );
        assert!(
            self.lines >= 2 && self.lines.is_power_of_two(),
            "height cache {name}: {} lines, which is no power of two from 2 up",
            self.lines
        );
        assert!(
            self.line_bits > self.index_bits() && self.line_bits <= 32,
            "height cache {name}: {} lines of a map of 2^{} leave no tag; take fewer",
            self.lines,
            self.line_bits
        );
        assert!(
            [2, 4, 8].contains(&self.pending),
            "height cache {name}: {} lines pending",
            self.pending
        );
        assert!(
            [1, 2].contains(&self.latency),
            "height cache {name}: a latency of {} cycles",
            self.latency
        );
    }

    /// Bits of a line's index.
    pub fn index_bits(&self) -> u32 {
        bits_for(self.lines)
    }

    /// Bits of a line's tag.
    pub fn tag_bits(&self) -> u32 {
        self.line_bits - self.index_bits()
    }

    /// Beats of a line, which are words of it too: 2 of 8-bit heights, 4 of 16-bit ones. The
    /// first height stands in the low bits of the first word.
    pub fn beats(&self) -> u32 {
        LINE_HEIGHTS * self.height_bits / WORD_BITS
    }

    /// Bits of a place in a line that a lookup's address ends with.
    pub fn offset_bits(&self) -> u32 {
        match self.answer {
            CacheAnswer::Height => bits_for(LINE_HEIGHTS),
            CacheAnswer::Line => 0,
        }
    }

    /// Bits of a lookup's address.
    pub fn address_bits(&self) -> u32 {
        self.line_bits + self.offset_bits()
    }

    /// Words that are read in a lookup.
    pub fn words_read(&self) -> u32 {
        match self.answer {
            CacheAnswer::Height => 1,
            CacheAnswer::Line => self.beats(),
        }
    }

    /// The output ports of an answer's heights: `height_o`, or `line_0_o` and so on, the words of
    /// the line.
    pub fn answer_ports(&self) -> Vec<(String, u32)> {
        match self.answer {
            CacheAnswer::Height => vec![("height_o".to_owned(), self.height_bits)],
            CacheAnswer::Line => (0..self.beats())
                .map(|word| (format!("line_{word}_o"), WORD_BITS))
                .collect(),
        }
    }

    /// Ports and registers, in the order of the words of [`ClockedUnit`](crate::machine::ClockedUnit).
    pub fn declaration(&self) -> Vec<Declared> {
        let pointer = bits_for(self.pending);
        let mut signals = vec![
            Declared::input("lookup_valid_i", 1),
            Declared::input("lookup_address_i", self.address_bits()),
            Declared::input("fetch_ready_i", 1),
            Declared::input("beat_valid_i", 1),
            Declared::input("beat_data_i", WORD_BITS),
            Declared::output("lookup_ready_o", 1),
            Declared::output("answer_valid_o", 1),
            Declared::output("hit_o", 1),
        ];
        let ports = self.answer_ports();
        signals.extend(ports.into_iter().map(|(name, w)| Declared::output(name, w)));
        signals.push(Declared::output("fetch_valid_o", 1));
        signals.push(Declared::output("fetch_line_o", self.line_bits));
        if self.counters {
            for name in ["hits_o", "misses_o", "fetches_o"] {
                signals.push(Declared::output(name, COUNTER_BITS));
            }
        }
        for name in ["writes", "collides", "fills", "notes"] {
            signals.push(Declared::wire(name, 1));
        }
        signals.push(Declared::register("swept", self.index_bits() + 1, 0));
        for stage in 1..=self.latency {
            let named = |name: &str| format!("{name}_s{stage}");
            signals.push(Declared::register(named("lookup_valid"), 1, 0));
            let address = self.address_bits();
            signals.push(Declared::register(named("lookup_address"), address, 0));
            signals.push(Declared::register(named("collided"), 1, 1));
            signals.push(Declared::data_register(named("stored_valid"), 1));
            signals.push(Declared::data_register(
                named("stored_tag"),
                self.tag_bits(),
            ));
            for word in 0..self.words_read() {
                let name = match self.answer {
                    CacheAnswer::Height => named("heights"),
                    CacheAnswer::Line => named(&format!("line_{word}")),
                };
                signals.push(Declared::data_register(name, WORD_BITS));
            }
        }
        for slot in 0..self.pending {
            signals.push(Declared::register(format!("slot_valid_{slot}"), 1, 0));
            signals.push(Declared::register(format!("slot_filled_{slot}"), 1, 0));
            signals.push(Declared::wire(format!("serves_{slot}"), 1));
            signals.push(Declared::data_register(
                format!("slot_line_{slot}"),
                self.line_bits,
            ));
        }
        for name in ["note", "fetch", "fill"] {
            signals.push(Declared::register(format!("{name}_pointer"), pointer, 0));
        }
        signals.push(Declared::register("unasked", pointer + 1, 0));
        signals.push(Declared::register("beat_index", bits_for(self.beats()), 0));
        signals
    }
}
