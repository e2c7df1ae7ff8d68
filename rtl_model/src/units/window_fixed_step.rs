//! One step of a window walk, method `window`, in exact fixed point: integers only, and no divider. See
//! [`super::window_walk`]; what the ray sees of its window is `wide_fixed_line`.
//!
//! A candidate is gone down into at the position at its depth, or, where the ray comes in below its
//! top, at the border it crosses: on that axis the first of the cells below, on the other the one
//! that the error term tells, by three comparisons.

use super::fixed_answer::{FixedAnswer, fixed_answer};
use super::fixed_setup::{FixedRayRegisters, fixed_mirror, shift_left_by, shift_right_by};
use super::fixed_shape::FixedShape;
use super::fixed_step::FixedWalkRegisters;
use super::traverse_step::INDEX_BITS;
use super::wide_fixed_line::{LineAt, entered_by, fixed_line};
use super::wide_shape::MOST_SIDE;
use super::window_walk::{
    WindowShape, WindowWalk, crossed, first_texel, take, texel_within, window_advance,
    window_start_level, window_walk_start,
};
use crate::arith::Arith;

/// What an exact fixed-point window unit is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct WindowFixedShape {
    /// The words of its numbers.
    pub words: FixedShape,
}

impl WindowFixedShape {
    /// The windows.
    pub const fn windows(self) -> WindowShape {
        WindowShape {
            root_level: self.words.root_level,
            height_bits: self.words.height_bits,
        }
    }

    /// Bits of the error term anywhere in a window, signed: at most five sides of a node beside
    /// the ray.
    pub const fn window_error_bits(self) -> u32 {
        self.words.error_bits() + 3
    }
}

/// The registers a ray carries unchanged from step to step.
#[derive(Debug)]
pub struct WindowFixedRay<A: Arith> {
    /// As of every exact fixed-point walk.
    pub ray: FixedRayRegisters<A>,
    /// Texel on u that the mirrored ray enters.
    pub entry_i: A::Int,
    /// Texel on v.
    pub entry_j: A::Int,
}

impl<A: Arith> Clone for WindowFixedRay<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for WindowFixedRay<A> {}

/// The registers of a walk that change from step to step.
#[derive(Debug)]
pub struct WindowFixedWalk<A: Arith> {
    /// What every window walk has.
    pub walk: WindowWalk<A>,
    /// The error term at the near corner of the window's first node, of
    /// [`FixedShape::error_bits`] bits; after a hit, of the texel.
    pub error: A::Int,
    /// Height steps from the top to the texel hit.
    pub depth: A::Int,
    /// The hit is on the texel's side, where the ray crosses its near border on u.
    pub at_border_u: A::Bit,
    /// The same on v.
    pub at_border_v: A::Bit,
}

impl<A: Arith> Clone for WindowFixedWalk<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for WindowFixedWalk<A> {}

/// Sets up a quantised ray: see [`super::fixed_setup::fixed_setup`].
pub fn window_fixed_setup<A: Arith>(
    a: &mut A,
    shape: WindowFixedShape,
    u: A::Int,
    v: A::Int,
    du: A::Int,
    dv: A::Int,
) -> (WindowFixedRay<A>, WindowFixedWalk<A>) {
    let words = shape.words;
    let ray = fixed_mirror(a, words, u, v, du, dv);
    let u_is_longer = a.int_less_than(ray.slope_v, ray.slope_u);
    let slope = a.int_select(u_is_longer, ray.slope_u, ray.slope_v);
    // Times the full height, which is all ones.
    let longer = shift_left_by(a, slope, words.slope_bits + 1, words.height_bits);
    let longer = a.int_sub(longer, slope);
    a.name_int("longer_travel", longer);
    let level = window_start_level(a, shape.windows(), |a, texels_log2| {
        let below = a.int_constant((1 << (texels_log2 + words.fraction_bits())) - 1);
        a.int_less_than(below, longer)
    });
    let entry = |a: &mut A, entry| {
        let texel = shift_right_by(a, entry, words.entry_fraction_bits);
        a.int_wrap(texel, words.root_level + 1)
    };
    let entry_i = entry(a, ray.u);
    a.name_int("entry_i", entry_i);
    let entry_j = entry(a, ray.v);
    a.name_int("entry_j", entry_j);
    let walk = window_walk_start(a, level, entry_i, entry_j);
    let behind = |a: &mut A, entry, index| {
        let near = first_texel(a, level, index);
        // The node holds the entry, and is no larger than the map.
        let near = a.int_wrap(near, words.root_level + 1);
        let near = shift_left_by(a, near, words.root_level + 1, words.entry_fraction_bits);
        let behind = a.int_sub(near, entry);
        a.int_wrap(behind, words.entry_bits())
    };
    let behind_u = behind(a, ray.u, walk.i);
    a.name_int("behind_u", behind_u);
    let behind_v = behind(a, ray.v, walk.j);
    a.name_int("behind_v", behind_v);
    let product_u = a.int_mul(behind_u, ray.slope_v);
    let product_v = a.int_mul(behind_v, ray.slope_u);
    let error = a.int_sub(product_u, product_v);
    let error = a.int_wrap(error, words.error_bits());
    a.name_int("start_error", error);
    let no = a.bit_constant(false);
    let walk = WindowFixedWalk {
        walk,
        error,
        depth: a.int_constant(0),
        at_border_u: no,
        at_border_v: no,
    };
    let ray = WindowFixedRay {
        ray,
        entry_i,
        entry_j,
    };
    (ray, walk)
}

