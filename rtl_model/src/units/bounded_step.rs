//! One step of a walk by bounds: a line of heights is read, and the depths at which the ray reaches
//! its borders are known to within a unit. Integers only: no divider and no multiplier.
//!
//! Depths of equidistant borders are equidistant, so a border's bound is that of the block's near
//! border and a few times [`BoundedRay::t_delta_u`], shifted by the level: adds. A cell that the
//! ray *may* pass through, and may hit, is a candidate; the candidates of a line are kept as a mask
//! and taken in path order, as in [`super::wide_walk`]. Erring towards more candidates misses
//! nothing. A candidate of level 0 is not yet the hit: [`super::bounded_leaf`] says so exactly, or refuses it,
//! and the walk [resumes](BoundedWalk::resumes) with the next candidate.
//!
//! # The bounds of blocks
//!
//! Of every line level the bounds of the near borders of the block last read there are kept, in a
//! small memory by ray and line number: a step reads the *base* that its block is found from (of the line
//! above, or of the start line's own last block, from which it crosses), and writes its own.

use super::bounded_leaf::SeenCorner;
use super::bounded_line::{bounded_line, depth_of};
use super::bounded_setup::{BoundedRay, by_line};
use super::bounded_shape::{BoundedShape, LINE_BITS, MOST_BOUNDED_LINES, PLACE_BITS};
use super::fixed_setup::{shift_left_by, shift_right_by};
use super::wide_shape::MOST_CELLS;
use super::wide_walk::{First, first_of, mask, select_bit};
use crate::arith::Arith;

/// The registers of a walk that change from step to step, but for the bounds of blocks.
#[derive(Debug)]
pub struct BoundedWalk<A: Arith> {
    /// The line to be read: line `n` has cells of level `n * log2_side`.
    pub line: A::Int,
    /// The near corner of its block on u, in texels, mirrored where the ray is, not wrapped to the
    /// map. After a hit, the texel.
    pub i: A::Int,
    /// The same on v.
    pub j: A::Int,
    /// The block is found from the last block of its own line, and not of the line above.
    pub from_own_line: A::Bit,
    /// So many blocks from there on u: -1 to 3.
    pub column: A::Int,
    /// On v.
    pub row: A::Int,
    /// The candidates kept, by line: bit `n` is the cell of place `n` in path order.
    pub kept: [A::Int; MOST_BOUNDED_LINES],
    /// The ray leaves its block of the start line across u.
    pub leaves_u: A::Bit,
    /// That block was the first of two beside a corner in doubt: the other is next.
    pub leaves_back: A::Bit,
    /// The line has been seen: its candidates are those kept. Set where a leaf is refused.
    pub resumes: A::Bit,
    /// Steps taken: lines read.
    pub steps: A::Int,
    /// Crossings from a block of the start line to the next.
    pub crossings: A::Int,
    /// The walk has come to texel (i, j), for the leaf check to decide.
    pub hit: A::Bit,
    /// The walk has ended at the step bound.
    pub guard: A::Bit,
    /// Height steps from the top to that texel.
    pub depth: A::Int,
}

impl<A: Arith> Clone for BoundedWalk<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for BoundedWalk<A> {}

/// A step's result.
#[derive(Debug)]
pub struct BoundedStepResult<A: Arith> {
    /// The walk after it.
    pub walk: BoundedWalk<A>,
    /// The bounds of the near borders of the block read, on u and v: to be kept as those of its line.
    pub t_near: (A::Int, A::Int),
    /// Of a texel that the walk has come to: what bounds say of its near corner.
    pub corner: SeenCorner<A>,
}

/// The walk before its first step: the start line's own block, whose bounds the setup has made.
pub fn bounded_walk_start<A: Arith>(
    a: &mut A,
    start_line: A::Int,
    i: A::Int,
    j: A::Int,
) -> BoundedWalk<A> {
    let none = a.int_constant(0);
    let no = a.bit_constant(false);
    BoundedWalk {
        line: start_line,
        i,
        j,
        from_own_line: a.bit_constant(true),
        column: none,
        row: none,
        kept: [none; MOST_BOUNDED_LINES],
        leaves_u: no,
        leaves_back: no,
        resumes: no,
        steps: none,
        crossings: none,
        hit: no,
        guard: no,
        depth: none,
    }
}

/// The walk after its leaf was refused, or not.
pub fn bounded_walk_after_leaf<A: Arith>(
    a: &mut A,
    walk: &BoundedWalk<A>,
    refused: A::Bit,
) -> BoundedWalk<A> {
    let accepted = a.not(refused);
    BoundedWalk {
        hit: a.and(walk.hit, accepted),
        resumes: refused,
        ..*walk
    }
}

