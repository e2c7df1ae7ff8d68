//! A cache alone, and behind its port a memory that stalls.

use super::super::axi_memory::{AxiMemory, AxiMemoryShape};
use super::super::read_port::{ReadPort, ReadPortInputs, ReadPortShape};
use super::*;

fn shape(answer: CacheAnswer, height_bits: u32, latency: u32) -> HeightCacheShape {
    HeightCacheShape {
        name: "height_cache".to_owned(),
        height_bits,
        line_bits: 8,
        lines: 16,
        pending: 4,
        answer,
        latency,
        counters: true,
    }
}

/// Cache, port and memory, cycle by cycle.
struct Bench {
    cache: HeightCache,
    port: ReadPort,
    memory: AxiMemory<'static>,
    asked: Vec<u64>,
    words: Vec<u64>,
}

impl Bench {
    fn new(shape: HeightCacheShape, stalls: Option<u16>) -> Bench {
        let words: Vec<u64> = (1..=256 * u64::from(shape.beats()))
            .map(|word| word.wrapping_mul(0x9e37_79b9_7f4a_7c15))
            .collect();
        let memory = AxiMemoryShape {
            latency: 10,
            bytes_per_cycle: 8,
            outstanding: 4,
            stalls,
        };
        Bench {
            port: ReadPort::new(ReadPortShape::new("read_port", 8, shape.beats(), 4)),
            memory: AxiMemory::new(memory, words.clone()),
            cache: HeightCache::new(shape),
            asked: Vec::new(),
            words,
        }
    }

    fn height(&self, address: u64) -> u64 {
        let in_word = u64::from(64 / self.cache.shape.height_bits);
        let word = self.words[(address / in_word) as usize];
        let shift = address % in_word * u64::from(self.cache.shape.height_bits);
        word >> shift & ((1 << self.cache.shape.height_bits) - 1)
    }

    /// A cycle; answers what the cache gave in it.
    fn cycle(&mut self, lookup: Option<u64>) -> HeightCacheOutputs {
        let outputs = self.cache.outputs();
        let answer = self.memory.outputs();
        let port_inputs = ReadPortInputs {
            request_valid: outputs.fetch_valid,
            request_line: outputs.fetch_line,
            beat_ready: true,
            arready: answer.arready,
            r: answer.r,
        };
        let port = self.port.outputs(&port_inputs);
        if outputs.fetch_valid && port.request_ready {
            self.asked.push(outputs.fetch_line);
        }
        self.cache.clock(&HeightCacheInputs {
            lookup_valid: lookup.is_some(),
            lookup_address: lookup.unwrap_or_default(),
            fetch_ready: port.request_ready,
            beat_valid: port.beat_valid,
            beat_data: port.beat_data,
        });
        self.port.clock(&port_inputs);
        self.memory.clock(&port.ar, port.rready);
        assert!(!port.error);
        outputs
    }

    fn sweep(&mut self) {
        for _ in 0..16 {
            assert!(!self.cycle(Some(3)).lookup_ready);
        }
        let outputs = self.cycle(None);
        assert!(outputs.lookup_ready && !outputs.answer_valid);
        assert_eq!(self.cache.misses(), 0);
    }
}

/// Twelve who ask in turn, each for the same until it hits.
struct Askers {
    answer: CacheAnswer,
    state: u64,
    addresses: [u64; 12],
    asked: usize,
    answered: usize,
}

impl Askers {
    fn new(answer: CacheAnswer) -> Askers {
        let mut askers = Askers {
            answer,
            state: 7,
            addresses: [0; 12],
            asked: 0,
            answered: 0,
        };
        askers.addresses = std::array::from_fn(|_| askers.draw());
        askers
    }

    fn draw(&mut self) -> u64 {
        let state = self.state.wrapping_mul(6364136223846793005);
        self.state = state.wrapping_add(1442695040888963407);
        // Lines that collide, and among them a few that come often.
        let lines = [0xff, 0x33][(self.state >> 63) as usize];
        let line = self.state >> 40 & lines;
        match self.answer {
            CacheAnswer::Height => line << 4 | self.state >> 50 & 15,
            CacheAnswer::Line => line,
        }
    }

    fn address(&mut self) -> u64 {
        let asker = self.asked % self.addresses.len();
        self.asked += 1;
        self.addresses[asker]
    }

    fn answered(&mut self, hit: bool) {
        let asker = self.answered % self.addresses.len();
        self.answered += 1;
        if hit {
            self.addresses[asker] = self.draw();
        }
    }
}

