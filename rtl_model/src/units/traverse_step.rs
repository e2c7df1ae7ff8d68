//! One step of the walk down and across the pyramid of maximum heights: method `oh`
//! (Oh, Ki, Lee 2006, as defined by measurement in the project's notes on the papers).
//!
//! A step looks at one node. With d its depth and t the depth reached so far:
//! if d is not beyond t, go one level down; else, if the ray is still inside the node at d,
//! advance to d and go one level down; else cross into the neighbour behind the border that the
//! ray leaves through. At level 0, going down is the hit.
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

use super::traverse_axis::{AXIS_U, AXIS_V, Axis, exit, far_child};
use super::traverse_setup::RayRegisters;
use crate::arith::Arith;
use crate::float::Rounding::{NearestEven, TowardZero};
use crate::ray::REACH_TEXELS;

/// How far the true exit depth can lie above the computed one, in units in the last place, where
/// the distance to the border is exact: truncating the quotient loses less than one.
pub const EXACT_EXIT_ULPS: u32 = 1;

/// The same where the distance was truncated too: it loses less than one unit of its own, which
/// the quotient sees as less than two (its significand may be the smaller one).
pub const ROUNDED_EXIT_ULPS: u32 = 3;

/// Bits of a node index, signed: a walk starts in texels -4096 to 4095 and reaches 2^14 texels.
pub const INDEX_BITS: u32 = 16;

/// Bits of the step and crossing counters, signed: enough for [`TraverseShape::step_bound`].
pub const COUNTER_BITS: u32 = 17;

/// Bits of a level, signed: 0 to 12, and -1 in passing.
pub const LEVEL_BITS: u32 = 5;

/// What a traverse unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TraverseShape {
    /// Level of the pyramid's root: log2 of the map's size, 0 to 12.
    pub root_level: u32,
    /// Bits of a height: 8 or 16.
    pub height_bits: u32,
}

impl TraverseShape {
    /// Texels on a side of the map.
    pub const fn size(self) -> u32 {
        1 << self.root_level
    }

    /// More steps than any ray within reach can take; a walk that gets there answers `guard`.
    ///
    /// A step goes down a level, at most `root_level + 1` times, or crosses. Going straight, a
    /// crossing moves on by at least a texel on one axis, and there are `reach + size` of them on
    /// either; a corner in doubt makes three crossings of two.
    pub const fn step_bound(self) -> u32 {
        self.root_level + 1 + 3 * (REACH_TEXELS as u32 + self.size())
    }

    /// Bits of a height's address in the pyramid's memory.
    pub const fn address_bits(self) -> u32 {
        2 * self.root_level + 1
    }
}

/// The registers of a walk that change from step to step.
#[derive(Debug)]
pub struct WalkRegisters<A: Arith> {
    /// Level of the node looked at; 0 is the map itself.
    pub level: A::Int,
    /// Index of the node on u, mirrored where the ray is, not wrapped to the map.
    pub i: A::Int,
    /// Index of the node on v.
    pub j: A::Int,
    /// Depth reached: never later than the ray truly is.
    pub t: A::Num,
    /// The depth t is that at which a border of v was crossed.
    pub at_border_v: A::Bit,
    /// A corner was in doubt and u was crossed first: the node across the corner is owed a visit.
    pub corner_owed: A::Bit,
    /// The visit across the corner is being paid: the next crossing goes behind the corner.
    pub corner_paid: A::Bit,
    /// Steps taken.
    pub steps: A::Int,
    /// Node crossings among them.
    pub crossings: A::Int,
    /// The walk has ended in a hit: level 0, node (i, j), depth t.
    pub hit: A::Bit,
    /// The walk has ended at the step bound.
    pub guard: A::Bit,
}

impl<A: Arith> Clone for WalkRegisters<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for WalkRegisters<A> {}

/// What a step leaves: the registers for the next one, and the position they stand for.
#[derive(Debug)]
pub struct StepResult<A: Arith> {
    /// The walk after the step; unchanged if it had ended before.
    pub walk: WalkRegisters<A>,
    /// Position on u at depth t, not mirrored, not wrapped: for the answer, never for a decision.
    pub position_u: A::Num,
    /// Position on v.
    pub position_v: A::Num,
    /// Texel on u at level 0 of the map, wrapped; meaningful once the walk has ended.
    pub texel_i: A::Int,
    /// Texel on v.
    pub texel_j: A::Int,
}

/// The walk's registers before its first step: at the root, at depth 0.
pub fn walk_start<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    i: A::Int,
    j: A::Int,
) -> WalkRegisters<A> {
    let no = a.bit_constant(false);
    let none = a.int_constant(0);
    WalkRegisters {
        level: a.int_constant(i64::from(shape.root_level)),
        i,
        j,
        t: a.zero(),
        at_border_v: no,
        corner_owed: no,
        corner_paid: no,
        steps: none,
        crossings: none,
        hit: no,
        guard: no,
    }
}

