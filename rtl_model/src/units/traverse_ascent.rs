//! When a crossing also goes a level up, and which borders are remembered for it.
//!
//! # Why no surface is stepped past
//!
//! A crossing enters a neighbour; one that goes up takes the neighbour's parent instead, at the same
//! t. The parent holds the neighbour, so whatever the ray meets next lies in it, and t is no later
//! than the ray's entry into the neighbour: the state is as sound as after any crossing. No step
//! goes up while a corner is in doubt, since the visit it owes is told by the node's own index.
//!
//! # Why every walk ends
//!
//! The parent may also hold what the ray has left already, and the walk may go down into that.
//!
//! - With [`Ascent::Always`] and [`Ascent::Coherent`] it may even be the node that was just left:
//!   t is not beyond the border crossed, only at it, and rounded. So these policies remember the
//!   last border passed on either axis, as an integer number of texels, and never take a child that
//!   ends there or before (`units::traverse_descent`). Every crossing then passes a border that was
//!   not passed before, and a crossing goes up one level at most.
//! - With [`Ascent::EvenBorder`], and so with [`Ascent::Selective`], the border crossed is one of
//!   the parent's too: on its axis nothing lies behind. On the other axis the rounded position may
//!   choose a child that ends just before the ray, and its far border, B, is then crossed once
//!   again. A border that is odd at level b is inside of nodes above b, and crossing it leads up to
//!   b at most. The crossing that began this led up to a level above b, and to no more than that at
//!   which its own border is odd: so neither B nor a lower one leads back across it. Each ascent
//!   costs at most one crossing more. A node visited so lies beside the ray, a rounding away: to
//!   hit it is to be early, never late.

use super::search_policy::{Ascent, SearchPolicy};
use super::traverse_axis::Axis;
use super::traverse_registers::{PassedBorders, WalkRegisters};
use super::traverse_shape::{INDEX_BITS, SHIFT_BITS, TraverseShape};
use crate::arith::Arith;
use crate::float::Rounding::NearestEven;

/// A crossing from the walk's node into a neighbour, as far as an ascent asks.
pub(super) struct NodeCrossing<A: Arith> {
    /// It takes place.
    pub(super) crosses: A::Bit,
    /// The border is one of u, and crossed forward; else it is one of v.
    pub(super) across_u: A::Bit,
    /// Which border comes first is not certain.
    pub(super) corner_in_doubt: A::Bit,
    /// The neighbour's index on u.
    pub(super) i: A::Int,
    /// The neighbour's index on v.
    pub(super) j: A::Int,
}

/// What a crossing passes, seen when all of it is known.
pub(super) struct CrossedBorders<A: Arith> {
    /// Any border is crossed.
    pub(super) crosses: A::Bit,
    /// A border of u is crossed, forward.
    pub(super) crosses_u: A::Bit,
    /// A border of v is crossed.
    pub(super) crosses_v: A::Bit,
    /// No corner was in doubt before.
    pub(super) straight: A::Bit,
    /// A corner is in doubt now.
    pub(super) doubt_begins: A::Bit,
    /// The neighbour's index on u.
    pub(super) i: A::Int,
    /// The neighbour's index on v.
    pub(super) j: A::Int,
}

/// What the prediction of [`Ascent::Selective`] asks for.
pub(super) struct Prediction<'a, A: Arith> {
    pub(super) axis_u: &'a Axis<A>,
    pub(super) axis_v: &'a Axis<A>,
    /// log2 of the node's size.
    pub(super) size_exponent: A::Int,
    /// The node's depth.
    pub(super) depth: A::Num,
}

/// The node that a crossing leads to.
pub(super) struct NodeBehind<A: Arith> {
    /// It is the neighbour's parent; none where the policy never goes up.
    pub(super) goes_up: Option<A::Bit>,
    pub(super) level: A::Int,
    pub(super) i: A::Int,
    pub(super) j: A::Int,
}

/// The neighbour or its parent, as the policy says.
pub(super) fn node_behind<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    policy: SearchPolicy,
    walk: &WalkRegisters<A>,
    crossing: &NodeCrossing<A>,
    prediction: &Prediction<'_, A>,
) -> NodeBehind<A> {
    let rule = match policy.ascent {
        Ascent::Never => {
            return NodeBehind {
                goes_up: None,
                level: walk.level,
                i: crossing.i,
                j: crossing.j,
            };
        }
        Ascent::Always => None,
        Ascent::EvenBorder => Some(border_is_even(a, crossing)),
        Ascent::Selective => {
            let even = border_is_even(a, crossing);
            let further = leaves_neighbour(a, walk, prediction);
            Some(a.and(even, further))
        }
        Ascent::Coherent => walk.crossed_before,
    };
    let root_level = a.int_constant(i64::from(shape.root_level));
    let below_root = a.int_less_than(walk.level, root_level);
    a.name_bit("is_below_root", below_root);
    let at_corner = a.or(walk.corner_owed, walk.corner_paid);
    let at_corner = a.or(at_corner, crossing.corner_in_doubt);
    a.name_bit("at_corner", at_corner);
    let no_corner = a.not(at_corner);
    let may_go_up = a.and(below_root, no_corner);
    let may_go_up = match rule {
        Some(rule) => a.and(may_go_up, rule),
        None => may_go_up,
    };
    a.name_bit("may_go_up", may_go_up);
    let goes_up = a.and(crossing.crosses, may_go_up);
    a.name_bit("goes_up", goes_up);
    let one = a.int_constant(1);
    let level_above = a.int_add(walk.level, one);
    a.name_int("level_above", level_above);
    let level = a.int_select(goes_up, level_above, walk.level);
    a.name_int("level_unless_down", level);
    let parent_i = a.int_shift_right(crossing.i, one, 1);
    a.name_int("parent_i", parent_i);
    let parent_j = a.int_shift_right(crossing.j, one, 1);
    a.name_int("parent_j", parent_j);
    NodeBehind {
        goes_up: Some(goes_up),
        level,
        i: a.int_select(goes_up, parent_i, crossing.i),
        j: a.int_select(goes_up, parent_j, crossing.j),
    }
}

