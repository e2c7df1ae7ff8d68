//! One step of a walk down, across and up the pyramid of maximum heights: all methods that look at
//! a node a step (`oh`: Oh, Ki, Lee 2006; the others as [`SearchPolicy`] tells them apart; all as
//! defined by measurement in the project's notes on the papers).
//!
//! A step looks at one node. With d its depth and t the depth reached so far:
//! if d is not beyond t, go down; else, if the ray is still inside the node at d, advance to d and
//! go down; else cross into the neighbour behind the border that the ray leaves through. At level
//! 0, going down is the hit. A policy may go down several levels at once
//! (`units::traverse_descent`), go up a level where it crosses (`units::traverse_ascent`), and start
//! elsewhere than at the root (`units::traverse_start`). What it has no use for is not computed:
//! the operations depend on the policy, never on a ray.
//!
//! # Why no surface is stepped past
//!
//! Every operator rounds, so each quantity is kept as a bound on the safe side:
//!
//! - t is never later than the ray's true depth at this point of its walk, and a node's depth d is
//!   rounded toward the ray;
//! - the depth at which a node is left is known from below (`exit_depth`: a difference and a
//!   quotient, both truncated) and from above (`exit_bound`: [`EXACT_EXIT_ULPS`] further, or
//!   [`ROUNDED_EXIT_ULPS`] where the difference may have been rounded). "Still inside at d" is
//!   asked of the upper bound, and t advances to the lower one;
//! - a child is the far one of its axis only if the truncated distance travelled has reached an
//!   upward-rounded midline: else the near child is visited first and left again;
//! - a ray that is on the midline at t has not left the near child before t, so the near child is
//!   the one, with two exceptions of the definition: at the start a ray belongs to the texel it
//!   travels into, and through a corner u is crossed first, so that after a crossing of v a ray on
//!   the midline of u has crossed that too;
//! - which border comes first is not always certain. Where the two exits lie within each other's
//!   bounds, the ray passes so close to a corner that either of two nodes may hold a sliver of it.
//!   Then the step crosses u first, owing a visit to the node on the other side of the corner; the
//!   next crossing pays that visit, and the one after it goes on behind the corner.
//!
//! The bounds hold for a float `eXfY` and a map of `2^L` texels a side if no node border or
//! distance to one is flushed or rounded unawares: exponent bias at least `L + Y + 2`, and at most
//! `2^(Y-2)` texels from top to bottom ([`crate::ray::reach_in`]). The unit's own format e7f16 satisfies both for every map
//! and every ray within reach.
//!
//! In a reading that does not round, both bounds are one and the last case never arises.

use super::search_policy::SearchPolicy;
use super::traverse_ascent::{
    CrossedBorders, NodeCrossing, Prediction, crossed_after, node_behind, passed_after,
};
use super::traverse_axis::{AXIS_U, AXIS_V, Axis, exit};
use super::traverse_descent::{NodeBelow, Reached, child, far_children, node_below};
use super::traverse_setup::RayRegisters;
use super::traverse_shape::SHIFT_BITS;
use crate::arith::Arith;
use crate::float::Rounding::{NearestEven, TowardZero};

pub use super::traverse_registers::{PassedBorders, WalkRegisters, walk_start};
pub use super::traverse_shape::{
    COUNTER_BITS, INDEX_BITS, LEVEL_BITS, TraverseShape, counter_bits,
};

/// How far the true exit depth can lie above the computed one, in units in the last place, where
/// the distance to the border is exact: truncating the quotient loses less than one.
pub const EXACT_EXIT_ULPS: u32 = 1;

/// The same where the distance was truncated too: it loses less than one unit of its own, which
/// the quotient sees as less than two (its significand may be the smaller one).
pub const ROUNDED_EXIT_ULPS: u32 = 3;