/// Where the height of the walk's node lies in the pyramid's memory (the layout is
/// [`crate::maps::Pyramid`]'s): a one, then the node's index on v, then on u.
pub fn node_address<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
    ray: &RayRegisters<A>,
    walk: &WalkRegisters<A>,
) -> A::Int {
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

/// One step of a walk, at a node of this height.
pub fn traverse_step<A: Arith>(
    a: &mut A,
    shape: TraverseShape,
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
    // A t that gets further in this step is no longer that of the crossing.
    let t_is_old = a.not(gets_further);
    a.name_bit("t_is_old", t_is_old);
    let still_at_border_v = a.and(walk.at_border_v, t_is_old);
    a.name_bit("still_at_border_v", still_at_border_v);
    let never = a.bit_constant(false);
    let far_u = far_child(
        a,
        &axis_u,
        size_exponent,
        walk.i,
        travelled_u,
        still_at_border_v,
    );
    let far_v = far_child(a, &axis_v, size_exponent, walk.j, travelled_v, never);
    let owed = walk.corner_owed;
    let paid = walk.corner_paid;
    let not_owed = a.not(owed);
    a.name_bit("not_owed", not_owed);
    let not_paid = a.not(paid);
    a.name_bit("not_paid", not_paid);
    let far_u = a.or(far_u, paid);
    a.name_bit("far_u_or_paid", far_u);
    let far_u = a.and(far_u, not_owed);
    a.name_bit("child_is_far_u", far_u);
    let far_v = a.or(far_v, owed);
    a.name_bit("far_v_or_owed", far_v);
    let far_v = a.and(far_v, not_paid);
    a.name_bit("child_is_far_v", far_v);
    let child_i = child_index(a, "first_child_i", walk.i, far_u);
    a.name_int("child_i", child_i);
    let child_j = child_index(a, "first_child_j", walk.j, far_v);
    a.name_int("child_j", child_j);

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
    let at_level_0 = a.int_equal(walk.level, zero);
    a.name_bit("at_level_0", at_level_0);
    let running = a.not(ended);
    a.name_bit("running", running);
    let goes_down = a.and(down, running);
    a.name_bit("goes_down", goes_down);
    let not_down = a.not(down);
    a.name_bit("not_down", not_down);
    let crosses = a.and(not_down, running);
    a.name_bit("crosses", crosses);
    let hits = a.and(goes_down, at_level_0);
    a.name_bit("hits", hits);
    let hit = a.or(walk.hit, hits);
    a.name_bit("next_hit", hit);
    let above_level_0 = a.not(at_level_0);
    a.name_bit("above_level_0", above_level_0);
    let descends = a.and(goes_down, above_level_0);
    a.name_bit("descends", descends);

    let level_below = a.int_sub(walk.level, one);
    a.name_int("level_below", level_below);
    let level = a.int_select(descends, level_below, walk.level);
    // The level goes from root_level down to 0.
    let level = a.int_wrap(level, LEVEL_BITS);
    a.name_int("next_level", level);
    let i = a.int_select(crosses, neighbour_i, walk.i);
    a.name_int("i_unless_down", i);
    let i = a.int_select(descends, child_i, i);
    // A ray within reach stays within the index's bits.
    let i = a.int_wrap(i, INDEX_BITS);
    a.name_int("next_i", i);
    let j = a.int_select(crosses, neighbour_j, walk.j);
    a.name_int("j_unless_down", j);
    let j = a.int_select(descends, child_j, j);
    let j = a.int_wrap(j, INDEX_BITS);
    a.name_int("next_j", j);

    let crosses_u = a.and(crosses, i_forward);
    a.name_bit("crosses_u", crosses_u);
    let not_across_u = a.not(i_forward);
    let crosses_v = a.and(crosses, not_across_u);
    a.name_bit("crosses_v", crosses_v);
    let not_across_u_now = a.not(crosses_u);
    a.name_bit("not_across_u_now", not_across_u_now);
    let stays_at_border_v = a.and(still_at_border_v, not_across_u_now);
    a.name_bit("stays_at_border_v", stays_at_border_v);
    let at_border_v = a.or(crosses_v, stays_at_border_v);
    a.name_bit("next_at_border_v", at_border_v);
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

    let step = a.int_from_bit(running);
    let steps = a.int_add(walk.steps, step);
    // The guard ends a walk before its counters could overflow.
    let steps = a.int_wrap(steps, COUNTER_BITS);
    a.name_int("next_steps", steps);
    let crossing = a.int_from_bit(crosses);
    a.name_int("crossing", crossing);
    let crossings = a.int_add(walk.crossings, crossing);
    let crossings = a.int_wrap(crossings, COUNTER_BITS);
    a.name_int("next_crossings", crossings);
    let step_bound = a.int_constant(i64::from(shape.step_bound()));
    let at_bound = a.int_equal(steps, step_bound);
    a.name_bit("at_bound", at_bound);
    let no_hit = a.not(hit);
    a.name_bit("no_hit", no_hit);
    let bound_reached = a.and(at_bound, no_hit);
    let guard = a.or(walk.guard, bound_reached);
    a.name_bit("next_guard", guard);

    // The answer, should the walk have ended.
    let position_u = a.add(NearestEven, ray.u, travelled_u);
    a.name_num("mirrored_position_u", position_u);
    let position_u = a.negate_if(ray.mirror_u, position_u);
    a.name_num("position_u", position_u);
    let position_v = a.add(NearestEven, ray.v, travelled_v);
    a.name_num("mirrored_position_v", position_v);
    let position_v = a.negate_if(ray.mirror_v, position_v);
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
            steps,
            crossings,
            hit,
            guard,
        },
        position_u,
        position_v,
        texel_i,
        texel_j,
    }
}

fn child_index<A: Arith>(
    a: &mut A,
    first_child: &'static str,
    index: A::Int,
    far: A::Bit,
) -> A::Int {
    let twice = a.int_add(index, index);
    a.name_int(first_child, twice);
    let far = a.int_from_bit(far);
    a.int_or(twice, far)
}

fn texel<A: Arith>(a: &mut A, shape: TraverseShape, mirror: A::Bit, index: A::Int) -> A::Int {
    let index = a.int_complement_if(mirror, index);
    let size_mask = a.int_constant(i64::from(shape.size()) - 1);
    a.int_and(index, size_mask)
}