/// Is the border crossed, counted in nodes of this level, even? It is then one of the level above.
/// Forward, a border's number is that of the node behind it.
fn border_is_even<A: Arith>(a: &mut A, crossing: &NodeCrossing<A>) -> A::Bit {
    let entered = a.int_select(crossing.across_u, crossing.i, crossing.j);
    a.name_int("border_crossed", entered);
    let odd = a.int_low_bits(entered, 1);
    let zero = a.int_constant(0);
    let even = a.int_equal(odd, zero);
    a.name_bit("border_is_even", even);
    even
}

struct PredictionNames {
    next_border_but_one: &'static str,
    border: &'static str,
    distance: &'static str,
    predicted: &'static str,
    leaves: &'static str,
}

const PREDICTION_U: PredictionNames = PredictionNames {
    next_border_but_one: "next_border_but_one_i",
    border: "border_but_one_u",
    distance: "border_but_one_distance_u",
    predicted: "predicted_travelled_u",
    leaves: "leaves_neighbour_u",
};
const PREDICTION_V: PredictionNames = PredictionNames {
    next_border_but_one: "next_border_but_one_j",
    border: "border_but_one_v",
    distance: "border_but_one_distance_v",
    predicted: "predicted_travelled_v",
    leaves: "leaves_neighbour_v",
};

/// Does the ray, at the depth of the node, lie further than in a neighbour? A node that is crossed
/// is left at that depth, so the larger of the index differences is 1 or more; here it is 2 or more
/// on some axis. It saves or costs steps, nothing else: any rounding will do.
fn leaves_neighbour<A: Arith>(
    a: &mut A,
    walk: &WalkRegisters<A>,
    prediction: &Prediction<'_, A>,
) -> A::Bit {
    let u = leaves_neighbour_on(a, &PREDICTION_U, prediction, prediction.axis_u, walk.i);
    let v = leaves_neighbour_on(a, &PREDICTION_V, prediction, prediction.axis_v, walk.j);
    let leaves = a.or(u, v);
    a.name_bit("leaves_neighbour", leaves);
    leaves
}

fn leaves_neighbour_on<A: Arith>(
    a: &mut A,
    names: &PredictionNames,
    prediction: &Prediction<'_, A>,
    axis: &Axis<A>,
    index: A::Int,
) -> A::Bit {
    let two = a.int_constant(2);
    let next = a.int_add(index, two);
    a.name_int(names.next_border_but_one, next);
    let border = a.number_from_integer(NearestEven, next, prediction.size_exponent);
    a.name_num(names.border, border);
    let distance = a.sub(NearestEven, border, axis.coordinate);
    a.name_num(names.distance, distance);
    let predicted = a.mul(NearestEven, prediction.depth, axis.direction);
    a.name_num(names.predicted, predicted);
    let leaves = a.less_equal(distance, predicted);
    a.name_bit(names.leaves, leaves);
    leaves
}

/// The borders passed after the step. At a corner in doubt none is passed before the walk is behind
/// the corner; then both are.
pub(super) fn passed_after<A: Arith>(
    a: &mut A,
    walk: &WalkRegisters<A>,
    crossed: &CrossedBorders<A>,
) -> Option<PassedBorders<A>> {
    let passed = walk.passed?;
    let no_doubt = a.not(crossed.doubt_begins);
    let passes_u = a.and(crossed.crosses_u, no_doubt);
    a.name_bit("passes_u", passes_u);
    let straight_v = a.and(crossed.crosses_v, crossed.straight);
    a.name_bit("crosses_v_straight", straight_v);
    let behind_corner = a.and(crossed.crosses, walk.corner_paid);
    a.name_bit("gets_behind_corner", behind_corner);
    let passes_v = a.or(straight_v, behind_corner);
    a.name_bit("passes_v", passes_v);
    let mut after = |names: [&'static str; 2], passes, index, before| {
        let border = a.int_shift_left(index, walk.level, SHIFT_BITS);
        // In texels, a ray within reach stays within the index's bits too.
        let border = a.int_wrap(border, INDEX_BITS);
        a.name_int(names[0], border);
        let after = a.int_select(passes, border, before);
        a.name_int(names[1], after);
        after
    };
    Some(PassedBorders {
        i: after(
            ["near_border_i", "next_passed_border_i"],
            passes_u,
            crossed.i,
            passed.i,
        ),
        j: after(
            ["near_border_j", "next_passed_border_j"],
            passes_v,
            crossed.j,
            passed.j,
        ),
    })
}

/// Whether the step crossed into the node it leaves the walk at; a walk that has ended keeps what
/// it had.
pub(super) fn crossed_after<A: Arith>(
    a: &mut A,
    walk: &WalkRegisters<A>,
    ended: A::Bit,
    crosses: A::Bit,
    goes_up: Option<A::Bit>,
) -> Option<A::Bit> {
    let crossed_before = walk.crossed_before?;
    let goes_up = goes_up?;
    let stays_at_level = a.not(goes_up);
    let crossed = a.and(crosses, stays_at_level);
    a.name_bit("crossed_at_level", crossed);
    let kept = a.and(ended, crossed_before);
    let crossed = a.or(crossed, kept);
    a.name_bit("next_crossed_before", crossed);
    Some(crossed)
}
