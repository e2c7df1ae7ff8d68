//! The borders of a line's columns or rows, and the depths at which a ray crosses them.

use super::traverse_step::{EXACT_EXIT_ULPS, ROUNDED_EXIT_ULPS};
use super::wide_shape::MOST_SIDE;
use crate::arith::Arith;
use crate::float::Rounding::TowardZero;

/// The names of a border's signals.
struct BorderNames {
    border: &'static str,
    is_behind: &'static str,
    distance: &'static str,
    distance_is_exact: &'static str,
    quotient: &'static str,
    depth: &'static str,
    bound: &'static str,
}

/// The names of an axis's signals, border by border from the near end.
pub(super) struct WideAxisNames([BorderNames; MOST_SIDE + 1]);

/// What the step needs of a ray on one axis.
pub(super) struct WideAxis<A: Arith> {
    pub(super) names: &'static WideAxisNames,
    pub(super) coordinate: A::Num,
    pub(super) direction: A::Num,
    pub(super) exact_below: A::Num,
}

/// A border of a column or row.
#[derive(Debug)]
pub(super) struct Border<A: Arith> {
    /// The ray starts on it or behind it.
    pub(super) is_behind: A::Bit,
    /// The depth at which the ray crosses it, never later than in truth; zero if it is behind.
    pub(super) depth: A::Num,
    /// The same, never earlier.
    pub(super) bound: A::Num,
}

impl<A: Arith> Clone for Border<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for Border<A> {}

/// The borders of `side` cells in a row on an axis, from cell `first` on, near to far: one more than
/// cells; what is left of the array is the last one again.
pub(super) fn borders<A: Arith>(
    a: &mut A,
    side: usize,
    axis: &WideAxis<A>,
    size_exponent: A::Int,
    first: A::Int,
) -> [Border<A>; MOST_SIDE + 1] {
    let nearest = border(a, axis, 0, size_exponent, first);
    let mut borders = [nearest; MOST_SIDE + 1];
    for n in 1..=MOST_SIDE {
        borders[n] = if n <= side {
            border(a, axis, n, size_exponent, first)
        } else {
            borders[n - 1]
        };
    }
    borders
}

fn border<A: Arith>(
    a: &mut A,
    axis: &WideAxis<A>,
    n: usize,
    size_exponent: A::Int,
    first: A::Int,
) -> Border<A> {
    let names = &axis.names.0[n];
    let n = a.int_constant(n as i64);
    let index = a.int_add(first, n);
    // Exact: an index has no more bits than a significand.
    let border = a.number_from_integer(TowardZero, index, size_exponent);
    a.name_num(names.border, border);
    let is_behind = a.less_equal(border, axis.coordinate);
    a.name_bit(names.is_behind, is_behind);
    let distance = a.sub(TowardZero, border, axis.coordinate);
    a.name_num(names.distance, distance);
    let quotient = a.div(TowardZero, distance, axis.direction);
    a.name_num(names.quotient, quotient);
    // A border is a multiple of a texel, and within reach multiples of a texel are representable:
    // only the coordinate's grain can have been lost.
    let is_exact = a.less_than(distance, axis.exact_below);
    a.name_bit(names.distance_is_exact, is_exact);
    let near_bound = a.ulps_up(quotient, EXACT_EXIT_ULPS);
    let far_bound = a.ulps_up(quotient, ROUNDED_EXIT_ULPS);
    let bound = a.select(is_exact, near_bound, far_bound);
    // What a border behind the ray would be divided to means nothing: zero by zero, or below zero.
    let zero = a.zero();
    let depth = a.select(is_behind, zero, quotient);
    a.name_num(names.depth, depth);
    let bound = a.select(is_behind, zero, bound);
    a.name_num(names.bound, bound);
    Border {
        is_behind,
        depth,
        bound,
    }
}

macro_rules! border_names {
    ($axis:literal, $n:literal) => {
        BorderNames {
            border: concat!("border_", $axis, "_", $n),
            is_behind: concat!("border_", $axis, "_", $n, "_is_behind"),
            distance: concat!("distance_", $axis, "_", $n),
            distance_is_exact: concat!("distance_", $axis, "_", $n, "_is_exact"),
            quotient: concat!("quotient_", $axis, "_", $n),
            depth: concat!("crossing_", $axis, "_", $n),
            bound: concat!("crossing_", $axis, "_", $n, "_bound"),
        }
    };
}

macro_rules! axis_names {
    ($axis:literal) => {
        WideAxisNames([
            border_names!($axis, 0),
            border_names!($axis, 1),
            border_names!($axis, 2),
            border_names!($axis, 3),
            border_names!($axis, 4),
        ])
    };
}

pub(super) static WIDE_U: WideAxisNames = axis_names!("u");
pub(super) static WIDE_V: WideAxisNames = axis_names!("v");
