//! What a wide walk does once it knows which cells of a line are candidates: integers and bits
//! alone, the same in every number format.
//!
//! A cell is a *candidate* if the ray's path runs through it and its surface is not below the ray
//! where the ray leaves it. The walk takes the first candidate in path order
//! ([`WideShape::path_order`]) and reads that cell's own line next; the others it keeps as a mask of
//! the line's level. A line without candidates sends it to the first one kept at the lowest level,
//! and where none is kept to the next block of the start level. So no line is read twice, and the
//! state holds no depth: a candidate of level 0 *is* the hit, since all that lies before it on the
//! path has been ruled out.

use super::traverse_step::{INDEX_BITS, LEVEL_BITS};
use super::wide_shape::{MOST_CELLS, MOST_LINE_LEVELS, WIDE_COUNTER_BITS, WideShape};
use crate::arith::Arith;
use crate::ray::REACH_TEXELS;

/// The registers of a wide walk that change from step to step, but for what the hit's depth is.
#[derive(Debug)]
pub struct WideWalk<A: Arith> {
    /// Level of the cells of the line to be read; 0 is the map itself.
    pub level: A::Int,
    /// Index of the line's block on u, mirrored where the ray is, not wrapped to the map. After a
    /// hit, the texel.
    pub i: A::Int,
    /// Index of the line's block on v.
    pub j: A::Int,
    /// The candidates kept, by line level: bit `n` is the cell of place `n` in path order. Those of
    /// level 0 are never kept, so the first is zero.
    pub kept: [A::Int; MOST_LINE_LEVELS],
    /// The ray leaves its block of the start level across u.
    pub leaves_u: A::Bit,
    /// That block was the first of two beside a corner in doubt: the other is next.
    pub leaves_back: A::Bit,
    /// Steps taken: lines read.
    pub steps: A::Int,
    /// Crossings from a block of the start level to the next.
    pub crossings: A::Int,
    /// The walk has ended in a hit: level 0, texel (i, j).
    pub hit: A::Bit,
    /// The walk has ended at the step bound.
    pub guard: A::Bit,
}

impl<A: Arith> Clone for WideWalk<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for WideWalk<A> {}

/// What geometry says about a line.
pub(super) struct Sight<A: Arith> {
    /// Is the cell of this place in path order a candidate? As many as the line has cells.
    pub(super) candidates: [A::Bit; MOST_CELLS],
    /// Does the ray leave the line's block across u?
    pub(super) leaves_u: A::Bit,
    /// Is the block the first of two beside a corner in doubt?
    pub(super) leaves_back: A::Bit,
}

/// What a step comes to.
pub(super) struct Advance<A: Arith> {
    /// The walk after it.
    pub(super) walk: WideWalk<A>,
    /// This step hits.
    pub(super) hits: A::Bit,
    /// The cell taken, if any: its place in path order.
    pub(super) place: A::Int,
    /// Its column in its line.
    pub(super) column: A::Int,
    /// Its row.
    pub(super) row: A::Int,
}

/// The walk before its first step: at the block of the start level that holds this texel.
pub(super) fn wide_walk_start<A: Arith>(
    a: &mut A,
    shape: WideShape,
    start_level: A::Int,
    texel_i: A::Int,
    texel_j: A::Int,
) -> WideWalk<A> {
    let log2_side = a.int_constant(shape.log2_side.into());
    let block_level = a.int_add(start_level, log2_side);
    let block_level = a.int_low_bits(block_level, 4);
    a.name_int("start_block_level", block_level);
    let i = a.int_shift_right(texel_i, block_level, 4);
    a.name_int("start_block_i", i);
    let j = a.int_shift_right(texel_j, block_level, 4);
    a.name_int("start_block_j", j);
    let none = a.int_constant(0);
    let no = a.bit_constant(false);
    WideWalk {
        level: start_level,
        i,
        j,
        kept: [none; MOST_LINE_LEVELS],
        leaves_u: no,
        leaves_back: no,
        steps: none,
        crossings: none,
        hit: no,
        guard: no,
    }
}

/// The level that a walk starts at: by how many levels' reach the ray has.
pub(super) fn start_level<A: Arith>(
    a: &mut A,
    shape: WideShape,
    mut reaches: impl FnMut(&mut A, u32) -> A::Bit,
) -> A::Int {
    let mut level = a.int_constant(0);
    for n in 1..shape.line_levels() {
        let higher = shape.line_level(n);
        if 1 << shape.start_reach_log2(higher) > REACH_TEXELS as u32 {
            break;
        }
        let reaches = reaches(a, shape.start_reach_log2(higher));
        let higher = a.int_constant(higher.into());
        level = a.int_select(reaches, higher, level);
    }
    a.name_int("start_level", level);
    level
}

