//! Which node a step goes down to: the child the ray is in at t, or the child's child, and so on.
//!
//! # Why no surface is stepped past
//!
//! On each axis a child is the far one only where the ray is surely there ([`far_child`]); in
//! doubt it is the near one, which is left again by a crossing if it is not hit. Going down several
//! levels at once asks this of each level in turn, at the same t. The nodes between are not looked
//! at; they could have moved t on, nothing else, so the walk arrives below no later than it would
//! have. A child chosen for the earlier t is entered no later by the ray.
//!
//! Where the policy remembers borders, a near child that ends at the last one passed, or before
//! it, is never taken: the ray is past it, whatever its rounded position says.

use super::search_policy::SearchPolicy;
use super::traverse_axis::Axis;
use super::traverse_registers::WalkRegisters;
use super::traverse_shape::SHIFT_BITS;
use crate::arith::Arith;
use crate::float::Rounding::{TowardZero, Up};

/// The names of an axis's signals where a child is chosen, one level down or more.
struct ChildNames {
    half_exponent: &'static str,
    odd_index: &'static str,
    midline: &'static str,
    midline_distance: &'static str,
    past_midline: &'static str,
    reached_midline: &'static str,
    started_on_midline: &'static str,
    tie_crossed: &'static str,
    double_midline: &'static str,
    double_border: &'static str,
    midline_lies_ahead: &'static str,
    first_child: &'static str,
    child: &'static str,
}

macro_rules! child_names {
    ($axis:literal, $index:literal, $below:literal) => {
        ChildNames {
            half_exponent: concat!("half_exponent_", $axis, $below),
            odd_index: concat!("odd_", $index, $below),
            midline: concat!("midline_", $axis, $below),
            midline_distance: concat!("midline_distance_", $axis, $below),
            past_midline: concat!("past_midline_", $axis, $below),
            reached_midline: concat!("reached_midline_", $axis, $below),
            started_on_midline: concat!("started_on_midline_", $axis, $below),
            tie_crossed: concat!("tie_crossed_", $axis, $below),
            double_midline: concat!("double_midline_", $index, $below),
            double_border: concat!("double_passed_border_", $index, $below),
            midline_lies_ahead: concat!("midline_lies_ahead_", $index, $below),
            first_child: concat!("first_child_", $index, $below),
            child: concat!("child_", $index, $below),
        }
    };
}

/// By levels gone down before; the first of them is the step that every policy has.
static CHILDREN_U: [ChildNames; 4] = [
    child_names!("u", "i", ""),
    child_names!("u", "i", "_2_down"),
    child_names!("u", "i", "_3_down"),
    child_names!("u", "i", "_4_down"),
];
static CHILDREN_V: [ChildNames; 4] = [
    child_names!("v", "j", ""),
    child_names!("v", "j", "_2_down"),
    child_names!("v", "j", "_3_down"),
    child_names!("v", "j", "_4_down"),
];

/// Names of the exponent of a node's size, by levels gone down before it.
static SIZE_EXPONENTS: [&str; 4] = [
    "size_exponent",
    "size_exponent_2_down",
    "size_exponent_3_down",
    "size_exponent_4_down",
];

/// The ray at t: what decides between the children of a node.
pub(super) struct Reached<'a, A: Arith> {
    pub(super) axis_u: &'a Axis<A>,
    pub(super) axis_v: &'a Axis<A>,
    /// Distance travelled on u, truncated.
    pub(super) travelled_u: A::Num,
    /// Distance travelled on v, truncated.
    pub(super) travelled_v: A::Num,
    /// Is t the depth at which a border of v was crossed?
    pub(super) still_at_border_v: A::Bit,
}

/// The node that a step goes down to.
pub(super) struct NodeBelow<A: Arith> {
    pub(super) level: A::Int,
    pub(super) i: A::Int,
    pub(super) j: A::Int,
}

/// Whether the child of the walk's node is the far one, on u and on v; the corner in doubt is not
/// asked yet.
pub(super) fn far_children<A: Arith>(
    a: &mut A,
    reached: &Reached<'_, A>,
    walk: &WalkRegisters<A>,
    size_exponent: A::Int,
) -> (A::Bit, A::Bit) {
    let never = a.bit_constant(false);
    let passed_i = walk.passed.map(|passed| Passed::<A> {
        border: passed.i,
        level: walk.level,
    });
    let passed_j = walk.passed.map(|passed| Passed::<A> {
        border: passed.j,
        level: walk.level,
    });
    let far_u = far_child(
        a,
        &CHILDREN_U[0],
        &reached.node_u(size_exponent, walk.i),
        reached.still_at_border_v,
        passed_i,
    );
    let far_v = far_child(
        a,
        &CHILDREN_V[0],
        &reached.node_v(size_exponent, walk.j),
        never,
        passed_j,
    );
    (far_u, far_v)
}

