//! A memory behind an AXI4 read port: latency, bandwidth, several bursts under way, random stalls.

use std::borrow::Cow;
use std::collections::VecDeque;

use super::read_port::{AxiAddress, AxiBeat, BEAT_BYTES};
use super::stall::StallPattern;
use crate::scene::Machine;

/// `rresp` of a burst beyond the memory: SLVERR.
const SLAVE_ERROR: u64 = 2;
/// Cycles that a stall between two beats takes at least.
const STALL_CYCLES: u64 = 3;

/// How a memory behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxiMemoryShape {
    /// Cycles from the one in which an address is taken to the one in which its first beat is
    /// offered, where nothing stands before it; at least 1.
    pub latency: u32,
    /// Bytes that come a cycle at most: 1, 2, 4 or 8, of a bus of 8.
    pub bytes_per_cycle: u32,
    /// Bursts taken and not yet answered, at most.
    pub outstanding: u32,
    /// The seed of random stalls, on the address channel and between beats; none where there are
    /// no stalls.
    pub stalls: Option<u16>,
}

impl AxiMemoryShape {
    /// The memory of a scene's machine. With a seed it stalls by that, whatever the scene says.
    pub fn of(machine: &Machine, stalls: Option<u16>) -> AxiMemoryShape {
        AxiMemoryShape {
            latency: machine.memory.latency,
            bytes_per_cycle: machine.memory.bytes_per_cycle,
            outstanding: machine.cache.pending,
            stalls: stalls.or(machine.memory.stalls.then_some(1)),
        }
    }

    /// When it stalls, from the first cycle on: addresses, and beats.
    pub fn stall_patterns(&self) -> [StallPattern; 2] {
        let beats = self.stalls.map(|seed| seed.rotate_left(8) ^ 0x5a5a);
        [self.stalls, beats].map(StallPattern::seeded)
    }
}

#[derive(Clone, Copy, Debug)]
struct Burst {
    /// Of the next beat, in beats.
    word: u64,
    beats_left: u64,
    id: u64,
    /// The first cycle in which a beat may be offered.
    answers_at: u64,
}

/// What the memory's ports carry in a cycle; none follows an input within the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxiMemoryOutputs {
    /// `arready`.
    pub arready: bool,
    /// The read data channel.
    pub r: AxiBeat,
}

/// A memory that answers bursts in their order. A beat that is offered stays until it is taken.
///
/// Random stalls come from two [`StallPattern`]s that step once a cycle: the first holds `arready`
/// low in one cycle of eight; the second, where it holds in the cycle in which a beat is taken,
/// puts off the next by at least 3 cycles.
#[derive(Clone, Debug)]
pub struct AxiMemory<'a> {
    shape: AxiMemoryShape,
    words: Cow<'a, [u64]>,
    bursts: VecDeque<Burst>,
    cycle: u64,
    /// The first cycle in which the bus may carry the next beat.
    bus_free_at: u64,
    address_stalls: StallPattern,
    beat_stalls: StallPattern,
    /// What the patterns say of this cycle.
    address_ready: bool,
    beat_ready: bool,
    beats: u64,
}

impl<'a> AxiMemory<'a> {
    /// A memory that holds `words`, the first at address 0.
    ///
    /// # Panics
    /// If the shape's figures are out of their ranges.
    pub fn new(shape: AxiMemoryShape, words: impl Into<Cow<'a, [u64]>>) -> AxiMemory<'a> {
        assert!(
            [1, 2, 4, 8].contains(&shape.bytes_per_cycle),
            "{} bytes a cycle: 1, 2, 4 or 8 can be",
            shape.bytes_per_cycle
        );
        assert!(
            shape.latency >= 1 && shape.outstanding >= 1,
            "a memory that answers at once, or nothing"
        );
        let [address_stalls, beat_stalls] = shape.stall_patterns();
        let mut memory = AxiMemory {
            bursts: VecDeque::with_capacity(shape.outstanding as usize),
            words: words.into(),
            cycle: 0,
            bus_free_at: 0,
            address_stalls,
            beat_stalls,
            address_ready: true,
            beat_ready: true,
            beats: 0,
            shape,
        };
        memory.step_patterns();
        memory
    }

    /// Beats taken so far: times 8, the bytes read.
    pub fn beats(&self) -> u64 {
        self.beats
    }

    fn step_patterns(&mut self) {
        self.address_ready = self.address_stalls.next_ready();
        self.beat_ready = self.beat_stalls.next_ready();
    }

    /// What the ports carry in this cycle.
    pub fn outputs(&self) -> AxiMemoryOutputs {
        let arready = self.address_ready && self.bursts.len() < self.shape.outstanding as usize;
        let r = match self.bursts.front() {
            Some(burst) if self.cycle >= burst.answers_at.max(self.bus_free_at) => {
                let word = self.words.get(burst.word as usize);
                AxiBeat {
                    valid: true,
                    id: burst.id,
                    data: word.copied().unwrap_or_default(),
                    response: if word.is_some() { 0 } else { SLAVE_ERROR },
                    last: burst.beats_left == 1,
                }
            }
            _ => AxiBeat::default(),
        };
        AxiMemoryOutputs { arready, r }
    }

    /// The rising edge at the end of a cycle.
    pub fn clock(&mut self, ar: &AxiAddress, rready: bool) {
        let outputs = self.outputs();
        if outputs.r.valid && rready {
            let interval = u64::from(BEAT_BYTES / self.shape.bytes_per_cycle);
            let stall = if self.beat_ready { 0 } else { STALL_CYCLES };
            self.bus_free_at = self.cycle + interval + stall;
            self.beats += 1;
            if outputs.r.last {
                self.bursts.pop_front();
            } else if let Some(burst) = self.bursts.front_mut() {
                burst.word += 1;
                burst.beats_left -= 1;
            }
        }
        if ar.valid && outputs.arready {
            self.bursts.push_back(Burst {
                word: ar.address / u64::from(BEAT_BYTES),
                beats_left: ar.length + 1,
                id: ar.id,
                answers_at: self.cycle + u64::from(self.shape.latency),
            });
        }
        self.cycle += 1;
        self.step_patterns();
    }
}

#[cfg(test)]
mod tests {
    use super::super::read_port::{ReadPort, ReadPortInputs, ReadPortShape};
    use super::*;

