//! One step of a wide walk, methods `quad` and `block`, in exact fixed point: integers only, and no
//! divider.
//!
//! What a step does, and every tie, is that of [`super::wide_step`]; what it goes on with is
//! the very same code ([`super::wide_walk`]). No decision is rounded, so a walk reads the lines of the
//! quantised ray's own path, and the first candidate of level 0 is the hit of the definition.
//!
//! - *On the path*: the ray crosses column border c no later than row border r iff the error term
//!   of the point where they meet is not above zero (see [`super::fixed_setup`]). The walk carries the
//!   term of its block's near corner; from there to any other point of the line is a sum of slopes
//!   shifted, and to the next block a product with a short distance in texels.
//! - *Candidate*: the position at the cell's depth, `(entry << height_bits) + n * slope`, is beyond
//!   the far border of the cell on neither axis. Of the cells with the same sum of column and row
//!   the ray meets one, which is chosen before it is multiplied: 14 multipliers for 4 x 4 cells,
//!   6 for 2 x 2.

use super::fixed_answer::{FixedAnswer, fixed_answer};
use super::fixed_setup::{FixedRayRegisters, fixed_mirror, shift_left_by, shift_right_by};
use super::fixed_shape::FixedShape;
use super::fixed_step::FixedWalkRegisters;
use super::traverse_step::INDEX_BITS;
use super::wide_shape::{MOST_CELLS, MOST_SIDE, WideShape};
use super::wide_step::{CANDIDATES, ON_PATH};
use super::wide_walk::{Sight, WideWalk, advance, in_path_order, start_level, wide_walk_start};
use crate::arith::Arith;

/// Sums of column and row in a line: one less than twice the side.
const MOST_RANKS: usize = 2 * MOST_SIDE - 1;

/// What an exact fixed-point wide unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct WideFixedShape {
    /// The words of its numbers.
    pub words: FixedShape,
    /// log2 of the cells on a side of a line: 1 or 2.
    pub log2_side: u32,
}

impl WideFixedShape {
    /// The lines and their path order.
    pub const fn lines(self) -> WideShape {
        WideShape {
            root_level: self.words.root_level,
            height_bits: self.words.height_bits,
            log2_side: self.log2_side,
        }
    }

    /// log2 of the texels on a side of the largest block. It may be above the root.
    pub const fn block_level(self) -> u32 {
        self.lines().line_level(self.lines().line_levels())
    }

    /// Bits of the error term of a block that the ray passes through, signed: the near corner is off
    /// the ray by at most the block's side along either axis.
    pub const fn error_bits(self) -> u32 {
        self.block_level() + self.words.entry_fraction_bits + self.words.slope_bits + 1
    }

    /// Bits of the error term anywhere in the line, signed: the slopes may add up.
    pub const fn line_error_bits(self) -> u32 {
        self.error_bits() + 1
    }
}

/// The registers of a walk that change from step to step.
#[derive(Debug)]
pub struct WideFixedWalk<A: Arith> {
    /// What every wide walk has.
    pub walk: WideWalk<A>,
    /// The error term at the near corner of the block, of [`WideFixedShape::error_bits`] bits; after
    /// a hit, of the texel.
    pub error: A::Int,
    /// Height steps from the top to the texel hit.
    pub depth: A::Int,
    /// The hit is on the texel's side, where the ray crosses its near border on u.
    pub at_border_u: A::Bit,
    /// The same on v.
    pub at_border_v: A::Bit,
}

impl<A: Arith> Clone for WideFixedWalk<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for WideFixedWalk<A> {}

/// A ray set up for a wide walk.
#[derive(Debug)]
pub struct WideFixedSetUpRay<A: Arith> {
    /// What stays, as of every exact fixed-point walk.
    pub ray: FixedRayRegisters<A>,
    /// The level of the lines that the walk starts with, and crosses at.
    pub start_level: A::Int,
    /// The walk before its first step.
    pub walk: WideFixedWalk<A>,
}