/// The number of the line whose bounds a step starts from.
pub fn base_line<A: Arith>(a: &mut A, walk: &BoundedWalk<A>) -> A::Int {
    let one = a.int_constant(1);
    let above = a.int_add(walk.line, one);
    let line = a.int_select(walk.from_own_line, walk.line, above);
    let line = a.int_wrap(line, LINE_BITS);
    a.name_int("base_line", line);
    line
}

/// Where the walk's line lies in memory: see [`crate::maps::Lines`].
pub fn bounded_address<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    mirrors: (A::Bit, A::Bit),
    walk: &BoundedWalk<A>,
) -> A::Int {
    let i = a.int_complement_if(mirrors.0, walk.i);
    let j = a.int_complement_if(mirrors.1, walk.j);
    let address = by_line(a, shape, walk.line, |a, n| {
        let index_bits = shape.words.root_level.saturating_sub(shape.block_level(n));
        let marker = a.int_constant(1 << (2 * index_bits));
        if index_bits == 0 {
            return marker;
        }
        let mut index = |texel| {
            let block = shift_right_by(a, texel, shape.block_level(n));
            a.int_low_bits(block, index_bits)
        };
        let (column, row) = (index(i), index(j));
        let row = shift_left_by(a, row, index_bits + 1, index_bits);
        let place = a.int_or(row, column);
        a.int_or(place, marker)
    });
    let address = a.int_low_bits(address, shape.address_bits());
    a.name_int("line_address", address);
    address
}

