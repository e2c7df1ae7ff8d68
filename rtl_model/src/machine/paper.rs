//! The traverse unit of the 2013 hardware paper (section 4), cycle by cycle.
//!
//! ```text
//! ray -> FIFO 0 -> controller -> loop of passes -> FIFO 1 -> hit
//!                                  |        ^
//!                             height cache -> read port -> memory
//! ```
//!
//! A ray goes round a pipeline of passes ([`PaperStep`](crate::units::paper_step::PaperStep)): the
//! first decides its start level, each further one is a step. What leaves the last stage without an
//! answer enters the first again; where it leaves a gap the controller lets a ray in from FIFO 0,
//! but only while the rays in the loop and those in FIFO 1 leave a place there. So a ray that has
//! hit always finds one, and nothing in the loop ever stops. A pass whose lookup misses changes
//! nothing: the line is fetched, and the ray asks again in its next pass.

use super::fifo::Fifo;
use super::height_cache::{HeightCache, HeightCacheInputs};
use super::ledger::HIT_WORDS;
use super::paper_pass::{Datapath, Pass};
use super::paper_shape::{COUNTER_BITS, PaperShape};
use super::read_port::{AxiAddress, AxiBeat, ReadPort, ReadPortInputs, ReadPortOutputs};
use super::run_summary::Lookups;
use crate::maps::Pyramid;
use crate::ray::Ray;
use crate::readings::Word;

/// What the unit's input ports carry in a cycle.
#[derive(Clone, Copy, Debug)]
pub struct PaperInputs {
    /// A ray is offered.
    pub ray_valid: bool,
    /// Its id.
    pub ray_id: u32,
    /// The ray.
    pub ray: Ray<u64>,
    /// A hit would be taken.
    pub hit_ready: bool,
    /// The memory takes an address.
    pub arready: bool,
    /// What the memory answers.
    pub r: AxiBeat,
}

impl PaperInputs {
    /// The words of the input ports, in their declared order.
    pub fn words(&self) -> [u64; 13] {
        [
            self.ray_valid.into(),
            self.ray_id.into(),
            self.ray.u,
            self.ray.v,
            self.ray.du,
            self.ray.dv,
            self.hit_ready.into(),
            self.arready.into(),
            self.r.valid.into(),
            self.r.id,
            self.r.data,
            self.r.response,
            self.r.last.into(),
        ]
    }
}

/// What the unit's handshakes carry in a cycle, and what its control does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PaperOutputs {
    /// A ray offered in this cycle is put into FIFO 0.
    pub ray_ready: bool,
    /// FIFO 1 offers a hit.
    pub hit_valid: bool,
    /// Its ray's id.
    pub hit_id: u32,
    /// Its walk ended at the step bound.
    pub hit_guard: bool,
    /// The ray in the last stage has its answer.
    pub ends: bool,
    /// The ray in the last stage goes round again.
    pub recirculates: bool,
    /// A ray from FIFO 0 enters the loop.
    pub admits: bool,
    /// The address channel of the memory.
    pub ar: AxiAddress,
    /// A beat of the memory would be taken.
    pub rready: bool,
    /// The memory has answered wrongly.
    pub error: bool,
}

/// What has been counted since reset. A cycle is a pass that begins, or a gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PaperCounts {
    /// Passes begun: starts, steps and misses.
    pub passes: u64,
    /// Cycles in which no pass began since FIFO 0 was empty.
    pub gaps_without_ray: u64,
    /// Cycles in which no pass began since FIFO 1 might have overflowed, or the cache was being
    /// cleared.
    pub gaps_without_room: u64,
    /// Lookups that found their height.
    pub hits: u64,
    /// Lookups that did not.
    pub misses: u64,
    /// Lines fetched.
    pub lines_fetched: u64,
}

impl Lookups for PaperCounts {
    fn hits_and_misses(&self) -> (u64, u64) {
        (self.hits, self.misses)
    }
}

/// The paper's traverse unit of a map, in a number format.
///
/// After [`PaperMachine::new`] nothing is allocated: what enters the loop takes over the buffers
/// of what left it.
#[derive(Debug)]
pub struct PaperMachine<R: Word> {
    shape: PaperShape,
    datapath: Datapath<R>,
    /// Stages 0 to the last, as a ring; `first` is stage 0.
    stages: Vec<Pass<R>>,
    first: usize,
    fifo_0: Fifo,
    fifo_1: Fifo,
    cache: HeightCache,
    port: ReadPort,
    rays_inside: u32,
    lookup_valid: bool,
    lookup_address: u64,
    counts: PaperCounts,
    cycle: u64,
}