/// What a step leaves: the registers for the next one, and the position they stand for.
#[derive(Debug)]
pub struct StepResult<A: Arith> {
    /// The walk after the step; unchanged if it had ended before.
    pub walk: WalkRegisters<A>,
    /// Position on u at depth t, not mirrored, not wrapped: for the answer, never for a decision.
    pub position_u: A::Num,
    /// Position on v.
    pub position_v: A::Num,
    /// The same on u before the ray's mirroring is undone.
    pub mirrored_position_u: A::Num,
    /// The same on v.
    pub mirrored_position_v: A::Num,
    /// Texel on u at level 0 of the map, wrapped; meaningful once the walk has ended.
    pub texel_i: A::Int,
    /// Texel on v.
    pub texel_j: A::Int,
}

/// Where the height of the walk's node lies in the pyramid's memory (the layout is
/// [`crate::maps::Pyramid`]'s): a one, then the node's index on v, then on u.
pub fn node_address<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    policy: SearchPolicy,
    ray: &RayRegisters<A>,
    walk: &WalkRegisters<A>,
) -> A::Int {
    if policy.is_flat() {
        return texel_address(a, shape, ray, walk);
    }
    let root_level = a.int_constant(i64::from(shape.root_level));
    let below_root = a.int_sub(root_level, walk.level);
    let below_root = a.int_low_bits(below_root, 4);
    a.name_int("below_root", below_root);
    let one = a.int_constant(1);
    let nodes_on_a_side = a.int_shift_left(one, below_root, 4);
    let nodes_on_a_side = a.int_wrap(nodes_on_a_side, INDEX_BITS);
    a.name_int("nodes_on_a_side", nodes_on_a_side);
    let index_mask = a.int_sub(nodes_on_a_side, one);
    a.name_int("index_mask", index_mask);
    let i = a.int_complement_if(ray.mirror_u, walk.i);
    let i = a.int_and(i, index_mask);
    a.name_int("wrapped_i", i);
    let j = a.int_complement_if(ray.mirror_v, walk.j);
    let j = a.int_and(j, index_mask);
    a.name_int("wrapped_j", j);
    let j = a.int_or(j, nodes_on_a_side);
    let row = a.int_shift_left(j, below_root, 4);
    let address = a.int_or(row, i);
    // Marker, v and u take 2 * below_root + 1 bits, so nothing but zeros is cut.
    let address = a.int_low_bits(address, shape.address_bits());
    a.name_int("node_address", address);
    address
}

/// The same where the walk looks at texels only.
fn texel_address<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    ray: &RayRegisters<A>,
    walk: &WalkRegisters<A>,
) -> A::Int {
    let i = texel(a, shape, ray.mirror_u, walk.i);
    a.name_int("wrapped_i", i);
    let j = texel(a, shape, ray.mirror_v, walk.j);
    a.name_int("wrapped_j", j);
    let size = a.int_constant(i64::from(shape.size()));
    let j = a.int_or(j, size);
    let index_bits = a.int_constant(i64::from(shape.root_level));
    let row = a.int_shift_left(j, index_bits, SHIFT_BITS);
    let address = a.int_or(row, i);
    let address = a.int_low_bits(address, shape.address_bits());
    a.name_int("node_address", address);
    address
}

