//! One step of a pyramid traversal as published: the position is moved a small offset beyond a
//! border, and the node is found anew from the rounded position.
//!
//! It is here to show what that costs, beside [`super::traverse_step`], which carries the node's
//! index along. Where the offset is large the walk steps over the corners of nodes; where it is so
//! small that rounding eats it the position stays in the node, and the walk crosses the same border
//! for ever: it ends at the step bound with `guard`.
//!
//! The offset is so many texels on the axis on which the ray is quickest, along the ray. The node
//! at level L is the texel's index without its last L bits. All else is the search policy's: where
//! the walk starts, how far it goes down at once, and when it goes up. Everything rounds to nearest,
//! as published programs do: no direction would be safe.

use super::search_policy::{Ascent, SearchPolicy, Start};
use crate::arith::Arith;
use crate::float::Rounding::NearestEven;
use crate::ray::REACH_TEXELS;

/// Bits of a texel index, signed: a ray starts in texels 0 to 4095 and reaches 2^14 texels either
/// way, and an offset may take it a texel further.
pub const INDEX_BITS: u32 = 16;

/// Bits of the step and crossing counters, signed: enough for [`OffsetShape::step_bound`].
pub const COUNTER_BITS: u32 = 18;

/// Bits of a level, signed: 0 to 12.
pub const LEVEL_BITS: u32 = 5;

/// What a traverse unit that crosses by an offset is built for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetShape {
    /// Level of the pyramid's root: log2 of the map's size, 0 to 12.
    pub root_level: u32,
    /// Bits of a height: 8 or 16.
    pub height_bits: u32,
    /// Where it starts, how far it goes down, when up.
    pub policy: SearchPolicy,
    /// Texels beyond a border, along the ray, on the axis on which that is quickest; above 0, at
    /// most 1.
    pub texels: f64,
}

impl OffsetShape {
    /// Texels on a side of the map.
    pub const fn size(self) -> u32 {
        1 << self.root_level
    }

    /// Bits of a height's address in the pyramid's memory.
    pub const fn address_bits(self) -> u32 {
        2 * self.root_level + 1
    }

    /// More steps than a ray within reach takes that gets on at each: a crossing moves on by a texel
    /// on one axis, of `reach + size` on either; with it the walk may go a level up, which it comes
    /// down again in a step of its own.
    pub const fn step_bound(self) -> u32 {
        self.root_level + 1 + 4 * (REACH_TEXELS as u32 + self.size())
    }
}

/// The registers a ray carries unchanged from step to step.
#[derive(Debug)]
pub struct OffsetRay<A: Arith> {
    /// Entry coordinate, 0 to 1.
    pub u: A::Num,
    /// Entry coordinate on the other axis.
    pub v: A::Num,
    /// Offset for one unit of depth.
    pub du: A::Num,
    /// Offset on the other axis.
    pub dv: A::Num,
    /// Depth by which a crossing goes beyond the border; at most 1.
    pub offset: A::Num,
}

impl<A: Arith> Clone for OffsetRay<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for OffsetRay<A> {}

/// The registers of a walk that change from step to step.
#[derive(Debug)]
pub struct OffsetWalk<A: Arith> {
    /// Level of the node looked at; 0 is the map itself.
    pub level: A::Int,
    /// Index of the texel on u that the rounded position lies in, not wrapped to the map.
    pub i: A::Int,
    /// Index of the texel on v.
    pub j: A::Int,
    /// Depth reached, as rounded.
    pub t: A::Num,
    /// The step before was a crossing that stayed at its level.
    pub crossed: A::Bit,
    /// Steps taken.
    pub steps: A::Int,
    /// Node crossings among them.
    pub crossings: A::Int,
    /// The walk has ended in a hit at depth t, in texel (i, j).
    pub hit: A::Bit,
    /// The walk has ended at the step bound.
    pub guard: A::Bit,
}

impl<A: Arith> Clone for OffsetWalk<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for OffsetWalk<A> {}

