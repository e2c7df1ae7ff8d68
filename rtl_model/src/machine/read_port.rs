//! A read port: asks an AXI4 memory for lines and hands on their beats.

use super::declaration::{ClockedUnit, Declared, bits_for};

/// Bytes of a beat: the data bus has 64 bits.
pub const BEAT_BYTES: u32 = 8;
/// Bits of an address on the bus.
pub const ADDRESS_BITS: u32 = 32;

/// What a read port is built as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadPortShape {
    /// The module's name.
    pub name: String,
    /// Bits of a line's number.
    pub line_bits: u32,
    /// Beats of a line, a power of two from 2 to 16: one burst.
    pub beats: u32,
    /// Lines that may be asked for and not yet have arrived, at least 1.
    pub outstanding: u32,
    /// Bits of the id.
    pub id_bits: u32,
    /// The id of every burst: answers come in order.
    pub id: u64,
    /// Where line 0 stands: a multiple of the bytes of all lines, so that no adder is needed.
    pub base: u64,
}

impl ReadPortShape {
    /// A port for lines of `beats` beats, up to `outstanding` of them under way, id 0 of four
    /// bits, line 0 at address 0.
    ///
    /// # Panics
    /// As [`check`](ReadPortShape::check) does.
    pub fn new(name: &str, line_bits: u32, beats: u32, outstanding: u32) -> ReadPortShape {
        let shape = ReadPortShape {
            name: name.to_owned(),
            line_bits,
            beats,
            outstanding,
            id_bits: 4,
            id: 0,
            base: 0,
        };
        shape.check();
        shape
    }

    /// # Panics
    /// If it is no port that can be built.
    pub fn check(&self) {
        let name = &self.name;
        assert!(
            self.beats.is_power_of_two() && (2..=16).contains(&self.beats),
            "read port {name}: bursts of {} beats",
            self.beats
        );
        assert!(self.outstanding >= 1, "read port {name}: no line under way");
        let bits = self.line_bits + self.line_shift();
        assert!(
            bits <= ADDRESS_BITS && self.base >> ADDRESS_BITS == 0,
            "read port {name}: addresses beyond {ADDRESS_BITS} bits"
        );
        assert!(
            self.base & ((1 << bits) - 1) == 0,
            "read port {name}: base {:#x} is no multiple of 2^{bits}",
            self.base
        );
        assert!(
            self.id >> self.id_bits == 0,
            "read port {name}: an id of more than {} bits",
            self.id_bits
        );
    }

    /// A line's address is its number shifted left by this, plus the base.
    pub fn line_shift(&self) -> u32 {
        bits_for(self.beats * BEAT_BYTES)
    }

    /// Bits of the count of lines under way.
    pub fn outstanding_bits(&self) -> u32 {
        bits_for(self.outstanding + 1)
    }

    /// Ports and registers, in the order of the words of [`ClockedUnit`].
    pub fn declaration(&self) -> Vec<Declared> {
        vec![
            Declared::input("request_valid_i", 1),
            Declared::input("request_line_i", self.line_bits),
            Declared::input("beat_ready_i", 1),
            Declared::input("mem_arready_i", 1),
            Declared::input("mem_rvalid_i", 1),
            Declared::input("mem_rid_i", self.id_bits),
            Declared::input("mem_rdata_i", 8 * BEAT_BYTES),
            Declared::input("mem_rresp_i", 2),
            Declared::input("mem_rlast_i", 1),
            Declared::output("request_ready_o", 1),
            Declared::output("beat_valid_o", 1),
            Declared::output("beat_data_o", 8 * BEAT_BYTES),
            Declared::output("beat_last_o", 1),
            Declared::output("error_o", 1),
            Declared::output("mem_arvalid_o", 1),
            Declared::output("mem_araddr_o", ADDRESS_BITS),
            Declared::output("mem_arlen_o", 8),
            Declared::output("mem_arsize_o", 3),
            Declared::output("mem_arburst_o", 2),
            Declared::output("mem_arid_o", self.id_bits),
            Declared::output("mem_rready_o", 1),
            Declared::wire("takes_request", 1),
            Declared::wire("takes_beat", 1),
            Declared::data_register("asked_line", self.line_bits),
            Declared::register("outstanding", self.outstanding_bits(), 0),
            Declared::register("beat_index", bits_for(self.beats), 0),
        ]
    }
}

/// What a read port's input ports carry in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadPortInputs {
    /// A line is asked for.
    pub request_valid: bool,
    /// Its number.
    pub request_line: u64,
    /// A beat would be taken.
    pub beat_ready: bool,
    /// The memory takes an address.
    pub arready: bool,
    /// The memory's answer.
    pub r: AxiBeat,
}

/// A beat on the read data channel of AXI4.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxiBeat {
    /// `rvalid`.
    pub valid: bool,
    /// `rid`.
    pub id: u64,
    /// `rdata`.
    pub data: u64,
    /// `rresp`: 0 is OKAY.
    pub response: u64,
    /// `rlast`.
    pub last: bool,
}

