//! A line of heights as a walk by bounds sees it: which cells the ray may pass through, and which
//! of them it may hit.
//!
//! All depths of borders are upper bounds, late by no more than a unit of the order fraction. In
//! that unit two bounds in a row by at least two are in the order of the depths themselves; nearer
//! ones are in doubt, and a cell stays in when in doubt.

use super::bounded_setup::BoundedRay;
use super::bounded_shape::BoundedShape;
use super::fixed_setup::shift_right_by;
use super::wide_shape::{MOST_CELLS, MOST_SIDE};
use super::wide_step::{CANDIDATES, ON_PATH};
use super::wide_walk::{Sight, mask, select_bit};
use crate::arith::Arith;

/// What bounds say of a cell's corners, with the bit of a cell its place in path order.
pub(super) struct SeenCorners<A: Arith> {
    /// The order of the near borders is not in doubt, nor is it that the ray enters the cell before it
    /// leaves it.
    pub(super) are_known: A::Int,
    /// The near border on v is crossed after that on u.
    pub(super) v_is_later: A::Int,
}

/// The bounds of a line's column or row borders.
struct Bounds<A: Arith> {
    /// In units of the order fraction.
    order: [A::Int; MOST_SIDE + 1],
    /// Surely at or behind the start.
    is_behind: [A::Bit; MOST_SIDE + 1],
    /// The last height step not beyond the border, without the bits above those of a height.
    step: [A::Int; MOST_SIDE + 1],
    /// It is at the bottom or beyond: every height is reached before.
    is_beyond: [A::Bit; MOST_SIDE + 1],
}

