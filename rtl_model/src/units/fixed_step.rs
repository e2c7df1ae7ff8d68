//! One step of the walk by nodes in exact fixed point: integers only, and no divider.
//!
//! What a step does is what [`super::traverse_step`] does, by any [`SearchPolicy`]. Every decision is
//! a comparison of integers that are never rounded, so a walk takes the path of the quantised ray
//! itself: it ends at the very hit of the definition, and crosses no border twice.
//!
//! # The depth reached
//!
//! It is either a whole number of height steps (`depth`), where the walk advanced to the surface of a
//! node, or the depth at which a border was crossed, which is a ratio. A ratio is never formed: the
//! walk only knows on which axis it is at a border (`at_border_u`, `at_border_v`). The border is the
//! near one of its node, or, after an ascent across an odd border, its midline (`at_midline`).
//!
//! - *Inside*: the ray is inside its node at the node's depth n iff its position at n,
//!   `(entry << height_bits) + n * slope`, is beyond the far border on neither axis.
//! - *Not beyond*: n is not beyond the depth reached iff n is at most `depth`; at a border, iff the
//!   position at n is not beyond that border. Either implies "inside", so only "inside" decides
//!   whether a walk goes down. A `depth` left behind by a crossing bounds the depth reached from
//!   below, so that the larger of it and n may stand for n everywhere: one multiplier an axis.
//! - *Which border comes first*: the sign of the error term (see [`super::fixed_setup`]) at the far
//!   corner.
//! - *Which child*: by position (see `fixed_child`); at a border, exactly on the axis
//!   crossed and by the error term on the other.

use super::fixed_answer::{FixedAnswer, fixed_answer};
use super::fixed_ascent::{FixedCrossing, fixed_ascent};
use super::fixed_child::{
    DESCENTS, FixedNode, FixedPosition, HalfSide, child, far_by_position, half_of,
};
use super::fixed_setup::{FixedRayRegisters, FixedSetUpRay, shift_left_by};
use super::fixed_shape::{FIXED_COUNTER_BITS, FixedShape};
use super::search_policy::{Ascent, SearchPolicy};
use super::traverse_step::{INDEX_BITS, LEVEL_BITS};
use crate::arith::Arith;

/// The registers of a walk that change from step to step.
#[derive(Debug)]
pub struct FixedWalkRegisters<A: Arith> {
    /// Level of the node looked at; 0 is the map itself.
    pub level: A::Int,
    /// Index of the node on u, mirrored where the ray is, not wrapped to the map.
    pub i: A::Int,
    /// Index of the node on v.
    pub j: A::Int,
    /// The error term at the node's near corner, of [`FixedShape::error_bits`] bits.
    pub error: A::Int,
    /// Height steps from the top: the depth reached, or, at a border, one not beyond it.
    pub depth: A::Int,
    /// The depth reached is that at which a border of u was crossed.
    pub at_border_u: A::Bit,
    /// The depth reached is that at which a border of v was crossed.
    pub at_border_v: A::Bit,
    /// The border crossed is the node's midline, not its near border. There where the policy
    /// can go up across an odd border.
    pub at_midline: Option<A::Bit>,
    /// The step before was a crossing at this level. There where the policy asks.
    pub crossed_before: Option<A::Bit>,
    /// Steps taken.
    pub steps: A::Int,
    /// Node crossings among them.
    pub crossings: A::Int,
    /// The walk has ended in a hit: level 0, node (i, j).
    pub hit: A::Bit,
    /// The walk has ended at the step bound.
    pub guard: A::Bit,
}

impl<A: Arith> Clone for FixedWalkRegisters<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for FixedWalkRegisters<A> {}

/// Can a walk by this policy go up across a border that the node above does not have?
pub const fn meets_midlines(policy: SearchPolicy) -> bool {
    matches!(policy.ascent, Ascent::Always | Ascent::Coherent)
}

/// Does this policy ask whether the step before was a crossing?
pub const fn asks_for_crossings(policy: SearchPolicy) -> bool {
    matches!(policy.ascent, Ascent::Coherent)
}

/// The walk's registers before its first step: at depth 0.
pub fn fixed_walk_start<A: Arith>(
    a: &mut A,
    policy: SearchPolicy,
    setup: &FixedSetUpRay<A>,
) -> FixedWalkRegisters<A> {
    let no = a.bit_constant(false);
    let none = a.int_constant(0);
    FixedWalkRegisters {
        level: setup.level,
        i: setup.i,
        j: setup.j,
        error: setup.error,
        depth: none,
        at_border_u: no,
        at_border_v: no,
        at_midline: meets_midlines(policy).then_some(no),
        crossed_before: asks_for_crossings(policy).then_some(no),
        steps: none,
        crossings: none,
        hit: no,
        guard: no,
    }
}