/// Where the walk's line lies in memory (the layout is [`crate::maps::Lines`]'s): a one, then the
/// block's index on v, then on u.
pub(super) fn wide_address<A: Arith>(
    a: &mut A,
    shape: WideShape,
    mirror_u: A::Bit,
    mirror_v: A::Bit,
    walk: &WideWalk<A>,
) -> A::Int {
    let top = i64::from(shape.root_level) - i64::from(shape.log2_side);
    let top = a.int_constant(top);
    let below_root = a.int_sub(top, walk.level);
    let zero = a.int_constant(0);
    let above_root = a.int_less_than(below_root, zero);
    a.name_bit("block_is_above_root", above_root);
    let below_root = a.int_select(above_root, zero, below_root);
    let below_root = a.int_low_bits(below_root, 4);
    a.name_int("block_below_root", below_root);
    let one = a.int_constant(1);
    let blocks = a.int_shift_left(one, below_root, 4);
    let blocks = a.int_wrap(blocks, INDEX_BITS);
    a.name_int("blocks_on_a_side", blocks);
    let index_mask = a.int_sub(blocks, one);
    a.name_int("index_mask", index_mask);
    let i = a.int_complement_if(mirror_u, walk.i);
    let i = a.int_and(i, index_mask);
    a.name_int("wrapped_i", i);
    let j = a.int_complement_if(mirror_v, walk.j);
    let j = a.int_and(j, index_mask);
    a.name_int("wrapped_j", j);
    let j = a.int_or(j, blocks);
    let row = a.int_shift_left(j, below_root, 4);
    let address = a.int_or(row, i);
    // Marker, v and u take 2 * block_below_root + 1 bits, so nothing but zeros is cut.
    let address = a.int_low_bits(address, shape.address_bits());
    a.name_int("line_address", address);
    address
}

/// The heights of a line, which memory has row by row, in path order of a mirrored ray.
pub(super) fn in_path_order<A: Arith>(
    a: &mut A,
    shape: WideShape,
    mirror_u: A::Bit,
    mirror_v: A::Bit,
    heights: &[A::Int],
) -> [A::Int; MOST_CELLS] {
    let side = shape.side();
    let mut words = [heights[0]; MOST_CELLS];
    for (word, &height) in words.iter_mut().zip(heights) {
        // A height has no sign; from here on it is an integer like others.
        *word = a.int_low_bits(height, shape.height_bits);
    }
    let heights = words;
    let mut ordered = heights;
    for (place, &(column, row)) in shape.path_order().iter().enumerate() {
        let far_column = side - 1 - column;
        let far_row = side - 1 - row;
        let near = a.int_select(
            mirror_u,
            heights[row * side + far_column],
            heights[row * side + column],
        );
        let far = a.int_select(
            mirror_u,
            heights[far_row * side + far_column],
            heights[far_row * side + column],
        );
        ordered[place] = a.int_select(mirror_v, far, near);
        a.name_int(CELL_HEIGHTS[place], ordered[place]);
    }
    ordered
}

