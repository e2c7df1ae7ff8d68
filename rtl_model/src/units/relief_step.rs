//! One step of relief mapping (Policarpo, Oliveira and Comba 2005), and of the confined search of a
//! depth-interval grid (Judnich and Ling), which differ in which samples a ray takes.
//!
//! A step looks at the map at one depth. First come linear samples, evenly spaced, down to the
//! first that lies below the surface: the surface is taken to be met between it and the one before.
//! Then [`BINARY_STEPS`] samples halve what is between. The answer is the uppermost depth that was
//! found below the surface, as in the published program.
//!
//! What is published samples on behind the first one below, for want of branches; nothing comes of
//! that, and it is left out here, so the steps are fewer.

use super::linear_ray::{
    BINARY_STEPS, LinearRay, LinearShape, SAMPLE_BITS, depth_of_sample, place_at,
};
use crate::arith::Arith;
use crate::float::Rounding::TowardZero;

/// The registers of a search that change from step to step.
#[derive(Debug)]
pub struct ReliefWalk<A: Arith> {
    /// Depth of the sample looked at; of the hit, once the search has ended.
    pub t: A::Num,
    /// Texel on u that it lies in, wrapped to the map.
    pub texel_i: A::Int,
    /// Texel on v.
    pub texel_j: A::Int,
    /// Number of the linear sample looked at, or of the first below the surface.
    pub sample: A::Int,
    /// The lowest depth known to be above the surface.
    pub near: A::Num,
    /// The uppermost depth known to be below it, in the binary steps.
    pub far: A::Num,
    /// The search is in its binary steps.
    pub refining: A::Bit,
    /// Binary steps taken.
    pub binary_steps: A::Int,
    /// Steps taken.
    pub steps: A::Int,
    /// The search has ended, at depth t.
    pub hit: A::Bit,
    /// The search has ended at its bound: its ports named no sample to end at.
    pub guard: A::Bit,
}

impl<A: Arith> Clone for ReliefWalk<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for ReliefWalk<A> {}

/// What a step leaves: the registers for the next one, and the position they stand for.
#[derive(Debug)]
pub struct ReliefResult<A: Arith> {
    /// The search after the step; unchanged if it had ended before.
    pub walk: ReliefWalk<A>,
    /// Position on u at depth t, not wrapped.
    pub position_u: A::Num,
    /// Position on v.
    pub position_v: A::Num,
}

/// The step at which a search that has not ended ends with `guard`: none does that has a last
/// sample, since there it is below the surface.
pub const STEP_BOUND: u32 = super::linear_ray::LINEAR_SAMPLES + BINARY_STEPS + 1;

/// Bits of the count of binary steps, signed.
pub const BINARY_STEP_BITS: u32 = 4;

/// The registers before the first step: at the ray's first sample.
pub fn relief_start<A: Arith>(a: &mut A, shape: LinearShape, ray: &LinearRay<A>) -> ReliefWalk<A> {
    let one = a.int_constant(1);
    let before = a.int_sub(ray.first_sample, one);
    a.name_int("sample_before", before);
    let near = depth_of_sample(a, "number_before", before, ray.spacing);
    a.name_num("depth_before", near);
    let t = depth_of_sample(a, "first_number", ray.first_sample, ray.spacing);
    a.name_num("first_depth", t);
    let place = place_at(a, shape, ray, t);
    let no = a.bit_constant(false);
    let none = a.int_constant(0);
    ReliefWalk {
        t,
        texel_i: place.texel_i,
        texel_j: place.texel_j,
        sample: ray.first_sample,
        near,
        far: t,
        refining: no,
        binary_steps: none,
        steps: none,
        hit: no,
        guard: no,
    }
}

/// One step of a search, at a texel of this height.
pub fn relief_step<A: Arith>(
    a: &mut A,
    shape: LinearShape,
    ray: &LinearRay<A>,
    walk: &ReliefWalk<A>,
    height: A::Int,
) -> ReliefResult<A> {
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
    let linear = a.not(walk.refining);
    a.name_bit("linear", linear);
    let ends_here = a.and(linear, at_last);
    a.name_bit("ends_here", ends_here);
    let below = a.or(under, ends_here);
    a.name_bit("below", below);

    // What is known of the surface.
    let keeps_near = a.or(below, ended);
    let near = a.select(keeps_near, walk.near, walk.t);
    a.name_num("next_near", near);
    let moves_far = a.and(below, running);
    a.name_bit("moves_far", moves_far);
    let far = a.select(moves_far, walk.t, walk.far);
    a.name_num("next_far", far);
    let refining = a.or(walk.refining, moves_far);
    a.name_bit("next_refining", refining);

    // The search after the step.
    let samples_on = a.or(refining, ended);
    let samples_on = a.not(samples_on);
    a.name_bit("samples_on", samples_on);
    let advance = a.int_from_bit(samples_on);
    let sample = a.int_add(walk.sample, advance);
    let sample = a.int_wrap(sample, SAMPLE_BITS);
    a.name_int("next_sample", sample);
    let halves = a.and(walk.refining, running);
    a.name_bit("halves", halves);
    let halving = a.int_from_bit(halves);
    let binary_steps = a.int_add(walk.binary_steps, halving);
    // A search ends at the last one, which fits.
    let binary_steps = a.int_wrap(binary_steps, BINARY_STEP_BITS);
    a.name_int("next_binary_steps", binary_steps);
    let all_binary_steps = a.int_constant(i64::from(BINARY_STEPS));
    let refined = a.int_equal(binary_steps, all_binary_steps);
    a.name_bit("refined", refined);
    let hit = a.or(walk.hit, refined);
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

    // The depth to look at next: a linear sample, or the middle; at the end that of the hit.
    let linear_t = depth_of_sample(a, "sample_number", sample, ray.spacing);
    a.name_num("linear_t", linear_t);
    let sum = a.add(TowardZero, near, far);
    a.name_num("near_plus_far", sum);
    let middle = a.scale(sum, -1);
    a.name_num("middle", middle);
    let t = a.select(refining, middle, linear_t);
    a.name_num("sampled_t", t);
    let t = a.select(hit, far, t);
    a.name_num("reached_t", t);
    let t = a.select(ended, walk.t, t);
    a.name_num("next_t", t);
    let place = place_at(a, shape, ray, t);

    ReliefResult {
        walk: ReliefWalk {
            t,
            texel_i: place.texel_i,
            texel_j: place.texel_j,
            sample,
            near,
            far,
            refining,
            binary_steps,
            steps,
            hit,
            guard,
        },
        position_u: place.position_u,
        position_v: place.position_v,
    }
}
