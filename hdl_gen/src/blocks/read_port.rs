//! The read port in Verilog: a register on the address channel, one on the data channel, and the
//! count of lines under way.

use std::sync::Arc;

use super::declared::{DeclaredSignals, next_number, up_and_down};
use crate::netlist::{Builder, Module};
use rtl_model::machine::{ADDRESS_BITS, BEAT_BYTES, ReadPortShape};

/// `arburst` of addresses that increase.
const INCREMENTING: u64 = 1;

/// The read port of a shape.
///
/// # Panics
/// If the shape is none that can be built.
pub fn read_port(shape: &ReadPortShape) -> Arc<Module> {
    shape.check();
    let mut builder = Builder::new(&shape.name);
    let b = &mut builder;
    b.describe("A read port: asks an AXI4 memory for lines and hands on their beats.");
    b.describe("Address and data stand in registers; a beat that is offered stays until taken.");
    b.describe("golden: rtl_model::machine::ReadPort");
    b.set_latency(1);
    let beats = b.localparam("BEATS", shape.beats.into(), "of a line: one burst");
    b.localparam(
        "LINE_SHIFT",
        shape.line_shift().into(),
        "a line's address is its number shifted left by this",
    );
    let outstanding_lines = b.localparam(
        "OUTSTANDING",
        shape.outstanding.into(),
        "lines asked for and not yet there, at most",
    );
    let mut signals = DeclaredSignals::new(b, shape.declaration());

    b.section("the address channel");
    let outstanding = signals.register(b, "outstanding");
    let arvalid = b.register(1, None, Some(0));
    let most = b.constant(outstanding_lines, shape.outstanding_bits());
    let is_most = b.equal(outstanding, most);
    let has_room = b.not(is_most);
    let arready = signals.get("mem_arready_i");
    let is_idle = b.not(arvalid);
    let is_free = b.or(is_idle, arready);
    let request_ready = b.and(is_free, has_room);
    let takes_request = b.and(signals.get("request_valid_i"), request_ready);
    signals.wire(b, "takes_request", takes_request);
    let not_taken = b.not(arready);
    let stays = b.and(arvalid, not_taken);
    let next = b.or(takes_request, stays);
    b.connect(arvalid, next);
    let asked_line = signals.register(b, "asked_line");
    b.connect_enabled(asked_line, signals.get("request_line_i"), takes_request);
    let zeros = b.constant(0, shape.line_shift());
    let above = ADDRESS_BITS - shape.line_bits - shape.line_shift();
    let mut address = vec![asked_line, zeros];
    if above > 0 {
        let base = shape.base >> (shape.line_bits + shape.line_shift());
        address.insert(0, b.constant(base, above));
    }
    let address = b.concat(&address);

    b.section("the data channel");
    let beat_valid = b.register(1, None, Some(0));
    let beat_ready = signals.get("beat_ready_i");
    let is_empty = b.not(beat_valid);
    let data_is_free = b.or(is_empty, beat_ready);
    let is_under_way = b.any_bit(outstanding);
    let rready = b.and(data_is_free, is_under_way);
    let takes_beat = b.and(signals.get("mem_rvalid_i"), rready);
    signals.wire(b, "takes_beat", takes_beat);
    let not_handed_on = b.not(beat_ready);
    let stays = b.and(beat_valid, not_handed_on);
    let next = b.or(takes_beat, stays);
    b.connect(beat_valid, next);
    let beat_data = b.registered(signals.get("mem_rdata_i"), Some(takes_beat), None);

    b.section("beats and lines");
    let beat_index = signals.register(b, "beat_index");
    let next = next_number(b, beat_index);
    b.connect_enabled(beat_index, next, takes_beat);
    let is_last = b.all_bits(beat_index);
    let beat_last = b.registered(is_last, Some(takes_beat), None);
    let line_ends = b.and(takes_beat, is_last);
    up_and_down(b, outstanding, takes_request, line_ends);

    b.section("what the memory must not answer");
    let has_failed = b.any_bit(signals.get("mem_rresp_i"));
    let other_length = b.xor(signals.get("mem_rlast_i"), is_last);
    let id = b.constant(shape.id, shape.id_bits);
    let same_id = b.equal(signals.get("mem_rid_i"), id);
    let other_id = b.not(same_id);
    let wrong = b.or(has_failed, other_length);
    let wrong = b.or(wrong, other_id);
    let wrong = b.and(wrong, takes_beat);
    let error = b.register(1, None, Some(0));
    let next = b.or(error, wrong);
    b.connect(error, next);

    signals.output(b, "request_ready_o", request_ready);
    signals.output(b, "beat_valid_o", beat_valid);
    signals.output(b, "beat_data_o", beat_data);
    signals.output(b, "beat_last_o", beat_last);
    signals.output(b, "error_o", error);
    signals.output(b, "mem_arvalid_o", arvalid);
    signals.output(b, "mem_araddr_o", address);
    let length = b.constant(beats - 1, 8);
    signals.output(b, "mem_arlen_o", length);
    let size = b.constant(u64::from(BEAT_BYTES.trailing_zeros()), 3);
    signals.output(b, "mem_arsize_o", size);
    let burst = b.constant(INCREMENTING, 2);
    signals.output(b, "mem_arburst_o", burst);
    signals.output(b, "mem_arid_o", id);
    signals.output(b, "mem_rready_o", rready);
    signals.finish(builder)
}