impl<R: Word> PaperMachine<R> {
    /// The machine after its reset, in which every stage has filled with what stands in an empty
    /// FIFO 0. A pass takes `pass_cycles`; the ray enters again one cycle later.
    ///
    /// # Panics
    /// If the cache answers after the pass.
    pub fn new(reading: R, shape: PaperShape, pyramid: &Pyramid, pass_cycles: u32) -> Self {
        assert!(shape.height_stage() <= pass_cycles, "a height in time");
        let mut machine = PaperMachine {
            datapath: Datapath::new(reading, shape.step, pyramid),
            stages: Vec::new(),
            first: 0,
            fifo_0: Fifo::new(shape.fifo_0.clone()),
            fifo_1: Fifo::new(shape.fifo_1.clone()),
            cache: HeightCache::new(shape.cache.clone()),
            port: ReadPort::new(shape.port.clone()),
            rays_inside: 0,
            lookup_valid: false,
            lookup_address: 0,
            counts: PaperCounts::default(),
            cycle: 0,
            shape,
        };
        let shown = machine.cache.outputs().heights[0];
        for _ in 0..=pass_cycles {
            let mut pass = Pass::empty();
            let waiting = machine.fifo_0.outputs();
            machine.datapath.set_up(waiting.out, &mut pass);
            machine.datapath.begin(&mut pass);
            machine.datapath.answer(&mut pass, shown, false);
            machine.stages.push(pass);
        }
        machine
    }

    /// The words that the memory behind the read port holds: lines of 16 heights.
    pub fn memory_words(shape: &PaperShape, pyramid: &Pyramid) -> Vec<u64> {
        let heights = shape.step.memory(pyramid);
        let bits = shape.step.shape.height_bits;
        let word = |heights: &[u16]| {
            let places = heights.iter().enumerate();
            places.fold(0, |word, (place, &height)| {
                word | u64::from(height) << (place as u32 * bits)
            })
        };
        heights.chunks(64 / bits as usize).map(word).collect()
    }

    /// Cycles since reset.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// What has been counted so far.
    pub fn counts(&self) -> PaperCounts {
        PaperCounts {
            hits: self.cache.hits(),
            misses: self.cache.misses(),
            lines_fetched: self.cache.fetches(),
            ..self.counts
        }
    }

    /// The hit that FIFO 1 offers, as it stands there.
    pub fn hit(&self) -> &[u64; HIT_WORDS] {
        let hit = self.fifo_1.outputs().out;
        hit.try_into().expect("FIFO 1 has the fields of a hit")
    }

    /// Where a stage stands in the ring.
    fn place(&self, stage: usize) -> usize {
        let place = self.first + stage;
        place
            - if place < self.stages.len() {
                0
            } else {
                self.stages.len()
            }
    }

    fn stage(&self, stage: usize) -> &Pass<R> {
        &self.stages[self.place(stage)]
    }

    fn last_stage(&self) -> &Pass<R> {
        self.stage(self.stages.len() - 1)
    }

    fn port_inputs(&self, inputs: &PaperInputs) -> ReadPortInputs {
        let cache = self.cache.outputs();
        ReadPortInputs {
            request_valid: cache.fetch_valid,
            request_line: cache.fetch_line,
            beat_ready: true,
            arready: inputs.arready,
            r: inputs.r,
        }
    }

    fn port_outputs(&self, inputs: &PaperInputs) -> ReadPortOutputs {
        self.port.outputs(&self.port_inputs(inputs))
    }

    /// What the handshakes carry in this cycle.
    pub fn outputs(&self, inputs: &PaperInputs) -> PaperOutputs {
        let last = self.last_stage();
        let ends = last.valid && (last.answers[0].1.bit() || last.answers[1].1.bit());
        let recirculates = last.valid && !ends;
        let (waiting, done) = (self.fifo_0.outputs(), self.fifo_1.outputs());
        let port = self.port_outputs(inputs);
        PaperOutputs {
            ray_ready: waiting.in_ready,
            hit_valid: done.out_valid,
            hit_id: done.out[0] as u32,
            hit_guard: done.out.last() == Some(&1),
            ends,
            recirculates,
            admits: waiting.out_valid && !recirculates && self.has_room(inputs.hit_ready),
            ar: port.ar,
            rready: port.rready,
            error: port.error,
        }
    }

    /// May one more ray be let in? A hit that is taken in this cycle makes a place.
    fn has_room(&self, hit_ready: bool) -> bool {
        let leaves = hit_ready && self.fifo_1.outputs().out_valid;
        let room = self.rays_inside < self.shape.fifo_1.depth || leaves;
        room && self.cache.outputs().lookup_ready
    }