/// What a step leaves: the registers for the next one, and the position they stand for.
#[derive(Debug)]
pub struct OffsetResult<A: Arith> {
    /// The walk after the step; unchanged if it had ended before.
    pub walk: OffsetWalk<A>,
    /// Position on u at depth t, not wrapped.
    pub position_u: A::Num,
    /// Position on v.
    pub position_v: A::Num,
    /// Texel on u, wrapped; meaningful once the walk has ended.
    pub texel_i: A::Int,
    /// Texel on v.
    pub texel_j: A::Int,
}

/// What is done to a ray once: how deep its offset is, and where its walk starts.
pub fn offset_setup<A: Arith>(
    a: &mut A,
    shape: OffsetShape,
    [u, v, du, dv]: [A::Num; 4],
) -> (OffsetRay<A>, OffsetWalk<A>) {
    let magnitude_du = a.magnitude(du);
    let magnitude_dv = a.magnitude(dv);
    let speed = a.max(magnitude_du, magnitude_dv);
    a.name_num("speed", speed);
    let (significand, exponent) = odd_significand(shape.texels);
    let significand = a.int_constant(significand);
    let exponent = a.int_constant(exponent - i64::from(shape.root_level));
    let width = a.number_from_integer(NearestEven, significand, exponent);
    a.name_num("offset_width", width);
    let offset = a.div(NearestEven, width, speed);
    a.name_num("offset_depth", offset);
    // A ray that does not travel so far crosses nothing by it; a bound keeps infinities out.
    let one = one(a);
    let offset = a.min(offset, one);
    a.name_num("offset", offset);

    let i = texel_index(a, shape, u, ["entry_texels_u", "entry_i"]);
    let j = texel_index(a, shape, v, ["entry_texels_v", "entry_j"]);
    let root_level = a.int_constant(i64::from(shape.root_level));
    let none = a.int_constant(0);
    let level = match shape.policy.start {
        Start::Root => root_level,
        Start::Texel => none,
        Start::WholeRay => {
            let exit_u = a.add(NearestEven, u, du);
            a.name_num("exit_u", exit_u);
            let exit_v = a.add(NearestEven, v, dv);
            a.name_num("exit_v", exit_v);
            let exit_i = texel_index(a, shape, exit_u, ["exit_texels_u", "exit_i"]);
            let exit_j = texel_index(a, shape, exit_v, ["exit_texels_v", "exit_j"]);
            let differs_i = a.int_xor(i, exit_i);
            let differs_j = a.int_xor(j, exit_j);
            let differs = a.int_or(differs_i, differs_j);
            // A ray that leaves the tile to the left differs in its sign: in all bits.
            let differs = a.int_low_bits(differs, INDEX_BITS);
            a.name_int("differing_bits", differs);
            let level = a.int_bit_length(differs);
            a.name_int("whole_ray_level", level);
            let within = a.int_less_than(level, root_level);
            let level = a.int_select(within, level, root_level);
            let level = a.int_wrap(level, LEVEL_BITS);
            a.name_int("start_level", level);
            level
        }
    };
    let no = a.bit_constant(false);
    let walk = OffsetWalk {
        level,
        i,
        j,
        t: a.zero(),
        crossed: no,
        steps: none,
        crossings: none,
        hit: no,
        guard: no,
    };
    let ray = OffsetRay {
        u,
        v,
        du,
        dv,
        offset,
    };
    (ray, walk)
}