struct BoundNames {
    bounds: [&'static str; MOST_SIDE + 1],
    steps: [&'static str; MOST_SIDE + 1],
    beyond: [&'static str; MOST_SIDE + 1],
}

const NAMES_U: BoundNames = BoundNames {
    bounds: ["t_u_0", "t_u_1", "t_u_2", "t_u_3", "t_u_4"],
    steps: [
        "t_step_u_0",
        "t_step_u_1",
        "t_step_u_2",
        "t_step_u_3",
        "t_step_u_4",
    ],
    beyond: [
        "t_u_0_is_beyond",
        "t_u_1_is_beyond",
        "t_u_2_is_beyond",
        "t_u_3_is_beyond",
        "t_u_4_is_beyond",
    ],
};
const NAMES_V: BoundNames = BoundNames {
    bounds: ["t_v_0", "t_v_1", "t_v_2", "t_v_3", "t_v_4"],
    steps: [
        "t_step_v_0",
        "t_step_v_1",
        "t_step_v_2",
        "t_step_v_3",
        "t_step_v_4",
    ],
    beyond: [
        "t_v_0_is_beyond",
        "t_v_1_is_beyond",
        "t_v_2_is_beyond",
        "t_v_3_is_beyond",
        "t_v_4_is_beyond",
    ],
};

/// What the ray sees of a line with these heights, row by row, as memory has them. `near` are the
/// bounds of its near borders, `cell` the depths between two borders of its cells.
pub(super) fn bounded_line<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &BoundedRay<A>,
    near: (A::Int, A::Int),
    cell: (A::Int, A::Int),
    heights: &[A::Int],
) -> (Sight<A>, SeenCorners<A>) {
    let lines = shape.lines();
    let side = lines.side();
    let u = bounds(a, shape, &NAMES_U, near.0, cell.0);
    let v = bounds(a, shape, &NAMES_V, near.1, cell.1);

    // Which of a column's and a row's border may be first, where it matters.
    let no = a.bit_constant(false);
    let mut u_may_be_first = [[no; MOST_SIDE + 1]; MOST_SIDE + 1];
    let mut v_may_be_first = [[no; MOST_SIDE + 1]; MOST_SIDE + 1];
    let zero = a.int_constant(0);
    let minus_one = a.int_constant(-1);
    for column in 0..=side {
        for row in 0..=side {
            let lead = a.int_sub(v.order[row], u.order[column]);
            // By two or more: a sign and its other bits, which is less than a comparator.
            let is_negative = a.int_less_than(lead, zero);
            let is_minus_one = a.int_equal(lead, minus_one);
            let is_more = a.not(is_minus_one);
            let v_leads = a.and(is_negative, is_more);
            u_may_be_first[column][row] = a.not(v_leads);
            a.name_bit(U_MAY_BE_FIRST[column][row], u_may_be_first[column][row]);
            let half = shift_right_by(a, lead, 1);
            let is_one_at_most = a.int_equal(half, zero);
            let is_small = a.or(is_negative, is_one_at_most);
            let u_leads = a.not(is_small);
            v_may_be_first[column][row] = a.not(u_leads);
            a.name_bit(V_MAY_BE_FIRST[column][row], v_may_be_first[column][row]);
        }
    }

    // Cells are compared where memory has them; what tells columns and rows apart is mirrored
    // instead, which is less.
    let within = within(a, shape, ray, &u, &v, heights);
    let mut candidates = [no; MOST_CELLS];
    let mut are_known = [no; MOST_CELLS];
    let mut v_is_later = [no; MOST_CELLS];
    for (place, &(column, row)) in lines.path_order().iter().enumerate() {
        let mut on_path = u_may_be_first[column][row + 1];
        if column + 1 < side || row > 0 {
            on_path = a.and(on_path, v_may_be_first[column + 1][row]);
        }
        let behind = a.or(u.is_behind[column + 1], v.is_behind[row + 1]);
        let ahead = a.not(behind);
        on_path = a.and(on_path, ahead);
        a.name_bit(ON_PATH[place], on_path);
        candidates[place] = a.and(on_path, within[place]);
        a.name_bit(CANDIDATES[place], candidates[place]);

        v_is_later[place] = a.not(v_may_be_first[column][row]);
        let u_is_later = a.not(u_may_be_first[column][row]);
        let in_order = a.or(u_is_later, v_is_later[place]);
        let in_doubt = a.or(
            v_may_be_first[column][row + 1],
            u_may_be_first[column + 1][row],
        );
        let on_path = a.not(in_doubt);
        are_known[place] = a.and(in_order, on_path);
    }

    // Of two blocks beside a corner in doubt the one on u comes first; there the near border on u
    // and the far one on v are in doubt, and the other block is next.
    let leaves_u = u_may_be_first[side][side];
    a.name_bit("leaves_u", leaves_u);
    let leaves_back = a.and(u_may_be_first[0][side], v_may_be_first[0][side]);
    a.name_bit("leaves_back", leaves_back);
    let cells = lines.cells();
    let corners = SeenCorners {
        are_known: mask(a, &are_known[..cells]),
        v_is_later: mask(a, &v_is_later[..cells]),
    };
    let sight = Sight {
        candidates,
        leaves_u,
        leaves_back,
    };
    (sight, corners)
}

fn bounds<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    names: &BoundNames,
    near: A::Int,
    cell: A::Int,
) -> Bounds<A> {
    let height_bits = shape.words.height_bits;
    let zero = a.int_constant(0);
    let no = a.bit_constant(false);
    let mut bounds = Bounds::<A> {
        order: [zero; MOST_SIDE + 1],
        is_behind: [no; MOST_SIDE + 1],
        step: [zero; MOST_SIDE + 1],
        is_beyond: [no; MOST_SIDE + 1],
    };
    for n in 0..=shape.lines().side() {
        let bound = match n {
            0 => near,
            3 => {
                let one = a.int_constant(1);
                let twice = a.int_shift_left(cell, one, 1);
                let way = a.int_add(twice, cell);
                a.int_add(near, way)
            }
            _ => {
                let log2 = a.int_constant(n.ilog2().into());
                let way = a.int_shift_left(cell, log2, 2);
                a.int_add(near, way)
            }
        };
        let bound = a.int_wrap(bound, shape.bound_bits());
        a.name_int(names.bounds[n], bound);
        let below = shape.fraction_bits() - shape.order_fraction_bits();
        bounds.order[n] = shift_right_by(a, bound, below);
        bounds.is_behind[n] = a.int_less_than(bound, zero);
        let steps = shift_right_by(a, bound, shape.fraction_bits());
        let step = a.int_low_bits(steps, height_bits);
        a.name_int(names.steps[n], step);
        bounds.step[n] = step;
        let above = shift_right_by(a, steps, height_bits);
        let is_on_map = a.int_equal(above, zero);
        let is_not_beyond = a.or(is_on_map, bounds.is_behind[n]);
        bounds.is_beyond[n] = a.not(is_not_beyond);
        a.name_bit(names.beyond[n], bounds.is_beyond[n]);
    }
    bounds
}

/// Is each cell's depth not beyond the borders that the ray leaves it by? In path order.
fn within<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &BoundedRay<A>,
    u: &Bounds<A>,
    v: &Bounds<A>,
    heights: &[A::Int],
) -> [A::Bit; MOST_CELLS] {
    let side = shape.lines().side();
    let (mirror_u, mirror_v) = (ray.fixed.mirror_u, ray.fixed.mirror_v);
    let (of_column, of_row) = (
        far_borders(a, shape, mirror_u, u),
        far_borders(a, shape, mirror_v, v),
    );
    let no = a.bit_constant(false);
    let mut in_memory = [no; MOST_CELLS];
    for (cell, &height) in heights.iter().enumerate() {
        let depth = depth_of(a, shape, height);
        let mut within = [no; 2];
        for (within, (step, is_beyond)) in within
            .iter_mut()
            .zip([of_column[cell % side], of_row[cell / side]])
        {
            let is_late = a.int_less_than(step, depth);
            let in_time = a.not(is_late);
            *within = a.or(in_time, is_beyond);
        }
        in_memory[cell] = a.and(within[0], within[1]);
    }
    let mut ordered = in_memory;
    for (place, &(column, row)) in shape.lines().path_order().iter().enumerate() {
        let (far_column, far_row) = (side - 1 - column, side - 1 - row);
        let at = |column: usize, row: usize| in_memory[row * side + column];
        let near = select_bit(a, mirror_u, at(far_column, row), at(column, row));
        let far = select_bit(a, mirror_u, at(far_column, far_row), at(column, far_row));
        ordered[place] = select_bit(a, mirror_v, far, near);
    }
    ordered
}