/// Sets up a quantised ray: see [`super::fixed_setup::fixed_setup`].
pub fn wide_fixed_setup<A: Arith>(
    a: &mut A,
    shape: WideFixedShape,
    u: A::Int,
    v: A::Int,
    du: A::Int,
    dv: A::Int,
) -> WideFixedSetUpRay<A> {
    let words = shape.words;
    let ray = fixed_mirror(a, words, u, v, du, dv);
    let u_is_longer = a.int_less_than(ray.slope_v, ray.slope_u);
    let slope = a.int_select(u_is_longer, ray.slope_u, ray.slope_v);
    // Times the full height, which is all ones.
    let longer = shift_left_by(a, slope, words.slope_bits + 1, words.height_bits);
    let longer = a.int_sub(longer, slope);
    a.name_int("longer_travel", longer);
    let start_level = start_level(a, shape.lines(), |a, texels_log2| {
        let below = a.int_constant((1 << (texels_log2 + words.fraction_bits())) - 1);
        a.int_less_than(below, longer)
    });
    let texel_i = entry_texel(a, words, ray.u);
    a.name_int("entry_i", texel_i);
    let texel_j = entry_texel(a, words, ray.v);
    a.name_int("entry_j", texel_j);
    let walk = wide_walk_start(a, shape.lines(), start_level, texel_i, texel_j);
    let behind_u = near_distance(a, shape, ray.u, &walk, walk.i);
    a.name_int("behind_u", behind_u);
    let behind_v = near_distance(a, shape, ray.v, &walk, walk.j);
    a.name_int("behind_v", behind_v);
    let product_u = a.int_mul(behind_u, ray.slope_v);
    let product_v = a.int_mul(behind_v, ray.slope_u);
    let error = a.int_sub(product_u, product_v);
    let error = a.int_wrap(error, shape.error_bits());
    a.name_int("start_error", error);
    let no = a.bit_constant(false);
    WideFixedSetUpRay {
        ray,
        start_level,
        walk: WideFixedWalk {
            walk,
            error,
            depth: a.int_constant(0),
            at_border_u: no,
            at_border_v: no,
        },
    }
}

fn entry_texel<A: Arith>(a: &mut A, words: FixedShape, entry: A::Int) -> A::Int {
    let texel = shift_right_by(a, entry, words.entry_fraction_bits);
    a.int_wrap(texel, words.root_level + 1)
}

/// From the entry back to the near border of the walk's first block, on one axis: zero or below.
fn near_distance<A: Arith>(
    a: &mut A,
    shape: WideFixedShape,
    entry: A::Int,
    walk: &WideWalk<A>,
    block: A::Int,
) -> A::Int {
    let words = shape.words;
    let near = first_texel(a, shape, walk.level, block);
    // The block holds the entry, which is within a map of the origin.
    let bits = shape.block_level() + 1;
    let near = a.int_wrap(near, bits);
    let near = shift_left_by(a, near, bits, words.entry_fraction_bits);
    let behind = a.int_sub(near, entry);
    a.int_wrap(behind, bits + words.entry_fraction_bits)
}

/// The first texel of a block, on one axis.
fn first_texel<A: Arith>(a: &mut A, shape: WideFixedShape, level: A::Int, block: A::Int) -> A::Int {
    let log2_side = a.int_constant(shape.log2_side.into());
    let cell = a.int_shift_left(block, log2_side, 2);
    let cell = a.int_wrap(cell, INDEX_BITS);
    let shift = a.int_low_bits(level, 4);
    let texel = a.int_shift_left(cell, shift, 4);
    a.int_wrap(texel, INDEX_BITS)
}

/// The borders of a line's columns or rows.
struct FixedBorders<A: Arith> {
    /// Their positions, as [`FixedShape::position_bits`] says.
    positions: [A::Int; MOST_SIDE + 1],
    /// The ray starts on them or behind them.
    is_behind: [A::Bit; MOST_SIDE + 1],
    /// What each adds to the error term of the near corner: the slope on the other axis times the
    /// way there.
    error: [A::Int; MOST_SIDE + 1],
}

