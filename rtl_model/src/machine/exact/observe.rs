//! What the golden exact machine says of a cycle: the words that its Verilog is held against.

use super::super::declaration::ClockedUnit;
use super::super::exact_shape::EXACT_COUNTER_BITS;
use super::super::exact_trip::exact_trip;
use super::{ExactInputs, ExactMachine};
use crate::readings::{E7F16, FloatReading, Traced};

impl ExactMachine {
    /// Appends the result of every operation of the trip in a stage, as the golden reading keeps them. Before
    /// the cache has answered, those that depend on its heights are of no use.
    pub fn trace(
        &self,
        stage: u32,
        traced: &mut Traced<FloatReading<E7F16>>,
        words: &mut Vec<u64>,
    ) {
        let trip = self.stage(stage as usize);
        traced.words.clear();
        exact_trip(
            traced,
            (self.shape.bounded, self.shape.counters),
            &trip.ray.bounded(),
            &trip.walk.bounded(),
            trip.base,
            (trip.fresh, trip.missed),
            &trip.heights[..self.shape.bounded.lines().cells()],
        );
        words.extend_from_slice(&traced.words);
    }

    /// Appends what stands in front of the first stage beside the walk: valid, slot, fresh.
    pub fn observe_entry(&self, words: &mut Vec<u64>) {
        let trip = self.stage(0);
        words.extend([u64::from(trip.valid), trip.slot, trip.fresh.into()]);
    }

    /// Appends what stands in front of a stage, of those behind the first: missed, the place in the
    /// cache's line, then the inputs of the trip's datapath in their order.
    pub fn observe_stage(&self, stage: u32, words: &mut Vec<u64>) {
        let trip = self.stage(stage as usize);
        words.extend([trip.missed.into(), trip.place as u64]);
        let ray = &trip.ray;
        words.extend([ray.t_delta_u as u64, ray.t_delta_v as u64]);
        words.extend([u64::from(ray.mirror_u), ray.mirror_v.into()]);
        words.push(ray.start_line as u64);
        trip.walk.observe(&self.shape, words);
        words.extend([trip.base.0 as u64, trip.base.1 as u64]);
        words.extend([u64::from(trip.fresh), trip.missed.into()]);
        let cells = self.shape.bounded.lines().cells();
        words.extend(trip.heights[..cells].iter().map(|&height| height as u64));
    }

    /// Appends the words of this cycle: the declared signals of the unit that are no inputs, then those of
    /// the FIFO, the cache and the read port. Words of integers have the sign in front.
    pub fn observe(&self, inputs: &ExactInputs, words: &mut Vec<u64>) {
        let outputs = self.outputs(inputs);
        words.extend([u64::from(outputs.ray_ready), outputs.hit_valid.into()]);
        let hit = self.hit();
        words.extend([
            u64::from(hit.id),
            hit.i.into(),
            hit.j.into(),
            hit.at_border_u.into(),
            hit.at_border_v.into(),
            hit.way as u64,
            hit.slope as u64,
            hit.depth as u64,
        ]);
        if self.shape.counters {
            words.extend([u64::from(hit.steps), hit.crossings.into(), hit.guard.into()]);
        }
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
                counts.trips,
                counts.gaps,
                counts.refusals,
                counts.hits,
                counts.misses,
                counts.lines_fetched,
            ];
            words.extend(counters.map(|count| count & ((1 << EXACT_COUNTER_BITS) - 1)));
        }
        for (set_up, number) in self.setups.iter().zip(0..) {
            set_up.observe(&self.shape, number, words);
        }
        words.push(self.free_slots);
        words.extend([u64::from(outputs.recirculates), outputs.ends.into()]);
        words.extend([u64::from(outputs.returns), outputs.admits.into()]);
        self.stage(0).walk.observe(&self.shape, words);
        words.extend([u64::from(self.lookup_valid), self.lookup_address as u64]);
        words.extend([
            u64::from(self.fetched_valid),
            self.fetched.0.slot,
            self.fetched.1.id.into(),
        ]);
        words.push(self.waiting_valid.into());
        self.waiting.0.observe(&self.shape, 2, words);
        self.waiting.1.observe_leaf(words);
        words.push(self.check_valid.into());
        self.check.walk.observe(&self.shape, 1, words);
        let ray = &self.check.ray;
        words.extend([u64::from(ray.id), ray.slope_u as u64, ray.slope_v as u64]);
        words.extend([u64::from(ray.mirror_u), ray.mirror_v.into()]);
        words.push(self.answer_valid.into());
        self.answer.walk.observe(&self.shape, 0, words);
        let ray = &self.answer.ray;
        words.extend([u64::from(ray.id), ray.mirror_u.into(), ray.mirror_v.into()]);
        self.check.observe(words);
        let answer = &self.answer;
        words.extend([u64::from(answer.refused), answer.at_border_u.into()]);
        words.extend([u64::from(answer.at_border_v), answer.way as u64]);
        words.push(answer.slope as u64);

        let fetches = self.leaf_moves().fetches;
        let driven = [outputs.ends.into(), self.last_stage().slot, fetches.into()];
        self.leaf_fifo.observe(&driven, words);
        let cache = self.cache.outputs();
        let port = self.port_outputs(inputs);
        let driven = [
            self.lookup_valid.into(),
            self.lookup_address as u64 >> self.shape.offset_bits(),
            port.request_ready.into(),
            port.beat_valid.into(),
            port.beat_data,
        ];
        self.cache.observe(&driven, words);
        let driven = [
            cache.fetch_valid.into(),
            cache.fetch_line,
            1,
            inputs.arready.into(),
            inputs.r.valid.into(),
            inputs.r.id,
            inputs.r.data,
            inputs.r.response,
            inputs.r.last.into(),
        ];
        self.port.observe(&driven, words);
    }
}
