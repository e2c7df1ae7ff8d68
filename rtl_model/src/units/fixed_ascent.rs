//! A crossing of the exact fixed-point walk, and whether it goes a level up.
//!
//! A policy decides by what the walk meets; whatever it decides, the node above holds the neighbour,
//! and the border crossed stays known as that node's near border or midline. So an ascent changes
//! the number of steps, never the answer.

use super::fixed_child::HalfSide;
use super::fixed_shape::FixedShape;
use super::search_policy::{Ascent, SearchPolicy};
use crate::arith::Arith;

/// A crossing into a neighbour, from the node (before the crossing) whose borders these are.
#[derive(Debug)]
pub(super) struct FixedCrossing<A: Arith> {
    /// Is it a border of u? Else of v.
    pub(super) u_first: A::Bit,
    /// Level of both nodes.
    pub(super) level: A::Int,
    /// Index of the neighbour on u.
    pub(super) i: A::Int,
    /// Index of the neighbour on v.
    pub(super) j: A::Int,
    /// The error term at the neighbour's near corner.
    pub(super) error: A::Int,
    /// Far border on u of the node left.
    pub(super) far_border_u: A::Int,
    /// Far border on v of the node left.
    pub(super) far_border_v: A::Int,
    /// Position on u at the depth of the node left.
    pub(super) position_u: A::Int,
    /// Position on v.
    pub(super) position_v: A::Int,
    /// Side of a node.
    pub(super) side: HalfSide<A>,
    /// The step before was a crossing at this level.
    pub(super) crossed_before: Option<A::Bit>,
}

/// The node that a crossing ends in.
#[derive(Debug)]
pub(super) struct FixedCrossed<A: Arith> {
    pub(super) level: A::Int,
    pub(super) i: A::Int,
    pub(super) j: A::Int,
    pub(super) error: A::Int,
    /// Is it a level up?
    pub(super) ascends: A::Bit,
    /// Is the border crossed its midline? None where the policy goes up across even borders only.
    pub(super) at_midline: Option<A::Bit>,
}

/// Where a crossing ends: in the neighbour, or in the node above it where the policy goes up.
pub(super) fn fixed_ascent<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    policy: SearchPolicy,
    crossing: &FixedCrossing<A>,
) -> FixedCrossed<A> {
    let stays = FixedCrossed {
        level: crossing.level,
        i: crossing.i,
        j: crossing.j,
        error: crossing.error,
        ascends: a.bit_constant(false),
        at_midline: None,
    };
    let odd_i = is_odd(a, crossing.i);
    let odd_j = is_odd(a, crossing.j);
    let one = a.int_constant(1);
    let wanted = match policy.ascent {
        Ascent::Never => return stays,
        Ascent::Always => a.bit_constant(true),
        Ascent::EvenBorder => even_border(a, crossing, odd_i, odd_j),
        Ascent::Selective => {
            let even = even_border(a, crossing, odd_i, odd_j);
            let near = ends_in_a_neighbour(a, shape, crossing);
            let far = a.not(near);
            a.and(even, far)
        }
        Ascent::Coherent => crossing
            .crossed_before
            .expect("the register is there where the policy asks for it"),
    };
    a.name_bit("ascent_wanted", wanted);
    let root_level = a.int_constant(i64::from(shape.root_level));
    let below_root = a.int_less_than(crossing.level, root_level);
    a.name_bit("is_below_root", below_root);
    let ascends = a.and(wanted, below_root);
    a.name_bit("ascends", ascends);

    let level_above = a.int_add(crossing.level, one);
    let level = a.int_select(ascends, level_above, crossing.level);
    a.name_int("crossed_level", level);
    let parent_i = a.int_shift_right(crossing.i, one, 1);
    let i = a.int_select(ascends, parent_i, crossing.i);
    a.name_int("crossed_i", i);
    let parent_j = a.int_shift_right(crossing.j, one, 1);
    let j = a.int_select(ascends, parent_j, crossing.j);
    a.name_int("crossed_j", j);
    // An odd neighbour is the far child of its parent, whose near corner is a side back.
    let none = a.int_constant(0);
    let back_u = a.and(ascends, odd_i);
    let back_u = a.int_select(back_u, crossing.side.span_v, none);
    let back_v = a.and(ascends, odd_j);
    let back_v = a.int_select(back_v, crossing.side.span_u, none);
    let error = a.int_sub(crossing.error, back_u);
    let error = a.int_add(error, back_v);
    // The ray passes through the node.
    let error = a.int_wrap(error, shape.error_bits());
    a.name_int("crossed_error", error);
    let at_midline = match policy.ascent {
        Ascent::Never | Ascent::EvenBorder | Ascent::Selective => None,
        Ascent::Always | Ascent::Coherent => {
            let odd = crossed_odd(a, crossing, odd_i, odd_j);
            let at_midline = a.and(ascends, odd);
            a.name_bit("crossed_midline", at_midline);
            Some(at_midline)
        }
    };
    FixedCrossed {
        level,
        i,
        j,
        error,
        ascends,
        at_midline,
    }
}

fn is_odd<A: Arith>(a: &mut A, index: A::Int) -> A::Bit {
    let low = a.int_low_bits(index, 1);
    let one = a.int_constant(1);
    a.int_equal(low, one)
}

/// Is the index of the border crossed, which is the neighbour's, odd?
fn crossed_odd<A: Arith>(
    a: &mut A,
    crossing: &FixedCrossing<A>,
    odd_i: A::Bit,
    odd_j: A::Bit,
) -> A::Bit {
    super::fixed_step::choose(a, crossing.u_first, odd_i, odd_j)
}

fn even_border<A: Arith>(
    a: &mut A,
    crossing: &FixedCrossing<A>,
    odd_i: A::Bit,
    odd_j: A::Bit,
) -> A::Bit {
    let odd = crossed_odd(a, crossing, odd_i, odd_j);
    let even = a.not(odd);
    a.name_bit("border_is_even", even);
    even
}

/// Is the position at the node's depth in a node next to it, by a border or a corner? It is not
/// in the node itself, which the ray leaves.
fn ends_in_a_neighbour<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    crossing: &FixedCrossing<A>,
) -> A::Bit {
    let mut before = |names: [&'static str; 2], far_border, position| {
        let second = a.int_add(far_border, crossing.side.distance);
        // Beyond the reach of a ray by two sides, and still within the index's bits.
        let second = a.int_wrap(second, shape.position_bits());
        a.name_int(names[0], second);
        let before = a.int_less_than(position, second);
        a.name_bit(names[1], before);
        before
    };
    let near_u = before(
        ["second_border_u", "before_second_u"],
        crossing.far_border_u,
        crossing.position_u,
    );
    let near_v = before(
        ["second_border_v", "before_second_v"],
        crossing.far_border_v,
        crossing.position_v,
    );
    let near = a.and(near_u, near_v);
    a.name_bit("ends_in_a_neighbour", near);
    near
}
