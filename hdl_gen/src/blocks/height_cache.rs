//! The height cache in Verilog: memories of tags and of heights, read into registers, behind which
//! the tag is compared; and slots for the lines that are on their way or have not served yet.

use std::sync::Arc;

use super::declared::{DeclaredSignals, next_number, plus_bit, up_and_down};
use crate::netlist::{Builder, MemoryId, Module, Wire};
use rtl_model::machine::{CacheAnswer, HeightCacheShape};

/// Bits of a beat.
const WORD_BITS: u32 = 64;

/// The height cache of a shape.
///
/// # Panics
/// If the shape is none that can be built.
pub fn height_cache(shape: &HeightCacheShape) -> Arc<Module> {
    shape.check();
    let mut builder = Builder::new(&shape.name);
    let b = &mut builder;
    describe(b, shape);
    let mut signals = DeclaredSignals::new(b, shape.declaration());
    let index_bits = shape.index_bits();

    b.section("clearing the tags after reset");
    let swept = signals.register(b, "swept");
    let is_ready = b.bit(swept, index_bits);
    let is_sweeping = b.not(is_ready);
    let next = plus_bit(b, swept, is_sweeping);
    b.connect(swept, next);

    b.section("the lines on their way, and those that have not been hit since");
    let slots = Slots::build(b, &mut signals, shape);

    b.section("what is written: a line's beats, or a tag to be cleared");
    let beat_valid = signals.get("beat_valid_i");
    let beat_index = signals.register(b, "beat_index");
    let next = next_number(b, beat_index);
    b.connect_enabled(beat_index, next, beat_valid);
    let is_last = b.all_bits(beat_index);
    let fills = b.and(beat_valid, is_last);
    signals.wire(b, "fills", fills);
    let filling = slots.line_at(b, signals.get("fill_pointer"));
    let filling_index = b.slice(filling, index_bits - 1, 0);
    let filling_tag = b.slice(filling, shape.line_bits - 1, index_bits);
    let sweep_index = b.slice(swept, index_bits - 1, 0);
    let write_index = b.mux(is_ready, filling_index, sweep_index);
    let writes = b.or(is_sweeping, beat_valid);
    signals.wire(b, "writes", writes);

    b.section("the lookup: read into registers, unless the index is being written");
    let lookup_address = signals.get("lookup_address_i");
    let lookup_line = b.slice(
        lookup_address,
        shape.address_bits() - 1,
        shape.offset_bits(),
    );
    let lookup_index = b.slice(lookup_line, index_bits - 1, 0);
    let same_index = b.equal(write_index, lookup_index);
    let collides = b.and(writes, same_index);
    signals.wire(b, "collides", collides);
    let reads = b.not(collides);
    let tags = b.memory("tags", shape.lines, 1 + shape.tag_bits());
    // The line is whole, and there, with its last beat; a sweep finds the beat index at zero.
    let tag = b.concat(&[is_last, filling_tag]);
    b.memory_write(tags, writes, write_index, tag);
    let stored = b.memory_read(tags, lookup_index);
    let mut read = vec![
        b.bit(stored, shape.tag_bits()),
        b.slice(stored, shape.tag_bits() - 1, 0),
    ];
    read.extend(heights(
        b,
        shape,
        write_index,
        beat_index,
        beat_valid,
        lookup_address,
    ));
    let accepted = b.and(signals.get("lookup_valid_i"), is_ready);
    let mut before = [accepted, lookup_address, collides];
    for stage in 1..=shape.latency {
        let at = |name: &str| format!("{name}_s{stage}");
        let names = ["lookup_valid", "lookup_address", "collided"];
        for (name, wire) in names.iter().zip(&mut before) {
            let register = signals.register(b, &at(name));
            b.connect(register, *wire);
            *wire = register;
        }
        for (name, wire) in read_names(shape).iter().zip(&mut read) {
            let register = signals.register(b, &at(name));
            if stage == 1 {
                b.connect_enabled(register, *wire, reads);
            } else {
                b.connect(register, *wire);
            }
            *wire = register;
        }
    }

    b.section("the answer");
    let [answer_valid, address, collided] = before;
    let (stored_valid, stored_tag) = (read[0], read[1]);
    let line = b.slice(address, shape.address_bits() - 1, shape.offset_bits());
    let tag = b.slice(line, shape.line_bits - 1, index_bits);
    let same_tag = b.equal(stored_tag, tag);
    let not_collided = b.not(collided);
    let is_there = b.and(stored_valid, not_collided);
    let is_there = b.and(is_there, same_tag);
    let hit = b.and(answer_valid, is_there);
    let answers = match shape.answer {
        CacheAnswer::Line => read[2..].to_vec(),
        CacheAnswer::Height => vec![one_height(b, shape, read[2], address)],
    };

    b.section("a miss: its line is noted, unless one of its index is already, or there is no room");
    let not_hit = b.not(hit);
    let missed = b.and(answer_valid, not_hit);
    let index = b.slice(line, index_bits - 1, 0);
    let of_index = slots.of_index(b, index);
    let is_noted = b.any_bit(of_index);
    let is_new = b.not(is_noted);
    let is_used = slots.is_next_used(b, signals.get("note_pointer"));
    let has_room = b.not(is_used);
    let notes = b.and(missed, is_new);
    let notes = b.and(notes, has_room);
    signals.wire(b, "notes", notes);

    b.section("noted, asked for, filled; free again with the first hit");
    let unasked = signals.register(b, "unasked");
    let fetch_valid = b.any_bit(unasked);
    let asks = b.and(fetch_valid, signals.get("fetch_ready_i"));
    up_and_down(b, unasked, notes, asks);
    for (pointer, enable) in [
        ("note_pointer", notes),
        ("fetch_pointer", asks),
        ("fill_pointer", fills),
    ] {
        let pointer = signals.get(pointer);
        let next = next_number(b, pointer);
        b.connect_enabled(pointer, next, enable);
    }
    let fetch_line = slots.line_at(b, signals.get("fetch_pointer"));
    slots.connect(b, &mut signals, line, [notes, fills, hit], of_index);

    signals.output(b, "lookup_ready_o", is_ready);
    signals.output(b, "answer_valid_o", answer_valid);
    signals.output(b, "hit_o", hit);
    for ((name, _), wire) in shape.answer_ports().iter().zip(answers) {
        signals.output(b, name, wire);
    }
    signals.output(b, "fetch_valid_o", fetch_valid);
    signals.output(b, "fetch_line_o", fetch_line);
    if shape.counters {
        b.section("counters");
        for (name, event) in [("hits_o", hit), ("misses_o", missed), ("fetches_o", notes)] {
            let counter = b.register(32, None, Some(0));
            let next = next_number(b, counter);
            b.connect_enabled(counter, next, event);
            signals.output(b, name, counter);
        }
    }
    signals.finish(builder)
}

