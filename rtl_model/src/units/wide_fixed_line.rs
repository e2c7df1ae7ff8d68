//! A line of heights as an exact fixed-point ray sees it: which cells it passes through, and which of
//! them it may hit. Integers that are never rounded, and no divider.

use super::fixed_setup::{FixedRayRegisters, shift_left_by};
use super::fixed_shape::FixedShape;
use super::traverse_step::INDEX_BITS;
use super::wide_shape::{MOST_CELLS, MOST_SIDE, WideShape};
use super::wide_step::{CANDIDATES, ON_PATH};
use super::wide_walk::in_path_order;
use crate::arith::Arith;

/// Sums of column and row in a line: one less than twice the side.
const MOST_RANKS: usize = 2 * MOST_SIDE - 1;

/// Where a line lies.
pub(super) struct LineAt<A: Arith> {
    /// Level of its cells.
    pub(super) level: A::Int,
    /// The error term at its near corner.
    pub(super) error: A::Int,
    /// Its first texel on u.
    pub(super) first_u: A::Int,
    /// Its first texel on v.
    pub(super) first_v: A::Int,
}

/// What the ray sees of a line.
pub(super) struct FixedLine<A: Arith> {
    pub(super) u: FixedBorders<A>,
    pub(super) v: FixedBorders<A>,
    /// Is a column's border crossed no later than a row's? By column border, then row border.
    pub(super) u_first: [[A::Bit; MOST_SIDE + 1]; MOST_SIDE + 1],
    /// Cells that the ray passes through, and may hit, in path order.
    pub(super) candidates: [A::Bit; MOST_CELLS],
    /// By the sum of column and row.
    ranks: [Rank<A>; MOST_RANKS],
}

/// The depth of the one cell of a rank that the ray meets, and where the ray is there.
#[derive(Debug)]
pub(super) struct Rank<A: Arith> {
    pub(super) depth: A::Int,
    pub(super) position_u: A::Int,
    pub(super) position_v: A::Int,
}

impl<A: Arith> Clone for Rank<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for Rank<A> {}

/// The borders of a line's columns or rows.
pub(super) struct FixedBorders<A: Arith> {
    /// Their positions, as [`FixedShape::position_bits`] says.
    pub(super) positions: [A::Int; MOST_SIDE + 1],
    /// The ray starts on them or behind them.
    pub(super) is_behind: [A::Bit; MOST_SIDE + 1],
    /// What each adds to the error term of the near corner: the slope on the other axis times the
    /// way there.
    pub(super) error: [A::Int; MOST_SIDE + 1],
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
    lines: WideShape,
    (words, line_error_bits): (FixedShape, u32),
    names: &FixedBorderNames,
    (level, first): (A::Int, A::Int),
    entry: A::Int,
    other_slope: A::Int,
) -> FixedBorders<A> {
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
    for n in 0..=lines.side() {
        if n > 0 {
            texel = a.int_add(texel, cell);
            // No block that a ray passes through ends beyond the index's bits.
            texel = a.int_wrap(texel, INDEX_BITS);
            sum = a.int_add(sum, span);
            sum = a.int_wrap(sum, line_error_bits);
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

/// What a ray sees of a line with these heights, row by row, as memory has them.
pub(super) fn fixed_line<A: Arith>(
    a: &mut A,
    lines: WideShape,
    words: FixedShape,
    line_error_bits: u32,
    ray: &FixedRayRegisters<A>,
    at: &LineAt<A>,
    heights: &[A::Int],
) -> FixedLine<A> {
    let (side, order) = (lines.side(), lines.path_order());
    let zero = a.int_constant(0);
    let heights = in_path_order(a, lines, ray.mirror_u, ray.mirror_v, heights);
    let borders = |a: &mut A, names, first, entry, other_slope| {
        let words = (words, line_error_bits);
        fixed_borders(
            a,
            lines,
            words,
            names,
            (at.level, first),
            entry,
            other_slope,
        )
    };
    let u = borders(a, &BORDERS_U, at.first_u, ray.u, ray.slope_v);
    let v = borders(a, &BORDERS_V, at.first_v, ray.v, ray.slope_u);

    // Which cells the ray passes through: is the column's border crossed no later than the row's?
    // Asked of every point where two borders meet but the near corner.
    let mut u_first = [[a.bit_constant(false); MOST_SIDE + 1]; MOST_SIDE + 1];
    for column in 0..=side {
        for row in 0..=side {
            if column + row == 0 {
                continue;
            }
            let across = a.int_add(at.error, u.error[column]);
            let across = a.int_sub(across, v.error[row]);
            let across = a.int_wrap(across, line_error_bits);
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

    FixedLine {
        u,
        v,
        u_first,
        candidates,
        ranks,
    }
}

impl<A: Arith> FixedLine<A> {
    /// Of the cell at this column and row.
    pub(super) fn rank_of(
        &self,
        a: &mut A,
        lines: WideShape,
        column: A::Int,
        row: A::Int,
    ) -> Rank<A> {
        let rank = a.int_add(column, row);
        let mut hit = self.ranks[0];
        for (n, sum) in self.ranks[..2 * lines.side() - 1]
            .iter()
            .enumerate()
            .skip(1)
        {
            let n = a.int_constant(n as i64);
            let is_here = a.int_equal(rank, n);
            hit = Rank::<A> {
                depth: a.int_select(is_here, sum.depth, hit.depth),
                position_u: a.int_select(is_here, sum.position_u, hit.position_u),
                position_v: a.int_select(is_here, sum.position_v, hit.position_v),
            };
        }
        hit
    }
}

/// Does the ray come into a cell below its top, and by which side: across its near border on u, or on
/// v? The near borders are those of these texels, and the error term is that of the near corner.
pub(super) fn entered_by<A: Arith>(
    a: &mut A,
    words: FixedShape,
    ray: &FixedRayRegisters<A>,
    (near_u, near_v): (A::Int, A::Int),
    error: A::Int,
    rank: &Rank<A>,
) -> (A::Bit, A::Bit) {
    let zero = a.int_constant(0);
    let before_u = side_hit(a, words, ray.u, near_u, rank.position_u);
    a.name_bit("before_u", before_u);
    let before_v = side_hit(a, words, ray.v, near_v, rank.position_v);
    a.name_bit("before_v", before_v);
    // Of both near borders the one crossed later is the side.
    let v_is_later = a.int_less_than(error, zero);
    let u_is_later = a.not(v_is_later);
    let not_before_v = a.not(before_v);
    let u_counts = a.or(u_is_later, not_before_v);
    let at_border_u = a.and(before_u, u_counts);
    let not_at_border_u = a.not(at_border_u);
    let at_border_v = a.and(before_v, not_at_border_u);
    (at_border_u, at_border_v)
}

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
