//! The leaf check of a walk by bounds: does the ray hit the texel that the walk has come to? Exact,
//! and without a multiplier.
//!
//! Products are made a binary digit of one factor a turn, the highest first: `sum = 2 * sum + digit * slope`.
//!
//! 1. *Where is the ray at the texel's depth?* [`travel_digit`], as often as a height has bits, on
//!    both axes at once. Beyond a far border, the texel is refused; between the borders, the ray
//!    hits the top.
//! 2. *Which border is crossed first?* Only of a ray that is still before the texel at its depth,
//!    and may pass by: the error term of [`super::fixed_setup`] at the near corner, by
//!    [`corner_digit`]. It tells by which side the ray comes in, or that it does not. Where the bounds
//!    of the texel's borders tell already ([`SeenCorner`]), it is not computed: 0 or -1 stands for it.

use super::bounded_shape::BoundedShape;
use super::fixed_setup::{FixedRayRegisters, shift_left_by, shift_right_by};
use crate::arith::Arith;

/// The way of a ray to a texel, as far as the digits of its depth go.
#[derive(Debug)]
pub struct LeafTravel<A: Arith> {
    /// From the near border on u to the ray: in units of an entry before the first digit, of a
    /// position after the last.
    pub u: A::Int,
    /// The same on v.
    pub v: A::Int,
    /// The digits to come, the first the highest.
    pub depth: A::Int,
}

impl<A: Arith> Clone for LeafTravel<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for LeafTravel<A> {}

/// Where a ray is at a texel's depth.
#[derive(Debug)]
pub struct LeafPlace<A: Arith> {
    /// Beyond a far border, or the texel lies behind the start.
    pub is_beyond: A::Bit,
    /// Not beyond the near border on u, which is ahead of the start.
    pub is_before_u: A::Bit,
    /// The same on v.
    pub is_before_v: A::Bit,
}

impl<A: Arith> Clone for LeafPlace<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for LeafPlace<A> {}

/// The error term at a texel's near corner, as far as its digits go.
#[derive(Debug)]
pub struct LeafCorner<A: Arith> {
    /// From the near border on u to the ray's entry, its digits to come, the first the highest.
    pub u: A::Int,
    /// The same on v.
    pub v: A::Int,
    /// The term.
    pub error: A::Int,
}

impl<A: Arith> Clone for LeafCorner<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for LeafCorner<A> {}

/// What a step says of the near corner of the texel that it comes to.
#[derive(Debug)]
pub struct SeenCorner<A: Arith> {
    /// Its near borders are crossed in the order of their bounds, and both before either far one.
    pub is_known: A::Bit,
    /// If so: that on v later.
    pub v_is_later: A::Bit,
}

impl<A: Arith> Clone for SeenCorner<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arith> Copy for SeenCorner<A> {}

/// What a leaf check answers.
#[derive(Debug)]
pub struct LeafVerdict<A: Arith> {
    /// The ray does not hit the texel.
    pub refused: A::Bit,
    /// It hits the side on u.
    pub at_border_u: A::Bit,
    /// It hits the side on v.
    pub at_border_v: A::Bit,
}

/// The ways from the texel's near borders to the ray's entry, in units of an entry.
pub fn leaf_ways<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &FixedRayRegisters<A>,
    i: A::Int,
    j: A::Int,
) -> (A::Int, A::Int) {
    let mut way = |texel, entry| {
        let border = shift_left_by(
            a,
            texel,
            shape.index_bits(),
            shape.words.entry_fraction_bits,
        );
        let way = a.int_sub(entry, border);
        a.int_wrap(way, shape.way_bits())
    };
    (way(i, ray.u), way(j, ray.v))
}

