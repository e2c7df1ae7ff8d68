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
use super::wide_fixed_line::{LineAt, entered_by, fixed_line};
use super::wide_shape::WideShape;
use super::wide_walk::{Sight, WideWalk, advance, start_level, wide_walk_start};
use crate::arith::Arith;

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
    let (level, i, j) = (walk.walk.level, walk.walk.i, walk.walk.j);
    let (was_u, was_v) = (
        first_texel(a, shape, level, i),
        first_texel(a, shape, level, j),
    );
    let at = LineAt {
        level,
        error: walk.error,
        first_u: was_u,
        first_v: was_v,
    };
    let line = fixed_line(a, lines, words, shape.line_error_bits(), ray, &at, heights);
    let (side, candidates) = (lines.side(), line.candidates);
    let sight = Sight {
        candidates,
        leaves_u: line.u_first[side][side],
        // No corner is ever in doubt.
        leaves_back: a.bit_constant(false),
    };
    let advance = advance(a, lines, start_level, &walk.walk, &sight);
    let next = advance.walk;

    // The error term at the next block's near corner, or at that of the texel hit.
    let ended = a.or(walk.walk.hit, walk.walk.guard);
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
    let hit = line.rank_of(a, lines, advance.column, advance.row);
    let (at_border_u, at_border_v) = entered_by(a, words, ray, (next_u, next_v), error, &hit);
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