#[test]
fn a_miss_fetches_a_line_once_and_later_lookups_hit() {
    for latency in [1, 2] {
        let mut bench = Bench::new(shape(CacheAnswer::Height, 8, latency), None);
        bench.sweep();
        let mut first_hit = None;
        for cycle in 0..40u64 {
            let outputs = bench.cycle(Some(0x123));
            assert_eq!(outputs.answer_valid, cycle >= u64::from(latency));
            if outputs.hit {
                first_hit = first_hit.or(Some(cycle));
                assert_eq!(outputs.heights[0], bench.height(0x123));
            } else {
                assert_eq!(first_hit, None, "visible once, visible for good");
            }
        }
        // Miss, note, port, ten cycles of memory, two beats, port, line, lookup.
        assert_eq!(first_hit, Some(15 + 2 * u64::from(latency)));
        assert_eq!(bench.asked, [0x12]);
        assert_eq!(bench.cache.fetches(), 1);
        assert_eq!(
            bench.cache.hits() + bench.cache.misses(),
            40 - u64::from(latency)
        );
    }
}

#[test]
fn what_hits_is_what_the_memory_holds() {
    for (answer, height_bits, latency) in [
        (CacheAnswer::Height, 8, 1),
        (CacheAnswer::Height, 16, 2),
        (CacheAnswer::Line, 8, 2),
        (CacheAnswer::Line, 16, 1),
    ] {
        let mut bench = Bench::new(shape(answer, height_bits, latency), Some(0xbeef));
        bench.sweep();
        let mut addresses = std::collections::VecDeque::new();
        let mut askers = Askers::new(answer);
        for _ in 0..20_000 {
            let address = askers.address();
            let outputs = bench.cycle(Some(address));
            addresses.push_back(address);
            if !outputs.answer_valid {
                continue;
            }
            let address: u64 = addresses.pop_front().unwrap();
            askers.answered(outputs.hit);
            if outputs.hit && answer == CacheAnswer::Height {
                assert_eq!(outputs.heights[0], bench.height(address));
            } else if outputs.hit {
                let beats = bench.cache.shape.beats() as usize;
                let words = &bench.words[address as usize * beats..][..beats];
                assert_eq!(&outputs.heights[..beats], words);
            }
        }
        assert!(bench.cache.hits() > 500 && bench.cache.fetches() > 1000);
    }
}

#[test]
fn no_index_is_noted_twice_and_none_beyond_the_room() {
    let mut bench = Bench::new(shape(CacheAnswer::Line, 8, 2), Some(3));
    bench.sweep();
    let mut askers = Askers::new(CacheAnswer::Line);
    let mut most = 0;
    for _ in 0..5000 {
        let address = askers.address();
        let outputs = bench.cycle(Some(address));
        if outputs.answer_valid {
            askers.answered(outputs.hit);
        }
        let slots = bench.cache.slots.iter().filter(|slot| slot.valid);
        let mut noted: Vec<u64> = slots.map(|slot| slot.line % 16).collect();
        most = most.max(noted.len());
        noted.sort_unstable();
        let count = noted.len();
        noted.dedup();
        assert_eq!(noted.len(), count);
    }
    assert_eq!(most, 4);
}

/// Two who want different lines of one index from a memory that answers sooner than they come
/// round. Were a line pushed out before it is hit, each would find the other's for ever.
#[test]
fn a_line_stays_until_it_has_been_hit() {
    let mut bench = Bench::new(shape(CacheAnswer::Line, 8, 1), None);
    bench.sweep();
    let mut wanted = [Some(0x13), Some(0x23)];
    for _ in 0..12 {
        for asker in [0, 1] {
            let idle = [None; 19];
            for lookup in std::iter::once(wanted[asker]).chain(idle) {
                let outputs = bench.cycle(lookup);
                if outputs.hit {
                    wanted[asker] = None;
                }
            }
        }
    }
    assert_eq!(wanted, [None; 2]);
    assert_eq!(bench.asked, [0x13, 0x23]);
}

#[test]
fn the_words_follow_the_declaration() {
    for answer in [CacheAnswer::Line, CacheAnswer::Height] {
        let cache = HeightCache::new(shape(answer, 16, 2));
        let mut words = Vec::new();
        cache.observe(&[0; 5], &mut words);
        assert_eq!(cache.declaration().len(), 5 + words.len());
    }
}
