//! The FIFO in Verilog: two pointers, a count, and memories that are read within the cycle.

use std::sync::Arc;

use super::declared::{DeclaredSignals, next_number, up_and_down};
use crate::netlist::{Builder, Module, Wire};
use rtl_model::machine::FifoShape;

/// Bits of the widest word of a netlist.
const WIDEST: u32 = 64;

/// The FIFO of a shape.
///
/// # Panics
/// If the shape is none that can be built.
pub fn fifo(shape: &FifoShape) -> Arc<Module> {
    shape.check();
    let mut builder = Builder::new(&shape.name);
    let b = &mut builder;
    b.describe(format!(
        "A FIFO of {} places: what is put in is offered from the next cycle on.",
        shape.depth
    ));
    b.describe("A full one takes nothing, even where something is taken out in the same cycle.");
    b.describe("golden: rtl_model::machine::Fifo");
    b.set_latency(1);
    let depth = b.localparam("DEPTH", shape.depth.into(), "places, a power of two");
    let depth = u32::try_from(depth).expect("a depth");
    let mut signals = DeclaredSignals::new(b, shape.declaration());

    b.section("how many places are taken");
    let count = signals.register(b, "count");
    // The depth is a power of two, and the count never passes it.
    let is_full = b.bit(count, depth.trailing_zeros());
    let in_ready = b.not(is_full);
    let out_valid = b.any_bit(count);
    let puts = b.and(signals.get("in_valid_i"), in_ready);
    signals.wire(b, "puts", puts);
    let takes = b.and(signals.get("out_ready_i"), out_valid);
    signals.wire(b, "takes", takes);
    up_and_down(b, count, puts, takes);

    b.section("where is put in, and taken out");
    let write_pointer = signals.register(b, "write_pointer");
    let next = next_number(b, write_pointer);
    b.connect_enabled(write_pointer, next, puts);
    let read_pointer = signals.register(b, "read_pointer");
    let next = next_number(b, read_pointer);
    b.connect_enabled(read_pointer, next, takes);

    b.section("the places");
    let mut outputs: Vec<Wire> = Vec::new();
    for (number, fields) in side_by_side(shape).iter().enumerate() {
        let inputs: Vec<Wire> = fields
            .iter()
            .map(|&field| signals.get(&format!("in_{}_i", shape.fields[field].name)))
            .collect();
        let data = b.concat(&inputs);
        let memory = b.memory(&format!("places_{number}"), depth, b.width(data));
        b.memory_write(memory, puts, write_pointer, data);
        let word = b.memory_read(memory, read_pointer);
        let mut high = b.width(word);
        for &field in fields {
            let width = shape.fields[field].width;
            outputs.push(b.slice(word, high - 1, high - width));
            high -= width;
        }
    }

    signals.output(b, "in_ready_o", in_ready);
    signals.output(b, "out_valid_o", out_valid);
    for (field, wire) in shape.fields.iter().zip(outputs) {
        signals.output(b, &format!("out_{}_o", field.name), wire);
    }
    signals.output(b, "count_o", count);
    signals.finish(builder)
}

/// The fields by the memory they stand in, each as full as their order allows.
fn side_by_side(shape: &FifoShape) -> Vec<Vec<usize>> {
    let mut memories: Vec<Vec<usize>> = Vec::new();
    let mut bits = WIDEST;
    for (place, field) in shape.fields.iter().enumerate() {
        if bits + field.width > WIDEST {
            memories.push(Vec::new());
            bits = 0;
        }
        bits += field.width;
        memories.last_mut().expect("one was pushed").push(place);
    }
    memories
}
