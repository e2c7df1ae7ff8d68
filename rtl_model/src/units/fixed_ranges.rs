//! What each signal of an exact fixed-point unit can be, for all rays of a range: the interval
//! reading of its setup and of a step at every level.

use std::collections::BTreeMap;

use super::fixed_setup::fixed_setup;
use super::fixed_step::{
    FixedWalkRegisters, asks_for_crossings, fixed_node_address, fixed_step, meets_midlines,
};
use super::search_policy::{Ascent, SearchPolicy};
use crate::ray_format::{RayFormat, RayRange, quantised};
use crate::readings::{IntegerInterval, IntervalReading, Maybe};

/// The range of each named integer, from the quantised ray to the answer. Its
/// [`IntegerInterval::signed_bits`] is the width that a unit for these rays alone needs.
///
/// A walk's registers hold what its invariants say, a level at a time: an index lies between those
/// of the texels of entry and exit, and the ray passes through the node, which bounds the error
/// term by the node's side times the slopes. What signals have to do with each other beyond that is
/// not seen, so a range may be wider than need be, and never narrower.
pub fn fixed_ranges(
    format: &RayFormat,
    policy: SearchPolicy,
    rays: &RayRange,
) -> BTreeMap<&'static str, IntegerInterval> {
    let shape = format.shape();
    let a = &mut IntervalReading::default();
    let ray = quantised(a, shape, rays.intervals());
    let setup = fixed_setup(a, shape, policy.start, ray.u, ray.v, ray.du, ray.dv);
    let ray = setup.ray;
    let full_height = i128::from(shape.full_height());
    let index = |entry: IntegerInterval, slope: IntegerInterval, level: u32| {
        let exit = (entry.high << shape.height_bits) + full_height * slope.high;
        IntegerInterval::new(
            entry.low >> (shape.entry_fraction_bits + level),
            exit >> (shape.fraction_bits() + level),
        )
    };
    let bound = i128::from(shape.step_bound(policy.ascent != Ascent::Never));
    for level in 0..=shape.root_level {
        let side = level + shape.entry_fraction_bits;
        let walk = FixedWalkRegisters::<IntervalReading> {
            level: IntegerInterval::point(level.into()),
            i: index(ray.u, ray.slope_u, level),
            j: index(ray.v, ray.slope_v, level),
            error: IntegerInterval::new(-(ray.slope_v.high << side), ray.slope_u.high << side),
            depth: IntegerInterval::new(0, full_height),
            at_border_u: Maybe::EITHER,
            at_border_v: Maybe::EITHER,
            at_midline: meets_midlines(policy).then_some(Maybe::EITHER),
            crossed_before: asks_for_crossings(policy).then_some(Maybe::EITHER),
            steps: IntegerInterval::new(0, bound - 1),
            crossings: IntegerInterval::new(0, bound - 1),
            hit: Maybe::known(false),
            guard: Maybe::known(false),
        };
        fixed_node_address(a, shape, &ray, &walk);
        let height = IntegerInterval::new(0, full_height);
        fixed_step(a, shape, policy, &ray, &walk, height);
    }
    std::mem::take(&mut a.integers)
}
