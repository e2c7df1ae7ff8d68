//! One step of a wide walk, methods `quad` and `block`, in numbers that may round: a line of the
//! pyramid is read, its cells are compared with the ray all at once, and the walk goes on to the
//! first that the ray may hit.
//!
//! # Which cells the ray passes through
//!
//! The columns and rows of a line have `side + 1` borders each, and the ray crosses every border
//! ahead of it at a depth of its own. It passes through a cell if it crosses the cell's near border
//! on u no later than the far one on v, and the near one on v before the far one on u: through an
//! exact corner u is crossed first, so the cell between is visited for zero length. A border that
//! the ray starts behind or on counts as crossed at depth zero, and cells behind it are out.
//!
//! # Why no surface is stepped past
//!
//! Every crossing depth is known from below and from above, as in
//! [`super::traverse_step`], and of either comparison the bounds are taken so that a cell
//! stays in when in doubt: its own surface is asked of the upper bound of its exit. So a cell that
//! the ray does hit is a candidate, and so are all nodes above it.
//!
//! A cell that is in by doubt alone lies beside a corner that the ray passes. Whatever the ray still
//! hits then lies behind one of the borders that make the corner, and the cell's exit is no
//! later than that border; an answer is never later than the lower bound of its cell's exit, so it is
//! early at worst. Of the cells of a line with the same sum of column and row it does
//! not matter for that which is taken first.
//!
//! # Quotients or products
//!
//! Ten quotients (six for `quad`) give the depths of all borders; products of distances and slopes
//! would order columns against rows with as many multipliers and no divider, but every cell's
//! depth is to be compared with two borders too, which takes a product for each cell and axis, 32 more,
//! where quotients are compared as they stand, and the answer's depth is one of them. In fixed
//! point it is the other way round: products of short words, and no quotient at all.

use super::traverse_setup::RayRegisters;
use super::wide_border::{Border, WIDE_U, WIDE_V, WideAxis, borders};
use super::wide_shape::{MOST_CELLS, MOST_SIDE, WideShape};
use super::wide_walk::{Sight, WideWalk, advance, in_path_order, wide_texel};
use crate::arith::Arith;
use crate::float::Rounding::{NearestEven, TowardZero};