    const QUICK: AxiMemoryShape = AxiMemoryShape {
        latency: 5,
        bytes_per_cycle: 8,
        outstanding: 4,
        stalls: None,
    };

    fn words() -> Vec<u64> {
        (0..64).map(|word| word * 0x0101_0101).collect()
    }

    /// Reads lines through a port; answers the beats and the cycles it took.
    fn read(shape: AxiMemoryShape, lines: &[u64], receiver: &mut StallPattern) -> (Vec<u64>, u64) {
        let mut memory = AxiMemory::new(shape, words());
        let mut port = ReadPort::new(ReadPortShape::new("read_port", 5, 2, 4));
        let (mut asked, mut beats, mut held) = (0, Vec::new(), None);
        for cycle in 0..5000 {
            let answer = memory.outputs();
            let inputs = ReadPortInputs {
                request_valid: asked < lines.len(),
                request_line: lines.get(asked).copied().unwrap_or_default(),
                beat_ready: receiver.next_ready(),
                arready: answer.arready,
                r: answer.r,
            };
            let outputs = port.outputs(&inputs);
            if let Some(before) = held {
                assert_eq!((outputs.ar.valid, outputs.ar), (true, before));
            }
            held = (outputs.ar.valid && !answer.arready).then_some(outputs.ar);
            asked += usize::from(inputs.request_valid && outputs.request_ready);
            if outputs.beat_valid && inputs.beat_ready {
                assert_eq!(outputs.beat_last, beats.len() % 2 == 1);
                beats.push(outputs.beat_data);
            }
            assert!(!outputs.error);
            if beats.len() == 2 * lines.len() {
                return (beats, cycle);
            }
            port.clock(&inputs);
            memory.clock(&outputs.ar, outputs.rready);
        }
        panic!(
            "{} of {} lines asked for, {} beats",
            asked,
            lines.len(),
            beats.len()
        );
    }

    #[test]
    fn lines_arrive_whole_and_in_order_whatever_stalls() {
        let lines: Vec<u64> = (0..32).chain((0..32).rev()).collect();
        let expected: Vec<u64> = lines
            .iter()
            .flat_map(|line| [2 * line, 2 * line + 1])
            .map(|word| word * 0x0101_0101)
            .collect();
        let (beats, cycles) = read(QUICK, &lines, &mut StallPattern::never());
        assert_eq!(beats, expected);
        // The bus is never idle once the first answer is there.
        assert!(cycles < 128 + 10, "{cycles}");
        let slow = AxiMemoryShape {
            bytes_per_cycle: 2,
            ..QUICK
        };
        let (beats, cycles) = read(slow, &lines, &mut StallPattern::never());
        assert_eq!(beats, expected);
        assert!((4 * 127..4 * 128 + 10).contains(&cycles), "{cycles}");
        for seed in 1..20 {
            let stalls = AxiMemoryShape {
                stalls: Some(seed),
                ..QUICK
            };
            let mut receiver = StallPattern::one_in_eight(seed + 77);
            let (beats, stalled) = read(stalls, &lines, &mut receiver);
            assert_eq!(beats, expected);
            assert!(stalled > 145, "{stalled}");
        }
    }

    #[test]
    fn a_burst_beyond_the_memory_is_an_error_that_stays() {
        let mut memory = AxiMemory::new(QUICK, vec![0; 4]);
        let mut port = ReadPort::new(ReadPortShape::new("read_port", 5, 2, 4));
        let mut errors = Vec::new();
        for cycle in 0..30 {
            let answer = memory.outputs();
            let inputs = ReadPortInputs {
                request_valid: cycle == 0 || cycle == 12,
                request_line: if cycle == 0 { 7 } else { 1 },
                beat_ready: true,
                arready: answer.arready,
                r: answer.r,
            };
            let outputs = port.outputs(&inputs);
            errors.push(outputs.error);
            port.clock(&inputs);
            memory.clock(&outputs.ar, outputs.rready);
        }
        assert!(!errors[6] && errors[8] && errors[29]);
    }

    #[test]
    fn a_beat_that_is_not_the_last_but_says_so_is_an_error() {
        for (last, id, response, error) in [
            (false, 0, 0, false),
            (true, 0, 0, true),
            (false, 3, 0, true),
            (false, 0, 2, true),
        ] {
            let mut port = ReadPort::new(ReadPortShape::new("read_port", 5, 4, 1));
            let mut inputs = ReadPortInputs {
                request_valid: true,
                ..ReadPortInputs::default()
            };
            port.clock(&inputs);
            assert!(!port.outputs(&inputs).request_ready, "one line under way");
            inputs.r = AxiBeat {
                valid: true,
                id,
                data: 0,
                response,
                last,
            };
            port.clock(&inputs);
            assert_eq!(port.outputs(&inputs).error, error);
        }
    }
}
