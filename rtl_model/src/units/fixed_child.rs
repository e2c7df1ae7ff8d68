//! Which child of a node a ray of the exact fixed-point walk is in.
//!
//! All comparisons are of integers, and what they mean where two are equal is the definition's: on
//! a midline a ray has not left the near child yet, unless it started there and so belongs to the
//! texel it travels into, or has just crossed v (through a corner u is crossed first, so the midline
//! of u is behind it).

use super::fixed_shape::FixedShape;
use crate::arith::Arith;

/// A node of the walk, as far as its children depend on it.
#[derive(Debug)]
pub(super) struct FixedNode<A: Arith> {
    /// Index on u.
    pub(super) i: A::Int,
    /// Index on v.
    pub(super) j: A::Int,
    /// Position of its near border on u.
    pub(super) near_u: A::Int,
    /// Position of its near border on v.
    pub(super) near_v: A::Int,
    /// The error term at its near corner.
    pub(super) error: A::Int,
}

impl<A: Arith> Clone for FixedNode<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for FixedNode<A> {}

/// Half of a node's side, as each thing that depends on it has it.
#[derive(Debug)]
pub(super) struct HalfSide<A: Arith> {
    /// As a distance of positions.
    pub(super) distance: A::Int,
    /// Times the slope on u: what a way so long on v is in the error term.
    pub(super) span_u: A::Int,
    /// Times the slope on v.
    pub(super) span_v: A::Int,
}

impl<A: Arith> Clone for HalfSide<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for HalfSide<A> {}

/// Where the ray is.
#[derive(Debug)]
pub(super) struct FixedPosition<A: Arith> {
    /// Position on u at the depth reached.
    pub(super) u: A::Int,
    /// Position on v.
    pub(super) v: A::Int,
    /// On a midline of u the far child is the one: the ray started there.
    pub(super) tie_is_far_u: A::Bit,
    /// The same on v.
    pub(super) tie_is_far_v: A::Bit,
}

impl<A: Arith> Clone for FixedPosition<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for FixedPosition<A> {}

/// The names of a descent's signals.
pub(super) struct DescentNames {
    midline_u: &'static str,
    midline_v: &'static str,
    past_u: &'static str,
    past_v: &'static str,
    on_u: &'static str,
    on_v: &'static str,
    far_u: &'static str,
    far_v: &'static str,
    half: &'static str,
    half_span_u: &'static str,
    half_span_v: &'static str,
    child_i: &'static str,
    child_j: &'static str,
    child_near_u: &'static str,
    child_near_v: &'static str,
    child_error: &'static str,
}

macro_rules! descent_names {
    ($suffix:literal) => {
        DescentNames {
            midline_u: concat!("midline_u", $suffix),
            midline_v: concat!("midline_v", $suffix),
            past_u: concat!("past_midline_u", $suffix),
            past_v: concat!("past_midline_v", $suffix),
            on_u: concat!("on_midline_u", $suffix),
            on_v: concat!("on_midline_v", $suffix),
            far_u: concat!("position_is_far_u", $suffix),
            far_v: concat!("position_is_far_v", $suffix),
            half: concat!("half_side", $suffix),
            half_span_u: concat!("half_span_u", $suffix),
            half_span_v: concat!("half_span_v", $suffix),
            child_i: concat!("child_i", $suffix),
            child_j: concat!("child_j", $suffix),
            child_near_u: concat!("child_near_u", $suffix),
            child_near_v: concat!("child_near_v", $suffix),
            child_error: concat!("child_error", $suffix),
        }
    };
}

/// The names of the levels that a walk goes down at once.
pub(super) static DESCENTS: [DescentNames; 4] = [
    descent_names!(""),
    descent_names!("_below"),
    descent_names!("_below_2"),
    descent_names!("_below_3"),
];

/// The half of a side.
pub(super) fn half_of<A: Arith>(a: &mut A, names: &DescentNames, side: HalfSide<A>) -> HalfSide<A> {
    let one = a.int_constant(1);
    let distance = a.int_shift_right(side.distance, one, 1);
    a.name_int(names.half, distance);
    let span_u = a.int_shift_right(side.span_u, one, 1);
    a.name_int(names.half_span_u, span_u);
    let span_v = a.int_shift_right(side.span_v, one, 1);
    a.name_int(names.half_span_v, span_v);
    HalfSide {
        distance,
        span_u,
        span_v,
    }
}

/// On which side of the midlines of a node a position is: far on u, far on v?
pub(super) fn far_by_position<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    names: &DescentNames,
    node: &FixedNode<A>,
    half: &HalfSide<A>,
    position: &FixedPosition<A>,
) -> (A::Bit, A::Bit) {
    let midline_u = a.int_add(node.near_u, half.distance);
    let midline_u = a.int_wrap(midline_u, shape.position_bits());
    a.name_int(names.midline_u, midline_u);
    let midline_v = a.int_add(node.near_v, half.distance);
    let midline_v = a.int_wrap(midline_v, shape.position_bits());
    a.name_int(names.midline_v, midline_v);
    let far_u = beyond(
        a,
        [names.past_u, names.on_u, names.far_u],
        midline_u,
        position.u,
        position.tie_is_far_u,
    );
    let far_v = beyond(
        a,
        [names.past_v, names.on_v, names.far_v],
        midline_v,
        position.v,
        position.tie_is_far_v,
    );
    (far_u, far_v)
}

/// Is a position beyond a midline, or on it where that counts?
fn beyond<A: Arith>(
    a: &mut A,
    [past_name, on_name, far_name]: [&'static str; 3],
    midline: A::Int,
    position: A::Int,
    tie_is_far: A::Bit,
) -> A::Bit {
    let past = a.int_less_than(midline, position);
    a.name_bit(past_name, past);
    let on = a.int_equal(midline, position);
    a.name_bit(on_name, on);
    let tie = a.and(on, tie_is_far);
    let far = a.or(past, tie);
    a.name_bit(far_name, far);
    far
}

/// A child of a node.
pub(super) fn child<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    names: &DescentNames,
    node: &FixedNode<A>,
    half: &HalfSide<A>,
    (far_u, far_v): (A::Bit, A::Bit),
) -> FixedNode<A> {
    let none = a.int_constant(0);
    let i = child_index(a, node.i, far_u);
    a.name_int(names.child_i, i);
    let j = child_index(a, node.j, far_v);
    a.name_int(names.child_j, j);
    let to_u = a.int_select(far_u, half.distance, none);
    let near_u = a.int_add(node.near_u, to_u);
    let near_u = a.int_wrap(near_u, shape.position_bits());
    a.name_int(names.child_near_u, near_u);
    let to_v = a.int_select(far_v, half.distance, none);
    let near_v = a.int_add(node.near_v, to_v);
    let near_v = a.int_wrap(near_v, shape.position_bits());
    a.name_int(names.child_near_v, near_v);
    let across_u = a.int_select(far_u, half.span_v, none);
    let error = a.int_add(node.error, across_u);
    let across_v = a.int_select(far_v, half.span_u, none);
    let error = a.int_sub(error, across_v);
    // The ray passes through the child.
    let error = a.int_wrap(error, shape.error_bits());
    a.name_int(names.child_error, error);
    FixedNode {
        i,
        j,
        near_u,
        near_v,
        error,
    }
}

fn child_index<A: Arith>(a: &mut A, index: A::Int, far: A::Bit) -> A::Int {
    let twice = a.int_add(index, index);
    let far = a.int_from_bit(far);
    a.int_or(twice, far)
}