/// What a step leaves: the registers for the next one, and the position they stand for.
#[derive(Debug)]
pub struct WideStepResult<A: Arith> {
    /// The walk after the step; unchanged if it had ended before.
    pub walk: WideWalk<A>,
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

/// One step of a walk, whose line has these heights: row by row, as memory has them.
pub fn wide_step<A: Arith>(
    a: &mut A,
    shape: WideShape,
    ray: &RayRegisters<A>,
    start_level: A::Int,
    walk: &WideWalk<A>,
    t: A::Num,
    heights: &[A::Int],
) -> WideStepResult<A> {
    let root_level = a.int_constant(i64::from(shape.root_level));
    let size_exponent = a.int_sub(walk.level, root_level);
    a.name_int("size_exponent", size_exponent);
    let depths = cell_depths(a, shape, ray, heights);
    let axis_u = WideAxis {
        names: &WIDE_U,
        coordinate: ray.u,
        direction: ray.du,
        exact_below: ray.exact_below_u,
    };
    let log2_side = a.int_constant(shape.log2_side.into());
    let first_i = a.int_shift_left(walk.i, log2_side, 2);
    let u = borders(a, shape.side(), &axis_u, size_exponent, first_i);
    let axis_v = WideAxis {
        names: &WIDE_V,
        coordinate: ray.v,
        direction: ray.dv,
        exact_below: ray.exact_below_v,
    };
    let first_j = a.int_shift_left(walk.j, log2_side, 2);
    let v = borders(a, shape.side(), &axis_v, size_exponent, first_j);

    let sight = sight(a, shape, &u, &v, &depths);
    let advance = advance(a, shape, start_level, walk, &sight);

    // The depth of the hit, should this be one: where the ray enters the texel or meets its top,
    // and within the texel.
    let place = (advance.place, advance.column, advance.row);
    let taken = taken_depths(a, shape, place, &u, &v, &depths);
    let reached = a.min(taken.reached, taken.exit);
    a.name_num("hit_depth", reached);
    let t = a.select(advance.hits, reached, t);
    a.name_num("next_t", t);

    // The answer, should the walk have ended.
    let travelled_u = a.mul(TowardZero, t, ray.du);
    a.name_num("travelled_u", travelled_u);
    let travelled_v = a.mul(TowardZero, t, ray.dv);
    a.name_num("travelled_v", travelled_v);
    let position_u = a.add(NearestEven, ray.u, travelled_u);
    a.name_num("mirrored_position_u", position_u);
    let position_u = a.negate_if(ray.mirror_u, position_u);
    a.name_num("position_u", position_u);
    let position_v = a.add(NearestEven, ray.v, travelled_v);
    a.name_num("mirrored_position_v", position_v);
    let position_v = a.negate_if(ray.mirror_v, position_v);
    a.name_num("position_v", position_v);
    let texel_i = wide_texel(a, shape, ray.mirror_u, advance.walk.i);
    a.name_int("texel_i", texel_i);
    let texel_j = wide_texel(a, shape, ray.mirror_v, advance.walk.j);
    a.name_int("texel_j", texel_j);
    WideStepResult {
        walk: advance.walk,
        t,
        position_u,
        position_v,
        texel_i,
        texel_j,
    }
}

/// The depths of the cells of a line, which memory has row by row, in path order.
pub(super) fn cell_depths<A: Arith>(
    a: &mut A,
    shape: WideShape,
    ray: &RayRegisters<A>,
    heights: &[A::Int],
) -> [A::Num; MOST_CELLS] {
    let heights = in_path_order(a, shape, ray.mirror_u, ray.mirror_v, heights);
    let mut depths = [a.zero(); MOST_CELLS];
    for (place, &height) in heights.iter().enumerate().take(shape.cells()) {
        depths[place] = a.depth_from_height(height, shape.height_bits);
        a.name_num(CELL_DEPTHS[place], depths[place]);
    }
    depths
}

/// How deep the ray is in a cell.
pub(super) struct TakenDepths<A: Arith> {
    /// Where it enters the cell, or meets its top if that is further.
    pub(super) reached: A::Num,
    /// Where it leaves the cell.
    pub(super) exit: A::Num,
}

/// The depths of the cell at this place, column and row, none later than in truth.
pub(super) fn taken_depths<A: Arith>(
    a: &mut A,
    shape: WideShape,
    (place, column, row): (A::Int, A::Int, A::Int),
    u: &[Border<A>; MOST_SIDE + 1],
    v: &[Border<A>; MOST_SIDE + 1],
    depths: &[A::Num; MOST_CELLS],
) -> TakenDepths<A> {
    let entry_u = by_place(a, column, shape, |n| u[n].depth);
    a.name_num("entry_u", entry_u);
    let entry_v = by_place(a, row, shape, |n| v[n].depth);
    a.name_num("entry_v", entry_v);
    let exit_u = by_place(a, column, shape, |n| u[n + 1].depth);
    a.name_num("exit_u", exit_u);
    let exit_v = by_place(a, row, shape, |n| v[n + 1].depth);
    a.name_num("exit_v", exit_v);
    let mut depth = depths[0];
    for (n, &here) in depths.iter().enumerate().take(shape.cells()).skip(1) {
        let n = a.int_constant(n as i64);
        let is_here = a.int_equal(place, n);
        depth = a.select(is_here, here, depth);
    }
    a.name_num("taken_depth", depth);
    let entry = a.max(entry_u, entry_v);
    a.name_num("entry_depth", entry);
    let reached = a.max(entry, depth);
    a.name_num("reached", reached);
    let exit = a.min(exit_u, exit_v);
    a.name_num("exit_depth", exit);
    TakenDepths { reached, exit }
}

/// Which cells are candidates, and where the ray leaves the block.
fn sight<A: Arith>(
    a: &mut A,
    shape: WideShape,
    u: &[Border<A>; MOST_SIDE + 1],
    v: &[Border<A>; MOST_SIDE + 1],
    depths: &[A::Num; MOST_CELLS],
) -> Sight<A> {
    let side = shape.side();
    let candidates = candidates(a, shape, u, v, depths);
    // Where the two exits lie within each other's bounds, either of two blocks may hold a sliver of
    // the ray. The one on u comes first; seen from there, its near border on u and its far border
    // on v lie within each other's bounds, and the other block is next.
    let u_first = a.less_equal(u[side].depth, v[side].depth);
    a.name_bit("u_first", u_first);
    let in_doubt = a_corner_in_doubt(a, &u[side], &v[side]);
    a.name_bit("corner_in_doubt", in_doubt);
    let leaves_u = a.or(u_first, in_doubt);
    a.name_bit("leaves_u", leaves_u);
    let leaves_back = a_corner_in_doubt(a, &u[0], &v[side]);
    a.name_bit("leaves_back", leaves_back);
    Sight {
        candidates,
        leaves_u,
        leaves_back,
    }
}

/// Which cells the ray passes through, and may hit, in path order.
pub(super) fn candidates<A: Arith>(
    a: &mut A,
    shape: WideShape,
    u: &[Border<A>; MOST_SIDE + 1],
    v: &[Border<A>; MOST_SIDE + 1],
    depths: &[A::Num; MOST_CELLS],
) -> [A::Bit; MOST_CELLS] {
    let no = a.bit_constant(false);
    let mut candidates = [no; MOST_CELLS];
    for (place, &(column, row)) in shape.path_order().iter().enumerate() {
        let (near_u, far_u) = (&u[column], &u[column + 1]);
        let (near_v, far_v) = (&v[row], &v[row + 1]);
        let enters_u = a.less_equal(near_u.depth, far_v.bound);
        let enters_v = a.less_than(near_v.depth, far_u.bound);
        let enters = a.and(enters_u, enters_v);
        let behind = a.or(far_u.is_behind, far_v.is_behind);
        let ahead = a.not(behind);
        let on_path = a.and(enters, ahead);
        a.name_bit(ON_PATH[place], on_path);
        let within_u = a.less_equal(depths[place], far_u.bound);
        let within_v = a.less_equal(depths[place], far_v.bound);
        let within = a.and(within_u, within_v);
        candidates[place] = a.and(on_path, within);
        a.name_bit(CANDIDATES[place], candidates[place]);
    }
    candidates
}

fn a_corner_in_doubt<A: Arith>(a: &mut A, u: &Border<A>, v: &Border<A>) -> A::Bit {
    let u_may_be_first = a.less_than(u.depth, v.bound);
    let v_may_be_first = a.less_than(v.depth, u.bound);
    a.and(u_may_be_first, v_may_be_first)
}

/// A number of the column or row `index` of a line.
pub(super) fn by_place<A: Arith>(
    a: &mut A,
    index: A::Int,
    shape: WideShape,
    number: impl Fn(usize) -> A::Num,
) -> A::Num {
    let mut selected = number(0);
    for n in 1..shape.side() {
        let here = a.int_constant(n as i64);
        let is_here = a.int_equal(index, here);
        selected = a.select(is_here, number(n), selected);
    }
    selected
}

const CELL_DEPTHS: [&str; MOST_CELLS] = [
    "cell_depth_0",
    "cell_depth_1",
    "cell_depth_2",
    "cell_depth_3",
    "cell_depth_4",
    "cell_depth_5",
    "cell_depth_6",
    "cell_depth_7",
    "cell_depth_8",
    "cell_depth_9",
    "cell_depth_10",
    "cell_depth_11",
    "cell_depth_12",
    "cell_depth_13",
    "cell_depth_14",
    "cell_depth_15",
];
pub(super) const ON_PATH: [&str; MOST_CELLS] = [
    "on_path_0",
    "on_path_1",
    "on_path_2",
    "on_path_3",
    "on_path_4",
    "on_path_5",
    "on_path_6",
    "on_path_7",
    "on_path_8",
    "on_path_9",
    "on_path_10",
    "on_path_11",
    "on_path_12",
    "on_path_13",
    "on_path_14",
    "on_path_15",
];
pub(super) const CANDIDATES: [&str; MOST_CELLS] = [
    "candidate_0",
    "candidate_1",
    "candidate_2",
    "candidate_3",
    "candidate_4",
    "candidate_5",
    "candidate_6",
    "candidate_7",
    "candidate_8",
    "candidate_9",
    "candidate_10",
    "candidate_11",
    "candidate_12",
    "candidate_13",
    "candidate_14",
    "candidate_15",
];