/// A digit of the texel's depth.
pub fn travel_digit<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &FixedRayRegisters<A>,
    travel: &LeafTravel<A>,
) -> LeafTravel<A> {
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    let height_bits = shape.words.height_bits;
    let highest = a.int_constant(1 << (height_bits - 1));
    let digit = a.int_and(travel.depth, highest);
    let is_zero = a.int_equal(digit, zero);
    let mut on = |way, slope| {
        let doubled = a.int_shift_left(way, one, 1);
        let step = a.int_select(is_zero, zero, slope);
        let way = a.int_add(doubled, step);
        a.int_wrap(way, shape.way_bits() + height_bits)
    };
    let (u, v) = (on(travel.u, ray.slope_u), on(travel.v, ray.slope_v));
    let depth = a.int_shift_left(travel.depth, one, 1);
    let depth = a.int_low_bits(depth, height_bits);
    LeafTravel { u, v, depth }
}

/// Where the ray is after the last digit; `ways` are those it began with.
pub fn leaf_place<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ways: (A::Int, A::Int),
    travel: &LeafTravel<A>,
) -> LeafPlace<A> {
    let zero = a.int_constant(0);
    let one = a.int_constant(1);
    let fraction_bits = shape.words.fraction_bits();
    // Against 0 and a texel, by the bits: there is nothing to subtract.
    let mut axis = |way, position| {
        let starts_before = a.int_less_than(way, zero);
        let texels = shift_right_by(a, way, shape.words.entry_fraction_bits);
        let is_first = a.int_equal(texels, zero);
        let is_ahead = a.or(starts_before, is_first);
        let is_behind = a.not(is_ahead);
        let is_negative = a.int_less_than(position, zero);
        let texels = shift_right_by(a, position, fraction_bits);
        let fraction = a.int_low_bits(position, fraction_bits);
        let at_border = a.int_equal(fraction, zero);
        let below_one = a.int_equal(texels, zero);
        let at_one = a.int_equal(texels, one);
        let at_far = a.and(at_one, at_border);
        let at_near = a.and(below_one, at_border);
        let stays = a.or(is_negative, below_one);
        let stays = a.or(stays, at_far);
        let passes = a.not(stays);
        let is_outside = a.or(is_negative, at_near);
        (a.or(is_behind, passes), a.and(starts_before, is_outside))
    };
    let (beyond_u, is_before_u) = axis(ways.0, travel.u);
    let (beyond_v, is_before_v) = axis(ways.1, travel.v);
    LeafPlace {
        is_beyond: a.or(beyond_u, beyond_v),
        is_before_u,
        is_before_v,
    }
}

/// The error term before its first digit: that of the signs of the ways. Or, where the corner is known,
/// one of which the verdict is the same as of the error term itself: there are no digits then.
pub fn corner_start<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &FixedRayRegisters<A>,
    (u, v): (A::Int, A::Int),
    corner: SeenCorner<A>,
) -> LeafCorner<A> {
    let zero = a.int_constant(0);
    let u_is_negative = a.int_less_than(u, zero);
    let v_is_negative = a.int_less_than(v, zero);
    let up = a.int_select(u_is_negative, ray.slope_v, zero);
    let down = a.int_select(v_is_negative, ray.slope_u, zero);
    let error = a.int_sub(up, down);
    let minus_one = a.int_constant(-1);
    let seen = a.int_select(corner.v_is_later, minus_one, zero);
    let error = a.int_select(corner.is_known, seen, error);
    let digits = shape.way_bits() - 1;
    LeafCorner {
        u: a.int_low_bits(u, digits),
        v: a.int_low_bits(v, digits),
        error,
    }
}

/// Digits of the error term.
pub const fn corner_digits(shape: BoundedShape) -> u32 {
    shape.way_bits() - 1
}