    /// Appends the words of this cycle: the declared signals of the unit that are no inputs, those
    /// of FIFO 0, FIFO 1, the cache and the read port; the first stage's valid bit, id, registers
    /// and results; and, of the stage in which the cache answers, the height, whether it missed,
    /// and all results.
    pub fn observe(&self, inputs: &PaperInputs, words: &mut Vec<u64>) {
        use super::declaration::ClockedUnit;
        let outputs = self.outputs(inputs);
        words.extend([u64::from(outputs.ray_ready), outputs.hit_valid.into()]);
        words.extend_from_slice(self.fifo_1.outputs().out);
        words.extend([
            u64::from(outputs.ar.valid),
            outputs.ar.address,
            outputs.ar.length,
            // 2^3 bytes a beat, addresses that increase.
            3,
            1,
            outputs.ar.id,
            outputs.rready.into(),
            outputs.error.into(),
        ]);
        if self.shape.counters {
            let counts = self.counts();
            let counters = [
                counts.passes,
                counts.gaps_without_ray,
                counts.gaps_without_room,
                counts.hits,
                counts.misses,
                counts.lines_fetched,
            ];
            words.extend(counters.map(|count| count & ((1 << COUNTER_BITS) - 1)));
        }
        words.extend([
            u64::from(outputs.ends),
            outputs.recirculates.into(),
            outputs.admits.into(),
            self.rays_inside.into(),
            self.lookup_valid.into(),
            self.lookup_address,
        ]);
        let cache = self.cache.outputs();
        let port = self.port_outputs(inputs);
        let ports = inputs.words();
        // An offered ray, and whether one is taken.
        let mut driven = [0; 7];
        driven[..6].copy_from_slice(&ports[..6]);
        driven[6] = outputs.admits.into();
        self.fifo_0.observe(&driven, words);
        let mut driven = [0; 11];
        driven[0] = outputs.ends.into();
        driven[1..10].copy_from_slice(&self.datapath.hit_fields(self.last_stage()));
        driven[10] = inputs.hit_ready.into();
        self.fifo_1.observe(&driven, words);
        let driven = [
            self.lookup_valid.into(),
            self.lookup_address,
            port.request_ready.into(),
            port.beat_valid.into(),
            port.beat_data,
        ];
        self.cache.observe(&driven, words);
        let mut driven = [
            u64::from(cache.fetch_valid),
            cache.fetch_line,
            1,
            0,
            0,
            0,
            0,
            0,
            0,
        ];
        driven[3..].copy_from_slice(&ports[7..]);
        self.port.observe(&driven, words);
        let entry = self.stage(0);
        words.extend([u64::from(entry.valid), entry.id.into()]);
        words.extend_from_slice(&entry.inputs);
        words.extend_from_slice(&entry.words);
        let answered = self.stage(self.shape.height_stage() as usize);
        words.extend([answered.height, answered.missed.into()]);
        words.extend_from_slice(&answered.words);
    }

    /// The rising edge at the end of this cycle.
    pub fn clock(&mut self, inputs: &PaperInputs) {
        let outputs = self.outputs(inputs);
        let port_inputs = self.port_inputs(inputs);
        let port = self.port.outputs(&port_inputs);
        let has_room = self.has_room(inputs.hit_ready);
        self.count(&outputs, has_room);
        let first = self.stage(0);
        let asks = first.valid && !first.starts;
        let address = first.address;

        let slot = self.place(self.stages.len() - 1);
        // The slot that falls free holds what enters.
        let pass = &mut self.stages[slot];
        if outputs.ends {
            let hit = self.datapath.hit_fields(pass);
            assert!(self.fifo_1.outputs().in_ready, "FIFO 1 overflows");
            self.fifo_1.clock(Some(&hit), inputs.hit_ready);
        } else {
            self.fifo_1.clock(None, inputs.hit_ready);
        }
        if outputs.recirculates {
            self.datapath.go_round(pass);
        } else {
            pass.valid = outputs.admits;
            self.datapath.set_up(self.fifo_0.outputs().out, pass);
        }
        self.datapath.begin(pass);
        let ray = inputs.ray;
        let offered = [inputs.ray_id.into(), ray.u, ray.v, ray.du, ray.dv];
        let offered = inputs.ray_valid.then_some(&offered[..]);
        self.fifo_0.clock(offered, outputs.admits);
        let leaves = outputs.hit_valid && inputs.hit_ready;
        self.rays_inside = self.rays_inside + u32::from(outputs.admits) - u32::from(leaves);

        self.cache.clock(&HeightCacheInputs {
            lookup_valid: self.lookup_valid,
            lookup_address: self.lookup_address,
            fetch_ready: port.request_ready,
            beat_valid: port.beat_valid,
            beat_data: port.beat_data,
        });
        self.port.clock(&port_inputs);
        (self.lookup_valid, self.lookup_address) = (asks, address);

        self.first = slot;
        let answer = self.cache.outputs();
        let missed = answer.answer_valid && !answer.hit;
        let answered = self.place(self.shape.height_stage() as usize);
        self.datapath
            .answer(&mut self.stages[answered], answer.heights[0], missed);
        self.cycle += 1;
    }

    fn count(&mut self, outputs: &PaperOutputs, has_room: bool) {
        if outputs.recirculates || outputs.admits {
            self.counts.passes += 1;
        } else if has_room {
            self.counts.gaps_without_ray += 1;
        } else {
            self.counts.gaps_without_room += 1;
        }
    }
}
