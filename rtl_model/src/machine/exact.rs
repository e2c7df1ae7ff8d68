//! The exact machine, cycle by cycle: the walk by bounds as a traverse unit.
//!
//! ```text
//! ray -> setups -> loop of trips -> FIFO -> leaf check -> hit
//!                   |    ^   ^                  |
//!                   |    |   +---- refused -----+
//!              height cache -> read port -> memory
//! ```
//!
//! Every ray inside has a slot, from its entry into the loop until its hit is taken; its constants
//! and the bounds of its blocks stand in memories by slot. The FIFO has a place for every slot, so
//! what ends its trips always finds one; whatever waits behind the loop, nothing in it ever stops.
//! A walk that is refused goes back into the loop before any new ray does, as soon as there is a
//! gap. So every walk in the loop gets on, and no wait is a circle: hits wait for their receiver,
//! the leaf check for hits, the FIFO for the leaf check, new rays for slots.

mod observe;
mod ports;

pub use ports::{ExactCounts, ExactHit, ExactInputs, ExactOutputs};

use super::exact_shape::{ExactMachineShape, KNOWN_STAGE, READ_STAGE};
use super::exact_state::{Checking, LeafWalk, LoopWalk, SetUp, SlotRay, Trip, fixed_ray};
use super::exact_trip::{curve_address, exact_trip};
use super::fifo::Fifo;
use super::height_cache::{HeightCache, HeightCacheInputs};
use super::read_port::{ReadPort, ReadPortInputs, ReadPortOutputs};
use crate::readings::F64Reading;
use crate::units::bounded_leaf::{
    LeafTravel, corner_digit, corner_start, leaf_place, leaf_verdict, leaf_ways, travel_digit,
};
use crate::units::bounded_setup::{near_digit, near_start, setup_digit, setup_end, setup_entry};
use crate::units::bounded_shape::LINE_BITS;

/// The exact machine.
#[derive(Clone, Debug)]
pub struct ExactMachine {
    shape: ExactMachineShape,
    setups: Vec<SetUp>,
    free_slots: u64,
    rays: Vec<SlotRay>,
    /// By slot: walks that wait for the leaf check.
    ended: Vec<LeafWalk>,
    /// By slot and line number.
    t_near: Vec<(i64, i64)>,
    line_words: usize,
    /// What was last read of the rays, and of the bounds, for the loop.
    read_ray: SlotRay,
    read_near: (i64, i64),
    /// Stages 0 to the last, as a ring; `first` is stage 0.
    trips: Vec<Trip>,
    first: usize,
    lookup_valid: bool,
    lookup_address: i64,
    cache: HeightCache,
    port: ReadPort,
    leaf_fifo: Fifo,
    /// What the memories give in this cycle, a half of it late.
    fetched_valid: bool,
    fetched: (LeafWalk, SlotRay),
    waiting_valid: bool,
    waiting: (LeafWalk, SlotRay),
    check_valid: bool,
    check: Checking,
    answer_valid: bool,
    answer: Checking,
    counts: ExactCounts,
    cycle: u64,
}

impl ExactMachine {
    /// The machine after a reset in which every stage has filled with zeros, its memories full of
    /// zeros.
    pub fn new(shape: ExactMachineShape) -> ExactMachine {
        let slots = shape.effort.slots as usize;
        let line_words = shape.bounded.line_levels().next_power_of_two().max(2);
        let mut machine = ExactMachine {
            setups: vec![SetUp::default(); shape.setup_places() as usize],
            free_slots: u64::MAX >> (64 - shape.effort.slots),
            rays: vec![SlotRay::default(); slots],
            ended: vec![LeafWalk::default(); slots],
            t_near: vec![(0, 0); slots * line_words],
            line_words,
            read_ray: SlotRay::default(),
            read_near: (0, 0),
            trips: vec![Trip::default(); shape.effort.stages as usize],
            first: 0,
            lookup_valid: false,
            lookup_address: 0,
            cache: HeightCache::new(shape.cache.clone()),
            port: ReadPort::new(shape.port.clone()),
            leaf_fifo: Fifo::new(shape.leaf_fifo.clone()),
            fetched_valid: false,
            fetched: Default::default(),
            waiting_valid: false,
            waiting: Default::default(),
            check_valid: false,
            check: Checking::default(),
            answer_valid: false,
            answer: Checking::default(),
            counts: ExactCounts::default(),
            cycle: 0,
            shape,
        };
        let mut read = Trip::default();
        machine.read(&mut read);
        let mut answered = read;
        answered.place = 0;
        machine.answer(&mut answered);
        machine.trips[1..].fill(answered);
        machine.trips[KNOWN_STAGE as usize..=READ_STAGE as usize].fill(read);
        machine
    }

