//! One step of a window walk, method `window`, in numbers that may round: see
//! [`super::window_walk`].
//!
//! Which cells of a window are candidates is decided as in [`super::wide_step`], with the same bounds. What
//! is new is where the next window begins, and that must never be beyond the ray's place at the
//! time, on either axis: cells of the window that the ray has left already, or does not enter, are then off
//! its path, and it enters its path in time.
//!
//! - A window is left at the depth of the nearer of its far borders. The next begins behind those borders that
//!   the ray has crossed by then for sure: their upper bound is not beyond the lower bound of the
//!   far border on the other axis. At a corner in doubt that is neither of the far borders, but the
//!   third on both axes, so that both cells beside the corner are in the next window.
//! - A candidate that is in by doubt alone may not be on the path. Going down into it, the walk
//!   does not count on being in its column, or row, unless that is certain: what lies on the other side of
//!   the corner is then in the window too.
//! - A candidate is gone down into where the ray is at the depth at which it enters it or meets
//!   its top, whichever is later, both from below. The position there is rounded down; exactly on a border, the
//!   ray may still hit the top of what lies before it.

use super::traverse_setup::{RayRegisters, mirror_ray};
use super::traverse_step::INDEX_BITS;
use super::wide_border::{Border, WIDE_U, WIDE_V, WideAxis, borders};
use super::wide_shape::{MOST_SIDE, WideShape};
use super::wide_step::{by_place, candidates, cell_depths, taken_depths};
use super::wide_walk::wide_texel;
use super::window_walk::{
    WindowShape, WindowWalk, crossed, first_texel, take, texel_within, window_advance,
    window_start_level, window_walk_start,
};
use crate::arith::Arith;
use crate::float::Rounding::{Down, NearestEven, TowardZero};
use crate::ray::Ray;

/// The registers a ray carries unchanged from step to step.
#[derive(Debug)]
pub struct WindowRay<A: Arith> {
    /// As of every walk.
    pub ray: RayRegisters<A>,
    /// Texel on u that the mirrored ray enters.
    pub entry_i: A::Int,
    /// Texel on v.
    pub entry_j: A::Int,
}

impl<A: Arith> Clone for WindowRay<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for WindowRay<A> {}

/// What a step leaves: the registers for the next one, and the position they stand for.
#[derive(Debug)]
pub struct WindowStepResult<A: Arith> {
    /// The walk after the step; unchanged if it had ended before.
    pub walk: WindowWalk<A>,
    /// Depth of the hit, never later than in truth; what it was before while there is none.
    pub t: A::Num,
    /// Position on u at depth t, not mirrored, not wrapped: for the answer, never for a decision.
    pub position_u: A::Num,
    /// Position on v.
    pub position_v: A::Num,
    /// Texel on u at level 0 of the map, wrapped; meaningful once the walk has ended.
    pub texel_i: A::Int,
    /// Texel on v.
    pub texel_j: A::Int,
}

/// Mirrors a ray with u and v in [0, 1), and chooses where its walk starts. Exact.
pub fn window_setup<A: Arith>(
    a: &mut A,
    shape: WindowShape,
    ray: Ray<A::Num>,
) -> (WindowRay<A>, WindowWalk<A>) {
    let (ray, _) = mirror_ray(a, ray.u, ray.v, ray.du, ray.dv);
    let reach = a.max(ray.du, ray.dv);
    a.name_num("longer_direction", reach);
    let level = window_start_level(a, shape, |a, texels_log2| {
        let one = a.int_constant(1);
        let exponent = a.int_constant(i64::from(texels_log2) - i64::from(shape.root_level));
        let least = a.number_from_integer(TowardZero, one, exponent);
        a.less_equal(least, reach)
    });
    let texels = a.scale(ray.u, shape.root_level as i32);
    let entry_i = a.floor(texels, INDEX_BITS);
    a.name_int("entry_i", entry_i);
    let texels = a.scale(ray.v, shape.root_level as i32);
    let entry_j = a.floor(texels, INDEX_BITS);
    a.name_int("entry_j", entry_j);
    let walk = window_walk_start(a, level, entry_i, entry_j);
    let ray = WindowRay {
        ray,
        entry_i,
        entry_j,
    };
    (ray, walk)
}