/// The walk's next registers.
pub(super) fn advance<A: Arith>(
    a: &mut A,
    shape: WideShape,
    start_level: A::Int,
    walk: &WideWalk<A>,
    sight: &Sight<A>,
) -> Advance<A> {
    let ended = a.or(walk.hit, walk.guard);
    a.name_bit("ended", ended);
    let running = a.not(ended);
    a.name_bit("running", running);
    let zero = a.int_constant(0);
    let one = a.int_constant(1);

    // The masks with this line's candidates among them.
    let fresh = mask(a, &sight.candidates[..shape.cells()]);
    a.name_int("candidates", fresh);
    let line_levels = shape.line_levels();
    let mut masks = [zero; MOST_LINE_LEVELS];
    for (n, mask) in masks[..line_levels].iter_mut().enumerate() {
        let level = a.int_constant(shape.line_level(n).into());
        let is_this = a.int_equal(walk.level, level);
        *mask = a.int_select(is_this, fresh, walk.kept[n]);
        a.name_int(MASKS[n], *mask);
    }

    // The lowest level with candidates, and the first of them.
    let mut taken_level = zero;
    let mut taken_mask = masks[line_levels - 1];
    let mut is_empty = [a.bit_constant(false); MOST_LINE_LEVELS];
    for n in (0..line_levels).rev() {
        is_empty[n] = a.int_equal(masks[n], zero);
        a.name_bit(EMPTY[n], is_empty[n]);
        let level = a.int_constant(shape.line_level(n).into());
        if n + 1 == line_levels {
            taken_level = level;
        } else {
            taken_level = a.int_select(is_empty[n], taken_level, level);
            taken_mask = a.int_select(is_empty[n], taken_mask, masks[n]);
        }
    }
    a.name_int("taken_level", taken_level);
    a.name_int("taken_mask", taken_mask);
    let none_left = a.int_equal(taken_mask, zero);
    a.name_bit("none_left", none_left);
    let First {
        rest,
        place,
        column,
        row,
        ..
    } = first_of(a, shape, taken_mask);

    // Its index: that of the block it lies in, and its place there.
    let up = a.int_sub(taken_level, walk.level);
    let up = a.int_low_bits(up, 4);
    a.name_int("levels_up", up);
    let log2_side = a.int_constant(shape.log2_side.into());
    let cell_i = cell_index(a, walk.i, up, log2_side, column);
    a.name_int("taken_i", cell_i);
    let cell_j = cell_index(a, walk.j, up, log2_side, row);
    a.name_int("taken_j", cell_j);

    // Or the next block of the start level.
    let at_start_level = a.int_equal(walk.level, start_level);
    a.name_bit("at_start_level", at_start_level);
    let sees_exit = a.and(at_start_level, running);
    a.name_bit("sees_exit", sees_exit);
    let leaves_u = select_bit(a, sees_exit, sight.leaves_u, walk.leaves_u);
    a.name_bit("next_leaves_u", leaves_u);
    let leaves_back = select_bit(a, sees_exit, sight.leaves_back, walk.leaves_back);
    a.name_bit("next_leaves_back", leaves_back);
    let to_start_level = a.int_sub(start_level, walk.level);
    let to_start_level = a.int_low_bits(to_start_level, 4);
    a.name_int("to_start_level", to_start_level);
    let minus_one = a.int_constant(-1);
    let forward_i = a.int_from_bit(leaves_u);
    let change_i = a.int_select(leaves_back, minus_one, forward_i);
    a.name_int("change_i", change_i);
    let stays_on_v = a.not(leaves_back);
    let only_u = a.and(leaves_u, stays_on_v);
    let change_j = a.int_select(only_u, zero, one);
    a.name_int("change_j", change_j);
    let start_i = a.int_shift_right(walk.i, to_start_level, 4);
    let next_i = a.int_add(start_i, change_i);
    a.name_int("next_block_i", next_i);
    let start_j = a.int_shift_right(walk.j, to_start_level, 4);
    let next_j = a.int_add(start_j, change_j);
    a.name_int("next_block_j", next_j);

    // The registers after the step.
    let on_map = a.not(is_empty[0]);
    let hits = a.and(on_map, running);
    a.name_bit("hits", hits);
    let hit = a.or(walk.hit, hits);
    a.name_bit("next_hit", hit);
    let crosses = a.and(none_left, running);
    a.name_bit("crosses", crosses);
    let level_below = a.int_sub(taken_level, log2_side);
    let level = a.int_select(none_left, start_level, level_below);
    // A hit is at level 0 already.
    let level = a.int_select(is_empty[0], level, zero);
    let level = a.int_select(ended, walk.level, level);
    let level = a.int_wrap(level, LEVEL_BITS);
    a.name_int("next_level", level);
    let i = a.int_select(none_left, next_i, cell_i);
    let i = a.int_select(ended, walk.i, i);
    // A ray within reach stays within the index's bits.
    let i = a.int_wrap(i, INDEX_BITS);
    a.name_int("next_i", i);
    let j = a.int_select(none_left, next_j, cell_j);
    let j = a.int_select(ended, walk.j, j);
    let j = a.int_wrap(j, INDEX_BITS);
    a.name_int("next_j", j);
    let mut kept = [zero; MOST_LINE_LEVELS];
    for n in 1..line_levels {
        let level = a.int_constant(shape.line_level(n).into());
        let is_taken = a.int_equal(taken_level, level);
        kept[n] = a.int_select(is_taken, rest, masks[n]);
        kept[n] = a.int_select(ended, walk.kept[n], kept[n]);
        kept[n] = a.int_low_bits(kept[n], shape.cells() as u32);
        a.name_int(NEXT_KEPT[n], kept[n]);
    }

    let step = a.int_from_bit(running);
    let steps = a.int_add(walk.steps, step);
    // The guard ends a walk before its counters could overflow.
    let steps = a.int_wrap(steps, WIDE_COUNTER_BITS);
    a.name_int("next_steps", steps);
    let crossing = a.int_from_bit(crosses);
    let crossings = a.int_add(walk.crossings, crossing);
    let crossings = a.int_wrap(crossings, WIDE_COUNTER_BITS);
    a.name_int("next_crossings", crossings);
    let step_bound = a.int_constant(shape.step_bound().into());
    let at_bound = a.int_equal(steps, step_bound);
    a.name_bit("at_bound", at_bound);
    let no_hit = a.not(hit);
    let bound_reached = a.and(at_bound, no_hit);
    let guard = a.or(walk.guard, bound_reached);
    a.name_bit("next_guard", guard);

    Advance {
        walk: WideWalk {
            level,
            i,
            j,
            kept,
            leaves_u,
            leaves_back,
            steps,
            crossings,
            hit,
            guard,
        },
        hits,
        place,
        column,
        row,
    }
}