/// Where a step that goes down gets to, from the child it is in at t.
pub(super) fn node_below<A: Arith>(
    a: &mut A,
    policy: SearchPolicy,
    reached: &Reached<'_, A>,
    walk: &WalkRegisters<A>,
    size_exponent: A::Int,
    child: NodeBelow<A>,
) -> NodeBelow<A> {
    if policy.levels_down == 1 {
        return child;
    }
    // Before the first crossing no corner is in doubt, and t is the depth of no border.
    let never = a.bit_constant(false);
    let one = a.int_constant(1);
    let mut exponent = size_exponent;
    let (mut far_i, mut far_j) = (child.i, child.j);
    for below in 1..policy.levels_down as usize {
        exponent = a.int_sub(exponent, one);
        a.name_int(SIZE_EXPONENTS[below], exponent);
        let mut grandchild = |names: &ChildNames, node: NodeOnAxis<'_, A>| {
            let far = far_child(a, names, &node, never, None);
            let child = child_index(a, names, node.index, far);
            a.name_int(names.child, child);
            child
        };
        far_i = grandchild(&CHILDREN_U[below], reached.node_u(exponent, far_i));
        far_j = grandchild(&CHILDREN_V[below], reached.node_v(exponent, far_j));
    }
    let zero = a.int_constant(0);
    let no_crossing_yet = a.int_equal(walk.crossings, zero);
    a.name_bit("no_crossing_yet", no_crossing_yet);
    let levels_down = a.int_constant(i64::from(policy.levels_down));
    let too_few_levels = a.int_less_than(walk.level, levels_down);
    a.name_bit("too_few_levels", too_few_levels);
    let enough_levels = a.not(too_few_levels);
    let all_down = a.and(no_crossing_yet, enough_levels);
    a.name_bit("goes_all_levels_down", all_down);
    let level_far_below = a.int_sub(walk.level, levels_down);
    a.name_int("level_far_below", level_far_below);
    NodeBelow {
        level: a.int_select(all_down, level_far_below, child.level),
        i: a.int_select(all_down, far_i, child.i),
        j: a.int_select(all_down, far_j, child.j),
    }
}

/// The child of the walk's node. At a corner in doubt it is the one at the corner.
pub(super) fn child<A: Arith>(
    a: &mut A,
    walk: &WalkRegisters<A>,
    far: (A::Bit, A::Bit),
    not_owed: A::Bit,
    not_paid: A::Bit,
) -> (A::Int, A::Int) {
    let (far_u, far_v) = far;
    let far_u = a.or(far_u, walk.corner_paid);
    a.name_bit("far_u_or_paid", far_u);
    let far_u = a.and(far_u, not_owed);
    a.name_bit("child_is_far_u", far_u);
    let far_v = a.or(far_v, walk.corner_owed);
    a.name_bit("far_v_or_owed", far_v);
    let far_v = a.and(far_v, not_paid);
    a.name_bit("child_is_far_v", far_v);
    let i = child_index(a, &CHILDREN_U[0], walk.i, far_u);
    a.name_int(CHILDREN_U[0].child, i);
    let j = child_index(a, &CHILDREN_V[0], walk.j, far_v);
    a.name_int(CHILDREN_V[0].child, j);
    (i, j)
}

/// A node on one axis, and the ray in it at t.
struct NodeOnAxis<'a, A: Arith> {
    axis: &'a Axis<A>,
    size_exponent: A::Int,
    index: A::Int,
    travelled: A::Num,
}

/// A border passed, in texels, and the level of the node it may lie in.
struct Passed<A: Arith> {
    border: A::Int,
    level: A::Int,
}

impl<'a, A: Arith> Reached<'a, A> {
    fn node_u(&self, size_exponent: A::Int, index: A::Int) -> NodeOnAxis<'a, A> {
        NodeOnAxis {
            axis: self.axis_u,
            size_exponent,
            index,
            travelled: self.travelled_u,
        }
    }

    fn node_v(&self, size_exponent: A::Int, index: A::Int) -> NodeOnAxis<'a, A> {
        NodeOnAxis {
            axis: self.axis_v,
            size_exponent,
            index,
            travelled: self.travelled_v,
        }
    }
}

/// Is the ray in the child on the far side of the midline? On the midline it is in the near one,
/// unless it started there, or `crosses_ties`. It is in the far one too if the midline is passed.
fn far_child<A: Arith>(
    a: &mut A,
    names: &ChildNames,
    node: &NodeOnAxis<'_, A>,
    crosses_ties: A::Bit,
    passed: Option<Passed<A>>,
) -> A::Bit {
    let one = a.int_constant(1);
    let half_exponent = a.int_sub(node.size_exponent, one);
    a.name_int(names.half_exponent, half_exponent);
    let twice = a.int_add(node.index, node.index);
    let odd = a.int_or(twice, one);
    a.name_int(names.odd_index, odd);
    let midline = a.number_from_integer(TowardZero, odd, half_exponent);
    a.name_num(names.midline, midline);
    let distance = a.sub(Up, midline, node.axis.coordinate);
    a.name_num(names.midline_distance, distance);
    let past = a.less_than(distance, node.travelled);
    a.name_bit(names.past_midline, past);
    let reached = a.less_equal(distance, node.travelled);
    a.name_bit(names.reached_midline, reached);
    let started_there = a.is_zero(distance);
    a.name_bit(names.started_on_midline, started_there);
    let tie_crossed = a.and(reached, crosses_ties);
    a.name_bit(names.tie_crossed, tie_crossed);
    let past = a.or(past, started_there);
    let far = a.or(past, tie_crossed);
    let Some(Passed { border, level }) = passed else {
        return far;
    };
    // The midline is half of odd << level texels, so the double of the border is compared.
    let double_midline = a.int_shift_left(odd, level, SHIFT_BITS);
    a.name_int(names.double_midline, double_midline);
    let double_border = a.int_add(border, border);
    a.name_int(names.double_border, double_border);
    let midline_lies_ahead = a.int_less_than(double_border, double_midline);
    a.name_bit(names.midline_lies_ahead, midline_lies_ahead);
    let midline_is_passed = a.not(midline_lies_ahead);
    a.or(far, midline_is_passed)
}

fn child_index<A: Arith>(a: &mut A, names: &ChildNames, index: A::Int, far: A::Bit) -> A::Int {
    let twice = a.int_add(index, index);
    a.name_int(names.first_child, twice);
    let far = a.int_from_bit(far);
    a.int_or(twice, far)
}