/// One step of a walk, at a node of this height.
pub fn traverse_step<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    policy: SearchPolicy,
    ray: &RayRegisters<A>,
    walk: &WalkRegisters<A>,
    height: A::Int,
) -> StepResult<A> {
    let ended = a.or(walk.hit, walk.guard);
    a.name_bit("ended", ended);
    let depth = a.depth_from_height(height, shape.height_bits);
    a.name_num("node_depth", depth);

    // Where the ray leaves the node, and by which border.
    let root_level = a.int_constant(i64::from(shape.root_level));
    let size_exponent = a.int_sub(walk.level, root_level);
    a.name_int("size_exponent", size_exponent);
    let axis_u = Axis::<A> {
        names: &AXIS_U,
        coordinate: ray.u,
        direction: ray.du,
        exact_below: ray.exact_below_u,
    };
    let axis_v = Axis::<A> {
        names: &AXIS_V,
        coordinate: ray.v,
        direction: ray.dv,
        exact_below: ray.exact_below_v,
    };
    let exit_u = exit(a, &axis_u, size_exponent, walk.i);
    let exit_v = exit(a, &axis_v, size_exponent, walk.j);
    let u_first = a.less_equal(exit_u.depth, exit_v.depth);
    a.name_bit("u_first", u_first);
    let u_may_be_first = a.less_than(exit_u.depth, exit_v.bound);
    a.name_bit("u_may_be_first", u_may_be_first);
    let v_may_be_first = a.less_than(exit_v.depth, exit_u.bound);
    a.name_bit("v_may_be_first", v_may_be_first);
    let corner_in_doubt = a.and(u_may_be_first, v_may_be_first);
    a.name_bit("corner_in_doubt", corner_in_doubt);
    let exit_depth = a.select(u_first, exit_u.depth, exit_v.depth);
    a.name_num("exit_depth", exit_depth);
    let exit_bound = a.select(u_first, exit_u.bound, exit_v.bound);
    a.name_num("exit_bound", exit_bound);

    // Down, or across?
    let not_beyond = a.less_equal(depth, walk.t);
    a.name_bit("not_beyond", not_beyond);
    let inside = a.less_equal(depth, exit_bound);
    a.name_bit("inside", inside);
    let down = a.or(not_beyond, inside);
    a.name_bit("down", down);

    // The depth reached: one expression serves all three cases. A node not beyond t leaves t as
    // it is, since d <= t; a node that is crossed has d beyond both exits.
    let exit_is_nearer = a.less_than(exit_depth, depth);
    a.name_bit("exit_is_nearer", exit_is_nearer);
    let reached = a.select(exit_is_nearer, exit_depth, depth);
    a.name_num("reached", reached);
    let gets_further = a.less_than(walk.t, reached);
    a.name_bit("gets_further", gets_further);
    let advanced = a.select(gets_further, reached, walk.t);
    a.name_num("advanced_t", advanced);
    let t = a.select(ended, walk.t, advanced);
    a.name_num("next_t", t);

    // Which child the ray is in at t. At a corner in doubt it is the one at the corner.
    let travelled_u = a.mul(TowardZero, t, ray.du);
    a.name_num("travelled_u", travelled_u);
    let travelled_v = a.mul(TowardZero, t, ray.dv);
    a.name_num("travelled_v", travelled_v);
    let descent = (!policy.is_flat()).then(|| {
        // A t that gets further in this step is no longer that of the crossing.
        let t_is_old = a.not(gets_further);
        a.name_bit("t_is_old", t_is_old);
        let still_at_border_v = a.and(walk.at_border_v, t_is_old);
        a.name_bit("still_at_border_v", still_at_border_v);
        let reached = Reached {
            axis_u: &axis_u,
            axis_v: &axis_v,
            travelled_u,
            travelled_v,
            still_at_border_v,
        };
        let far = far_children(a, &reached, walk, size_exponent);
        (reached, far)
    });
    let owed = walk.corner_owed;
    let paid = walk.corner_paid;
    let not_owed = a.not(owed);
    a.name_bit("not_owed", not_owed);
    let not_paid = a.not(paid);
    a.name_bit("not_paid", not_paid);
    let descent = descent.map(|(reached, far)| {
        let child = child(a, walk, far, not_owed, not_paid);
        (reached, child)
    });

    // Which neighbour a crossing goes to: (+1, 0) or (0, +1) as the exits say, (+1, 0) at a corner
    // in doubt, then (-1, +1) to the node owed a visit, then (+1, 0) behind the corner.
    let u_is_crossed = a.or(u_first, corner_in_doubt);
    a.name_bit("u_first_or_in_doubt", u_is_crossed);
    let u_is_crossed = a.or(u_is_crossed, paid);
    a.name_bit("u_is_crossed", u_is_crossed);
    let i_forward = a.and(u_is_crossed, not_owed);
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    let minus_one = a.int_constant(-1);
    a.name_bit("i_forward", i_forward);
    let i_or_none = a.int_select(i_forward, one, zero);
    let i_change = a.int_select(owed, minus_one, i_or_none);
    a.name_int("i_change", i_change);
    let j_change = a.int_select(i_forward, zero, one);
    a.name_int("j_change", j_change);
    let neighbour_i = a.int_add(walk.i, i_change);
    a.name_int("neighbour_i", neighbour_i);
    let neighbour_j = a.int_add(walk.j, j_change);
    a.name_int("neighbour_j", neighbour_j);

    // The walk after the step.
    let at_level_0 = (!policy.is_flat()).then(|| {
        let at_level_0 = a.int_equal(walk.level, zero);
        a.name_bit("at_level_0", at_level_0);
        at_level_0
    });
    let running = a.not(ended);
    a.name_bit("running", running);
    let goes_down = a.and(down, running);
    a.name_bit("goes_down", goes_down);
    let not_down = a.not(down);
    a.name_bit("not_down", not_down);
    let crosses = a.and(not_down, running);
    a.name_bit("crosses", crosses);
    let hits = match at_level_0 {
        Some(at_level_0) => a.and(goes_down, at_level_0),
        None => goes_down,
    };
    a.name_bit("hits", hits);
    let hit = a.or(walk.hit, hits);
    a.name_bit("next_hit", hit);
    let descends = at_level_0.map(|at_level_0| {
        let above_level_0 = a.not(at_level_0);
        a.name_bit("above_level_0", above_level_0);
        let descends = a.and(goes_down, above_level_0);
        a.name_bit("descends", descends);
        descends
    });
    let crossing = NodeCrossing {
        crosses,
        across_u: i_forward,
        corner_in_doubt,
        i: neighbour_i,
        j: neighbour_j,
    };
    let prediction = Prediction {
        axis_u: &axis_u,
        axis_v: &axis_v,
        size_exponent,
        depth,
    };
    let behind = node_behind(a, shape, policy, walk, &crossing, &prediction);
    let below = descent.as_ref().map(|(reached, child)| {
        let level_below = a.int_sub(walk.level, one);
        a.name_int("level_below", level_below);
        let child = NodeBelow {
            level: level_below,
            i: child.0,
            j: child.1,
        };
        node_below(a, policy, reached, walk, size_exponent, child)
    });
    let goes_below = descends.zip(below);

    let mut level = behind.level;
    if let Some((descends, below)) = &goes_below {
        level = a.int_select(*descends, below.level, level);
        // It stays between 0 and root_level.
        level = a.int_wrap(level, LEVEL_BITS);
        a.name_int("next_level", level);
    }
    let mut i = a.int_select(crosses, behind.i, walk.i);
    a.name_int("i_unless_down", i);
    if let Some((descends, below)) = &goes_below {
        i = a.int_select(*descends, below.i, i);
    }
    // A ray within reach stays within the index's bits.
    let i = a.int_wrap(i, INDEX_BITS);
    a.name_int("next_i", i);
    let mut j = a.int_select(crosses, behind.j, walk.j);
    a.name_int("j_unless_down", j);
    if let Some((descends, below)) = &goes_below {
        j = a.int_select(*descends, below.j, j);
    }
    let j = a.int_wrap(j, INDEX_BITS);
    a.name_int("next_j", j);

    let crosses_u = a.and(crosses, i_forward);
    a.name_bit("crosses_u", crosses_u);
    let not_across_u = a.not(i_forward);
    let crosses_v = a.and(crosses, not_across_u);
    a.name_bit("crosses_v", crosses_v);
    let at_border_v = match &descent {
        Some((reached, _)) => {
            let not_across_u_now = a.not(crosses_u);
            a.name_bit("not_across_u_now", not_across_u_now);
            let stays_at_border_v = a.and(reached.still_at_border_v, not_across_u_now);
            a.name_bit("stays_at_border_v", stays_at_border_v);
            let at_border_v = a.or(crosses_v, stays_at_border_v);
            a.name_bit("next_at_border_v", at_border_v);
            at_border_v
        }
        None => walk.at_border_v,
    };
    let straight = a.and(not_owed, not_paid);
    a.name_bit("straight", straight);
    let doubt_begins = a.and(straight, corner_in_doubt);
    a.name_bit("doubt_begins", doubt_begins);
    let owed_if_crossing = a.and(crosses, doubt_begins);
    a.name_bit("owed_if_crossing", owed_if_crossing);
    let paid_if_crossing = a.and(crosses, owed);
    a.name_bit("paid_if_crossing", paid_if_crossing);
    let stays = a.not(crosses);
    let owed_if_staying = a.and(stays, owed);
    a.name_bit("owed_if_staying", owed_if_staying);
    let paid_if_staying = a.and(stays, paid);
    a.name_bit("paid_if_staying", paid_if_staying);
    let corner_owed = a.or(owed_if_crossing, owed_if_staying);
    a.name_bit("next_corner_owed", corner_owed);
    let corner_paid = a.or(paid_if_crossing, paid_if_staying);
    a.name_bit("next_corner_paid", corner_paid);

    let crossed = CrossedBorders {
        crosses,
        crosses_u,
        crosses_v,
        straight,
        doubt_begins,
        i: neighbour_i,
        j: neighbour_j,
    };
    let passed = passed_after(a, walk, &crossed);
    let crossed_before = crossed_after(a, walk, ended, crosses, behind.goes_up);

    let step = a.int_from_bit(running);
    let steps = a.int_add(walk.steps, step);
    // The guard ends a walk before its counters could overflow.
    let steps = a.int_wrap(steps, counter_bits(policy));
    a.name_int("next_steps", steps);
    let crossing = a.int_from_bit(crosses);
    a.name_int("crossing", crossing);
    let crossings = a.int_add(walk.crossings, crossing);
    let crossings = a.int_wrap(crossings, counter_bits(policy));
    a.name_int("next_crossings", crossings);
    let step_bound = a.int_constant(i64::from(shape.step_bound(policy)));
    let at_bound = a.int_equal(steps, step_bound);
    a.name_bit("at_bound", at_bound);
    let no_hit = a.not(hit);
    a.name_bit("no_hit", no_hit);
    let bound_reached = a.and(at_bound, no_hit);
    let guard = a.or(walk.guard, bound_reached);
    a.name_bit("next_guard", guard);

    // The answer, should the walk have ended.
    let mirrored_position_u = a.add(NearestEven, ray.u, travelled_u);
    a.name_num("mirrored_position_u", mirrored_position_u);
    let position_u = a.negate_if(ray.mirror_u, mirrored_position_u);
    a.name_num("position_u", position_u);
    let mirrored_position_v = a.add(NearestEven, ray.v, travelled_v);
    a.name_num("mirrored_position_v", mirrored_position_v);
    let position_v = a.negate_if(ray.mirror_v, mirrored_position_v);
    a.name_num("position_v", position_v);
    let texel_i = texel(a, shape, ray.mirror_u, i);
    a.name_int("texel_i", texel_i);
    let texel_j = texel(a, shape, ray.mirror_v, j);
    a.name_int("texel_j", texel_j);

    StepResult {
        walk: WalkRegisters {
            level,
            i,
            j,
            t,
            at_border_v,
            corner_owed,
            corner_paid,
            passed,
            crossed_before,
            steps,
            crossings,
            hit,
            guard,
        },
        position_u,
        position_v,
        mirrored_position_u,
        mirrored_position_v,
        texel_i,
        texel_j,
    }
}

fn texel<A: Arith>(a: &mut A, shape: TraverseShape, mirror: A::Bit, index: A::Int) -> A::Int {
    let index = a.int_complement_if(mirror, index);
    let size_mask = a.int_constant(i64::from(shape.size()) - 1);
    a.int_and(index, size_mask)
}