fn describe(b: &mut Builder, shape: &HeightCacheShape) {
    b.describe(format!(
        "A height cache: direct mapped, {} lines of 16 heights of {} bits.",
        shape.lines, shape.height_bits
    ));
    b.describe(format!(
        "A lookup in every cycle, answered {} later; nothing ever waits.",
        match shape.latency {
            1 => "a cycle".to_owned(),
            cycles => format!("{cycles} cycles"),
        }
    ));
    b.describe(
        "A miss fetches the line, unless one of its index is on its way or no slot is free.",
    );
    b.describe("No line is pushed out before its first hit: ask again for what you asked for.");
    b.describe("golden: rtl_model::machine::HeightCache");
    b.set_latency(shape.latency);
    for (name, value, reason) in [
        ("LINES", shape.lines, "that it holds, a power of two"),
        (
            "INDEX_BITS",
            shape.index_bits(),
            "the low bits of a line's number",
        ),
        ("TAG_BITS", shape.tag_bits(), "the rest of them"),
        (
            "BEATS",
            shape.beats(),
            "of 64 bits: the first holds the first heights, low bits first",
        ),
        (
            "PENDING",
            shape.pending,
            "lines on their way or not yet hit, at most: slots",
        ),
    ] {
        b.localparam(name, value.into(), reason);
    }
}

/// The names of what is read, without their stage.
fn read_names(shape: &HeightCacheShape) -> Vec<String> {
    let mut names = vec!["stored_valid".to_owned(), "stored_tag".to_owned()];
    match shape.answer {
        CacheAnswer::Height => names.push("heights".to_owned()),
        CacheAnswer::Line => names.extend((0..shape.beats()).map(|word| format!("line_{word}"))),
    }
    names
}

/// The memories of heights, written beat by beat: a word for each index and beat in one memory,
/// where one height is read, or a memory for each beat, where a line is.
fn heights(
    b: &mut Builder,
    shape: &HeightCacheShape,
    write_index: Wire,
    beat_index: Wire,
    beat_valid: Wire,
    lookup_address: Wire,
) -> Vec<Wire> {
    let beats = shape.beats();
    let data = b.module().input("beat_data_i").expect("a declared port");
    let (index_bits, offset_bits) = (shape.index_bits(), shape.offset_bits());
    let read_index = b.slice(lookup_address, offset_bits + index_bits - 1, offset_bits);
    let written = |b: &mut Builder, memory: MemoryId, enable, write, read| {
        b.memory_write(memory, enable, write, data);
        b.memory_read(memory, read)
    };
    match shape.answer {
        CacheAnswer::Height => {
            let memory = b.memory("heights", shape.lines * beats, WORD_BITS);
            let write = b.concat(&[write_index, beat_index]);
            let beat = b.slice(
                lookup_address,
                offset_bits - 1,
                offset_bits - beats.trailing_zeros(),
            );
            let read = b.concat(&[read_index, beat]);
            vec![written(b, memory, beat_valid, write, read)]
        }
        CacheAnswer::Line => (0..beats)
            .map(|beat| {
                let memory = b.memory(&format!("lines_{beat}"), shape.lines, WORD_BITS);
                let number = b.constant(beat.into(), b.width(beat_index));
                let is_this = b.equal(beat_index, number);
                let enable = b.and(beat_valid, is_this);
                written(b, memory, enable, write_index, read_index)
            })
            .collect(),
    }
}

