//! What a step does on one axis: where the ray leaves its node, and which child it is in.

use super::traverse_step::{EXACT_EXIT_ULPS, ROUNDED_EXIT_ULPS};
use crate::arith::Arith;
use crate::float::Rounding::{TowardZero, Up};

/// The names of an axis's signals.
pub(super) struct AxisNames {
    next_index: &'static str,
    near_bound: &'static str,
    far_bound: &'static str,
    half_exponent: &'static str,
    odd_index: &'static str,
    border: &'static str,
    border_distance: &'static str,
    distance_is_exact: &'static str,
    exit_depth: &'static str,
    exit_bound: &'static str,
    midline: &'static str,
    midline_distance: &'static str,
    past_midline: &'static str,
    reached_midline: &'static str,
    started_on_midline: &'static str,
    tie_crossed: &'static str,
}

pub(super) static AXIS_U: AxisNames = AxisNames {
    next_index: "next_border_i",
    near_bound: "near_bound_u",
    far_bound: "far_bound_u",
    half_exponent: "half_exponent_u",
    odd_index: "odd_i",
    border: "border_u",
    border_distance: "border_distance_u",
    distance_is_exact: "distance_is_exact_u",
    exit_depth: "exit_depth_u",
    exit_bound: "exit_bound_u",
    midline: "midline_u",
    midline_distance: "midline_distance_u",
    past_midline: "past_midline_u",
    reached_midline: "reached_midline_u",
    started_on_midline: "started_on_midline_u",
    tie_crossed: "tie_crossed_u",
};
pub(super) static AXIS_V: AxisNames = AxisNames {
    next_index: "next_border_j",
    near_bound: "near_bound_v",
    far_bound: "far_bound_v",
    half_exponent: "half_exponent_v",
    odd_index: "odd_j",
    border: "border_v",
    border_distance: "border_distance_v",
    distance_is_exact: "distance_is_exact_v",
    exit_depth: "exit_depth_v",
    exit_bound: "exit_bound_v",
    midline: "midline_v",
    midline_distance: "midline_distance_v",
    past_midline: "past_midline_v",
    reached_midline: "reached_midline_v",
    started_on_midline: "started_on_midline_v",
    tie_crossed: "tie_crossed_v",
};

/// What the step needs of a ray on one axis.
pub(super) struct Axis<A: Arith> {
    pub(super) names: &'static AxisNames,
    pub(super) coordinate: A::Num,
    pub(super) direction: A::Num,
    pub(super) exact_below: A::Num,
}

/// The depth at which a ray leaves a node on one axis: never later than in truth, and never
/// earlier.
pub(super) struct Exit<A: Arith> {
    pub(super) depth: A::Num,
    pub(super) bound: A::Num,
}

/// Where the ray leaves its node on this axis.
pub(super) fn exit<A: Arith>(
    a: &mut A,
    axis: &Axis<A>,
    size_exponent: A::Int,
    index: A::Int,
) -> Exit<A> {
    let names = axis.names;
    let one = a.int_constant(1);
    let next = a.int_add(index, one);
    a.name_int(names.next_index, next);
    // Exact: an index has no more bits than a significand.
    let border = a.number_from_integer(TowardZero, next, size_exponent);
    a.name_num(names.border, border);
    let distance = a.sub(TowardZero, border, axis.coordinate);
    a.name_num(names.border_distance, distance);
    let depth = a.div(TowardZero, distance, axis.direction);
    a.name_num(names.exit_depth, depth);
    // A border is a multiple of a texel, and within reach multiples of a texel are representable:
    // only the coordinate's grain can have been lost.
    let is_exact = a.less_than(distance, axis.exact_below);
    a.name_bit(names.distance_is_exact, is_exact);
    let near_bound = a.ulps_up(depth, EXACT_EXIT_ULPS);
    a.name_num(names.near_bound, near_bound);
    let far_bound = a.ulps_up(depth, ROUNDED_EXIT_ULPS);
    a.name_num(names.far_bound, far_bound);
    let bound = a.select(is_exact, near_bound, far_bound);
    a.name_num(names.exit_bound, bound);
    Exit { depth, bound }
}

/// Is the ray in the child on the far side of the midline? On the midline it is in the near one,
/// unless it started there, or `crosses_ties`.
pub(super) fn far_child<A: Arith>(
    a: &mut A,
    axis: &Axis<A>,
    size_exponent: A::Int,
    index: A::Int,
    travelled: A::Num,
    crosses_ties: A::Bit,
) -> A::Bit {
    let names = axis.names;
    let one = a.int_constant(1);
    let half_exponent = a.int_sub(size_exponent, one);
    a.name_int(names.half_exponent, half_exponent);
    let twice = a.int_add(index, index);
    let odd = a.int_or(twice, one);
    a.name_int(names.odd_index, odd);
    let midline = a.number_from_integer(TowardZero, odd, half_exponent);
    a.name_num(names.midline, midline);
    let distance = a.sub(Up, midline, axis.coordinate);
    a.name_num(names.midline_distance, distance);
    let past = a.less_than(distance, travelled);
    a.name_bit(names.past_midline, past);
    let reached = a.less_equal(distance, travelled);
    a.name_bit(names.reached_midline, reached);
    let started_there = a.is_zero(distance);
    a.name_bit(names.started_on_midline, started_there);
    let tie_crossed = a.and(reached, crosses_ties);
    a.name_bit(names.tie_crossed, tie_crossed);
    let past = a.or(past, started_there);
    a.or(past, tie_crossed)
}