/// The texel of a walk that has hit, on one axis, wrapped to the map.
pub(super) fn wide_texel<A: Arith>(
    a: &mut A,
    shape: WideShape,
    mirror: A::Bit,
    index: A::Int,
) -> A::Int {
    let index = a.int_complement_if(mirror, index);
    let size_mask = a.int_constant(i64::from(shape.size()) - 1);
    a.int_and(index, size_mask)
}

/// The first cell of a mask, and what the mask is without it.
pub(super) struct First<A: Arith> {
    pub(super) rest: A::Int,
    /// The cell alone.
    pub(super) first: A::Int,
    /// Its place in path order, its column and its row.
    pub(super) place: A::Int,
    pub(super) column: A::Int,
    pub(super) row: A::Int,
}

pub(super) fn first_of<A: Arith>(a: &mut A, shape: WideShape, taken_mask: A::Int) -> First<A> {
    let zero = a.int_constant(0);
    let one = a.int_constant(1);
    let below = a.int_sub(taken_mask, one);
    let rest = a.int_and(taken_mask, below);
    a.name_int("rest_of_mask", rest);
    let first = a.int_sub(taken_mask, rest);
    let first = a.int_low_bits(first, shape.cells() as u32);
    a.name_int("first_of_mask", first);
    let place = a.int_bit_length(first);
    let place = a.int_sub(place, one);
    // Bit lengths are up to the number of cells; of an empty mask the place does not matter.
    let place = a.int_low_bits(place, 2 * shape.log2_side);
    a.name_int("taken_place", place);
    let (mut column, mut row) = (zero, zero);
    for (n, &(c, r)) in shape.path_order().iter().enumerate().skip(1) {
        let n = a.int_constant(n as i64);
        let is_here = a.int_equal(place, n);
        let c = a.int_constant(c as i64);
        column = a.int_select(is_here, c, column);
        let r = a.int_constant(r as i64);
        row = a.int_select(is_here, r, row);
    }
    a.name_int("taken_column", column);
    a.name_int("taken_row", row);
    First {
        rest,
        first,
        place,
        column,
        row,
    }
}

fn cell_index<A: Arith>(
    a: &mut A,
    block: A::Int,
    up: A::Int,
    log2_side: A::Int,
    place: A::Int,
) -> A::Int {
    let block = a.int_shift_right(block, up, 4);
    let first_cell = a.int_shift_left(block, log2_side, 2);
    a.int_or(first_cell, place)
}

/// Bits as an integer, the first the lowest.
pub(super) fn mask<A: Arith>(a: &mut A, bits: &[A::Bit]) -> A::Int {
    let zero = a.int_constant(0);
    let mut mask = zero;
    for (n, &bit) in bits.iter().enumerate() {
        let one = a.int_constant(1 << n);
        let bit = a.int_select(bit, one, zero);
        mask = a.int_or(mask, bit);
    }
    mask
}

pub(super) fn select_bit<A: Arith>(
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

const CELL_HEIGHTS: [&str; MOST_CELLS] = [
    "cell_height_0",
    "cell_height_1",
    "cell_height_2",
    "cell_height_3",
    "cell_height_4",
    "cell_height_5",
    "cell_height_6",
    "cell_height_7",
    "cell_height_8",
    "cell_height_9",
    "cell_height_10",
    "cell_height_11",
    "cell_height_12",
    "cell_height_13",
    "cell_height_14",
    "cell_height_15",
];
const MASKS: [&str; MOST_LINE_LEVELS] = [
    "mask_0", "mask_1", "mask_2", "mask_3", "mask_4", "mask_5", "mask_6", "mask_7", "mask_8",
    "mask_9", "mask_10", "mask_11",
];
const EMPTY: [&str; MOST_LINE_LEVELS] = [
    "empty_0", "empty_1", "empty_2", "empty_3", "empty_4", "empty_5", "empty_6", "empty_7",
    "empty_8", "empty_9", "empty_10", "empty_11",
];
const NEXT_KEPT: [&str; MOST_LINE_LEVELS] = [
    "next_kept_0",
    "next_kept_1",
    "next_kept_2",
    "next_kept_3",
    "next_kept_4",
    "next_kept_5",
    "next_kept_6",
    "next_kept_7",
    "next_kept_8",
    "next_kept_9",
    "next_kept_10",
    "next_kept_11",
];