    /// What it is built as.
    pub fn shape(&self) -> &ExactMachineShape {
        &self.shape
    }

    /// Cycles since reset.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// What has been counted so far.
    pub fn counts(&self) -> ExactCounts {
        ExactCounts {
            hits: self.cache.hits(),
            misses: self.cache.misses(),
            lines_fetched: self.cache.fetches(),
            ..self.counts
        }
    }

    fn stage(&self, stage: usize) -> &Trip {
        &self.trips[(self.first + stage) % self.trips.len()]
    }

    fn last_stage(&self) -> &Trip {
        self.stage(self.trips.len() - 1)
    }

    fn port_inputs(&self, inputs: &ExactInputs) -> ReadPortInputs {
        let cache = self.cache.outputs();
        ReadPortInputs {
            request_valid: cache.fetch_valid,
            request_line: cache.fetch_line,
            beat_ready: true,
            arready: inputs.arready,
            r: inputs.r,
        }
    }

    fn port_outputs(&self, inputs: &ExactInputs) -> ReadPortOutputs {
        self.port.outputs(&self.port_inputs(inputs))
    }

    /// A ray is set up, and not yet in the loop.
    pub fn is_set_up(&self) -> bool {
        let last = &self.setups[self.setups.len() - 1];
        last.busy && last.turns == 0 && !self.stage(0).fresh
    }

    /// May this setup be loaded at the end of this cycle?
    fn is_free(&self, setup: usize) -> bool {
        let this = &self.setups[setup];
        if setup + 1 == self.setups.len() {
            // It holds its bounds until the first trip has read them.
            return !this.busy || self.stage(0).fresh;
        }
        !this.busy || (this.turns == 0 && self.is_free(setup + 1))
    }

    /// What the handshakes carry in this cycle.
    pub fn outputs(&self, inputs: &ExactInputs) -> ExactOutputs {
        let last = self.last_stage();
        let recirculates = last.valid && !last.ends;
        let refused = self.answer_valid && self.answer.refused;
        let port = self.port_outputs(inputs);
        let has_slot = self.free_slots != 0 && self.cache.outputs().lookup_ready;
        ExactOutputs {
            ray_ready: self.is_free(0),
            hit_valid: self.answer_valid && !self.answer.refused,
            recirculates,
            ends: last.valid && last.ends,
            returns: refused && !recirculates,
            admits: self.is_set_up() && has_slot && !recirculates && !refused,
            ar: port.ar,
            rready: port.rready,
            error: port.error,
        }
    }

    /// What the ports of a hit carry, be one offered or not.
    pub fn hit(&self) -> ExactHit {
        let (answer, ray) = (&self.answer, &self.answer.ray);
        let texel = |mirror: bool, index: i64| {
            let index = if mirror { !index } else { index };
            (index & (i64::from(self.shape.bounded.words.size()) - 1)) as u32
        };
        ExactHit {
            id: ray.id,
            i: texel(ray.mirror_u, answer.walk.i),
            j: texel(ray.mirror_v, answer.walk.j),
            at_border_u: answer.at_border_u,
            at_border_v: answer.at_border_v,
            way: answer.way,
            slope: answer.slope,
            depth: answer.walk.depth,
            steps: answer.walk.steps as u32,
            crossings: answer.walk.crossings as u32,
            guard: answer.walk.guard,
        }
    }