/// One step of a walk whose line has these heights, row by row, as memory has them; `base` are the
/// bounds kept for its [`base_line`].
pub fn bounded_step<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &BoundedRay<A>,
    walk: &BoundedWalk<A>,
    base: (A::Int, A::Int),
    heights: &[A::Int],
) -> BoundedStepResult<A> {
    let (cell_u, near_u) = near_border(
        a,
        shape,
        &NEAR_U,
        (ray.t_delta_u, walk),
        base.0,
        walk.column,
    );
    let (cell_v, near_v) = near_border(a, shape, &NEAR_V, (ray.t_delta_v, walk), base.1, walk.row);
    let (sight, corners) = bounded_line(a, shape, ray, (near_u, near_v), (cell_u, cell_v), heights);

    let ended = a.or(walk.hit, walk.guard);
    a.name_bit("ended", ended);
    let running = a.not(ended);
    a.name_bit("running", running);
    let zero = a.int_constant(0);
    let one = a.int_constant(1);
    let (lines, count) = (shape.lines(), shape.line_levels());

    // The masks with this line's candidates among them.
    let fresh = mask(a, &sight.candidates[..lines.cells()]);
    a.name_int("candidates", fresh);
    let is_fresh = a.not(walk.resumes);
    let mut masks = walk.kept;
    for (n, mask) in masks[..count].iter_mut().enumerate() {
        let number = a.int_constant(n as i64);
        let is_this = a.int_equal(walk.line, number);
        let is_seen = a.and(is_this, is_fresh);
        *mask = a.int_select(is_seen, fresh, walk.kept[n]);
        a.name_int(MASKS[n], *mask);
    }

    // The lowest line with candidates, and the first of them.
    let mut taken_line = zero;
    let mut taken_mask = masks[count - 1];
    let mut is_empty = [a.bit_constant(false); MOST_BOUNDED_LINES];
    for n in (0..count).rev() {
        is_empty[n] = a.int_equal(masks[n], zero);
        a.name_bit(EMPTY[n], is_empty[n]);
        let number = a.int_constant(n as i64);
        if n + 1 == count {
            taken_line = number;
        } else {
            taken_line = a.int_select(is_empty[n], taken_line, number);
            taken_mask = a.int_select(is_empty[n], taken_mask, masks[n]);
        }
    }
    a.name_int("taken_line", taken_line);
    a.name_int("taken_mask", taken_mask);
    let none_left = a.int_equal(taken_mask, zero);
    a.name_bit("none_left", none_left);
    let First {
        rest,
        first,
        column,
        row,
        ..
    } = first_of(a, lines, taken_mask);

    // Or the next block of the start line.
    let at_start_line = a.int_equal(walk.line, ray.start_line);
    let sees_exit = a.and(at_start_line, running);
    a.name_bit("sees_exit", sees_exit);
    let leaves_u = select_bit(a, sees_exit, sight.leaves_u, walk.leaves_u);
    a.name_bit("next_leaves_u", leaves_u);
    let leaves_back = select_bit(a, sees_exit, sight.leaves_back, walk.leaves_back);
    a.name_bit("next_leaves_back", leaves_back);
    let minus_one = a.int_constant(-1);
    let forward_u = a.int_from_bit(leaves_u);
    let change_u = a.int_select(leaves_back, minus_one, forward_u);
    let stays_on_v = a.not(leaves_back);
    let only_u = a.and(leaves_u, stays_on_v);
    let change_v = a.int_select(only_u, zero, one);

    // The texel where it begins: so many cells or blocks from the block it is found from.
    let found_from = a.int_select(none_left, ray.start_line, taken_line);
    let found_from = a.int_wrap(found_from, LINE_BITS);
    a.name_int("found_from", found_from);
    let ways = [(walk.i, column, change_u), (walk.j, row, change_v)];
    let [i, j] = ways.map(|(texel, place, change)| {
        let kept = by_line(a, shape, found_from, |a, n| {
            a.int_constant(-1 << shape.block_level(n))
        });
        let block = a.int_and(texel, kept);
        let blocks = shift_left_by(a, change, 2, shape.log2_side);
        let way = a.int_select(none_left, blocks, place);
        let way_bits = shape.log2_side + 2;
        let way = a.int_wrap(way, way_bits);
        let way = by_line(a, shape, found_from, |a, n| {
            shift_left_by(a, way, way_bits, lines.line_level(n))
        });
        let next = a.int_add(block, way);
        let next = a.int_select(ended, texel, next);
        // A ray within reach stays within the index's bits.
        a.int_wrap(next, shape.index_bits())
    });
    a.name_int("next_i", i);
    a.name_int("next_j", j);

    // The registers after the step.
    let on_map = a.not(is_empty[0]);
    let hits = a.and(on_map, running);
    a.name_bit("hits", hits);
    let hit = a.or(walk.hit, hits);
    a.name_bit("next_hit", hit);
    let line_below = a.int_sub(taken_line, one);
    let line = a.int_select(none_left, ray.start_line, line_below);
    // At a leaf it stays at its line, should that be refused.
    let line = a.int_select(is_empty[0], line, zero);
    let line = a.int_select(ended, walk.line, line);
    let line = a.int_wrap(line, LINE_BITS);
    a.name_int("next_line", line);
    let own = a.or(none_left, on_map);
    let from_own_line = select_bit(a, ended, walk.from_own_line, own);
    a.name_bit("next_from_own_line", from_own_line);
    let places = [(walk.column, column, change_u), (walk.row, row, change_v)];
    let [next_column, next_row] = places.map(|(before, place, change)| {
        let next = a.int_select(none_left, change, place);
        let next = a.int_select(is_empty[0], next, zero);
        let next = a.int_select(ended, before, next);
        a.int_wrap(next, PLACE_BITS)
    });
    a.name_int("next_column", next_column);
    a.name_int("next_row", next_row);
    let mut kept = walk.kept;
    for n in 0..count {
        let number = a.int_constant(n as i64);
        let is_taken = a.int_equal(taken_line, number);
        kept[n] = a.int_select(is_taken, rest, masks[n]);
        kept[n] = a.int_select(ended, walk.kept[n], kept[n]);
        kept[n] = a.int_low_bits(kept[n], lines.cells() as u32);
        a.name_int(NEXT_KEPT[n], kept[n]);
    }

    // The depth of the texel, of the line read.
    let depth = leaf_depth(a, shape, ray, (column, row), heights);
    let depth = a.int_select(hits, depth, walk.depth);
    let depth = a.int_low_bits(depth, shape.words.height_bits);
    a.name_int("next_depth", depth);

    let step = a.int_from_bit(running);
    let steps = a.int_add(walk.steps, step);
    // The guard ends a walk before its counters could overflow.
    let steps = a.int_wrap(steps, shape.counter_bits());
    a.name_int("next_steps", steps);
    let crosses = a.and(none_left, running);
    let crossing = a.int_from_bit(crosses);
    let crossings = a.int_add(walk.crossings, crossing);
    let crossings = a.int_wrap(crossings, shape.counter_bits());
    a.name_int("next_crossings", crossings);
    let step_bound = a.int_constant(shape.step_bound().into());
    let at_bound = a.int_equal(steps, step_bound);
    let no_hit = a.not(hit);
    let bound_reached = a.and(at_bound, no_hit);
    let guard = a.or(walk.guard, bound_reached);
    a.name_bit("next_guard", guard);

    // A texel is of the line read, so that these are its borders.
    let of_first = [corners.are_known, corners.v_is_later].map(|cells| {
        let of_first = a.int_and(cells, first);
        let is_not = a.int_equal(of_first, zero);
        a.not(is_not)
    });
    let corner = SeenCorner {
        is_known: of_first[0],
        v_is_later: of_first[1],
    };
    a.name_bit("corner_is_known", corner.is_known);
    a.name_bit("v_is_later", corner.v_is_later);

    BoundedStepResult {
        walk: BoundedWalk {
            line,
            i,
            j,
            from_own_line,
            column: next_column,
            row: next_row,
            kept,
            leaves_u,
            leaves_back,
            resumes: a.bit_constant(false),
            steps,
            crossings,
            hit,
            guard,
            depth,
        },
        t_near: (near_u, near_v),
        corner,
    }
}