/// The height that the low bits of the address select from a word.
fn one_height(b: &mut Builder, shape: &HeightCacheShape, word: Wire, address: Wire) -> Wire {
    let mut word = word;
    for bit in (0..(WORD_BITS / shape.height_bits).trailing_zeros()).rev() {
        let half = b.width(word) / 2;
        let (high, low) = (
            b.slice(word, 2 * half - 1, half),
            b.slice(word, half - 1, 0),
        );
        let select = b.bit(address, bit);
        word = b.mux(select, high, low);
    }
    word
}

/// The slots of the lines on their way or not yet hit, filled in turn.
struct Slots {
    valid: Vec<Wire>,
    filled: Vec<Wire>,
    lines: Vec<Wire>,
}

impl Slots {
    fn build(b: &mut Builder, signals: &mut DeclaredSignals, shape: &HeightCacheShape) -> Slots {
        let names = |name: &'static str| (0..shape.pending).map(move |k| format!("{name}_{k}"));
        let valid = names("slot_valid").map(|name| signals.register(b, &name));
        let valid = valid.collect();
        let filled = names("slot_filled").map(|name| signals.register(b, &name));
        let filled = filled.collect();
        let lines = names("slot_line").map(|name| signals.register(b, &name));
        let lines = lines.collect();
        for name in ["note_pointer", "fetch_pointer", "fill_pointer"] {
            signals.register(b, name);
        }
        Slots {
            valid,
            filled,
            lines,
        }
    }

    /// The line in the slot that a pointer points to.
    fn line_at(&self, b: &mut Builder, pointer: Wire) -> Wire {
        pointed_to(b, &self.lines, pointer)
    }

    /// Is the slot that the next line noted would take still used?
    fn is_next_used(&self, b: &mut Builder, note_pointer: Wire) -> Wire {
        pointed_to(b, &self.valid, note_pointer)
    }

    /// The slots with a line of an index, a bit each, the last in the high bit.
    fn of_index(&self, b: &mut Builder, index: Wire) -> Wire {
        let high = b.width(index) - 1;
        let each: Vec<Wire> = self
            .valid
            .iter()
            .zip(&self.lines)
            .rev()
            .map(|(&valid, &held)| {
                let held = b.slice(held, high, 0);
                let same = b.equal(held, index);
                b.and(valid, same)
            })
            .collect();
        b.concat(&each)
    }

    fn connect(
        &self,
        b: &mut Builder,
        signals: &mut DeclaredSignals,
        line: Wire,
        [notes, fills, hit]: [Wire; 3],
        of_index: Wire,
    ) {
        let (note, fill) = (signals.get("note_pointer"), signals.get("fill_pointer"));
        for slot in 0..self.valid.len() {
            let (valid, filled, held) = (self.valid[slot], self.filled[slot], self.lines[slot]);
            let number = b.constant(slot as u64, b.width(note));
            let is_next = b.equal(note, number);
            let takes = b.and(notes, is_next);
            let is_filling = b.equal(fill, number);
            let is_full = b.and(fills, is_filling);
            // The first hit of an index whose line is whole is a hit of that line.
            let is_of_index = b.bit(of_index, slot as u32);
            let serves = b.and(hit, is_of_index);
            let serves = b.and(serves, filled);
            signals.wire(b, &format!("serves_{slot}"), serves);
            let stays = b.not(serves);
            let stays = b.and(valid, stays);
            let next = b.or(takes, stays);
            b.connect(valid, next);
            let whole = b.or(filled, is_full);
            let waits = b.not(takes);
            let next = b.and(whole, waits);
            b.connect(filled, next);
            b.connect_enabled(held, line, takes);
        }
    }
}

/// The wire that a pointer points to.
fn pointed_to(b: &mut Builder, wires: &[Wire], pointer: Wire) -> Wire {
    let mut wires = wires.to_vec();
    for bit in 0..b.width(pointer) {
        let select = b.bit(pointer, bit);
        wires = wires
            .chunks(2)
            .map(|pair| b.mux(select, pair[1], pair[0]))
            .collect();
    }
    wires[0]
}