struct FixedBorderNames {
    first_texel: &'static str,
    positions: [&'static str; MOST_SIDE + 1],
    is_behind: [&'static str; MOST_SIDE + 1],
    span: &'static str,
}

const BORDERS_U: FixedBorderNames = FixedBorderNames {
    first_texel: "first_texel_u",
    positions: [
        "border_u_0",
        "border_u_1",
        "border_u_2",
        "border_u_3",
        "border_u_4",
    ],
    is_behind: [
        "border_u_0_is_behind",
        "border_u_1_is_behind",
        "border_u_2_is_behind",
        "border_u_3_is_behind",
        "border_u_4_is_behind",
    ],
    span: "column_span",
};
const BORDERS_V: FixedBorderNames = FixedBorderNames {
    first_texel: "first_texel_v",
    positions: [
        "border_v_0",
        "border_v_1",
        "border_v_2",
        "border_v_3",
        "border_v_4",
    ],
    is_behind: [
        "border_v_0_is_behind",
        "border_v_1_is_behind",
        "border_v_2_is_behind",
        "border_v_3_is_behind",
        "border_v_4_is_behind",
    ],
    span: "row_span",
};

fn fixed_borders<A: Arith>(
    a: &mut A,
    shape: WideFixedShape,
    names: &FixedBorderNames,
    level: A::Int,
    block: A::Int,
    entry: A::Int,
    other_slope: A::Int,
) -> FixedBorders<A> {
    let words = shape.words;
    let first = first_texel(a, shape, level, block);
    a.name_int(names.first_texel, first);
    let shift = a.int_low_bits(level, 4);
    let zero = a.int_constant(0);
    // A cell's side in texels, and in the units of a position: at most the map's, since lines lie
    // below the root.
    let one = a.int_constant(1);
    let cell = a.int_shift_left(one, shift, 4);
    let cell = a.int_wrap(cell, words.root_level + 2);
    let entry = shift_left_by(a, entry, words.entry_bits(), words.height_bits);
    // The slope on the other axis times that side.
    let span = a.int_shift_left(other_slope, shift, 4);
    let span_bits = words.root_level + words.slope_bits + 1;
    let span = a.int_wrap(span, span_bits);
    let span = shift_left_by(a, span, span_bits, words.entry_fraction_bits);
    a.name_int(names.span, span);
    let mut texel = first;
    let mut sum = zero;
    let mut borders = FixedBorders {
        positions: [zero; MOST_SIDE + 1],
        is_behind: [a.bit_constant(false); MOST_SIDE + 1],
        error: [zero; MOST_SIDE + 1],
    };
    for n in 0..=shape.lines().side() {
        if n > 0 {
            texel = a.int_add(texel, cell);
            // No block that a ray passes through ends beyond the index's bits.
            texel = a.int_wrap(texel, INDEX_BITS);
            sum = a.int_add(sum, span);
            sum = a.int_wrap(sum, shape.line_error_bits());
        }
        let position = shift_left_by(a, texel, INDEX_BITS, words.fraction_bits());
        a.name_int(names.positions[n], position);
        borders.positions[n] = position;
        let is_ahead = a.int_less_than(entry, position);
        borders.is_behind[n] = a.not(is_ahead);
        a.name_bit(names.is_behind[n], borders.is_behind[n]);
        borders.error[n] = sum;
    }
    borders
}

/// One step of a walk, whose line has these heights, row by row, as memory has them: the registers
/// after it (unchanged if it had ended before), and the answer that they stand for.
pub fn wide_fixed_step<A: Arith>(
    a: &mut A,
    shape: WideFixedShape,
    ray: &FixedRayRegisters<A>,
    start_level: A::Int,
    walk: &WideFixedWalk<A>,
    heights: &[A::Int],
) -> (WideFixedWalk<A>, FixedAnswer<A>) {
    let (words, lines) = (shape.words, shape.lines());
    let (side, order) = (lines.side(), lines.path_order());
    let (level, i, j) = (walk.walk.level, walk.walk.i, walk.walk.j);
    let zero = a.int_constant(0);
    let heights = in_path_order(a, lines, ray.mirror_u, ray.mirror_v, heights);
    let u = fixed_borders(a, shape, &BORDERS_U, level, i, ray.u, ray.slope_v);
    let v = fixed_borders(a, shape, &BORDERS_V, level, j, ray.v, ray.slope_u);

    // Which cells the ray passes through: is the column's border crossed no later than the row's?
    // Asked of every point where two borders meet but the near corner.
    let mut u_first = [[a.bit_constant(false); MOST_SIDE + 1]; MOST_SIDE + 1];
    for column in 0..=side {
        for row in 0..=side {
            if column + row == 0 {
                continue;
            }
            let across = a.int_add(walk.error, u.error[column]);
            let across = a.int_sub(across, v.error[row]);
            let across = a.int_wrap(across, shape.line_error_bits());
            let v_first = a.int_less_than(zero, across);
            u_first[column][row] = a.not(v_first);
            a.name_bit(U_FIRST[column][row], u_first[column][row]);
        }
    }
    let mut on_path = [a.bit_constant(false); MOST_CELLS];
    for (place, &(column, row)) in order.iter().enumerate() {
        let still_in_u = a.not(u_first[column + 1][row]);
        let enters_v = a.or(still_in_u, v.is_behind[row]);
        let enters = a.and(u_first[column][row + 1], enters_v);
        let behind = a.or(u.is_behind[column + 1], v.is_behind[row + 1]);
        let ahead = a.not(behind);
        on_path[place] = a.and(enters, ahead);
        a.name_bit(ON_PATH[place], on_path[place]);
    }

    // Of each rank the ray meets one cell: is it inside that at the cell's depth?
    let full_height = a.int_constant(words.full_height());
    let mut ranks = [Rank::<A> {
        depth: zero,
        position_u: zero,
        position_v: zero,
    }; MOST_RANKS];
    let mut candidates = on_path;
    for (rank, sum) in ranks[..2 * side - 1].iter_mut().enumerate() {
        let cells = || order.iter().enumerate().filter(|(_, (c, r))| c + r == rank);
        let mut height = zero;
        let mut far_u = zero;
        let mut far_v = zero;
        for (n, (place, &(column, row))) in cells().enumerate() {
            if n == 0 {
                height = heights[place];
                (far_u, far_v) = (u.positions[column + 1], v.positions[row + 1]);
            } else {
                height = a.int_select(on_path[place], heights[place], height);
                far_u = a.int_select(on_path[place], u.positions[column + 1], far_u);
                far_v = a.int_select(on_path[place], v.positions[row + 1], far_v);
            }
        }
        let names = &RANKS[rank];
        let depth = a.int_sub(full_height, height);
        // A height is not negative, nor above the full height.
        sum.depth = a.int_wrap(depth, words.height_bits + 1);
        a.name_int(names[0], sum.depth);
        sum.position_u = position(a, words, ray.u, ray.slope_u, sum.depth);
        a.name_int(names[1], sum.position_u);
        sum.position_v = position(a, words, ray.v, ray.slope_v, sum.depth);
        a.name_int(names[2], sum.position_v);
        let beyond_u = a.int_less_than(far_u, sum.position_u);
        let beyond_v = a.int_less_than(far_v, sum.position_v);
        let beyond = a.or(beyond_u, beyond_v);
        let inside = a.not(beyond);
        a.name_bit(names[3], inside);
        for (place, _) in cells() {
            candidates[place] = a.and(on_path[place], inside);
            a.name_bit(CANDIDATES[place], candidates[place]);
        }
    }

    let sight = Sight {
        candidates,
        leaves_u: u_first[side][side],
        // No corner is ever in doubt.
        leaves_back: a.bit_constant(false),
    };
    let advance = advance(a, lines, start_level, &walk.walk, &sight);
    let next = advance.walk;

    // The error term at the next block's near corner, or at that of the texel hit.
    let ended = a.or(walk.walk.hit, walk.walk.guard);
    let was_u = first_texel(a, shape, level, i);
    let was_v = first_texel(a, shape, level, j);
    let next_u = first_texel(a, shape, next.level, next.i);
    let next_u = a.int_select(next.hit, next.i, next_u);
    let next_v = first_texel(a, shape, next.level, next.j);
    let next_v = a.int_select(next.hit, next.j, next_v);
    let change_u = error_change(a, shape, was_u, next_u, ray.slope_v);
    a.name_int("error_change_u", change_u);
    let change_v = error_change(a, shape, was_v, next_v, ray.slope_u);
    a.name_int("error_change_v", change_v);
    let error = a.int_add(walk.error, change_u);
    let error = a.int_sub(error, change_v);
    let error = a.int_select(ended, walk.error, error);
    // The ray passes through the block.
    let error = a.int_wrap(error, shape.error_bits());
    a.name_int("next_error", error);

    // Where a hit would be: on the top, or on the side by which the ray comes in.
    let rank = a.int_add(advance.column, advance.row);
    let mut hit = ranks[0];
    for (n, sum) in ranks[..2 * side - 1].iter().enumerate().skip(1) {
        let n = a.int_constant(n as i64);
        let is_here = a.int_equal(rank, n);
        hit = Rank::<A> {
            depth: a.int_select(is_here, sum.depth, hit.depth),
            position_u: a.int_select(is_here, sum.position_u, hit.position_u),
            position_v: a.int_select(is_here, sum.position_v, hit.position_v),
        };
    }
    let before_u = side_hit(a, words, ray.u, next_u, hit.position_u);
    a.name_bit("before_u", before_u);
    let before_v = side_hit(a, words, ray.v, next_v, hit.position_v);
    a.name_bit("before_v", before_v);
    // Of both near borders the one crossed later is the side.
    let v_is_later = a.int_less_than(error, zero);
    let u_is_later = a.not(v_is_later);
    let not_before_v = a.not(before_v);
    let u_counts = a.or(u_is_later, not_before_v);
    let at_border_u = a.and(before_u, u_counts);
    let not_at_border_u = a.not(at_border_u);
    let at_border_v = a.and(before_v, not_at_border_u);
    let depth = a.int_select(advance.hits, hit.depth, walk.depth);
    let depth = a.int_wrap(depth, words.height_bits + 1);
    a.name_int("next_depth", depth);
    let running = a.not(ended);
    let kept_u = a.and(ended, walk.at_border_u);
    let fresh_u = a.and(running, at_border_u);
    let at_border_u = a.or(kept_u, fresh_u);
    a.name_bit("next_at_border_u", at_border_u);
    let kept_v = a.and(ended, walk.at_border_v);
    let fresh_v = a.and(running, at_border_v);
    let at_border_v = a.or(kept_v, fresh_v);
    a.name_bit("next_at_border_v", at_border_v);

    let registers = FixedWalkRegisters {
        level: next.level,
        i: next.i,
        j: next.j,
        error,
        depth,
        at_border_u,
        at_border_v,
        at_midline: None,
        crossed_before: None,
        steps: next.steps,
        crossings: next.crossings,
        hit: next.hit,
        guard: next.guard,
    };
    let answer = fixed_answer(a, words, ray, &registers);
    let walk = WideFixedWalk {
        walk: next,
        error,
        depth,
        at_border_u,
        at_border_v,
    };
    (walk, answer)
}

/// The depth of the one cell of a rank that the ray meets, and where the ray is there.
#[derive(Debug)]
struct Rank<A: Arith> {
    depth: A::Int,
    position_u: A::Int,
    position_v: A::Int,
}

impl<A: Arith> Clone for Rank<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for Rank<A> {}

/// The position on an axis, so many height steps below the top.
fn position<A: Arith>(
    a: &mut A,
    words: FixedShape,
    entry: A::Int,
    slope: A::Int,
    depth: A::Int,
) -> A::Int {
    let travelled = a.int_mul(depth, slope);
    let entry = shift_left_by(a, entry, words.entry_bits(), words.height_bits);
    let position = a.int_add(entry, travelled);
    // A ray within reach stays within the index's bits.
    a.int_wrap(position, words.position_bits())
}

/// Is the near border of the texel ahead of the ray's start, and not before the position at the
/// texel's depth? Then the ray comes in below the top.
fn side_hit<A: Arith>(
    a: &mut A,
    words: FixedShape,
    entry: A::Int,
    texel: A::Int,
    position: A::Int,
) -> A::Bit {
    let near = shift_left_by(a, texel, INDEX_BITS, words.fraction_bits());
    let entry = shift_left_by(a, entry, words.entry_bits(), words.height_bits);
    let ahead = a.int_less_than(entry, near);
    let beyond = a.int_less_than(near, position);
    let not_beyond = a.not(beyond);
    a.and(ahead, not_beyond)
}

/// What a way in texels adds to the error term. The term itself fits its bits, so it may be summed
/// in those alone.
fn error_change<A: Arith>(
    a: &mut A,
    shape: WideFixedShape,
    from: A::Int,
    to: A::Int,
    slope: A::Int,
) -> A::Int {
    let way = a.int_sub(to, from);
    // Over a block of the start level, or into the next.
    let way = a.int_wrap(way, shape.block_level() + 2);
    let change = a.int_mul(way, slope);
    let bits = shape.error_bits() - shape.words.entry_fraction_bits;
    let change = a.int_wrap(change, bits);
    shift_left_by(a, change, bits, shape.words.entry_fraction_bits)
}

const RANKS: [[&str; 4]; MOST_RANKS] = [
    ["depth_0", "position_u_0", "position_v_0", "inside_0"],
    ["depth_1", "position_u_1", "position_v_1", "inside_1"],
    ["depth_2", "position_u_2", "position_v_2", "inside_2"],
    ["depth_3", "position_u_3", "position_v_3", "inside_3"],
    ["depth_4", "position_u_4", "position_v_4", "inside_4"],
    ["depth_5", "position_u_5", "position_v_5", "inside_5"],
    ["depth_6", "position_u_6", "position_v_6", "inside_6"],
];

/// By column border, then row border.
const U_FIRST: [[&str; MOST_SIDE + 1]; MOST_SIDE + 1] = [
    [
        "u_first_00",
        "u_first_01",
        "u_first_02",
        "u_first_03",
        "u_first_04",
    ],
    [
        "u_first_10",
        "u_first_11",
        "u_first_12",
        "u_first_13",
        "u_first_14",
    ],
    [
        "u_first_20",
        "u_first_21",
        "u_first_22",
        "u_first_23",
        "u_first_24",
    ],
    [
        "u_first_30",
        "u_first_31",
        "u_first_32",
        "u_first_33",
        "u_first_34",
    ],
    [
        "u_first_40",
        "u_first_41",
        "u_first_42",
        "u_first_43",
        "u_first_44",
    ],
];
