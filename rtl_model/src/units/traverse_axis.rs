//! What a step does on one axis: where the ray leaves its node.

use super::traverse_step::{EXACT_EXIT_ULPS, ROUNDED_EXIT_ULPS};
use crate::arith::Arith;
use crate::float::Rounding::TowardZero;

/// The names of an axis's signals.
pub(super) struct AxisNames {
    next_index: &'static str,
    near_bound: &'static str,
    far_bound: &'static str,
    border: &'static str,
    border_distance: &'static str,
    distance_is_exact: &'static str,
    exit_depth: &'static str,
    exit_bound: &'static str,
}

pub(super) static AXIS_U: AxisNames = AxisNames {
    next_index: "next_border_i",
    near_bound: "near_bound_u",
    far_bound: "far_bound_u",
    border: "border_u",
    border_distance: "border_distance_u",
    distance_is_exact: "distance_is_exact_u",
    exit_depth: "exit_depth_u",
    exit_bound: "exit_bound_u",
};
pub(super) static AXIS_V: AxisNames = AxisNames {
    next_index: "next_border_j",
    near_bound: "near_bound_v",
    far_bound: "far_bound_v",
    border: "border_v",
    border_distance: "border_distance_v",
    distance_is_exact: "distance_is_exact_v",
    exit_depth: "exit_depth_v",
    exit_bound: "exit_bound_v",
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