/// A digit of either way.
pub fn corner_digit<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &FixedRayRegisters<A>,
    corner: &LeafCorner<A>,
) -> LeafCorner<A> {
    let one = a.int_constant(1);
    let zero = a.int_constant(0);
    let digits = corner_digits(shape);
    let highest = a.int_constant(1 << (digits - 1));
    let mut next = |way, slope| {
        let digit = a.int_and(way, highest);
        let is_zero = a.int_equal(digit, zero);
        let product = a.int_select(is_zero, zero, slope);
        let rest = a.int_shift_left(way, one, 1);
        (product, a.int_low_bits(rest, digits))
    };
    // (corner - entry) * other slope, on u less on v.
    let (down, u) = next(corner.u, ray.slope_v);
    let (up, v) = next(corner.v, ray.slope_u);
    let doubled = a.int_shift_left(corner.error, one, 1);
    let error = a.int_add(doubled, up);
    let error = a.int_sub(error, down);
    let error = a.int_wrap(error, corner_bits(shape));
    LeafCorner { u, v, error }
}

/// Bits of the error term, signed: of a texel that the ray may miss, so as long as both factors.
pub const fn corner_bits(shape: BoundedShape) -> u32 {
    shape.way_bits() + shape.words.slope_bits + 1
}

/// The verdict, from the place at the texel's depth and the error term at its near corner, which
/// does not matter where the ray is before neither border.
pub fn leaf_verdict<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &FixedRayRegisters<A>,
    ways: (A::Int, A::Int),
    place: &LeafPlace<A>,
    error: A::Int,
) -> LeafVerdict<A> {
    let zero = a.int_constant(0);
    let is_before = a.or(place.is_before_u, place.is_before_v);
    // The near border on u is crossed no later than the far one on v, and the near one on v, if it is
    // ahead, before the far one on u.
    let (slope_bits, fraction) = (shape.words.slope_bits + 1, shape.words.entry_fraction_bits);
    let texel_u = shift_left_by(a, ray.slope_u, slope_bits, fraction);
    let v_is_left = a.int_less_than(texel_u, error);
    let texel_v = shift_left_by(a, ray.slope_v, slope_bits, fraction);
    let at_far_u = a.int_add(error, texel_v);
    let is_left_before = a.int_less_than(at_far_u, zero);
    let is_left_there = a.int_equal(at_far_u, zero);
    let u_is_left = a.or(is_left_before, is_left_there);
    let v_is_ahead = a.int_less_than(ways.1, zero);
    let u_is_left = a.and(u_is_left, v_is_ahead);
    let passes_by = a.or(v_is_left, u_is_left);
    let passes_by = a.and(is_before, passes_by);
    let refused = a.or(place.is_beyond, passes_by);
    // Of both near borders the one crossed later is the side.
    let v_is_later = a.int_less_than(error, zero);
    let u_is_later = a.not(v_is_later);
    let inside_v = a.not(place.is_before_v);
    let u_counts = a.or(u_is_later, inside_v);
    let at_border_u = a.and(place.is_before_u, u_counts);
    let not_u = a.not(at_border_u);
    LeafVerdict {
        refused,
        at_border_u,
        at_border_v: a.and(place.is_before_v, not_u),
    }
}

/// The whole check of a texel with this depth.
pub fn leaf_check<A: Arith>(
    a: &mut A,
    shape: BoundedShape,
    ray: &FixedRayRegisters<A>,
    (i, j): (A::Int, A::Int),
    depth: A::Int,
    seen: SeenCorner<A>,
) -> LeafVerdict<A> {
    let ways = leaf_ways(a, shape, ray, i, j);
    let mut travel = LeafTravel {
        u: ways.0,
        v: ways.1,
        depth,
    };
    for _ in 0..shape.words.height_bits {
        travel = travel_digit(a, shape, ray, &travel);
    }
    let place = leaf_place(a, shape, ways, &travel);
    let start = corner_start(a, shape, ray, ways, seen);
    let mut corner = start;
    for _ in 0..corner_digits(shape) {
        corner = corner_digit(a, shape, ray, &corner);
    }
    let error = a.int_select(seen.is_known, start.error, corner.error);
    leaf_verdict(a, shape, ray, ways, &place, error)
}