/// One step of a walk, whose window has these heights, row by row, as memory has them: the registers
/// after it (unchanged if it had ended before), and the answer that they stand for.
pub fn window_fixed_step<A: Arith>(
    a: &mut A,
    shape: WindowFixedShape,
    ray: &WindowFixedRay<A>,
    walk: &WindowFixedWalk<A>,
    heights: &[A::Int],
) -> (WindowFixedWalk<A>, FixedAnswer<A>) {
    let WindowFixedRay {
        ray,
        entry_i,
        entry_j,
    } = ray;
    let (words, windows) = (shape.words, shape.windows());
    let (level, i, j) = (walk.walk.level, walk.walk.i, walk.walk.j);
    let error_bits = shape.window_error_bits();
    let at = LineAt {
        level,
        error: walk.error,
        first_u: first_texel(a, level, i),
        first_v: first_texel(a, level, j),
    };
    let line = fixed_line(a, windows.cells(), words, error_bits, ray, &at, heights);
    let taken = take(a, windows, &walk.walk, &line.candidates);
    let (_, column, row) = taken.cell;
    let hit = line.rank_of(a, windows.cells(), column, row);

    // The error term at the near corner of the cell taken, and how the ray gets into it.
    let (mut error_u, mut error_v) = (line.u.error[0], line.v.error[0]);
    for n in 1..MOST_SIDE {
        let here = a.int_constant(n as i64);
        let is_column = a.int_equal(column, here);
        error_u = a.int_select(is_column, line.u.error[n], error_u);
        let is_row = a.int_equal(row, here);
        error_v = a.int_select(is_row, line.v.error[n], error_v);
    }
    let taken_error = a.int_add(walk.error, error_u);
    let taken_error = a.int_sub(taken_error, error_v);
    let taken_error = a.int_wrap(taken_error, error_bits);
    a.name_int("taken_error", taken_error);
    let near_u = first_texel(a, level, taken.i);
    let near_v = first_texel(a, level, taken.j);
    let (at_border_u, at_border_v) = entered_by(a, words, ray, (near_u, near_v), taken_error, &hit);

    // Where in the cell: by position, or behind a border by the error term on the other axis.
    let below = (taken.level_below, taken_error);
    let rows_below = crossed_below(a, shape, below, ray.slope_u, false);
    let columns_below = crossed_below(a, shape, below, ray.slope_v, true);
    let texel = |a: &mut A, position, near, crossed_texels, at_this, at_other| {
        // The last texel that the position is beyond the near border of.
        let one = a.int_constant(1);
        let before = a.int_sub(position, one);
        let by_position = shift_right_by(a, before, words.fraction_bits());
        let by_position = a.int_wrap(by_position, INDEX_BITS);
        let by_error = a.int_add(near, crossed_texels);
        let texel = a.int_select(at_other, by_error, by_position);
        let texel = a.int_select(at_this, near, texel);
        a.int_wrap(texel, INDEX_BITS)
    };
    let texel_u = texel(
        a,
        hit.position_u,
        near_u,
        columns_below,
        at_border_u,
        at_border_v,
    );
    let texel_u = texel_within(
        a,
        "texel_below_u",
        texel_u,
        (taken.i, level),
        near_u,
        *entry_i,
    );
    let texel_v = texel(
        a,
        hit.position_v,
        near_v,
        rows_below,
        at_border_v,
        at_border_u,
    );
    let texel_v = texel_within(
        a,
        "texel_below_v",
        texel_v,
        (taken.j, level),
        near_v,
        *entry_j,
    );

    // Or on from where it leaves the window.
    let columns = [1, 2, 3, 4].map(|n: usize| line.u_first[n][MOST_SIDE]);
    let columns = crossed(a, "columns_crossed", columns);
    let rows = [1, 2, 3, 4].map(|n: usize| {
        let not_first = a.not(line.u_first[MOST_SIDE][n]);
        a.or(not_first, line.v.is_behind[n])
    });
    let rows = crossed(a, "rows_crossed", rows);
    let next = window_advance(
        a,
        windows,
        &walk.walk,
        &taken,
        (texel_u, texel_v),
        (columns, rows),
    );

    // The error term at the next window's near corner, or at that of the texel hit.
    let next_u = first_texel(a, next.level, next.i);
    let next_v = first_texel(a, next.level, next.j);
    let change_u = error_change(a, shape, at.first_u, next_u, ray.slope_v);
    a.name_int("error_change_u", change_u);
    let change_v = error_change(a, shape, at.first_v, next_v, ray.slope_u);
    a.name_int("error_change_v", change_v);
    let error = a.int_add(walk.error, change_u);
    let error = a.int_sub(error, change_v);
    let error = a.int_select(taken.ended, walk.error, error);
    // The ray passes through the node.
    let error = a.int_wrap(error, words.error_bits());
    a.name_int("next_error", error);

    let depth = a.int_select(taken.hits, hit.depth, walk.depth);
    let depth = a.int_wrap(depth, words.height_bits + 1);
    a.name_int("next_depth", depth);
    let running = a.not(taken.ended);
    let kept_u = a.and(taken.ended, walk.at_border_u);
    let fresh_u = a.and(running, at_border_u);
    let at_border_u = a.or(kept_u, fresh_u);
    a.name_bit("next_at_border_u", at_border_u);
    let kept_v = a.and(taken.ended, walk.at_border_v);
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
    let walk = WindowFixedWalk {
        walk: next,
        error,
        depth,
        at_border_u,
        at_border_v,
    };
    (walk, answer)
}

