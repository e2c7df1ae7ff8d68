//! One step of parallax occlusion mapping (Tatarchuk 2006).
//!
//! A step looks at the map at one depth, sample by sample down to the first that lies below the
//! surface. Between it and the one before, the surface is taken to be a straight line, and the
//! answer is where the ray meets that: one secant.
//!
//! The line starts at the top plane, where no sample is taken: a ray whose first sample lies below
//! the surface answers with the top, as in the published program.

use super::linear_ray::{LinearRay, LinearShape, SAMPLE_BITS, depth_of_sample, place_at};
use crate::arith::Arith;
use crate::float::Rounding::NearestEven;

/// The registers of a search that change from step to step.
#[derive(Debug)]
pub struct PomWalk<A: Arith> {
    /// Depth of the sample looked at; of the hit, once the search has ended.
    pub t: A::Num,
    /// Texel on u that it lies in, wrapped to the map.
    pub texel_i: A::Int,
    /// Texel on v.
    pub texel_j: A::Int,
    /// Number of the sample looked at.
    pub sample: A::Int,
    /// Depth of the sample before; 0, the top, before the first.
    pub near: A::Num,
    /// How far the sample before lay above the surface; 0 at the top.
    pub clearance: A::Num,
    /// Steps taken.
    pub steps: A::Int,
    /// The search has ended, at depth t.
    pub hit: A::Bit,
    /// The search has ended at its bound: its ports named no sample to end at.
    pub guard: A::Bit,
}

impl<A: Arith> Clone for PomWalk<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for PomWalk<A> {}

/// What a step leaves: the registers for the next one, and the position they stand for.
#[derive(Debug)]
pub struct PomResult<A: Arith> {
    /// The search after the step; unchanged if it had ended before.
    pub walk: PomWalk<A>,
    /// Position on u at depth t, not wrapped.
    pub position_u: A::Num,
    /// Position on v.
    pub position_v: A::Num,
}

/// The step at which a search that has not ended ends with `guard`: none does that has a last
/// sample, since there it is below the surface.
pub const STEP_BOUND: u32 = super::linear_ray::LINEAR_SAMPLES + 1;

/// The registers before the first step: at the ray's first sample.
pub fn pom_start<A: Arith>(a: &mut A, shape: LinearShape, ray: &LinearRay<A>) -> PomWalk<A> {
    let t = depth_of_sample(a, "first_number", ray.first_sample, ray.spacing);
    a.name_num("first_depth", t);
    let place = place_at(a, shape, ray, t);
    let no = a.bit_constant(false);
    let none = a.int_constant(0);
    PomWalk {
        t,
        texel_i: place.texel_i,
        texel_j: place.texel_j,
        sample: ray.first_sample,
        near: a.zero(),
        clearance: a.zero(),
        steps: none,
        hit: no,
        guard: no,
    }
}

/// One step of a search, at a texel of this height.
pub fn pom_step<A: Arith>(
    a: &mut A,
    shape: LinearShape,
    ray: &LinearRay<A>,
    walk: &PomWalk<A>,
    height: A::Int,
) -> PomResult<A> {
    let ended = a.or(walk.hit, walk.guard);
    a.name_bit("ended", ended);
    let running = a.not(ended);
    a.name_bit("running", running);
    let depth = a.depth_from_height(height, shape.height_bits);
    a.name_num("texel_depth", depth);

    // Below the surface? The last sample is, whatever the map says: there the ray has ended.
    let under = a.less_equal(depth, walk.t);
    a.name_bit("under", under);
    let at_last = a.int_equal(walk.sample, ray.last_sample);
    a.name_bit("at_last_sample", at_last);
    let below = a.or(under, at_last);
    a.name_bit("below", below);

    // Where the ray meets the straight line through the last two samples.
    let clearance = a.sub(NearestEven, depth, walk.t);
    a.name_num("sample_clearance", clearance);
    let fall = a.sub(NearestEven, walk.clearance, clearance);
    a.name_num("fall", fall);
    let level = a.is_zero(fall);
    a.name_bit("no_fall", level);
    // A line that does not fall meets the ray nowhere, or everywhere: then the sample is the answer,
    // and the quotient is not used. Dividing by one spares it an infinity.
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    let one_as_number = a.number_from_integer(NearestEven, one, zero);
    let divisor = a.select(level, one_as_number, fall);
    a.name_num("divisor", divisor);
    let share = a.div(NearestEven, walk.clearance, divisor);
    a.name_num("share", share);
    let span = a.sub(NearestEven, walk.t, walk.near);
    a.name_num("span", span);
    let advance = a.mul(NearestEven, span, share);
    a.name_num("advance", advance);
    let met = a.add(NearestEven, walk.near, advance);
    a.name_num("met_t", met);
    let falls = a.not(level);
    let meets = a.and(under, falls);
    a.name_bit("meets", meets);
    let met = a.select(meets, met, walk.t);
    a.name_num("hit_t", met);

    // The search after the step.
    let not_below = a.not(below);
    let samples_on = a.and(not_below, running);
    a.name_bit("samples_on", samples_on);
    let near = a.select(samples_on, walk.t, walk.near);
    a.name_num("next_near", near);
    let clearance = a.select(samples_on, clearance, walk.clearance);
    a.name_num("next_clearance", clearance);
    let next = a.int_from_bit(samples_on);
    let sample = a.int_add(walk.sample, next);
    let sample = a.int_wrap(sample, SAMPLE_BITS);
    a.name_int("next_sample", sample);
    let hits = a.and(below, running);
    a.name_bit("hits", hits);
    let hit = a.or(walk.hit, hits);
    a.name_bit("next_hit", hit);
    let step = a.int_from_bit(running);
    let steps = a.int_add(walk.steps, step);
    let steps = a.int_wrap(steps, SAMPLE_BITS);
    a.name_int("next_steps", steps);
    let bound = a.int_constant(i64::from(STEP_BOUND));
    let at_bound = a.int_equal(steps, bound);
    let no_hit = a.not(hit);
    let bound_reached = a.and(at_bound, no_hit);
    let guard = a.or(walk.guard, bound_reached);
    a.name_bit("next_guard", guard);

    // The depth to look at next; at the end that of the hit.
    let linear_t = depth_of_sample(a, "sample_number", sample, ray.spacing);
    a.name_num("linear_t", linear_t);
    let t = a.select(hits, met, linear_t);
    a.name_num("reached_t", t);
    let t = a.select(ended, walk.t, t);
    a.name_num("next_t", t);
    let place = place_at(a, shape, ray, t);

    PomResult {
        walk: PomWalk {
            t,
            texel_i: place.texel_i,
            texel_j: place.texel_j,
            sample,
            near,
            clearance,
            steps,
            hit,
            guard,
        },
        position_u: place.position_u,
        position_v: place.position_v,
    }
}