/// The depth of a height, in height steps.
pub(super) fn depth_of<A: Arith>(a: &mut A, shape: BoundedShape, height: A::Int) -> A::Int {
    // The full height is all ones, so that the difference is the complement.
    let yes = a.bit_constant(true);
    let complement = a.int_complement_if(yes, height);
    a.int_low_bits(complement, shape.words.height_bits)
}

/// The far border of each column or row, as memory has them.
fn far_borders<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    mirror: A::Bit,
    bounds: &Bounds<A>,
) -> [(A::Int, A::Bit); MOST_SIDE] {
    let side = shape.lines().side();
    let mut far = [(bounds.step[1], bounds.is_beyond[1]); MOST_SIDE];
    for (n, far) in far.iter_mut().enumerate().take(side) {
        let step = a.int_select(mirror, bounds.step[side - n], bounds.step[n + 1]);
        let is_beyond = select_bit(
            a,
            mirror,
            bounds.is_beyond[side - n],
            bounds.is_beyond[n + 1],
        );
        *far = (step, is_beyond);
    }
    far
}

/// By column border, then row border.
const U_MAY_BE_FIRST: [[&str; MOST_SIDE + 1]; MOST_SIDE + 1] = [
    [
        "u_may_lead_00",
        "u_may_lead_01",
        "u_may_lead_02",
        "u_may_lead_03",
        "u_may_lead_04",
    ],
    [
        "u_may_lead_10",
        "u_may_lead_11",
        "u_may_lead_12",
        "u_may_lead_13",
        "u_may_lead_14",
    ],
    [
        "u_may_lead_20",
        "u_may_lead_21",
        "u_may_lead_22",
        "u_may_lead_23",
        "u_may_lead_24",
    ],
    [
        "u_may_lead_30",
        "u_may_lead_31",
        "u_may_lead_32",
        "u_may_lead_33",
        "u_may_lead_34",
    ],
    [
        "u_may_lead_40",
        "u_may_lead_41",
        "u_may_lead_42",
        "u_may_lead_43",
        "u_may_lead_44",
    ],
];
const V_MAY_BE_FIRST: [[&str; MOST_SIDE + 1]; MOST_SIDE + 1] = [
    [
        "v_may_lead_00",
        "v_may_lead_01",
        "v_may_lead_02",
        "v_may_lead_03",
        "v_may_lead_04",
    ],
    [
        "v_may_lead_10",
        "v_may_lead_11",
        "v_may_lead_12",
        "v_may_lead_13",
        "v_may_lead_14",
    ],
    [
        "v_may_lead_20",
        "v_may_lead_21",
        "v_may_lead_22",
        "v_may_lead_23",
        "v_may_lead_24",
    ],
    [
        "v_may_lead_30",
        "v_may_lead_31",
        "v_may_lead_32",
        "v_may_lead_33",
        "v_may_lead_34",
    ],
    [
        "v_may_lead_40",
        "v_may_lead_41",
        "v_may_lead_42",
        "v_may_lead_43",
        "v_may_lead_44",
    ],
];