    /// The rising edge at the end of this cycle.
    pub fn clock(&mut self, inputs: &ExactInputs) {
        let outputs = self.outputs(inputs);
        let port_inputs = self.port_inputs(inputs);
        let port = self.port.outputs(&port_inputs);
        let begins = outputs.recirculates || outputs.returns || outputs.admits;
        self.counts.trips += u64::from(begins);
        self.counts.gaps += u64::from(!begins);

        let last = *self.last_stage();
        let read = self.stage(READ_STAGE as usize);
        let (lookup_valid, lookup_address) = (read.valid, read.address);
        self.read_by_slot(outputs.admits, &last);
        if last.valid && last.writes {
            let place = self.bound_place(last.slot, last.walk.line);
            self.t_near[place] = last.near;
        }

        // What enters the first stage.
        let before = self.stage(0);
        let (mut slot, mut walk) = (before.slot, before.walk);
        let mut bounds = (0, 0);
        if outputs.recirculates {
            (slot, walk) = (last.slot, last.after);
        } else if outputs.returns {
            (slot, walk) = (self.answer.walk.slot, self.answer.walk.resumed());
        } else if outputs.admits {
            slot = u64::from(self.free_slots.trailing_zeros());
            self.free_slots &= !(1 << slot);
            (walk, bounds) = self.admit(slot);
        }
        let taken = outputs.hit_valid && inputs.hit_ready;
        if taken {
            self.free_slots |= 1 << self.answer.walk.slot;
        }
        self.clock_setups(inputs);
        self.clock_leaf(&outputs, taken, &last);

        self.cache.clock(&HeightCacheInputs {
            lookup_valid: self.lookup_valid,
            lookup_address: self.lookup_address as u64 >> self.shape.offset_bits(),
            fetch_ready: port.request_ready,
            beat_valid: port.beat_valid,
            beat_data: port.beat_data,
        });
        self.port.clock(&port_inputs);
        (self.lookup_valid, self.lookup_address) = (lookup_valid, lookup_address);

        self.first = (self.first + self.trips.len() - 1) % self.trips.len();
        self.trips[self.first] = Trip {
            valid: begins,
            slot,
            fresh: outputs.admits,
            walk,
            own: bounds,
            ..Trip::default()
        };
        let is_read = (self.first + KNOWN_STAGE as usize) % self.trips.len();
        let mut trip = self.trips[is_read];
        self.read(&mut trip);
        self.trips[is_read] = trip;
        let stage = self.shape.height_stage() as usize;
        let answered = (self.first + stage) % self.trips.len();
        let mut trip = self.trips[answered];
        self.answer(&mut trip);
        self.trips[answered] = trip;
        self.cycle += 1;
    }

    fn bound_place(&self, slot: u64, line: i64) -> usize {
        slot as usize * self.line_words + (line as usize & (self.line_words - 1))
    }

    /// A ray that is set up goes into a slot; answers its walk, and the bounds of its first block.
    fn admit(&mut self, slot: u64) -> (LoopWalk, (i64, i64)) {
        let last = self.setups.len() - 1;
        let set_up = match self.shape.effort.waiting_rays {
            0 => self.handed_on(last),
            _ => self.setups[last],
        };
        let ray = set_up.ray;
        let [u, v] = set_up.axes;
        self.rays[slot as usize] = SlotRay {
            t_delta_u: u.t_delta,
            t_delta_v: v.t_delta,
            ..ray
        };
        let walk = LoopWalk {
            line: ray.start_line,
            i: ray.i,
            j: ray.j,
            from_own_line: true,
            ..LoopWalk::default()
        };
        (walk, (u.t_near, v.t_near))
    }

    fn clock_setups(&mut self, inputs: &ExactInputs) {
        let shape = self.shape.bounded;
        let a = &mut F64Reading;
        let free: u64 = (0..self.setups.len())
            .map(|number| u64::from(self.is_free(number)) << number)
            .sum();
        for number in (0..self.setups.len()).rev() {
            let is_free = free >> number & 1 == 1;
            let loads = is_free
                && match number {
                    0 => inputs.ray_valid,
                    _ => self.setups[number - 1].busy && self.setups[number - 1].turns == 0,
                };
            if loads {
                let mut loaded = match number {
                    0 => {
                        let ray = inputs.ray;
                        let ports = [ray.u, ray.v, ray.du, ray.dv];
                        SetUp::of(inputs.ray_id, &setup_entry(a, shape, ports))
                    }
                    _ => self.handed_on(number - 1),
                };
                for (axis, before) in loaded.axes.iter_mut().zip(&self.setups[number].axes) {
                    // They are shifted out.
                    axis.division.quotient = before.division.quotient;
                }
                (loaded.busy, loaded.turns) = (true, self.shape.setup_turns(number as u32));
                self.setups[number] = loaded;
                continue;
            }
            let this = &mut self.setups[number];
            if is_free {
                this.busy = false;
            }
            if this.turns > 0 {
                this.turns -= 1;
                let slopes = [this.ray.slope_u, this.ray.slope_v];
                for (axis, slope) in this.axes.iter_mut().zip(slopes) {
                    if number as u32 == self.shape.effort.setups {
                        let digits = self.shape.near_digits();
                        for _ in 0..self.shape.effort.near_digits {
                            let quotient = axis.digits_before;
                            axis.product = near_digit(a, shape, digits, quotient, &axis.product);
                        }
                        continue;
                    }
                    axis.division = setup_digit(a, shape, slope, &axis.division);
                    axis.division.quotient &= (1 << self.shape.setup_turns(number as u32)) - 1;
                }
            }
        }
    }