/// Where the height of the walk's node lies in the pyramid's memory (the layout is
/// [`crate::maps::Pyramid`]'s): a one, then the node's index on v, then on u.
pub fn offset_address<A: Arith>(a: &mut A, shape: OffsetShape, walk: &OffsetWalk<A>) -> A::Int {
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
    let level = a.int_low_bits(walk.level, 4);
    let i = a.int_shift_right(walk.i, level, 4);
    let i = a.int_and(i, index_mask);
    a.name_int("wrapped_i", i);
    let j = a.int_shift_right(walk.j, level, 4);
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
pub fn offset_step<A: Arith>(
    a: &mut A,
    shape: OffsetShape,
    ray: &OffsetRay<A>,
    walk: &OffsetWalk<A>,
    height: A::Int,
) -> OffsetResult<A> {
    let ended = a.or(walk.hit, walk.guard);
    a.name_bit("ended", ended);
    let running = a.not(ended);
    a.name_bit("running", running);
    let depth = a.depth_from_height(height, shape.height_bits);
    a.name_num("node_depth", depth);

    // Where the ray leaves the node, and by which border.
    let root_level = a.int_constant(i64::from(shape.root_level));
    let size_exponent = a.int_sub(walk.level, root_level);
    a.name_int("size_exponent", size_exponent);
    let shift = a.int_low_bits(walk.level, 4);
    let node_i = a.int_shift_right(walk.i, shift, 4);
    a.name_int("node_i", node_i);
    let node_j = a.int_shift_right(walk.j, shift, 4);
    a.name_int("node_j", node_j);
    let exit_u = exit(a, &EXIT_U, node_i, size_exponent, ray.u, ray.du);
    let exit_v = exit(a, &EXIT_V, node_j, size_exponent, ray.v, ray.dv);
    let u_first = a.less_equal(exit_u.depth, exit_v.depth);
    a.name_bit("u_first", u_first);
    let exit_depth = a.select(u_first, exit_u.depth, exit_v.depth);
    a.name_num("exit_depth", exit_depth);

    // Down, or across?
    let not_beyond = a.less_equal(depth, walk.t);
    a.name_bit("not_beyond", not_beyond);
    let inside = a.less_equal(depth, exit_depth);
    a.name_bit("inside", inside);
    let down = a.or(not_beyond, inside);
    a.name_bit("down", down);
    let not_down = a.not(down);
    let crosses = a.and(not_down, running);
    a.name_bit("crosses", crosses);

    // The depth reached. An exit that is crossed lies above the node's depth, so above the bottom.
    let one_as_number = one(a);
    let border = a.min(exit_depth, one_as_number);
    a.name_num("border_depth", border);
    let beyond = a.add(NearestEven, border, ray.offset);
    a.name_num("beyond_border", beyond);
    let advanced = a.select(inside, depth, beyond);
    let stays = a.or(not_beyond, ended);
    a.name_bit("t_stays", stays);
    let t = a.select(stays, walk.t, advanced);
    a.name_num("next_t", t);

    // Where that is: a rounded position, and the texel it lies in.
    let travelled_u = a.mul(NearestEven, t, ray.du);
    a.name_num("travelled_u", travelled_u);
    let travelled_v = a.mul(NearestEven, t, ray.dv);
    a.name_num("travelled_v", travelled_v);
    let position_u = a.add(NearestEven, ray.u, travelled_u);
    a.name_num("position_u", position_u);
    let position_v = a.add(NearestEven, ray.v, travelled_v);
    a.name_num("position_v", position_v);
    let i = texel_index(a, shape, position_u, ["texels_u", "next_i"]);
    let j = texel_index(a, shape, position_v, ["texels_v", "next_j"]);

    // The level: down by the policy's stride, or up with a crossing.
    let zero = a.int_constant(0);
    let at_level_0 = a.int_equal(walk.level, zero);
    a.name_bit("at_level_0", at_level_0);
    let goes_down = a.and(down, running);
    a.name_bit("goes_down", goes_down);
    let hits = a.and(goes_down, at_level_0);
    a.name_bit("hits", hits);
    let stride = stride(a, shape.policy, walk);
    let not_at_level_0 = a.not(at_level_0);
    let descends = a.and(goes_down, not_at_level_0);
    a.name_bit("descends", descends);
    let lower = a.int_sub(walk.level, stride);
    a.name_int("lower_level", lower);
    let crossed_index = a.int_select(u_first, exit_u.border, exit_v.border);
    a.name_int("crossed_index", crossed_index);
    let ascends = match shape.policy.ascent {
        Ascent::Never => None,
        Ascent::Always => Some(a.bit_constant(true)),
        Ascent::EvenBorder => Some(is_even(a, crossed_index)),
        Ascent::Coherent => Some(walk.crossed),
        Ascent::Selective => {
            let even = is_even(a, crossed_index);
            let near = ends_in_neighbour(a, shape, ray, depth, shift, [node_i, node_j]);
            let not_near = a.not(near);
            Some(a.and(even, not_near))
        }
    };
    let mut level = a.int_select(descends, lower, walk.level);
    let mut stays_level = crosses;
    if let Some(ascends) = ascends {
        let below_the_root = a.int_less_than(walk.level, root_level);
        let ascends = a.and(ascends, below_the_root);
        let ascends = a.and(ascends, crosses);
        a.name_bit("ascends", ascends);
        let up = a.int_from_bit(ascends);
        level = a.int_add(level, up);
        let not_up = a.not(ascends);
        stays_level = a.and(crosses, not_up);
    }
    let level = a.int_wrap(level, LEVEL_BITS);
    a.name_int("next_level", level);
    let kept = a.and(ended, walk.crossed);
    let crossed = a.or(kept, stays_level);
    a.name_bit("next_crossed", crossed);

    let step = a.int_from_bit(running);
    let steps = a.int_add(walk.steps, step);
    // The guard ends a walk before its counters could overflow.
    let steps = a.int_wrap(steps, COUNTER_BITS);
    a.name_int("next_steps", steps);
    let crossing = a.int_from_bit(crosses);
    let crossings = a.int_add(walk.crossings, crossing);
    let crossings = a.int_wrap(crossings, COUNTER_BITS);
    a.name_int("next_crossings", crossings);
    let hit = a.or(walk.hit, hits);
    a.name_bit("next_hit", hit);
    let bound = a.int_constant(i64::from(shape.step_bound()));
    let at_bound = a.int_equal(steps, bound);
    let no_hit = a.not(hit);
    let bound_reached = a.and(at_bound, no_hit);
    let guard = a.or(walk.guard, bound_reached);
    a.name_bit("next_guard", guard);

    let size_mask = a.int_constant(i64::from(shape.size()) - 1);
    let texel_i = a.int_and(i, size_mask);
    a.name_int("texel_i", texel_i);
    let texel_j = a.int_and(j, size_mask);
    a.name_int("texel_j", texel_j);
    OffsetResult {
        walk: OffsetWalk {
            level,
            i,
            j,
            t,
            crossed,
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

/// The names of an axis's signals.
struct ExitNames {
    backward: &'static str,
    border_index: &'static str,
    border: &'static str,
    distance: &'static str,
    depth: &'static str,
}

static EXIT_U: ExitNames = ExitNames {
    backward: "backward_u",
    border_index: "border_i",
    border: "border_u",
    distance: "border_distance_u",
    depth: "exit_depth_u",
};
static EXIT_V: ExitNames = ExitNames {
    backward: "backward_v",
    border_index: "border_j",
    border: "border_v",
    distance: "border_distance_v",
    depth: "exit_depth_v",
};

/// Where the ray leaves a node on one axis.
struct Exit<A: Arith> {
    /// Index of the border, in units of the node's level.
    border: A::Int,
    /// Depth at which it is reached; infinite if never.
    depth: A::Num,
}

fn exit<A: Arith>(
    a: &mut A,
    names: &'static ExitNames,
    node: A::Int,
    size_exponent: A::Int,
    coordinate: A::Num,
    direction: A::Num,
) -> Exit<A> {
    let backward = a.is_negative(direction);
    a.name_bit(names.backward, backward);
    let forward = a.not(backward);
    let forward = a.int_from_bit(forward);
    let index = a.int_add(node, forward);
    a.name_int(names.border_index, index);
    let border = a.number_from_integer(NearestEven, index, size_exponent);
    a.name_num(names.border, border);
    let distance = a.sub(NearestEven, border, coordinate);
    let distance = a.negate_if(backward, distance);
    a.name_num(names.distance, distance);
    let magnitude = a.magnitude(direction);
    let depth = a.div(NearestEven, distance, magnitude);
    a.name_num(names.depth, depth);
    Exit {
        border: index,
        depth,
    }
}

/// The texel that a rounded position lies in.
fn texel_index<A: Arith>(
    a: &mut A,
    shape: OffsetShape,
    position: A::Num,
    [texels, index]: [&'static str; 2],
) -> A::Int {
    let position = a.scale(position, shape.root_level as i32);
    a.name_num(texels, position);
    let position = a.floor(position, INDEX_BITS);
    a.name_int(index, position);
    position
}

/// Levels to go down: the policy's number until the first crossing and where so many are left.
fn stride<A: Arith>(a: &mut A, policy: SearchPolicy, walk: &OffsetWalk<A>) -> A::Int {
    let one = a.int_constant(1);
    if policy.levels_down == 1 {
        return one;
    }
    let none = a.int_constant(0);
    let uncrossed = a.int_equal(walk.crossings, none);
    a.name_bit("uncrossed", uncrossed);
    let least = a.int_constant(i64::from(policy.levels_down) - 1);
    let is_deep = a.int_less_than(least, walk.level);
    a.name_bit("levels_left", is_deep);
    let leaps = a.and(uncrossed, is_deep);
    a.name_bit("leaps", leaps);
    let most = a.int_constant(i64::from(policy.levels_down));
    a.int_select(leaps, most, one)
}

fn is_even<A: Arith>(a: &mut A, index: A::Int) -> A::Bit {
    let parity = a.int_low_bits(index, 1);
    let zero = a.int_constant(0);
    let even = a.int_equal(parity, zero);
    a.name_bit("border_is_even", even);
    even
}

/// Does the position at the node's depth lie in one of the eight nodes around it?
fn ends_in_neighbour<A: Arith>(
    a: &mut A,
    shape: OffsetShape,
    ray: &OffsetRay<A>,
    depth: A::Num,
    level: A::Int,
    nodes: [A::Int; 2],
) -> A::Bit {
    let axes = [
        (ray.u, ray.du, ["predicted_texels_u", "predicted_i"]),
        (ray.v, ray.dv, ["predicted_texels_v", "predicted_j"]),
    ];
    let two = a.int_constant(2);
    let minus_two = a.int_constant(-2);
    let [(away_u, near_u), (away_v, near_v)] = [0, 1].map(|axis| {
        let (coordinate, direction, names) = axes[axis];
        let travelled = a.mul(NearestEven, depth, direction);
        let predicted = a.add(NearestEven, coordinate, travelled);
        let predicted = texel_index(a, shape, predicted, names);
        let predicted = a.int_shift_right(predicted, level, 4);
        let away = a.int_sub(predicted, nodes[axis]);
        let below_two = a.int_less_than(away, two);
        let above_minus_two = a.int_less_than(minus_two, away);
        (away, a.and(below_two, above_minus_two))
    });
    let near = a.and(near_u, near_v);
    let away = a.int_or(away_u, away_v);
    let zero = a.int_constant(0);
    let same = a.int_equal(away, zero);
    let elsewhere = a.not(same);
    let near = a.and(near, elsewhere);
    a.name_bit("ends_in_neighbour", near);
    near
}

fn one<A: Arith>(a: &mut A) -> A::Num {
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    a.number_from_integer(NearestEven, one, zero)
}

/// A positive number as an odd integer and a power of two, exactly.
fn odd_significand(value: f64) -> (i64, i64) {
    let bits = value.to_bits();
    let (field, fraction) = ((bits >> 52) as i64, bits & ((1 << 52) - 1));
    let (significand, exponent) = match field {
        0 => (fraction, -1074),
        _ => (fraction | (1 << 52), field - 1075),
    };
    let zeros = significand.trailing_zeros();
    (
        (significand >> zeros).cast_signed(),
        exponent + i64::from(zeros),
    )
}

#[cfg(test)]
mod tests {
    use super::odd_significand;

    #[test]
    fn an_offset_is_taken_exactly() {
        for value in [1.0, 0.5, 1e-3, 1e-4, 0.015625, 1e-30] {
            let (significand, exponent) = odd_significand(value);
            assert_eq!(significand as f64 * 2_f64.powi(exponent as i32), value);
            assert_eq!(significand % 2, 1);
        }
    }
}