/// Texels up to the last inner border of a cell, on one axis, that the ray crosses before the cell's near border on
/// the other: of borders a node of the level below apart.
///
/// The error term at the point where both meet says it. `columns`: of borders on u, which add to the
/// term; else on v. `slope` is that on the other axis than the borders'.
fn crossed_below<A: Arith>(
    a: &mut A,
    shape: WindowFixedShape,
    (level, error): (A::Int, A::Int),
    slope: A::Int,
    columns: bool,
) -> A::Int {
    let words = shape.words;
    let shift = a.int_low_bits(level, 4);
    let span = a.int_shift_left(slope, shift, 4);
    let span_bits = words.root_level + words.slope_bits + 1;
    let span = a.int_wrap(span, span_bits);
    let span = shift_left_by(a, span, span_bits, words.entry_fraction_bits);
    let zero = a.int_constant(0);
    let mut at_border = error;
    let mut crossed = zero;
    for n in 1..MOST_SIDE {
        at_border = if columns {
            a.int_add(at_border, span)
        } else {
            a.int_sub(at_border, span)
        };
        at_border = a.int_wrap(at_border, shape.window_error_bits());
        let is_crossed = if columns {
            a.int_less_than(at_border, zero)
        } else {
            a.int_less_than(zero, at_border)
        };
        let n = a.int_constant(n as i64);
        crossed = a.int_select(is_crossed, n, crossed);
    }
    let texels = a.int_shift_left(crossed, shift, 4);
    let texels = a.int_wrap(texels, INDEX_BITS);
    a.name_int(
        if columns {
            "columns_below"
        } else {
            "rows_below"
        },
        texels,
    );
    texels
}

/// What a way in texels adds to the error term. The term itself fits its bits, so it may be summed
/// in those alone.
fn error_change<A: Arith>(
    a: &mut A,
    shape: WindowFixedShape,
    from: A::Int,
    to: A::Int,
    slope: A::Int,
) -> A::Int {
    let words = shape.words;
    let way = a.int_sub(to, from);
    // Within the window, which is at most four maps wide, or just behind it.
    let way = a.int_wrap(way, words.root_level + 4);
    let change = a.int_mul(way, slope);
    let bits = words.error_bits() - words.entry_fraction_bits;
    let change = a.int_wrap(change, bits);
    shift_left_by(a, change, bits, words.entry_fraction_bits)
}