struct NearNames {
    cell: &'static str,
    near: &'static str,
}

const NEAR_U: NearNames = NearNames {
    cell: "t_cell_u",
    near: "t_near_u",
};
const NEAR_V: NearNames = NearNames {
    cell: "t_cell_v",
    near: "t_near_v",
};

/// The depth between two borders of the line's cells, and the bound of its block's near border.
fn near_border<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    names: &NearNames,
    (t_delta, walk): (A::Int, &BoundedWalk<A>),
    base: A::Int,
    blocks: A::Int,
) -> (A::Int, A::Int) {
    let bits = shape.bound_bits();
    let cell = by_line(a, shape, walk.line, |a, n| {
        let level = shape.lines().line_level(n);
        let cell = shift_left_by(a, t_delta, shape.delta_bits() + 1, level);
        a.int_wrap(cell, bits)
    });
    a.name_int(names.cell, cell);
    let block = shift_left_by(a, cell, bits, shape.log2_side);
    let block = a.int_wrap(block, bits);
    // So many blocks on, or one back: less is added with all bits inverted and a one carried in, by a
    // bit below the last on either side.
    let zero = a.int_constant(0);
    let one = a.int_constant(1);
    let is_back = a.int_less_than(blocks, zero);
    let mut way = zero;
    for place in 1..1_i64 << shape.log2_side {
        let number = a.int_constant(place);
        let is_here = a.int_equal(blocks, number);
        let times = match place {
            1 => {
                let is_one = a.or(is_here, is_back);
                way = a.int_select(is_one, block, way);
                continue;
            }
            2 => shift_left_by(a, block, bits, 1),
            _ => {
                let twice = shift_left_by(a, block, bits, 1);
                a.int_add(twice, block)
            }
        };
        way = a.int_select(is_here, times, way);
    }
    let way = a.int_complement_if(is_back, way);
    let way = a.int_wrap(way, bits);
    let carry = a.int_from_bit(is_back);
    let way = a.int_shift_left(way, one, 1);
    let way = a.int_or(way, carry);
    let base = a.int_shift_left(base, one, 1);
    let base = a.int_or(base, carry);
    let sum = a.int_add(base, way);
    let near = shift_right_by(a, sum, 1);
    // What every border of a block is between.
    let near = a.int_wrap(near, bits);
    a.name_int(names.near, near);
    (cell, near)
}

/// The depth of the cell at this column and row.
fn leaf_depth<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &BoundedRay<A>,
    (column, row): (A::Int, A::Int),
    heights: &[A::Int],
) -> A::Int {
    let side = shape.lines().side();
    let column = a.int_complement_if(ray.fixed.mirror_u, column);
    let column = a.int_low_bits(column, shape.log2_side);
    let row = a.int_complement_if(ray.fixed.mirror_v, row);
    let row = a.int_low_bits(row, shape.log2_side);
    let mut height = [heights[0]; MOST_CELLS];
    height[..heights.len()].copy_from_slice(heights);
    // The row first: the first words are then that row.
    for (place, stride) in [(row, side), (column, 1)] {
        for n in 1..side {
            let number = a.int_constant(n as i64);
            let is_here = a.int_equal(place, number);
            for word in 0..stride {
                height[word] = a.int_select(is_here, height[n * stride + word], height[word]);
            }
        }
    }
    depth_of(a, shape, height[0])
}

const MASKS: [&str; MOST_BOUNDED_LINES] =
    ["mask_0", "mask_1", "mask_2", "mask_3", "mask_4", "mask_5"];
const EMPTY: [&str; MOST_BOUNDED_LINES] = [
    "empty_0", "empty_1", "empty_2", "empty_3", "empty_4", "empty_5",
];
const NEXT_KEPT: [&str; MOST_BOUNDED_LINES] = [
    "next_kept_0",
    "next_kept_1",
    "next_kept_2",
    "next_kept_3",
    "next_kept_4",
    "next_kept_5",
];

/// The registers of the candidates kept.
pub(super) const MASK_NAMES: [&str; MOST_BOUNDED_LINES] =
    ["kept_0", "kept_1", "kept_2", "kept_3", "kept_4", "kept_5"];