/// Where the height of the walk's node lies in the pyramid's memory: a one, then the node's index
/// on v, then on u ([`crate::maps::Pyramid`]).
pub fn fixed_node_address<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    ray: &FixedRayRegisters<A>,
    walk: &FixedWalkRegisters<A>,
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

/// One step of a walk by this policy, at a node of this height: the registers after it (unchanged
/// if it had ended before), and the answer that they stand for.
pub fn fixed_step<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    policy: SearchPolicy,
    ray: &FixedRayRegisters<A>,
    walk: &FixedWalkRegisters<A>,
    height: A::Int,
) -> (FixedWalkRegisters<A>, FixedAnswer<A>) {
    let ended = a.or(walk.hit, walk.guard);
    a.name_bit("ended", ended);
    let running = a.not(ended);
    a.name_bit("running", running);
    let none = a.int_constant(0);
    let at_border = a.or(walk.at_border_u, walk.at_border_v);
    a.name_bit("at_border", at_border);

    // The depth of the node, or the depth reached if that is further.
    let full_height = a.int_constant(shape.full_height());
    let node_depth = a.int_sub(full_height, height);
    // A height is not negative, nor above the full height.
    let node_depth = a.int_wrap(node_depth, shape.height_bits + 1);
    a.name_int("node_depth", node_depth);
    let gets_further = a.int_less_than(walk.depth, node_depth);
    a.name_bit("gets_further", gets_further);
    let depth = a.int_select(gets_further, node_depth, walk.depth);
    a.name_int("furthest_depth", depth);

    // Where the ray is there.
    let position_u = position(
        a,
        shape,
        ["travelled_u", "position_u"],
        ray.u,
        ray.slope_u,
        depth,
    );
    let position_v = position(
        a,
        shape,
        ["travelled_v", "position_v"],
        ray.v,
        ray.slope_v,
        depth,
    );

    // The node: its borders, its side, and that times the slopes.
    let shift = a.int_low_bits(walk.level, 4);
    let near_u = border(a, shape, ["near_i", "near_u"], walk.i, shift);
    let near_v = border(a, shape, ["near_j", "near_v"], walk.j, shift);
    let one = a.int_constant(1);
    let texels = a.int_shift_left(one, shift, 4);
    // At most the root's.
    let texels = a.int_wrap(texels, shape.root_level + 2);
    a.name_int("side_texels", texels);
    let distance = shift_left_by(a, texels, shape.root_level + 2, shape.fraction_bits());
    a.name_int("side", distance);
    let span_u = span(a, shape, ray.slope_u, shift);
    a.name_int("span_u", span_u);
    let span_v = span(a, shape, ray.slope_v, shift);
    a.name_int("span_v", span_v);
    let side = HalfSide::<A> {
        distance,
        span_u,
        span_v,
    };
    let node = FixedNode::<A> {
        i: walk.i,
        j: walk.j,
        near_u,
        near_v,
        error: walk.error,
    };

    // Down, or across?
    let far_border_u = a.int_add(near_u, distance);
    // The side of a node beyond the reach of a ray still fits the index's bits.
    let far_border_u = a.int_wrap(far_border_u, shape.position_bits());
    a.name_int("far_border_u", far_border_u);
    let far_border_v = a.int_add(near_v, distance);
    let far_border_v = a.int_wrap(far_border_v, shape.position_bits());
    a.name_int("far_border_v", far_border_v);
    let beyond_u = a.int_less_than(far_border_u, position_u);
    a.name_bit("beyond_u", beyond_u);
    let beyond_v = a.int_less_than(far_border_v, position_v);
    a.name_bit("beyond_v", beyond_v);
    let beyond = a.or(beyond_u, beyond_v);
    a.name_bit("beyond", beyond);
    let inside = a.not(beyond);
    a.name_bit("inside", inside);

    // Does going down advance the ray to the node's depth, off the border it is at?
    let half = half_of(a, &DESCENTS[0], side);
    let border_behind = a.int_select(walk.at_border_v, near_v, near_u);
    let border_behind = match walk.at_midline {
        None => border_behind,
        Some(at_midline) => {
            let to_midline = a.int_select(at_midline, half.distance, none);
            let at_midline = a.int_add(border_behind, to_midline);
            a.int_wrap(at_midline, shape.position_bits())
        }
    };
    a.name_int("border_behind", border_behind);
    let position_there = a.int_select(walk.at_border_v, position_v, position_u);
    a.name_int("position_there", position_there);
    let past_border = a.int_less_than(border_behind, position_there);
    a.name_bit("past_border", past_border);
    let stays_at_border = a.not(past_border);
    a.name_bit("stays_at_border", stays_at_border);
    let stays_u = a.and(walk.at_border_u, stays_at_border);
    a.name_bit("stays_at_border_u", stays_u);
    let stays_v = a.and(walk.at_border_v, stays_at_border);
    a.name_bit("stays_at_border_v", stays_v);

    // Which child. Where the ray starts, or does not move on an axis, a tie is the far child's.
    let at_start = a.int_equal(depth, none);
    a.name_bit("at_start", at_start);
    let still_u = a.int_equal(ray.slope_u, none);
    a.name_bit("still_u", still_u);
    let still_v = a.int_equal(ray.slope_v, none);
    a.name_bit("still_v", still_v);
    let tie_is_far_u = a.or(at_start, still_u);
    a.name_bit("tie_is_far_u", tie_is_far_u);
    let tie_is_far_v = a.or(at_start, still_v);
    a.name_bit("tie_is_far_v", tie_is_far_v);
    let there = FixedPosition::<A> {
        u: position_u,
        v: position_v,
        tie_is_far_u,
        tie_is_far_v,
    };
    let (by_position_u, by_position_v) =
        far_by_position(a, shape, &DESCENTS[0], &node, &half, &there);
    let (across_u, across_v) = far_at_border(a, walk, &half, still_v);
    let on_axis = match walk.at_midline {
        None => a.bit_constant(false),
        Some(at_midline) => at_midline,
    };
    let far_u = choose(a, stays_v, across_u, by_position_u);
    let far_u = choose(a, stays_u, on_axis, far_u);
    a.name_bit("child_is_far_u", far_u);
    let far_v = choose(a, stays_u, across_v, by_position_v);
    let far_v = choose(a, stays_v, on_axis, far_v);
    a.name_bit("child_is_far_v", far_v);
    let first = child(a, shape, &DESCENTS[0], &node, &half, (far_u, far_v));

    // Several levels at once, until the first crossing: until then no border is behind the ray.
    let (mut below, mut smaller) = (first, half);
    for names in &DESCENTS[1..policy.levels_down as usize] {
        smaller = half_of(a, names, smaller);
        let far = far_by_position(a, shape, names, &below, &smaller, &there);
        below = child(a, shape, names, &below, &smaller, far);
    }
    let level_below = a.int_sub(walk.level, one);
    a.name_int("level_below", level_below);
    let (below, level_below) = if policy.levels_down == 1 {
        (first, level_below)
    } else {
        let levels = i64::from(policy.levels_down);
        let levels_down = a.int_constant(levels);
        let too_few_left = a.int_less_than(walk.level, levels_down);
        a.name_bit("too_few_levels_left", too_few_left);
        let no_crossing = a.int_equal(walk.crossings, none);
        a.name_bit("no_crossing_yet", no_crossing);
        let enough_left = a.not(too_few_left);
        let several = a.and(no_crossing, enough_left);
        a.name_bit("goes_several_levels", several);
        let level_far_below = a.int_sub(walk.level, levels_down);
        a.name_int("level_far_below", level_far_below);
        let below = FixedNode::<A> {
            i: a.int_select(several, below.i, first.i),
            j: a.int_select(several, below.j, first.j),
            // The borders of a node follow from its index.
            near_u: first.near_u,
            near_v: first.near_v,
            error: a.int_select(several, below.error, first.error),
        };
        let level = a.int_select(several, level_far_below, level_below);
        (below, level)
    };

    // The neighbour: behind the border that the error term at the far corner says.
    let past_corner_u = a.int_add(walk.error, span_v);
    let past_corner = a.int_sub(past_corner_u, span_u);
    a.name_int("far_corner_error", past_corner);
    let v_first = a.int_less_than(none, past_corner);
    a.name_bit("v_first", v_first);
    let u_first = a.not(v_first);
    a.name_bit("u_first", u_first);
    let forward_i = a.int_from_bit(u_first);
    let neighbour_i = a.int_add(walk.i, forward_i);
    a.name_int("neighbour_i", neighbour_i);
    let forward_j = a.int_from_bit(v_first);
    let neighbour_j = a.int_add(walk.j, forward_j);
    a.name_int("neighbour_j", neighbour_j);
    let past_corner_v = a.int_sub(walk.error, span_u);
    let neighbour_error = a.int_select(u_first, past_corner_u, past_corner_v);
    // Where the walk crosses, the ray passes through the neighbour.
    let neighbour_error = a.int_wrap(neighbour_error, shape.error_bits());
    a.name_int("neighbour_error", neighbour_error);
    let crossing = FixedCrossing::<A> {
        u_first,
        level: walk.level,
        i: neighbour_i,
        j: neighbour_j,
        error: neighbour_error,
        far_border_u,
        far_border_v,
        position_u,
        position_v,
        side,
        crossed_before: walk.crossed_before,
    };
    let across = fixed_ascent(a, shape, policy, &crossing);

    // The walk after the step.
    let at_level_0 = a.int_equal(walk.level, none);
    a.name_bit("at_level_0", at_level_0);
    let goes_down = a.and(inside, running);
    a.name_bit("goes_down", goes_down);
    let crosses = a.and(beyond, running);
    a.name_bit("crosses", crosses);
    let hits = a.and(goes_down, at_level_0);
    a.name_bit("hits", hits);
    let hit = a.or(walk.hit, hits);
    a.name_bit("next_hit", hit);
    let above_level_0 = a.not(at_level_0);
    let descends = a.and(goes_down, above_level_0);
    a.name_bit("descends", descends);

    let level = a.int_select(crosses, across.level, walk.level);
    let level = a.int_select(descends, level_below, level);
    // The level goes from root_level down to 0.
    let level = a.int_wrap(level, LEVEL_BITS);
    a.name_int("next_level", level);
    let i = a.int_select(crosses, across.i, walk.i);
    let i = a.int_select(descends, below.i, i);
    // A ray within reach stays within the index's bits.
    let i = a.int_wrap(i, INDEX_BITS);
    a.name_int("next_i", i);
    let j = a.int_select(crosses, across.j, walk.j);
    let j = a.int_select(descends, below.j, j);
    let j = a.int_wrap(j, INDEX_BITS);
    a.name_int("next_j", j);
    let error = a.int_select(crosses, across.error, walk.error);
    let error = a.int_select(descends, below.error, error);
    // The ray passes through the node.
    let error = a.int_wrap(error, shape.error_bits());
    a.name_int("next_error", error);

    let depth = a.int_select(goes_down, depth, walk.depth);
    a.name_int("next_depth", depth);
    let [at_border_u, at_border_v] = [
        ("next_at_border_u", u_first, stays_u, walk.at_border_u),
        ("next_at_border_v", v_first, stays_v, walk.at_border_v),
    ]
    .map(|(name, crossed, stays, was)| {
        let at_border = choose(a, goes_down, stays, was);
        let at_border = choose(a, crosses, crossed, at_border);
        a.name_bit(name, at_border);
        at_border
    });
    let at_midline = walk.at_midline.zip(across.at_midline);
    let at_midline = at_midline.map(|(was, after)| {
        // A child's border again, once the walk has gone down.
        let not_down = a.not(goes_down);
        let kept = a.and(was, not_down);
        let at_midline = choose(a, crosses, after, kept);
        a.name_bit("next_at_midline", at_midline);
        at_midline
    });
    let crossed_before = walk.crossed_before.map(|was| {
        let stays_up = a.not(across.ascends);
        let crossed_here = a.and(crosses, stays_up);
        let crossed = choose(a, running, crossed_here, was);
        a.name_bit("next_crossed_before", crossed);
        crossed
    });

    let step = a.int_from_bit(running);
    let steps = a.int_add(walk.steps, step);
    // The guard ends a walk before its counters could overflow.
    let steps = a.int_wrap(steps, FIXED_COUNTER_BITS);
    a.name_int("next_steps", steps);
    let crossing = a.int_from_bit(crosses);
    let crossings = a.int_add(walk.crossings, crossing);
    let crossings = a.int_wrap(crossings, FIXED_COUNTER_BITS);
    a.name_int("next_crossings", crossings);
    let step_bound = shape.step_bound(policy.ascent != Ascent::Never);
    let step_bound = a.int_constant(i64::from(step_bound));
    let at_bound = a.int_equal(steps, step_bound);
    a.name_bit("at_bound", at_bound);
    let no_hit = a.not(hit);
    let bound_reached = a.and(at_bound, no_hit);
    let guard = a.or(walk.guard, bound_reached);
    a.name_bit("next_guard", guard);

    let walk = FixedWalkRegisters {
        level,
        i,
        j,
        error,
        depth,
        at_border_u,
        at_border_v,
        at_midline,
        crossed_before,
        steps,
        crossings,
        hit,
        guard,
    };
    let answer = fixed_answer(a, shape, ray, &walk);
    (walk, answer)
}