    /// What a setup gives to the next.
    fn handed_on(&self, number: usize) -> SetUp {
        let mut set_up = self.setups[number];
        let (shape, setups) = (&self.shape, self.shape.effort.setups);
        let (a, digits) = (&mut F64Reading, shape.near_digits());
        for axis in &mut set_up.axes {
            if number as u32 == setups {
                let quotient = axis.digits_before;
                let (saturates, product) = (axis.saturates, &axis.product);
                (axis.t_delta, axis.t_near) =
                    setup_end(a, shape.bounded, digits, saturates, quotient, product);
            } else if (number as u32) < setups {
                let made = axis.digits_before << shape.setup_turns(number as u32);
                axis.digits_before = made | axis.division.quotient;
                if number as u32 + 1 == setups {
                    axis.product = near_start(a, shape.bounded, digits, axis.product.behind);
                }
            }
        }
        set_up
    }

    fn clock_leaf(&mut self, outputs: &ExactOutputs, taken: bool, last: &Trip) {
        let shape = self.shape.bounded;
        let a = &mut F64Reading;
        let LeafMoves {
            answers,
            checks,
            waits,
            fetches,
        } = self.leaf_moves();
        self.counts.refusals += u64::from(outputs.returns);

        let checking = self.check_valid;
        if outputs.returns || taken {
            self.answer_valid = false;
        }
        if let Some(verdict) = answers {
            (self.answer_valid, self.check_valid) = (true, false);
            self.answer = self.check;
            self.answer.refused = verdict.refused && !self.check.walk.guard;
            self.answer.at_border_u = verdict.at_border_u;
            self.answer.at_border_v = verdict.at_border_v;
            let ray = &self.check.ray;
            (self.answer.way, self.answer.slope) = match verdict.at_border_v {
                true => (self.check.ways.1, ray.slope_v),
                false => (self.check.ways.0, ray.slope_u),
            };
        }
        let turns = self.check.turns;
        let ray = fixed_ray(&self.check.ray);
        // An answer that leaves changes nothing that is read again, but its registers still turn.
        if checking {
            let is_known = self.check.walk.corner_is_known;
            if turns < self.shape.travel_turns() {
                for _ in 0..self.shape.effort.travel_digits {
                    self.check.travel = travel_digit(a, shape, &ray, &self.check.travel);
                }
            }
            if turns < self.shape.corner_turns() && !is_known {
                for _ in 0..self.shape.effort.corner_digits {
                    self.check.corner = corner_digit(a, shape, &ray, &self.check.corner);
                }
            }
            let most = self.shape.travel_turns().max(self.shape.corner_turns());
            self.check.turns += u32::from(turns < most);
        }
        if checks {
            let (walk, slot_ray) = self.waiting;
            let ray = fixed_ray(&slot_ray);
            let ways = leaf_ways(a, shape, &ray, walk.i, walk.j);
            self.check_valid = true;
            self.waiting_valid = false;
            self.check = Checking {
                walk,
                ray: slot_ray,
                ways,
                travel: LeafTravel {
                    u: ways.0,
                    v: ways.1,
                    depth: walk.depth,
                },
                corner: corner_start(a, shape, &ray, ways, walk.corner()),
                ..self.check
            };
            self.check.turns = 0;
        }
        if waits {
            self.waiting = self.fetched;
            (self.waiting_valid, self.fetched_valid) = (true, false);
        }
        if fetches {
            let slot = self.leaf_fifo.outputs().out[0] as usize;
            self.fetched = (self.ended[slot], self.rays[slot]);
            self.fetched_valid = true;
        }
        if outputs.ends {
            self.ended[last.slot as usize] = last.leaf_walk();
        }
        let slot = [last.slot];
        let put = outputs.ends.then_some(&slot[..]);
        self.leaf_fifo.clock(put, fetches);
    }