/// A burst on the read address channel of AXI4.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxiAddress {
    /// `arvalid`.
    pub valid: bool,
    /// `araddr`.
    pub address: u64,
    /// `arlen`: beats less one.
    pub length: u64,
    /// `arid`.
    pub id: u64,
}

/// What a read port's output ports carry in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadPortOutputs {
    /// A line that is asked for in this cycle is taken note of.
    pub request_ready: bool,
    /// A beat is offered.
    pub beat_valid: bool,
    /// Its data.
    pub beat_data: u64,
    /// It is the last of its line.
    pub beat_last: bool,
    /// The memory has answered with an error, with an id that is not ours, or with a burst of
    /// another length; stays once it is so.
    pub error: bool,
    /// The address channel.
    pub ar: AxiAddress,
    /// `rready`.
    pub rready: bool,
}

/// A read port. Address and data stand in registers, so that no path leads through it, except
/// from `beat_ready` to `rready` and from `arready` to `request_ready`.
#[derive(Clone, Debug)]
pub struct ReadPort {
    shape: ReadPortShape,
    asking: bool,
    asked_line: u64,
    offering: bool,
    data: u64,
    last: bool,
    /// Lines taken note of, and beats taken, since reset.
    lines: u64,
    beats: u64,
    error: bool,
}

impl ReadPort {
    /// A read port after its reset.
    ///
    /// # Panics
    /// If the shape is none that can be built.
    pub fn new(shape: ReadPortShape) -> ReadPort {
        shape.check();
        ReadPort {
            shape,
            asking: false,
            asked_line: 0,
            offering: false,
            data: 0,
            last: false,
            lines: 0,
            beats: 0,
            error: false,
        }
    }

    /// What it is built as.
    pub fn shape(&self) -> &ReadPortShape {
        &self.shape
    }

    /// Lines asked for of which beats have still to be taken.
    fn outstanding(&self) -> u64 {
        self.lines - self.beats / u64::from(self.shape.beats)
    }

    /// What the output ports carry in this cycle.
    pub fn outputs(&self, inputs: &ReadPortInputs) -> ReadPortOutputs {
        let address_is_free = !self.asking || inputs.arready;
        let room = self.outstanding() < u64::from(self.shape.outstanding);
        let data_is_free = !self.offering || inputs.beat_ready;
        ReadPortOutputs {
            request_ready: address_is_free && room,
            beat_valid: self.offering,
            beat_data: self.data,
            beat_last: self.last,
            error: self.error,
            ar: AxiAddress {
                valid: self.asking,
                address: self.shape.base + (self.asked_line << self.shape.line_shift()),
                length: u64::from(self.shape.beats) - 1,
                id: self.shape.id,
            },
            rready: data_is_free && self.outstanding() > 0,
        }
    }

    /// The rising edge at the end of a cycle.
    pub fn clock(&mut self, inputs: &ReadPortInputs) {
        let outputs = self.outputs(inputs);
        if inputs.arready {
            self.asking = false;
        }
        if inputs.request_valid && outputs.request_ready {
            self.asking = true;
            self.asked_line = inputs.request_line;
            self.lines += 1;
        }
        if inputs.beat_ready {
            self.offering = false;
        }
        if inputs.r.valid && outputs.rready {
            self.beats += 1;
            self.offering = true;
            self.data = inputs.r.data;
            self.last = self.beats.is_multiple_of(u64::from(self.shape.beats));
            self.error |= inputs.r.response != 0
                || inputs.r.last != self.last
                || inputs.r.id != self.shape.id;
        }
    }
}

impl ReadPortInputs {
    fn of_words(words: &[u64]) -> ReadPortInputs {
        ReadPortInputs {
            request_valid: words[0] != 0,
            request_line: words[1],
            beat_ready: words[2] != 0,
            arready: words[3] != 0,
            r: AxiBeat {
                valid: words[4] != 0,
                id: words[5],
                data: words[6],
                response: words[7],
                last: words[8] != 0,
            },
        }
    }
}

impl ClockedUnit for ReadPort {
    fn declaration(&self) -> Vec<Declared> {
        self.shape.declaration()
    }

    fn observe(&self, driven: &[u64], words: &mut Vec<u64>) {
        let inputs = ReadPortInputs::of_words(driven);
        let outputs = self.outputs(&inputs);
        words.extend([
            u64::from(outputs.request_ready),
            outputs.beat_valid.into(),
            outputs.beat_data,
            outputs.beat_last.into(),
            outputs.error.into(),
            outputs.ar.valid.into(),
            outputs.ar.address,
            outputs.ar.length,
            // 2^3 bytes a beat, addresses that increase.
            3,
            1,
            outputs.ar.id,
            outputs.rready.into(),
            (inputs.request_valid && outputs.request_ready).into(),
            (inputs.r.valid && outputs.rready).into(),
            self.asked_line,
            self.outstanding(),
            self.beats % u64::from(self.shape.beats),
        ]);
    }

    fn clock(&mut self, driven: &[u64]) {
        ReadPort::clock(self, &ReadPortInputs::of_words(driven));
    }
}