/// The position on an axis, so many height steps below the top.
fn position<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    [travelled_name, position_name]: [&'static str; 2],
    entry: A::Int,
    slope: A::Int,
    depth: A::Int,
) -> A::Int {
    let travelled = a.int_mul(depth, slope);
    a.name_int(travelled_name, travelled);
    let entry = shift_left_by(a, entry, shape.entry_bits(), shape.height_bits);
    let position = a.int_add(entry, travelled);
    // A ray within reach stays within the index's bits.
    let position = a.int_wrap(position, shape.position_bits());
    a.name_int(position_name, position);
    position
}

/// The position of a node's near border.
fn border<A: Arith>(
    a: &mut A,
    shape: FixedShape,
    [texel_name, border_name]: [&'static str; 2],
    index: A::Int,
    level: A::Int,
) -> A::Int {
    let texel = a.int_shift_left(index, level, 4);
    let texel = a.int_wrap(texel, INDEX_BITS);
    a.name_int(texel_name, texel);
    let border = shift_left_by(a, texel, INDEX_BITS, shape.fraction_bits());
    a.name_int(border_name, border);
    border
}

/// A slope times the side of a node, in the units of the error term.
fn span<A: Arith>(a: &mut A, shape: FixedShape, slope: A::Int, level: A::Int) -> A::Int {
    let texels = a.int_shift_left(slope, level, 4);
    let bits = shape.root_level + shape.slope_bits + 1;
    // At most the root's side.
    let texels = a.int_wrap(texels, bits);
    shift_left_by(a, texels, bits, shape.entry_fraction_bits)
}

/// Behind a border, is the far child the one, on the axis that was not crossed? On u after a
/// crossing of v, and on v after one of u.
///
/// The error term at the point where border and midline meet says on which side of it the ray
/// passes: above zero, it gets to the midline of v before it crosses that border of u.
fn far_at_border<A: Arith>(
    a: &mut A,
    walk: &FixedWalkRegisters<A>,
    half: &HalfSide<A>,
    still_v: A::Bit,
) -> (A::Bit, A::Bit) {
    let none = a.int_constant(0);
    let (on_u, on_v) = match walk.at_midline {
        None => (none, none),
        // The border is half a side further on: of v, or of u.
        Some(at_midline) => (
            a.int_select(at_midline, half.span_u, none),
            a.int_select(at_midline, half.span_v, none),
        ),
    };
    let at_border_v = a.int_sub(walk.error, on_u);
    let meeting_u = a.int_add(at_border_v, half.span_v);
    a.name_int("meeting_error_u", meeting_u);
    // Through a corner u is crossed first: a ray on the midline of u has crossed it.
    let before_u = a.int_less_than(none, meeting_u);
    let far_u = a.not(before_u);
    a.name_bit("crossed_far_u", far_u);
    let at_border_u = a.int_add(walk.error, on_v);
    let meeting_v = a.int_sub(at_border_u, half.span_u);
    a.name_int("meeting_error_v", meeting_v);
    let past_v = a.int_less_than(none, meeting_v);
    // A ray on the midline of v has not crossed it, unless it is on it all the way.
    let on_v = a.int_equal(meeting_v, none);
    let along_v = a.and(on_v, still_v);
    let far_v = a.or(past_v, along_v);
    a.name_bit("crossed_far_v", far_v);
    (far_u, far_v)
}

/// `when_one` where the condition holds, else `when_zero`.
pub(super) fn choose<A: Arith>(
    a: &mut A,
    condition: A::Bit,
    when_one: A::Bit,
    when_zero: A::Bit,
) -> A::Bit {
    let one = a.and(condition, when_one);
    let otherwise = a.not(condition);
    let zero = a.and(otherwise, when_zero);
    a.or(one, zero)
}