    /// Which of the walks that have ended go on in this cycle.
    fn leaf_moves(&self) -> LeafMoves {
        let verdict = (self.check_valid && !self.answer_valid).then(|| self.verdict());
        let answers = verdict.filter(|verdict| verdict.is_final);
        let checks = self.waiting_valid && (!self.check_valid || answers.is_some());
        let waits = self.fetched_valid && (!self.waiting_valid || checks);
        let fetches = self.leaf_fifo.outputs().out_valid && (!self.fetched_valid || waits);
        LeafMoves {
            answers,
            checks,
            waits,
            fetches,
        }
    }

    fn verdict(&self) -> Verdict {
        let shape = self.shape.bounded;
        let a = &mut F64Reading;
        let check = &self.check;
        let ray = fixed_ray(&check.ray);
        let mut corner = check.corner;
        if !check.walk.corner_is_known {
            for _ in 0..self.shape.corner_rest() {
                corner = corner_digit(a, shape, &ray, &corner);
            }
        }
        let place = leaf_place(a, shape, check.ways, &check.travel);
        let verdict = leaf_verdict(a, shape, &ray, check.ways, &place, corner.error);
        let is_before = place.is_before_u || place.is_before_v;
        let needs_corner = is_before && !check.walk.corner_is_known;
        let has_corner = check.turns >= self.shape.corner_turns();
        Verdict {
            is_final: check.turns >= self.shape.travel_turns() && (has_corner || !needs_corner),
            refused: verdict.refused,
            at_border_u: verdict.at_border_u,
            at_border_v: verdict.at_border_v,
        }
    }

    /// Reads by the slot in the first stage, at the edge at which that is left: what stood in the memories
    /// before it. Where a word is written at that edge, it is not read, and what was read last remains;
    /// a slot in the first stage with a walk in it is written by nothing.
    fn read_by_slot(&mut self, admits: bool, last: &Trip) {
        let (slot, walk) = (self.stage(0).slot, self.stage(0).walk);
        if !(admits && u64::from(self.free_slots.trailing_zeros()) == slot) {
            self.read_ray = self.rays[slot as usize];
        }
        let above = walk.line + i64::from(!walk.from_own_line);
        let line = above << (64 - LINE_BITS) >> (64 - LINE_BITS);
        let place = self.bound_place(slot, line);
        if !(last.valid && last.writes && self.bound_place(last.slot, last.walk.line) == place) {
            self.read_near = self.t_near[place];
        }
    }

    /// What was read belongs to a trip: its address follows.
    fn read(&self, trip: &mut Trip) {
        trip.ray = self.read_ray;
        trip.base = if trip.fresh { trip.own } else { self.read_near };
        let mirrors = (trip.ray.mirror_u, trip.ray.mirror_v);
        let walk = trip.walk.bounded::<F64Reading>();
        trip.address = curve_address(&mut F64Reading, self.shape.bounded, mirrors, &walk);
        trip.place = trip.address & ((1 << self.shape.offset_bits()) - 1);
    }

    /// The cache answers a trip.
    fn answer(&self, trip: &mut Trip) {
        let cache = self.cache.outputs();
        let bits = self.shape.bounded.words.height_bits;
        let cells = self.shape.bounded.lines().cells();
        let in_word = (64 / bits) as usize;
        for cell in 0..cells {
            let height = trip.place as usize * cells + cell;
            let word = cache.heights[height / in_word];
            let shifted = word >> ((height % in_word) as u32 * bits);
            trip.heights[cell] = (shifted & ((1 << bits) - 1)) as i64;
        }
        trip.missed = cache.answer_valid && !cache.hit;
        let result = exact_trip(
            &mut F64Reading,
            (self.shape.bounded, self.shape.counters),
            &trip.ray.bounded(),
            &trip.walk.bounded(),
            trip.base,
            (trip.fresh, trip.missed),
            &trip.heights[..cells],
        );
        trip.after = LoopWalk::of(&result.walk);
        trip.depth = result.walk.depth;
        trip.guard = result.walk.guard;
        trip.near = result.t_near;
        trip.corner_is_known = result.corner.is_known;
        trip.v_is_later = result.corner.v_is_later;
        trip.writes = result.writes;
        trip.ends = result.ends;
    }
}

/// Moves of the walks that have ended, at the end of a cycle.
struct LeafMoves {
    /// The check comes to its answer.
    answers: Option<Verdict>,
    /// A waiting walk goes on to the check.
    checks: bool,
    /// What was read goes on to wait.
    waits: bool,
    /// What the FIFO's first slot holds is read.
    fetches: bool,
}

#[derive(Clone, Copy)]
struct Verdict {
    is_final: bool,
    refused: bool,
    at_border_u: bool,
    at_border_v: bool,
}