/// One step of a walk, whose window has these heights: row by row, as memory has them.
pub fn window_step<A: Arith>(
    a: &mut A,
    shape: WindowShape,
    ray: &WindowRay<A>,
    walk: &WindowWalk<A>,
    t: A::Num,
    heights: &[A::Int],
) -> WindowStepResult<A> {
    let WindowRay {
        ray,
        entry_i,
        entry_j,
    } = ray;
    let cells = shape.cells();
    let root_level = a.int_constant(i64::from(shape.root_level));
    let size_exponent = a.int_sub(walk.level, root_level);
    a.name_int("size_exponent", size_exponent);
    let depths = cell_depths(a, cells, ray, heights);
    let axis_u = WideAxis {
        names: &WIDE_U,
        coordinate: ray.u,
        direction: ray.du,
        exact_below: ray.exact_below_u,
    };
    let u = borders(a, cells.side(), &axis_u, size_exponent, walk.i);
    let axis_v = WideAxis {
        names: &WIDE_V,
        coordinate: ray.v,
        direction: ray.dv,
        exact_below: ray.exact_below_v,
    };
    let v = borders(a, cells.side(), &axis_v, size_exponent, walk.j);
    let candidates = candidates(a, cells, &u, &v, &depths);
    let taken = take(a, shape, walk, &candidates);

    // Down to where the ray may meet the cell, or on from where it leaves the window.
    let depth = taken_depths(a, cells, taken.cell, &u, &v, &depths);
    // Where no cell is taken the depths mean nothing, and may be infinite.
    let zero = a.zero();
    let there = a.select(taken.found, depth.reached, zero);
    a.name_num("depth_below", there);
    let texel = |a: &mut A, coordinate, direction| {
        let travelled = a.mul(TowardZero, there, direction);
        let position = a.add(Down, coordinate, travelled);
        let position = a.scale(position, shape.root_level as i32);
        // The last texel that the position is beyond the near border of.
        let yes = a.bit_constant(true);
        let negative = a.negate_if(yes, position);
        let above = a.floor(negative, INDEX_BITS);
        a.int_complement_if(yes, above)
    };
    let texel_u = texel(a, ray.u, ray.du);
    let texel_v = texel(a, ray.v, ray.dv);
    // Not before the cell, if the ray is in its column, in its row for sure.
    let (_, column, row) = taken.cell;
    let (near_u, far_u) = taken_borders(a, cells, column, &u);
    let (near_v, far_v) = taken_borders(a, cells, row, &v);
    let in_column = a.less_equal(near_u, far_v);
    a.name_bit("surely_in_column", in_column);
    let in_row = a.less_than(near_v, far_u);
    a.name_bit("surely_in_row", in_row);
    let level = walk.level;
    let first_u = first_below(a, level, in_column, taken.i, walk.i);
    let first_v = first_below(a, level, in_row, taken.j, walk.j);
    let (cell_u, cell_v) = ((taken.i, level), (taken.j, level));
    let texel_u = texel_within(a, "texel_below_u", texel_u, cell_u, first_u, *entry_i);
    let texel_v = texel_within(a, "texel_below_v", texel_v, cell_v, first_v, *entry_j);
    let (last_u, last_v) = (u[4].depth, v[4].depth);
    let columns = [1, 2, 3, 4].map(|n| a.less_equal(u[n].bound, last_v));
    let columns = crossed(a, "columns_crossed", columns);
    let rows = [1, 2, 3, 4].map(|n| a.less_than(v[n].bound, last_u));
    let rows = crossed(a, "rows_crossed", rows);
    let walk = window_advance(a, shape, walk, &taken, (texel_u, texel_v), (columns, rows));

    let reached = a.min(depth.reached, depth.exit);
    a.name_num("hit_depth", reached);
    let t = a.select(taken.hits, reached, t);
    a.name_num("next_t", t);
    let travelled_u = a.mul(TowardZero, t, ray.du);
    a.name_num("travelled_u", travelled_u);
    let travelled_v = a.mul(TowardZero, t, ray.dv);
    a.name_num("travelled_v", travelled_v);
    let position_u = a.add(NearestEven, ray.u, travelled_u);
    let position_u = a.negate_if(ray.mirror_u, position_u);
    a.name_num("position_u", position_u);
    let position_v = a.add(NearestEven, ray.v, travelled_v);
    let position_v = a.negate_if(ray.mirror_v, position_v);
    a.name_num("position_v", position_v);
    let texel_i = wide_texel(a, cells, ray.mirror_u, walk.i);
    a.name_int("texel_i", texel_i);
    let texel_j = wide_texel(a, cells, ray.mirror_v, walk.j);
    a.name_int("texel_j", texel_j);
    WindowStepResult {
        walk,
        t,
        position_u,
        position_v,
        texel_i,
        texel_j,
    }
}

/// The upper bound of the near border of a window's column or row, and the lower bound of its far one.
fn taken_borders<A: Arith>(
    a: &mut A,
    cells: WideShape,
    index: A::Int,
    borders: &[Border<A>; MOST_SIDE + 1],
) -> (A::Num, A::Num) {
    let near = by_place(a, index, cells, |n| borders[n].bound);
    let far = by_place(a, index, cells, |n| borders[n + 1].depth);
    (near, far)
}

/// The first texel of the cell taken, if the ray is there for sure; else that of the window.
fn first_below<A: Arith>(
    a: &mut A,
    level: A::Int,
    is_there: A::Bit,
    cell: A::Int,
    window: A::Int,
) -> A::Int {
    let index = a.int_select(is_there, cell, window);
    first_texel(a, level, index)
}
